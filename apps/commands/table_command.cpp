#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>

#include "apps/cases/damage_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/damage_summary.hpp"
#include "apps/results/damage_terminal.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/whole_number.hpp"
#include "base/parallel.hpp"
#include "emulator/journal.hpp"
#include "identification/emulation/frequency_tables.hpp"
#include "identification/structural/damage/damage_cost.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

struct TableOptions {
  std::string part;                          ///< "I/N": compute only this part of the runs
  std::vector<std::filesystem::path> merge;  ///< parts to merge; their runs are not repeated
};

// Parses "2/5" (the second of five parts) to 0-based indices.
std::pair<int, int> parse_part(const std::string& text) {
  constexpr std::int64_t kMostParts = 1'000'000;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto parts =
      whole_number(std::string_view(text).substr(std::min(slash + 1, text.size())), 1, kMostParts);
  const auto part =
      whole_number(std::string_view(text).substr(0, slash), 1, parts.value_or(kMostParts));
  if (!part || !parts) {
    throw Failure(Exit::usage,
                  "--part " + text + ": must be I/N with 1 <= I <= N <= 1000000, e.g. 1/4");
  }
  return {static_cast<int>(*part - 1), static_cast<int>(*parts)};
}

emulator::TableFile read_parts(const std::vector<std::filesystem::path>& paths,
                               const DamageCase& damage_case) {
  std::vector<emulator::TableFile> parts;
  for (const auto& path : paths) {
    parts.push_back(emulator::read_table_file(
        path,
        {.expected_fingerprint = beam_fingerprint(damage_case.beam), .allow_incomplete = true}));
  }
  try {
    return emulator::merge(parts);
  } catch (const std::invalid_argument& error) {
    throw Failure(Exit::bad_input, paths[0].string() + " and others: " + error.what());
  }
}

/// Throws Failure if the case does not define a table to compute, or if the options do not fit it.
void require_table_case(const DamageCaseFile& parsed, const TableOptions& options) {
  const DamageCase& damage_case = parsed.damage;
  const Pointer predictor("/predictor");
  if (damage_case.structure) {
    parsed.file.refuse(Pointer("/structure"),
                       "an emulator is trained on a beam, not on a structure");
  }
  if (parsed.outside)
    parsed.file.refuse(predictor,
                       "a table holds runs of Wheeltap's beam model only; a damage case stores the "
                       "predictions of this model in its \"memory\"");
  if (!damage_case.emulator || damage_case.emulator->table) {
    parsed.file.refuse(
        predictor, "must describe a table to compute: {\"sites\": [...], \"multipliers\": [...]}");
  }
  const EmulatorSpec& spec = *damage_case.emulator;
  const DefectKind& kind = damage_case.kinds[0];
  if (kind.max_count < 1) {
    parsed.file.refuse(parsed.kinds[0] / "count" / "max",
                       "must be at least 1: a table needs at least one damage");
  }
  if (damage_case.modes() == 0) {
    parsed.file.refuse(Pointer("/data"),
                       "does not give the number of modes: give \"frequencies\" or \"modes\"");
  }
  if (spec.runs == EmulatorSpec::Runs::csv && !(options.part.empty() && options.merge.empty())) {
    parsed.file.refuse(predictor / "runs_csv", "are finished runs: nothing remains to be computed");
  }
  if (spec.accuracy && !(options.part.empty() && options.merge.empty())) {
    parsed.file.refuse(
        predictor / "accuracy",
        "chooses runs by the results of earlier runs, so the runs cannot be computed in "
        "parts: leave out \"accuracy\" or --part");
  }
}

