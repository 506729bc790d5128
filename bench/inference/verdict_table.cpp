// Prints the results of the engine for problems with known answers as a Markdown table, each line
// as soon as its runs end.
//
//   verdict_table [--seeds N] [--filter TEXT] [--family NAME] [--study]
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "inference/engine/reversible_jump.hpp"
#include "tests/inference/hard_verdict.hpp"
#include "tests/inference/study_problems.hpp"

namespace {

using namespace wheeltap::inference;

void print_line(const HardProblem& problem, int seeds) {
  Assessment worst;
  Verdict shown;
  int right = 0, converged = 0;
  double resolution = 0.0, calls = 0.0, seconds = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Posterior posterior = reversible_jump(
        problem.problem, {.seed = static_cast<std::uint64_t>(seed), .balance = problem.balance});
    Verdict verdict = judge(posterior);
    const Assessment a = assess(problem, verdict);
    right += a.right;
    converged += verdict.converged;
    resolution = std::max(resolution, verdict.resolution);
    calls += static_cast<double>(posterior.likelihood_evaluations) / seeds;
    seconds += posterior.wall_seconds / seeds;
    if (seed == 1 || a.reported_errors > worst.reported_errors) {
      worst = a;
      shown = std::move(verdict);
    }
  }
  const auto m = static_cast<std::size_t>(worst.model);
  std::printf("| %s | %s | %.5f | %.5f ± %.5f | %.1f | %d of %d | %d of %d | %.1e | ",
              problem.name.c_str(), problem.problem.space[worst.model].name.c_str(),
              problem.probability[m], shown.models[m].probability, shown.models[m].mcse,
              worst.reported_errors, converged, seeds, right, seeds, resolution);
  if (problem.hidden.empty()) {
    std::printf("-");
  } else {
    std::printf("%.1e", problem.basin);
  }
  std::printf(" | %.2g | %.1f |\n", calls, seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int seeds = 5;
  std::string filter, family;
  CLI::App app("The problems with known answers, as a Markdown table.");
  app.add_option("--seeds", seeds, "runs of each problem")->check(CLI::PositiveNumber);
  app.add_option("--filter", filter, "only problems whose name has this in it");
  app.add_option("--family", family, "only this family");
  bool study = false;
  app.add_flag("--study", study, "the problems of many dimensions and modes instead");
  CLI11_PARSE(app, argc, argv);

  std::printf(
      "| problem | model | exact | ours, worst seed | reported errors | converged | right | "
      "resolution, worst | basin | calls | s |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  std::fflush(stdout);
  const auto wanted = [&](const HardProblem& p) {
    return p.name.find(filter) != std::string::npos && (family.empty() || p.family == family);
  };
  for (const HardProblem& p : study ? study_problems() : hard_problems()) {
    if (wanted(p)) print_line(p, seeds);
  }
  if (study) return 0;
  const auto pine = std::filesystem::path(WHEELTAP_SHARED_DIR) / "validation" / "radiata";
  if (std::filesystem::exists(pine)) {
    const HardProblem p = radiata_problem(pine.string());
    if (wanted(p)) print_line(p, seeds);
  }
}
