#include "apps/results/monitoring/tracked_modes.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "apps/results/terminal.hpp"
#include "apps/words.hpp"
#include "base/constants.hpp"
#include "base/index.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {
namespace {

using identification::monitoring::modal_assurance;

double frequency_sd(const ModesFile& modes, Eigen::Index m) {
  return modes.covariance.size() > 0 ? std::sqrt(modes.covariance(m, m)) : kNaN;
}

struct TrackedRow {
  double median = kNaN, low = kNaN, high = kNaN, probability = 0.0;
  std::size_t present = 0;
};

TrackedRow row_of_mode(const TrackedModesOf& tracked, std::size_t k) {
  TrackedRow out;
  std::vector<double> frequencies;
  for (std::size_t t = 0; t < tracked.records.size(); ++t) {
    const int m = tracked.records[t].mode[k];
    if (m < 0) continue;
    frequencies.push_back(tracked.tests[t].modes.frequencies_hz[m]);
    out.probability += tracked.records[t].probability[static_cast<Eigen::Index>(k)];
  }
  out.present = frequencies.size();
  if (frequencies.empty()) return out;
  std::ranges::sort(frequencies);
  out.low = frequencies.front();
  out.high = frequencies.back();
  out.median = frequencies[frequencies.size() / 2];
  out.probability /= static_cast<double>(frequencies.size());
  return out;
}

}  // namespace

std::string tracked_netcdf(const TrackedModesOf& tracked, const std::filesystem::path& path) {
  const std::size_t n = tracked.records.size(), count = tracked.modes.size();
  std::vector<double> frequency, sd, damping, probability, mac, spurious;
  std::vector<int> number, modes;
  std::string files;
  for (std::size_t t = 0; t < n; ++t) {
    const auto& record = tracked.records[t];
    const ModesFile& found = tracked.tests[t].modes;
    files += tracked.tests[t].name + "\n";
    modes.push_back(static_cast<int>(found.frequencies_hz.size()));
    spurious.push_back(static_cast<double>(record.pairs.cols()) - record.pairs.sum());
    for (std::size_t k = 0; k < count; ++k) {
      const int m = record.mode[k];
      probability.push_back(record.probability[static_cast<Eigen::Index>(k)]);
      number.push_back(m < 0 ? 0 : found.numbers.empty() ? m + 1 : found.numbers[index(m)]);
      frequency.push_back(m < 0 ? kNaN : found.frequencies_hz[m]);
      sd.push_back(m < 0 ? kNaN : frequency_sd(found, m));
      damping.push_back(m < 0 ? kNaN : found.damping[m]);
      mac.push_back(m < 0 || found.shapes.rows() < 2
                        ? kNaN
                        : modal_assurance(tracked.modes[k].shape, found.shapes.col(m)));
    }
  }
  std::vector<double> reference, scatter, detection;
  for (const auto& mode : tracked.modes) {
    reference.push_back(std::exp(mode.log_frequency));
    scatter.push_back(mode.scatter);
    detection.push_back(mode.detection);
  }
  io::NetcdfWriter file(path);
  const int root = file.root();
  const int records = file.dimension(root, "record", n, 1);
  const int of_modes = file.dimension(root, "mode", count, 1);
  const auto units = [&](int variable, const char* unit) {
    file.text(root, variable, "units", unit);
  };
  file.text(root, NC_GLOBAL, "files", files);
  units(file.put(root, "frequency", {records, of_modes}, frequency), "Hz");
  units(file.put(root, "frequency_sd", {records, of_modes}, sd), "Hz");
  units(file.put(root, "damping", {records, of_modes}, damping), "1");
  units(file.put(root, "probability", {records, of_modes}, probability), "1");
  units(file.put(root, "mac", {records, of_modes}, mac), "1");
  file.put(root, "number", {records, of_modes}, number);
  file.put(root, "modes", {records}, modes);
  file.put(root, "spurious", {records}, spurious);
  units(file.put(root, "reference_frequency", {of_modes}, reference), "Hz");
  units(file.put(root, "scatter", {of_modes}, scatter), "1");
  units(file.put(root, "detection", {of_modes}, detection), "1");
  return file.close();
}

void print_tracked(std::ostream& out, const TrackedModesOf& tracked, bool colour) {
  const Page page{out, colour};
  std::vector<std::vector<std::string>> rows = {
      {"mode", "f, median [Hz]", "lowest", "highest", "identified", "missing", "probability"}};
  for (std::size_t k = 0; k < tracked.modes.size(); ++k) {
    const TrackedRow row = row_of_mode(tracked, k);
    rows.push_back(
        {std::to_string(k + 1), number_or_dash(row.median, 6), number_or_dash(row.low, 6),
         number_or_dash(row.high, 6), std::to_string(row.present),
         std::to_string(tracked.records.size() - row.present), percent(row.probability)});
  }
  page.table(rows);
  double spurious = 0.0;
  for (const auto& record : tracked.records)
    spurious += static_cast<double>(record.pairs.cols()) - record.pairs.sum();
  page.wrapped(significant(spurious / static_cast<double>(tracked.records.size()), 2) +
                   " identified modes per record belong to no tracked mode, on average.",
               "", "");
}

Report tracked_report(const TrackedModesOf& tracked) {
  Report out = Report::array();
  for (std::size_t k = 0; k < tracked.modes.size(); ++k) {
    const TrackedRow row = row_of_mode(tracked, k);
    out.push_back({{"mode", k + 1},
                   {"frequency_hz",
                    {{"median", finite(row.median)},
                     {"lowest", finite(row.low)},
                     {"highest", finite(row.high)}}},
                   {"identified", row.present},
                   {"missing", tracked.records.size() - row.present},
                   {"mean_probability", row.probability}});
  }
  return out;
}

}  // namespace wheeltap::apps
