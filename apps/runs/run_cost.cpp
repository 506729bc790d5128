#include "apps/runs/run_cost.hpp"

#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>

#include "apps/failure.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/file_error.hpp"
#include "io/netcdf/write_netcdf.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kGigabyte = 1e9;
std::string gigabytes(double bytes) {
  if (bytes < 0.01 * kGigabyte) return "0.01";
  return base::significant(bytes / kGigabyte, 2);
}

std::string rounded_cost(double x) {
  return x >= 1e3 && x < 1e15 ? base::grouped(std::lround(std::stod(base::significant(x, 2))))
                              : base::significant(x, 2);
}

}  // namespace

std::string in_words(const RunCost& cost) {
  std::string text = "about " + gigabytes(cost.bytes) + " GB of memory";
  if (cost.disk > 0.0) text += " and " + gigabytes(cost.disk) + " of disk";
  if (cost.likelihoods > 0.0) {
    text += ", " + rounded_cost(cost.likelihoods) + " likelihood evaluations or FE runs";
  }
  if (cost.seconds_a_likelihood > 0.0)
    text += " of " + base::significant(1e3 * cost.seconds_a_likelihood, 2) + " ms each";
  if (cost.seconds > 0.0) {
    text += ", " + duration(cost.seconds);
  }
  return text;
}

void print_estimate(const std::string& what, const RunCost& cost) {
  std::cout << "The " << what << " would take " << in_words(cost) << ".\n";
}

std::string estimate_json(const std::string& what, const RunCost& cost) {
  return Json({{"what", what},
               {"memory_bytes", cost.bytes},
               {"disk_bytes", cost.disk},
               {"likelihoods", cost.likelihoods},
               {"seconds", cost.seconds}})
      .dump();
}

void require_affordable(const CaseFile& file, const Pointer& where, const RunCost& cost,
                        const CommonOptions& common) {
  const auto refuse = [&](const std::string& option, double limit, const std::string& unit) {
    file.refuse(where, "would take " + in_words(cost) + "; --" + option + " allows " +
                           base::significant(limit, 4) + " " + unit);
  };
  if (cost.bytes > common.max_memory_gb * kGigabyte)
    refuse("max-memory", common.max_memory_gb, "GB");
  if (cost.seconds > common.max_hours * 3600.0) refuse("max-hours", common.max_hours, "h");
  if (common.max_disk_gb && cost.disk > *common.max_disk_gb * kGigabyte)
    refuse("max-disk", *common.max_disk_gb, "GB");
}

void require_room(const RunCost& cost, const CommonOptions& common) {
  const std::filesystem::path& folder = common.output;
  std::error_code unknown;
  const std::filesystem::space_info room = std::filesystem::space(folder, unknown);
  if (unknown || common.max_disk_gb) return;
  auto left = static_cast<double>(room.available);
  for (const auto& entry : std::filesystem::directory_iterator(folder, unknown))
    if (entry.path().filename().string().starts_with("checkpoint") &&
        entry.is_regular_file(unknown))
      left += static_cast<double>(entry.file_size(unknown));
  if (cost.disk <= left) return;
  throw io::FileError(io::FileError::Kind::unwritable, folder,
                      "the draws would take about " + gigabytes(cost.disk) +
                          " GB in this folder; " + gigabytes(left) +
                          " GB are free (--max-disk overrides this check)");
}

double draws_in_memory(const CommonOptions& common) {
  const bool has_folder =
      !common.output.empty() || common.dry_run;  // as in the runs of all commands
  return has_folder ? double{io::kNetcdfInMemory} : std::numeric_limits<double>::infinity();
}

double bytes_held() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

RunCost cost_of_truth(const CaseFile& file) {
  if (!file.json.contains("truth")) return {};
  const Json& truth = file.json["truth"];
  const double samples = truth["samples"].get<double>();
  std::size_t columns = 0;
  const auto count = [&](const Json& record) {
    columns += record["channels"].size() + truth["excitation"].size();
  };
  if (file.json.contains("record")) count(file.json["record"]);
  for (const Json& record : file.json.value("records", Json::array())) count(record);
  // Memory of every column: drawn, interpolated, simulated and with noise.
  return {.bytes = 8.0 * samples * (4.0 + 6.0 * static_cast<double>(columns))};
}

}  // namespace wheeltap::apps
