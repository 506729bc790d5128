#include "apps/commands.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <sstream>

#include "apps/checkpoint_file.hpp"
#include "apps/csv_frequencies.hpp"
#include "apps/damage_run.hpp"
#include "apps/damage_summary.hpp"
#include "apps/damage_terminal.hpp"
#include "apps/found_modes.hpp"
#include "apps/run_cost.hpp"
#include "apps/run_files.hpp"
#include "apps/running.hpp"
#include "apps/several_ranks.hpp"
#include "apps/sid_command.hpp"
#include "apps/simulation.hpp"
#include "apps/stored_run.hpp"
#include "apps/structure_case.hpp"
#include "apps/structure_command.hpp"
#include "apps/structure_words.hpp"
#include "apps/terminal.hpp"
#include "apps/update_command.hpp"
#include "apps/whole_number.hpp"
#include "base/parallel.hpp"
#include "emulator/journal.hpp"
#include "fem/modal_analysis.hpp"
#include "fem/structures/structure_modes.hpp"
#include "identification/structure_plausibility.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string sparkline(const Eigen::VectorXd& shape) {
  static const char* levels[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  constexpr int kColumns = 40;
  std::string text;
  const auto nodes = shape.size() / 2;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < nodes; ++i) largest = std::max(largest, std::abs(shape[2 * i]));
  for (int c = 0; c < kColumns; ++c) {
    const auto node = static_cast<Eigen::Index>(
        std::lround(static_cast<double>(c) / (kColumns - 1) * static_cast<double>(nodes - 1)));
    const double w = largest > 0.0 ? shape[2 * node] / largest : 0.0;
    text += levels[std::clamp(static_cast<int>(std::lround(3.5 + 3.5 * w)), 0, 7)];
  }
  return text;
}

// Of a beam whose truth only structures know: frequencies, and deflections at its nodes.
fem::Modes true_modes(const DamageCase& damage_case, int wanted) {
  const fem::StructureModes found = fem::structure_modes(true_structure(damage_case), wanted);
  const fem::Beam& beam = damage_case.beam;
  const fem::Mesh mesh(std::get<fem::Structure>(damage_case.solved_structure()));
  fem::Modes modes{.frequencies_hz = found.frequencies_hz,
                   .eigenvalues = found.eigenvalues,
                   .shapes = Eigen::MatrixXd::Zero(2 * beam.nodes(), found.shapes.cols()),
                   .rigid_body_modes = found.rigid_body_modes,
                   .certified = found.certified,
                   .solver = found.solver};
  int member = 0;
  double start = 0.0;
  for (int i = 0; i < beam.nodes(); ++i) {
    const double x = i * beam.element_length();
    while (member + 1 < static_cast<int>(mesh.structure().members.size()) &&
           x > start + mesh.member_length(member) * (1.0 + 1e-9)) {
      start += mesh.member_length(member++);
    }
    const fem::SparseRow deflection =
        mesh.motion(member, std::min(x - start, mesh.member_length(member)), fem::Direction::y);
    for (Eigen::Index j = 0; j < found.shapes.cols(); ++j) {
      modes.shapes(2 * i, j) = deflection.of(found.shapes.col(j));
    }
  }
  return modes;
}

}  // namespace

FoundModes find_modes(CaseFile file, const ModesOptions& options) {
  if (has_structure(file)) return find_structure_modes(std::move(file), options);
  if (!options.vtk.empty())
    throw Failure(Exit::usage, "--vtk: goes with a structure; this case has a beam");
  const DamageCaseFile parsed = parse_damage_case(std::move(file), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  if (options.truth && !damage_case.simulation) {
    parsed.file.refuse(Pointer("/damage/truth"), "is missing: --truth has nothing to show");
  }
  const fem::Defects defects = options.truth && !damage_case.solved_as_structure()
                                   ? damage_case.true_defects()
                                   : fem::Defects{};
  const int wanted = options.modes.value_or((damage_case.modes() > 0 ? damage_case.modes() : 10) +
                                            damage_case.rigid_body_modes);
  fem::Modes modes;
  try {
    modes = options.truth && damage_case.solved_as_structure()
                ? true_modes(damage_case, wanted)
                : fem::modal_analysis(damage_case.beam, defects, {.modes = wanted});
  } catch (const std::invalid_argument& error) {
    parsed.file.refuse(Pointer("/beam"), error.what());
  }
  const std::vector<double> frequencies(modes.frequencies_hz.begin(), modes.frequencies_hz.end());
  Report report = {{"frequencies_hz", frequencies},
                   {"rigid_body_modes", modes.rigid_body_modes},
                   {"certified", modes.certified},
                   {"solver", modes.solver}};
  if (options.shapes) {
    Report shapes = Report::array();
    for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
      std::vector<double> w;
      for (Eigen::Index i = 0; i < modes.shapes.rows(); i += 2) w.push_back(modes.shapes(i, j));
      shapes.push_back(w);
    }
    std::vector<double> x;
    for (int i = 0; i < damage_case.beam.nodes(); ++i) {
      x.push_back(i * damage_case.beam.element_length());
    }
    report["x_m"] = x;
    report["deflections"] = shapes;
  }
  std::ostringstream text;
  text << damage_case.title << (options.truth ? " (as damaged in truth)" : " (intact)") << "\n\n";
  text << "  mode   frequency [Hz]   deflection along the beam\n";
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
    char line[64];
    std::snprintf(line, sizeof line, "  %4d   %14.6f   ", static_cast<int>(j) + 1,
                  frequencies[static_cast<std::size_t>(j)]);
    text << line << sparkline(modes.shapes.col(j))
         << (j < modes.rigid_body_modes ? "  rigid body" : "") << '\n';
  }
  text << (modes.certified ? "\nA Sturm count certifies that no mode below the last is missing.\n"
                           : "\nNot certified: a mode may be missing.\n");
  return {.report = std::move(report), .text = text.str(), .doubts = implausible(damage_case.beam)};
}

