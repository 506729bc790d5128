#include <iostream>
#include <system_error>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/monitoring/monitor_truth.hpp"
#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/cases/simulation.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Writes the record simulated from the case's truth, as CSV.
void simulate_sid(const CommonOptions& common, CaseFile file) {
  if (common.output.extension() == ".json") {
    throw Failure(Exit::usage,
                  "--output: " + common.output.string() +
                      ": a simulated record is a table; the file name must end in .csv");
  }
  require_room_for_truth(file, common);
  const auto [record, title, seed] = simulated_record(std::move(file), common.seed);
  write_text(common.output,
             signals::record_csv(record, title + ", simulated by wheeltap " + WHEELTAP_VERSION +
                                             ", seed " + std::to_string(seed)));
  if (common.as_json)
    common.as_json(written_data(common.output, "simulated, seed " + std::to_string(seed),
                                static_cast<std::size_t>(record.samples()), "samples"));
  if (!common.quiet) {
    std::cout << record.samples() << " samples of " << record.columns.size()
              << " columns: " << io::printable(common.output.string()) << '\n';
  }
}

/// Writes the case with data simulated from its truth.
void simulate_update(const CommonOptions& common, CaseFile file) {
  if (common.output.extension() != ".json")
    throw Failure(
        Exit::usage,
        "--output: " + common.output.string() +
            ": simulated modes are written as a complete case; the file name must end in .json");
  const SimulatedCase simulated = simulated_update(std::move(file), common.seed);
  write_text(common.output, simulated.json.dump(2) + "\n");
  if (common.as_json)
    common.as_json(written_data(common.output, simulated.origin,
                                static_cast<std::size_t>(simulated.modes), "modes"));
  if (!common.quiet)
    std::cout << simulated.modes << " modes (" << simulated.origin
              << "): " << io::printable(common.output.string()) << '\n';
}

/// Writes the series simulated from the case's truth, as CSV.
void simulate_monitor(const CommonOptions& common, CaseFile file) {
  if (common.output.extension() == ".json")
    throw Failure(Exit::usage,
                  "--output: " + common.output.string() +
                      ": a simulated series is a table; the file name must end in .csv");
  const SimulatedTable table = simulated_table(std::move(file), common.seed);
  write_text(common.output, table.csv);
  if (common.as_json)
    common.as_json(written_data(common.output, "simulated, seed " + std::to_string(table.seed),
                                static_cast<std::size_t>(table.rows), "rows"));
  if (!common.quiet)
    std::cout << table.rows << " rows of " << table.features
              << " features: " << io::printable(common.output.string()) << '\n';
}

/// Writes noisy frequencies from the case's truth: as CSV, or as a complete case if the output ends
/// in .json.
void run_simulate(const CommonOptions& common) {
  std::error_code missing;
  if (std::filesystem::equivalent(common.output, common.case_path, missing))
    throw Failure(Exit::usage,
                  "--output: " + common.output.string() + " is the case itself: name another file");
  CaseFile file = read_case(common.case_path, common.overrides);
  if (file.json.value("kind", Json()) == "sid") return simulate_sid(common, std::move(file));
  if (file.json.value("kind", Json()) == "update") return simulate_update(common, std::move(file));
  if (file.json.value("kind", Json()) == "monitor")
    return simulate_monitor(common, std::move(file));
  const DamageCaseFile parsed = parse_damage_case(std::move(file), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  const std::uint64_t seed =
      common.seed.value_or(damage_case.simulation ? damage_case.simulation->seed : 1);
  const FrequencyData data = explained(parsed, [&] { return simulate(damage_case, seed); });
  std::string text;
  if (common.output.extension() == ".json") {
    text = with_simulated(parsed, data, seed).dump(2) + "\n";
  } else if (damage_case.modal() && !damage_case.modal()->sensors.empty()) {
    throw Failure(Exit::usage,
                  "--output: " + common.output.string() +
                      ": shapes are written as a complete case; the file name must end in .json");
  } else {
    text = frequency_csv({data.frequencies_hz, data.sd_hz},
                         damage_case.title + ", simulated by wheeltap " + WHEELTAP_VERSION +
                             ", seed " + std::to_string(seed));
  }
  write_text(common.output, text);
  if (common.as_json)
    common.as_json(
        written_data(common.output, data.origin, static_cast<std::size_t>(data.modes()), "modes"));
  if (!common.quiet) {
    const bool shapes = damage_case.modal() && !damage_case.modal()->sensors.empty();
    std::cout << data.modes() << (shapes ? " frequencies and shapes (" : " frequencies (")
              << data.origin << "): " << io::printable(common.output.string()) << '\n';
  }
}

}  // namespace

Command simulate_command() {
  return {.name = "simulate",
          .summary = "simulate data from the case's truth",
          .add_options =
              [](CommandOptions& options) {
                options.add_case();
                options.add_output(
                    "FILE", "file to write: .csv, or .json for a complete damage or update case");
                options.add_json("print a JSON summary of the written file");
                options.add_limits();
                options.add_seed("seed of the noise (default: that of the case, or 1)");
              },
          .run = [](const Invocation& asked) { run_simulate(asked.common); }};
}

}  // namespace wheeltap::apps
