#include "apps/commands.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <fstream>
#include <iostream>

#include "apps/csv_frequencies.hpp"
#include "apps/damage_summary.hpp"
#include "apps/evidence.hpp"
#include "apps/posterior_file.hpp"
#include "apps/report/report.hpp"
#include "apps/running.hpp"
#include "apps/sid_command.hpp"
#include "apps/terminal.hpp"
#include "emulator/atomic_file.hpp"
#include "fem/modal_analysis.hpp"
#include "inference/parallel.hpp"

namespace wheeltap::apps {
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

Report options_report(const SamplingOptions& options) {
  return {{"chains", options.chains},
          {"warmup", options.warmup},
          {"draws", options.draws},
          {"prior_only", options.prior_only},
          {"evidence", options.evidence}};
}

// The summary of a finished run in `directory`, if it is one of this case with these options.
std::optional<Report> finished_run(const std::filesystem::path& directory, const Json& case_json,
                                   std::uint64_t seed, const SamplingOptions& options) {
  std::ifstream stream(directory / "summary.json");
  if (!stream || !std::filesystem::exists(directory / "posterior.nc")) return {};
  Report summary = Report::parse(stream, nullptr, false);
  if (summary.is_discarded() || !summary.contains("wheeltap")) return {};
  const auto& about = summary["wheeltap"];
  const bool same = about.value("version", "") == WHEELTAP_VERSION &&
                    about.value("seed", 0U) == seed &&
                    about.value("options", Report()) == options_report(options) &&
                    about.contains("case") && Json::parse(about["case"].dump()) == case_json &&
                    !summary["diagnostics"].value("stopped_early", true);
  if (!same) return {};
  return summary;
}

void print_where(const std::filesystem::path& directory) {
  std::cout << "Results: " << (directory / "summary.json").string() << " (numbers), "
            << (directory / "posterior.nc").string() << " (every draw), "
            << (directory / "report.html").string() << " (pictures)\n";
}

}  // namespace

void run_modes(const CommonOptions& common, const ModesOptions& options) {
  const DamageCase damage_case =
      parse_damage_case(read_case(common.case_path, common.overrides), Needs::structure);
  if (options.truth && !damage_case.simulation) {
    damage_case.file.refuse(Pointer("/damage/truth"), "is missing: --truth has nothing to show");
  }
  const fem::Defects defects = options.truth ? damage_case.true_defects() : fem::Defects{};
  const int wanted = options.modes.value_or((damage_case.modes() > 0 ? damage_case.modes() : 10) +
                                            damage_case.rigid_body_modes);
  fem::Modes modes;
  try {
    modes = fem::modal_analysis(damage_case.beam, defects, {.modes = wanted});
  } catch (const std::invalid_argument& error) {
    damage_case.file.refuse(Pointer("/beam"), error.what());
  }
  const std::vector<double> frequencies(modes.frequencies_hz.begin(), modes.frequencies_hz.end());
  if (options.json) {
    Report out = {{"frequencies_hz", frequencies},
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
      out["x_m"] = x;
      out["deflections"] = shapes;
    }
    std::cout << out.dump() << '\n';
    return;
  }
  std::cout << damage_case.title << (options.truth ? " (as damaged in truth)" : " (intact)")
            << "\n\n";
  std::cout << "  mode   frequency [Hz]   deflection along the beam\n";
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
    char line[64];
    std::snprintf(line, sizeof line, "  %4d   %14.6f   ", static_cast<int>(j) + 1,
                  frequencies[static_cast<std::size_t>(j)]);
    std::cout << line << sparkline(modes.shapes.col(j))
              << (j < modes.rigid_body_modes ? "  rigid body" : "") << '\n';
  }
  std::cout << (modes.certified
                    ? "\nA Sturm count certifies that no mode below the last is missing.\n"
                    : "\nNot certified: a mode may be missing.\n");
}