/// Runs the design of the case's predictor, measures the emulator's error on further runs and
/// writes the table. Finished runs are stored beside the output until the table is written;
/// `resume` starts from these runs.
void run_table(const CommonOptions& common, const TableOptions& options) {
  const auto log = make_log(common.quiet);
  if (!options.part.empty() && !options.merge.empty()) {
    throw Failure(Exit::usage,
                  "--part and --merge exclude each other: compute a part, or merge parts");
  }
  const DamageCaseFile parsed =
      parse_damage_case(read_case(common.case_path, common.overrides), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  const Pointer predictor("/predictor");
  require_table_case(parsed, options);
  const EmulatorSpec& spec = *damage_case.emulator;
  const DefectKind& kind = damage_case.kinds[0];
  const int modes = damage_case.modes();
  const RunCost cost = cost_of_tables(damage_case);
  require_affordable(parsed.file, predictor, cost, common);
  if (common.dry_run) return common.dry_run("table", cost);
  const auto part = options.part.empty() ? std::pair(0, 1) : parse_part(options.part);
  require_same_on_all_ranks("case", parsed.file.json.dump());
  std::optional<emulator::TableFile> made;
  if (!options.merge.empty()) made = read_parts(options.merge, damage_case);
  // Check that the file can be written before the long computation.
  on_first_rank([&] { const io::AtomicFile writable(common.output); });
  const std::string stem = common.output.string() + ".runs";
  const auto journal = [&](int count) {
    return std::filesystem::path(stem + ".count_" + std::to_string(count));
  };
  const auto forget = [&] {
    if (made) return;  // all runs exist already
    for (int count = 1; count <= kind.max_count; ++count) emulator::Journal::remove(journal(count));
  };
  if (!common.resume) on_first_rank(forget);
  const fem::Reanalysis reanalysis(damage_case.beam, modes + damage_case.rigid_body_modes);
  ProgressBar bar(common.quiet);
  std::map<int, Eigen::Index> remembered;
  const RunOptions train = {
      .threads = base::thread_count(common.threads),
      .seed = common.seed.value_or(1),
      .journal_stem = made ? std::string() : stem,
      .progress =
          [&](int count, Eigen::Index done, Eigen::Index total) {
            remembered.try_emplace(count, done - 1);
            bar.show("table", static_cast<double>(done) / static_cast<double>(total),
                     std::to_string(done) + " of " + std::to_string(total) + " FE runs, " +
                         std::to_string(count) + (count == 1 ? " damage" : " damages"));
          },
      .runs = made ? &*made : nullptr};
  const std::map<std::string, std::string> attributes = {{"case", parsed.file.json.dump()},
                                                         {"wheeltap_version", WHEELTAP_VERSION},
                                                         {"command", common.command_line}};
  std::optional<FrequencyEmulator> trained;
  try {
    if (options.part.empty()) {
      trained = FrequencyEmulator::train(reanalysis, spec, kind, modes, train);
      bar.clear();
      on_first_rank([&] { trained->save(common.output, attributes); });
    } else {
      emulator::TableFile file =
          run_part(reanalysis, spec, kind, modes, part.first, part.second, train);
      bar.clear();
      file.attributes.insert(attributes.begin(), attributes.end());
      on_first_rank([&] { emulator::write_table_file(common.output, file); });
    }
  } catch (const std::invalid_argument& error) {
    bar.clear();
    parsed.file.refuse(predictor, error.what());
  }
  if (!base::is_first_rank()) return;
  forget();
  for (const auto& [count, runs] : remembered) {
    if (runs > 0) {
      std::cout << "Resumed: " << runs << " FE runs with " << count
                << (count == 1 ? " damage" : " damages") << " were not repeated.\n";
    }
  }
  if (!trained) {
    if (common.as_json)
      common.as_json(Report({{"table", common.output.string()}, {"part", options.part}}).dump(1));
    std::cout << "Part " << options.part << ": " << io::printable(common.output.string())
              << "  (merge the parts with wheeltap table CASE -o TABLE.nc --merge PART...)\n";
    return;
  }
  const auto intact = reanalysis.intact_frequencies_hz().subspan(
      static_cast<std::size_t>(damage_case.rigid_body_modes));
  const EmulatorFinding finding =
      emulator_finding(*trained, measurement_noise(damage_case, intact));
  if (common.as_json) {
    common.as_json(
        Report({{"table", common.output.string()}, {"emulator", emulator_report(finding)}})
            .dump(1));
  }
  print_emulator(std::cout, finding, colour_wanted(), true);
  std::cout << "\nTable: " << io::printable(common.output.string())
            << "  (use it with \"predictor\": {\"table\": \""
            << io::printable(common.output.filename().string()) << "\"})\n";
}

}  // namespace

Command table_command() {
  const auto table = std::make_shared<TableOptions>();
  return {
      .name = "table",
      .summary = "run a design of experiments, train an emulator, measure its error",
      .on_all_ranks = true,
      .add_options =
          [table](CommandOptions& options) {
            options.add_case();
            options.add_output("FILE.nc", "table file to write, NetCDF");
            options.add_json("print the errors of the emulator as JSON");
            options.add_seed(
                "seed of the FE validation runs that measure the emulator error (default 1)");
            options.add_threads();
            options.add_limits();
            options.add_dry_run();
            options.add_resume("continue an interrupted table; finished FE runs are not repeated");
            CLI::App& app = options.app();
            app.add_option(
                "--part", table->part,
                "part of the FE runs to compute, as I/N: part I of N (default: all runs)");
            app.add_option("--merge", table->merge,
                           "table files of the parts to merge; their FE runs are not repeated");
          },
      .run = [table](const Invocation& asked) { run_table(asked.common, *table); }};
}

}  // namespace wheeltap::apps
