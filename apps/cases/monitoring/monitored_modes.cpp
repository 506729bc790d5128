#include "apps/cases/monitoring/monitored_modes.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <sstream>

#include "apps/cases/modal_case.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "identification/modal/modal_record.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/text/text.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;
using identification::monitoring::IdentifiedMode;
using identification::monitoring::IdentifiedRecord;

const Pointer kModes("/series/modes"), kRecords("/series/records");
constexpr const char* kIndexFile = "index.json";

std::vector<std::string> names_of(const Json& value) {
  std::vector<std::string> out;
  if (value.is_string()) return {value.get<std::string>()};
  for (const Json& one : value) out.push_back(one.get<std::string>());
  return out;
}

std::vector<fs::path> sorted_files(const fs::path& folder,
                                   const std::function<bool(const fs::path&)>& wanted) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_regular_file() && wanted(entry.path())) out.push_back(entry.path());
  std::ranges::sort(out);
  return out;
}

std::vector<fs::path> files_in_folder(const fs::path& folder) {
  std::vector<fs::path> out = sorted_files(folder, [](const fs::path& p) {
    return p.extension() == ".json" && p.filename() != kIndexFile &&
           p.filename() != "summary.json" && p.filename() != "case.json";
  });
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_directory() && fs::exists(entry.path() / "modes.json"))
      out.push_back(entry.path() / "modes.json");
  std::ranges::sort(out);
  return out;
}

std::vector<fs::path> files_in_list(const fs::path& list) {
  std::vector<fs::path> out;
  std::istringstream lines(io::read_bytes(list));
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    const fs::path beside = list.parent_path() / line;
    fs::path found = fs::exists(beside) ? beside : fs::path(line);
    if (fs::is_directory(found)) found /= "modes.json";
    out.push_back(found);
  }
  return out;
}

std::vector<fs::path> files_of_name(const CaseFile& file, const std::string& name) {
  const fs::path path = name;
  const std::string last = path.filename().string();
  if (last.find_first_of("*?[") != std::string::npos)
    return sorted_files(file.place_of(path.has_parent_path() ? path.parent_path().string() : "."),
                        [&](const fs::path& p) {
                          return fnmatch(last.c_str(), p.filename().c_str(), FNM_PERIOD) == 0;
                        });
  return {file.place_of(name)};
}

MonitoredTest test_of(const fs::path& path) {
  return {.name = path.parent_path().filename() / path.filename(),
          .checksum = io::fnv1a(io::read_bytes(path))};
}

/// The fault of one record as one line.
std::string fault_of_record(const std::exception& error) {
  return io::printable(error.what());
}

/// Identifies modes by the modal case `json`, with `record` as its file.
ModesFile identify_record(const CaseFile& file, const fs::path& record, std::uint64_t seed) {
  CaseFile modal{.path = file.path,
                 .json = file.json.at(kRecords / "modal"),
                 .record_place = (kRecords / "modal" / "record").to_string()};
  modal.json["kind"] = "modal";
  modal.json["record"]["file"] = fs::absolute(record).string();
  ModalCaseFile parsed = parse_modal_case(std::move(modal));
  SetUp& set_up = parsed.set_ups.front();
  set_up.options.threads = 1;
  const signals::ModalResult result = identification::identify(set_up, seed);
  ModesFile out = measured_modes(result, parsed.sensors);
  out.title = record.stem().string();
  out.quantity = parsed.quantity;
  return out;
}

/// Stored modes of earlier calls: index.json, and a modes.json for each record.
class KeptModes {
 public:
  KeptModes(fs::path folder, std::string key) : folder_(std::move(folder)), key_(std::move(key)) {
    std::error_code error;
    if (folder_.empty() || !fs::exists(folder_ / kIndexFile, error)) return;
    const Json read = Json::parse(io::read_bytes(folder_ / kIndexFile), nullptr, false);
    if (read.is_object() && read.value("key", std::string()) == key_ && read.contains("records"))
      index_ = read.at("records");
  }
  /// Fills in the modes or the fault of an unchanged record.
  [[nodiscard]] bool find(MonitoredTest& test, const fs::path& path) const {
    const auto found = index_.find(path.string());
    if (found == index_.end() || found->value("checksum", std::uint64_t{0}) != test.checksum)
      return false;
    test.fault = found->value("fault", std::string());
    if (!test.fault.empty()) return true;
    const fs::path modes = folder_ / found->value("modes", std::string());
    if (!fs::is_regular_file(modes)) return false;
    test.modes = read_modes_file(modes);
    return true;
  }
  void keep(const MonitoredTest& test, const fs::path& path, std::size_t number) {
    if (folder_.empty()) return;
    Json one = {{"checksum", test.checksum}, {"fault", test.fault}};
    if (test.fault.empty()) {
      std::string digits = std::to_string(number + 1);
      digits.insert(0, digits.size() < 6 ? 6 - digits.size() : 0, '0');
      // The number and the name of the record may repeat when the list of records changes.
      const std::string name =
          digits + "_" + path.stem().string() + "_" + std::to_string(test.checksum) + ".json";
      fs::create_directories(folder_);
      io::AtomicFile written(folder_ / name);
      written.write(modes_json(test.modes).dump(1) + "\n");
      written.commit();
      one["modes"] = name;
    }
    index_[path.string()] = one;
    changed_ = true;
  }
  void write() const {
    if (folder_.empty() || !changed_) return;
    fs::create_directories(folder_);
    io::AtomicFile written(folder_ / kIndexFile);
    written.write(Json{{"key", key_}, {"records", index_}}.dump(1) + "\n");
    written.commit();
  }