void run_modes(const CommonOptions& common, const ModesOptions& options) {
  const FoundModes found = find_modes(read_case(common.case_path, common.overrides), options);
  warn_of(found.doubts);
  std::cout << (options.json ? found.report.dump() + "\n" : found.text);
}

namespace {

// "2/5": the second of five, 0-based.
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

}  // namespace

void run_table(const CommonOptions& common, const TableOptions& options) {
  const auto log = make_log(common.quiet);
  if (!options.part.empty() && !options.merge.empty()) {
    throw Failure(Exit::usage,
                  "--part and --merge: a part is computed or parts are joined, not both");
  }
  const DamageCaseFile parsed =
      parse_damage_case(read_case(common.case_path, common.overrides), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  const Pointer predictor("/predictor");
  if (damage_case.structure) {
    parsed.file.refuse(Pointer("/structure"),
                       "an emulator is trained on a beam, not on a structure");
  }
  if (parsed.outside)
    parsed.file.refuse(predictor,
                       "a table holds runs of our own beam; a damage case keeps the "
                       "answers of this model in a \"memory\"");
  if (!damage_case.emulator || damage_case.emulator->table) {
    parsed.file.refuse(
        predictor, "must describe a table to compute: {\"sites\": [...], \"multipliers\": [...]}");
  }
  const EmulatorSpec& spec = *damage_case.emulator;
  const DefectKind& kind = damage_case.kinds[0];
  if (kind.max_count < 1) {
    parsed.file.refuse(parsed.kinds[0] / "count" / "max",
                       "must be at least 1: a table needs a damage");
  }
  const int modes = damage_case.modes();
  if (modes == 0) {
    parsed.file.refuse(Pointer("/data"),
                       "says nothing of the number of modes: give \"frequencies\" or \"modes\"");
  }
  if (spec.runs == EmulatorSpec::Runs::csv && !(options.part.empty() && options.merge.empty())) {
    parsed.file.refuse(predictor / "runs_csv", "are made already: there are no parts to compute");
  }
  if (spec.accuracy && !(options.part.empty() && options.merge.empty())) {
    parsed.file.refuse(predictor / "accuracy",
                       "decides on runs by the runs before: they have no parts");
  }
  const RunCost cost = cost_of_tables(damage_case);
  require_affordable(parsed.file, predictor, cost, common);
  if (common.dry_run) return common.dry_run("table", cost);
  const auto part = options.part.empty() ? std::pair(0, 1) : parse_part(options.part);
  require_same_on_all_ranks("case", parsed.file.json.dump());
  std::optional<emulator::TableFile> made;
  if (!options.merge.empty()) made = read_parts(options.merge, damage_case);
  // Reserve the name first: a table that cannot be written should not be computed.
  on_first_rank([&] { const io::AtomicFile writable(common.output); });
  const std::string stem = common.output.string() + ".runs";
  const auto journal = [&](int count) {
    return std::filesystem::path(stem + ".count_" + std::to_string(count));
  };
  const auto forget = [&] {
    if (made) return;  // there are none
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
              << "  (join the parts with wheeltap table CASE -o TABLE.nc --merge PART...)\n";
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

namespace {

// States that do not fit their structure show where it is first solved.
RunCost explained_cost(const DamageCaseFile& parsed, const CommonOptions& common,
                       const SamplingOptions& options) {
  try {
    return cost_of_damages(parsed.damage, common, options);
  } catch (const fem::InvalidStructure& error) {
    parsed.refuse(InvalidInput(InvalidInput::Part::beam, error.what()));
  } catch (const std::invalid_argument& error) {
    parsed.refuse(InvalidInput(InvalidInput::Part::data, error.what()));
  }
}

}  // namespace

namespace {

// By a likelihood that is solved, unless that means to ask a model of someone else's, to train an
// emulator, or to prepare for long.
RunCost measured(RunCost cost, const std::shared_ptr<const DamageCaseFile>& parsed,
                 const CommonOptions& common, const SamplingOptions& options, spdlog::logger& log) {
  constexpr double kLongPreparation = 20.0;  // seconds
  if (parsed->outside || parsed->damage.emulator || cost.preparation > kLongPreparation)
    return cost;
  TerminalWatch watch(common, log);
  const auto began = std::chrono::steady_clock::now();
  const auto problem = prepare_damage(*parsed, common, watch);
  cost.preparation =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  measure(cost, problem->problem, engine_options(common, options), probe_seconds(common));
  return cost;
}

}  // namespace

void run_damage(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // refuse before anything runs
  const auto log = make_log(common.quiet);
  const auto parsed = std::make_shared<const DamageCaseFile>(
      parse_damage_case(read_case(common.case_path, common.overrides)));
  const std::uint64_t seed = common.seed.value_or(1);
  const RunCost tables = cost_of_tables(parsed->damage);
  require_affordable(parsed->file, Pointer("/predictor"), tables, common);
  const RunCost cost = explained_cost(*parsed, common, options);
  require_affordable(parsed->file, Pointer(), cost, common);
  if (common.dry_run) {
    if (tables.likelihoods > 0.0) common.dry_run("table", tables);
    return common.dry_run("run", measured(cost, parsed, common, options, *log));
  }
  require_same_on_all_ranks("case", identity_of(parsed->file));
  if (common.resume) {
    const auto text = first_rank_says([&] {
      return finished_run(common.output, parsed->file, seed, "options", options_report(options));
    });
    if (text && !base::is_first_rank()) return;
    if (text) return print_finished(common.output, *text, *log);
  }
  std::optional<RunFiles> files;
  on_first_rank([&] {
    files.emplace(common.output);
    require_room(cost, common);
  });
  CheckpointFile checkpoint(common.output,
                            {.command = "damage",
                             .seed = seed,
                             .options = options_report(options),
                             .case_json = parsed->file.json,
                             .inputs = parsed->file.inputs->json()},
                            common);
  TerminalWatch watch(common, *log);
  watch.keep(checkpoint);
  const auto problem = prepare_damage(*parsed, common, watch);
  if (problem->emulator && !common.quiet) {
    print_emulator(std::cout, emulator_finding(*problem->emulator, parsed->damage.data.sd_hz),
                   colour_wanted(), false);
  }
  const auto run = sample_damage(parsed, problem, common, options, watch);
  if (run) deliver(*run, *files, common.output, checkpoint);
}

void run_simulate(const CommonOptions& common) {
  std::error_code missing;
  if (std::filesystem::equivalent(common.output, common.case_path, missing))
    throw Failure(Exit::usage,
                  "--output: " + common.output.string() + " is the case itself: name another file");
  CaseFile file = read_case(common.case_path, common.overrides);
  if (file.json.value("kind", Json()) == "sid") return simulate_sid(common, std::move(file));
  if (file.json.value("kind", Json()) == "update") return simulate_update(common, std::move(file));
  const DamageCaseFile parsed = parse_damage_case(std::move(file), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  const std::uint64_t seed =
      common.seed.value_or(damage_case.simulation ? damage_case.simulation->seed : 1);
  const FrequencyData data = explained(parsed, [&] { return simulate(damage_case, seed); });
  std::string text;
  if (common.output.extension() == ".json") {
    text = with_simulated(parsed, data, seed).dump(2) + "\n";
  } else if (damage_case.modal && !damage_case.modal->sensors.empty()) {
    throw Failure(Exit::usage, "--output: " + common.output.string() +
                                   ": shapes are written as a complete case: name it .json");
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
    const bool shapes = damage_case.modal && !damage_case.modal->sensors.empty();
    std::cout << data.modes() << (shapes ? " frequencies and shapes (" : " frequencies (")
              << data.origin << "): " << io::printable(common.output.string()) << '\n';
  }
}

void run_schema(const std::string& name) {
  std::cout << schema(name).dump(2) << '\n';
}

}  // namespace wheeltap::apps
