// Coverage of intervals and calibration of probabilities on random structures with 0 to 3 defects,
// with truths drawn from their priors. Prints one line per case, then the tables.
//
//   structure_coverage [--seed N] [--cases N] [--first N] [--warmup N] [--draws N] [--searches N]
//                      [--keep FILE] [--check]
//
// --keep appends one JSON line per case to FILE and skips the cases that FILE contains, so that a
// stopped study resumes. --check returns 1 if chance does not explain the tables.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <set>

#include "coverage_score.hpp"

int main(int argc, char** argv) {
  using namespace wheeltap::coverage;
  std::uint64_t seed = 1;
  int cases = 200, first = 0, warmup = 0, draws = 0, searches = 0;
  std::string keep;
  bool check = false;
  CLI::App app("Coverage of random structures with random defects.");
  app.add_option("--seed", seed, "random seed; one file holds rows of one seed");
  app.add_option("--cases", cases, "number of cases")->check(CLI::NonNegativeNumber);
  app.add_option("--first", first, "number of the first case")->check(CLI::NonNegativeNumber);
  app.add_option("--warmup", warmup, "iterations per chain; 0: chosen by the engine");
  app.add_option("--draws", draws, "draws per chain; 0: chosen by the engine");
  app.add_option("--searches", searches, "climbs per model; 0: chosen by the engine");
  app.add_option("--keep", keep, "file of rows");
  app.add_flag("--check", check, "exit code 1 if there are faults");
  CLI11_PARSE(app, argc, argv);

  std::vector<Row> rows;
  std::set<int> known;
  if (std::ifstream kept(keep); !keep.empty() && kept) {
    for (std::string line; std::getline(kept, line);) {
      rows.push_back(Row::from_line(line));
      known.insert(rows.back().number);
    }
  }
  for (int i = first; i < first + cases; ++i) {
    if (known.contains(i)) continue;
    rows.push_back(
        run(random_case(seed, i), {.warmup = warmup, .draws = draws, .searches = searches}));
    const Row& row = rows.back();
    std::printf("case %d: %s, %d modes, cov %.2g %%; P(truth) = %.3f; %s, %.1f s\n", row.number,
                row.family.c_str(), row.modes, 100.0 * row.cv, row.probability_of_truth(),
                row.converged ? "converged" : "NOT converged", row.seconds);
    std::fflush(stdout);
    if (!keep.empty()) std::ofstream(keep, std::ios::app) << row.to_line() << '\n' << std::flush;
  }
  std::printf("\n%s", report(rows).c_str());
  const std::vector<std::string> wrong = faults(rows);
  for (const std::string& fault : wrong) std::printf("fault: %s\n", fault.c_str());
  return check && !wrong.empty() ? 1 : 0;
}