 private:
  fs::path folder_;
  std::string key_;
  Json index_ = Json::object();
  bool changed_ = false;
};

}  // namespace

std::vector<fs::path> mode_files(const fs::path& path) {
  if (fs::is_directory(path)) return files_in_folder(path);
  if (path.extension() != ".json" && fs::is_regular_file(path)) return files_in_list(path);
  return {path};
}

std::vector<fs::path> listed_files(const CaseFile& file, const Pointer& where,
                                   const std::vector<std::string>& names) {
  std::vector<fs::path> out;
  for (const std::string& name : names)
    for (const fs::path& path : files_of_name(file, name)) {
      const std::vector<fs::path> more =
          where == kModes ? mode_files(path) : std::vector<fs::path>{path};
      out.insert(out.end(), more.begin(), more.end());
    }
  if (out.empty()) file.refuse(where, "there is no such file");
  for (const fs::path& path : out)
    if (!fs::is_regular_file(path))
      throw Failure(Exit::no_input, io::printable(path.string()) + ": no such file");
  return out;
}

std::vector<MonitoredTest> read_tests(const std::vector<fs::path>& paths, bool following) {
  std::vector<MonitoredTest> out;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    try {
      MonitoredTest test = test_of(paths[i]);
      test.modes = read_modes_file(paths[i]);
      out.push_back(std::move(test));
    } catch (const std::exception&) {
      if (!following || i + 1 < paths.size()) throw;
    }
  }
  return out;
}

std::vector<MonitoredTest> read_modes_of_tests(const CaseFile& file, const ModesReading& reading) {
  return read_tests(listed_files(file, kModes, names_of(file.json.at(kModes))), reading.following);
}

std::vector<MonitoredTest> identify_tests(const CaseFile& file, const ModesReading& reading) {
  const Pointer where = kRecords / "files";
  const std::vector<fs::path> paths = listed_files(file, where, names_of(file.json.at(where)));
  KeptModes kept(reading.kept, io::fingerprint(file.json.at(kRecords / "modal").dump() + " seed " +
                                               std::to_string(reading.seed)));
  std::vector<MonitoredTest> out(paths.size());
  std::vector<std::size_t> todo;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    out[i] = test_of(paths[i]);
    if (!kept.find(out[i], paths[i])) todo.push_back(i);
  }
  std::mutex guard;
  double done = 0.0;
  base::parallel_for(static_cast<int>(todo.size()), reading.threads, [&](int n) {
    const std::size_t i = todo[index(n)];
    try {
      out[i].modes = identify_record(file, paths[i], reading.seed);
    } catch (const std::exception& error) {
      out[i].fault = fault_of_record(error);
    }
    const std::scoped_lock lock(guard);
    done += 1.0;
    if (reading.progress) reading.progress(done / static_cast<double>(todo.size()));
  });
  if (reading.following && !out.empty() && !out.back().fault.empty()) out.pop_back();
  if (std::ranges::all_of(out, [](const MonitoredTest& t) { return !t.fault.empty(); }))
    throw Failure(Exit::bad_input, out.empty() ? "no record can be read yet" : out.front().fault);
  for (const std::size_t i : todo)
    if (i < out.size()) kept.keep(out[i], paths[i], i);
  kept.write();
  return out;
}

std::vector<const MonitoredTest*> tests_named(const std::string& name,
                                              const std::vector<MonitoredTest>& tests) {
  std::vector<const MonitoredTest*> exact, similar;
  for (const MonitoredTest& test : tests) {
    if (test.name == name) exact.push_back(&test);
    if (fs::path(test.name).filename() == fs::path(name).filename()) similar.push_back(&test);
  }
  return exact.empty() ? similar : exact;
}

std::vector<IdentifiedRecord> identified_records(const std::vector<MonitoredTest>& tests) {
  std::vector<IdentifiedRecord> out;
  const MonitoredTest* first = nullptr;
  for (const MonitoredTest& test : tests) {
    const ModesFile& modes = test.modes;
    IdentifiedRecord record;
    if (test.fault.empty()) {
      if (first == nullptr) first = &test;
      if (modes.shapes.rows() != first->modes.shapes.rows())
        throw Failure(Exit::bad_input, io::printable(test.name) + ": has " +
                                           std::to_string(modes.shapes.rows()) + " sensors, but " +
                                           io::printable(first->name) + " has " +
                                           std::to_string(first->modes.shapes.rows()) +
                                           ": all tests must measure at the same sensors");
    }
    for (Eigen::Index m = 0; m < modes.frequencies_hz.size(); ++m) {
      if (!(modes.frequencies_hz[m] > 0.0)) continue;
      IdentifiedMode one{.frequency_hz = modes.frequencies_hz[m],
                         .doubtful = index(m) < modes.doubtful.size() && modes.doubtful[index(m)]};
      if (modes.covariance.size() > 0) one.frequency_sd = std::sqrt(modes.covariance(m, m));
      if (modes.shapes.rows() > 1) one.shape = modes.shapes.col(m);
      record.push_back(std::move(one));
    }
    out.push_back(std::move(record));
  }
  return out;
}

}  // namespace wheeltap::apps