void run_table(const CommonOptions& common) {
  const auto log = make_log(common.quiet);
  const DamageCase damage_case =
      parse_damage_case(read_case(common.case_path, common.overrides), Needs::structure);
  const Pointer predictor("/predictor");
  if (!damage_case.emulator || damage_case.emulator->table) {
    damage_case.file.refuse(
        predictor, "must describe a table to compute: {\"sites\": [...], \"multipliers\": [...]}");
  }
  const int max_count = damage_case.kinds[0].max_count;
  if (max_count < 1) {
    damage_case.file.refuse(damage_case.kinds[0].where / "count" / "max",
                            "must be at least 1: a table needs a damage");
  }
  if (damage_case.modes() == 0) {
    damage_case.file.refuse(
        Pointer("/data"), "says nothing of the number of modes: give \"frequencies\" or \"modes\"");
  }
  // Reserve the name first: a table that cannot be written should not be computed.
  { const emulator::AtomicFile writable(common.output); }
  const std::string stem = common.output.string() + ".runs";
  const auto journal = [&](int count) {
    return std::filesystem::path(stem + ".count_" + std::to_string(count));
  };
  std::error_code ignored;
  if (!common.resume) {
    for (int count = 1; count <= max_count; ++count)
      std::filesystem::remove(journal(count), ignored);
  }
  const fem::Reanalysis reanalysis(damage_case.beam,
                                   damage_case.modes() + damage_case.rigid_body_modes);
  ProgressBar bar(common.quiet);
  std::optional<FrequencyEmulator> trained;
  try {
    trained = FrequencyEmulator::train(
        reanalysis, *damage_case.emulator, max_count, damage_case.modes(),
        {.threads = inference::thread_count(common.threads),
         .seed = common.seed.value_or(1),
         .journal_stem = stem,
         .progress = [&](int count, Eigen::Index done, Eigen::Index total) {
           bar.show("table", static_cast<double>(done) / static_cast<double>(total),
                    std::to_string(done) + " of " + std::to_string(total) + " FE runs, " +
                        std::to_string(count) + (count == 1 ? " damage" : " damages"));
         }});
  } catch (const std::invalid_argument& error) {
    bar.clear();
    damage_case.file.refuse(predictor, error.what());
  }
  bar.clear();
  trained->save(common.output, {{"case", damage_case.file.json.dump()},
                                {"wheeltap_version", WHEELTAP_VERSION},
                                {"command", common.command_line}});
  for (int count = 1; count <= max_count; ++count) std::filesystem::remove(journal(count), ignored);
  print_emulator(std::cout, emulator_report(*trained, damage_case.data), colour_wanted(), true);
  std::cout << "\nTable: " << common.output.string()
            << "  (use it with \"predictor\": {\"table\": \"" << common.output.filename().string()
            << "\"})\n";
}

void run_damage(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // refuse before anything runs
  const auto log = make_log(common.quiet);
  DamageCase parsed = parse_damage_case(read_case(common.case_path, common.overrides));
  const std::uint64_t seed = common.seed.value_or(1);
  make_output_folder(common.output);
  if (common.resume) {
    if (const auto summary = finished_run(common.output, parsed.file.json, seed, options)) {
      log->info("{} holds a finished run of this case; nothing is run again.",
                common.output.string());
      print_damage(std::cout, *summary, colour_wanted());
      print_where(common.output);
      return;
    }
  }
  // Reserve the names first: a run that cannot be kept should not start.
  emulator::AtomicFile posterior_file(common.output / "posterior.nc");
  emulator::AtomicFile summary_file(common.output / "summary.json");

  ProgressBar bar(common.quiet);
  const auto problem = make_damage_problem(
      std::move(parsed), {.threads = inference::thread_count(common.threads),
                          .table_progress = [&](int count, Eigen::Index done, Eigen::Index total) {
                            bar.show("table",
                                     static_cast<double>(done) / static_cast<double>(total),
                                     std::to_string(total) + " FE runs, " + std::to_string(count) +
                                         (count == 1 ? " damage" : " damages"));
                          }});
  bar.clear();
  if (problem->emulator && !common.quiet) {
    print_emulator(std::cout, emulator_report(*problem->emulator, problem->damage_case.data),
                   colour_wanted(), false);
  }

  inference::Options engine;
  engine.seed = seed;
  engine.chains = options.chains;
  engine.threads = common.threads;
  engine.warmup = options.warmup;
  engine.draws = options.draws;
  engine.prior_only = options.prior_only;
  const inference::Posterior posterior =
      run_engine(problem->problem, engine, common.case_path, common.quiet);

  const auto evidence =
      compute_evidence(problem->problem, options.evidence, seed, common.threads, *log);
  Report summary = summarise_damage(*problem, posterior, evidence,
                                    {.seed = seed, .command_line = common.command_line});
  summary["wheeltap"]["options"] = options_report(options);
  write_posterior_file(posterior_file.temporary(), *problem, posterior, seed);
  write_text(summary_file, summary.dump(1) + "\n");
  posterior_file.commit();
  summary_file.commit();
  write_report(common.output);
  print_damage(std::cout, summary, colour_wanted());
  print_where(common.output);
  if (!summary["diagnostics"]["converged"].get<bool>()) {
    std::cout << "NOT CONVERGED: do not trust these numbers yet.\n";
  }
}

void run_simulate(const CommonOptions& common) {
  CaseFile file = read_case(common.case_path, common.overrides);
  if (file.json.value("kind", Json()) == "sid") return simulate_sid(common, std::move(file));
  const DamageCase damage_case = parse_damage_case(std::move(file), Needs::structure);
  const std::uint64_t seed =
      common.seed.value_or(damage_case.simulation ? damage_case.simulation->seed : 1);
  const FrequencyData data = simulate(damage_case, seed);
  std::string text;
  if (common.output.extension() == ".json") {
    Json json = damage_case.file.json;
    for (const char* key : {"file", "columns", "row", "modes", "seed"}) json["data"].erase(key);
    json["data"]["frequencies"] = data.frequencies_hz;
    text = json.dump(2) + "\n";
  } else {
    text = frequency_csv({data.frequencies_hz, data.sd_hz},
                         damage_case.title + ", simulated by wheeltap " + WHEELTAP_VERSION +
                             ", seed " + std::to_string(seed));
  }
  write_text(common.output, text);
  if (!common.quiet) {
    std::cout << data.modes() << " frequencies (" << data.origin << "): " << common.output.string()
              << '\n';
  }
}

void run_schema(const std::string& name) {
  std::cout << schema(name).dump(2) << '\n';
}

}  // namespace wheeltap::apps
