#include "apps/runs/monitor_run.hpp"

#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include "apps/report/monitor_page.hpp"
#include "apps/results/monitoring/chart_results.hpp"
#include "apps/results/monitoring/explained_change.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/running.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/netcdf/netcdf_writer.hpp"
#include "io/tables/delimited_text.hpp"

namespace wheeltap::apps {
namespace {

using identification::monitoring::Monitor;
using identification::monitoring::RowFinding;
namespace fs = std::filesystem;

constexpr const char* kStateVersion = "5";
constexpr const char* kStateFormat = "a monitoring state of wheeltap";

/// The stored state from which the next call continues.
struct MonitorState {
  Monitor monitor = {};
  std::int64_t rows = 0;        ///< processed rows of the series
  std::uint64_t checksum = 0;   ///< checksum of these rows
  std::string series_csv = {};  ///< fingerprint of series.csv
  std::string case_text = {};
};

std::uint64_t add_numbers(std::uint64_t hash, const double* numbers, Eigen::Index n,
                          Eigen::Index step) {
  for (Eigen::Index i = 0; i < n; ++i) {
    char bytes[sizeof(double)];
    std::memcpy(bytes, numbers + i * step, sizeof bytes);
    hash = io::fnv1a({bytes, sizeof bytes}, hash);
  }
  return hash;
}

/// The checksum, continued over rows [from, to) of time, features, sds and covariates.
std::uint64_t checksum_of(const MonitorCaseFile& parsed, std::int64_t from, std::int64_t to,
                          std::uint64_t hash) {
  const auto& series = parsed.series;
  const Eigen::Index n = series.rows();
  for (auto i = static_cast<Eigen::Index>(from); i < to; ++i) {
    hash = add_numbers(hash, &series.hours[index(i)], 1, 1);
    for (const Eigen::MatrixXd* table : {&parsed.features, &series.sds, &series.covariates})
      if (table->size() > 0) hash = add_numbers(hash, table->data() + i, table->cols(), n);
    if (parsed.tests) hash = io::fnv1a(std::to_string(parsed.tests->checksums[index(i)]), hash);
  }
  return hash;
}

/// The case as text, without keys that may change between calls.
std::string case_text_of(const MonitorCaseFile& parsed, std::uint64_t seed) {
  Json kept = parsed.file.json;
  for (const char* key : {"title", "notes", "$schema", "on_alarm", "truth"}) kept.erase(key);
  return kept.dump() + " seed " + std::to_string(seed);
}

std::string state_bytes(const MonitorState& state, const fs::path& path) {
  base::Packer packer;
  carry(packer, state.monitor);
  const std::string bytes = std::move(packer).bytes();
  const std::vector<std::uint8_t> numbers(bytes.begin(), bytes.end());
  io::NetcdfWriter file(path);
  const int root = file.root();
  file.text(root, NC_GLOBAL, "format", kStateFormat);
  file.text(root, NC_GLOBAL, "version", kStateVersion);
  file.text(root, NC_GLOBAL, "fingerprint", io::fingerprint(bytes));
  file.text(root, NC_GLOBAL, "case", state.case_text);
  file.text(root, NC_GLOBAL, "series_csv", state.series_csv);
  file.column(root, "rows", std::vector<std::int64_t>{state.rows});
  file.column(root, "checksum",
              std::vector<std::int64_t>{static_cast<std::int64_t>(state.checksum)});
  file.column(root, "monitor", numbers);
  return file.close();
}

std::optional<MonitorState> read_monitor_state(const fs::path& path) {
  using Kind = io::FileError::Kind;
  if (!fs::exists(path)) return {};
  const io::NetcdfReader file(io::read_bytes(path), path, kStateFormat);
  if (file.text("format") != kStateFormat) file.foreign("has another format");
  if (file.text("version") != kStateVersion)
    throw io::FileError(Kind::version, path,
                        "is of another version of wheeltap: run once without --resume");
  const auto numbers = file.column<std::vector<std::uint8_t>>(file.root(), "monitor");
  const std::string bytes(numbers.begin(), numbers.end());
  const auto rows = file.column<std::vector<std::int64_t>>(file.root(), "rows");
  const auto checksum = file.column<std::vector<std::int64_t>>(file.root(), "checksum");
  if (io::fingerprint(bytes) != file.text("fingerprint") || rows.size() != 1 ||
      checksum.size() != 1)
    throw io::FileError(Kind::corrupt, path, "is corrupt: run once without --resume");
  MonitorState out{.rows = rows[0],
                   .checksum = static_cast<std::uint64_t>(checksum[0]),
                   .series_csv = file.text("series_csv"),
                   .case_text = file.text("case")};
  base::Unpacker unpacker(bytes);
  carry(unpacker, out.monitor);
  return out;
}

void check_continues(const MonitorCaseFile& parsed, const MonitorState& state,
                     const std::string& case_text) {
  if (state.case_text != case_text)
    throw Failure(Exit::bad_input,
                  parsed.file.path.string() +
                      ": the case or the seed differs from that of state.nc: run once without "
                      "--resume to begin anew");
  const Pointer source = source_of(parsed.file);
  if (parsed.series.rows() < state.rows)
    parsed.file.refuse(source,
                       "has " + std::to_string(parsed.series.rows()) + " rows, but " +
                           std::to_string(state.rows) +
                           " were processed already: rows must be appended; run once without "
                           "--resume to begin anew");
  if (checksum_of(parsed, 0, state.rows, 0) != state.checksum)
    parsed.file.refuse(source,
                       "some of the first " + std::to_string(state.rows) +
                           " rows have changed since they were processed: restore them, or run "
                           "once without --resume to begin anew");
}

MonitorState learn(const MonitorCaseFile& parsed, const CommonOptions& common, std::uint64_t seed) {
  ProgressBar bar(common.quiet);
  auto options = parsed.options;
  options.learning.seed = options.replay.seed = seed;
  options.learning.threads = options.replay.threads = base::thread_count(common.threads);
  options.progress = [&](const char* stage, double fraction) {
    bar.show(stage, fraction, "");
    return true;
  };
  MonitorState out{.monitor = Monitor(parsed.series.first(parsed.learning_rows), options)};
  bar.clear();
  return out;
}

}  // namespace

MonitorRun run_monitor(const MonitorCaseFile& parsed, const CommonOptions& common,
                       const MonitorRunOptions& options) {
  const fs::path& folder = common.output;
  io::finish_commit(folder);
  const std::uint64_t seed = common.seed.value_or(1);
  const std::string case_text = case_text_of(parsed, seed);
  std::optional<MonitorState> state;
  std::string table;
  if (common.resume) state = read_monitor_state(folder / "state.nc");
  if (state) {
    check_continues(parsed, *state, case_text);
    table = io::read_bytes(folder / "series.csv");
    if (io::fingerprint(table) != state->series_csv)
      throw io::FileError(
          io::FileError::Kind::mismatch, folder / "series.csv",
          "differs from the file that the last call wrote: run once without --resume");
  } else {
    state = learn(parsed, common, seed);
    state->case_text = case_text;
    table = series_header(parsed);
    for (const RowFinding& row : state->monitor.learned())
      table += series_row(parsed, static_cast<int>(state->rows++), row);
    state->checksum = checksum_of(parsed, 0, state->rows, 0);
  }
  const Eigen::VectorXd usual =
      identification::monitoring::usual_sds(parsed.series, parsed.learning_rows);
  const std::int64_t first = state->rows;
  const std::size_t earlier = state->monitor.alarms().size();
  for (; state->rows < parsed.series.rows(); ++state->rows) {
    const int i = static_cast<int>(state->rows);
    table += series_row(parsed, i, state->monitor.add(row_of(parsed.series, i, usual)));
  }
  state->checksum = checksum_of(parsed, first, state->rows, state->checksum);
  state->series_csv = io::fingerprint(table);

  Report summary =
      monitor_summary(parsed, state->monitor, {.seed = seed, .command_line = common.command_line});
  add_explanations(parsed, explanations(parsed, state->monitor, base::thread_count(common.threads)),
                   summary);
  summary["files"]["series.csv"] = seal(table);
  std::string charts;
  if (options.charts) {
    const auto found = identification::monitoring::run_charts(
        parsed.series, parsed.learning_rows, std::exp(state->monitor.log_threshold_stated()),
        base::thread_count(common.threads));
    charts = charts_csv(parsed, found);
    summary["monitor"]["charts"] = charts_json(parsed, state->monitor, found);
    summary["files"]["charts.csv"] = seal(charts);
  }
  std::optional<io::Columns> chart_table;
  if (options.charts) chart_table = io::parse_delimited_text(charts, folder / "charts.csv");
  const std::string page =
      monitor_page(summary, io::parse_delimited_text(table, folder / "series.csv"), chart_table);
  io::AtomicFile series(folder / "series.csv"), kept(folder / "state.nc"),
      report(folder / "report.html"), whole(folder / "summary.json");
  std::optional<io::AtomicFile> compared;
  series.write(table);
  kept.write(state_bytes(*state, folder / "state.nc"));
  report.write(page);
  whole.write(summary.dump(1) + "\n");
  std::vector<io::AtomicFile*> files = {&series, &kept, &report, &whole};
  if (options.charts) {
    compared.emplace(folder / "charts.csv").write(charts);
    files.push_back(&*compared);
  }
  io::commit_together(files);
  return {.summary = std::move(summary), .new_alarms = state->monitor.alarms().size() - earlier};
}

}  // namespace wheeltap::apps
