// Coverage of credible intervals and detection limit of damage identification from raw
// accelerations by the program's commands, on random frames with truths drawn from the case's
// priors.
//
//   records_to_damage --program WHEELTAP [--seed N] [--cases N] [--first N] [--keep FILE]
//                     [--files DIR] [--sampling "--warmup N …"] [--check]
//
// --keep appends one JSON line per case to FILE and skips the cases that FILE contains, so that a
// stopped study resumes. Option --files keeps records, cases and results in DIR. Option --check
// returns 1 if an intact frame is diagnosed as damaged, if a damage that changes a frequency by 1 %
// is not detected, or if a truth lies outside the central 99.9 % of its posterior.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "records_row.hpp"

int main(int argc, char** argv) {
  using namespace wheeltap::coverage;
  RecordsOptions options{
      .program = "wheeltap", .folder = {}, .sampling = "--warmup 2000 --draws 1000 --search 20"};
  int cases = 200, first = 0;
  std::string keep, files;
  bool check = false;
  CLI::App app("From accelerations of random frames to damage.");
  app.add_option("--program", options.program, "path of wheeltap");
  app.add_option("--seed", options.seed, "random seed; one file holds rows of one seed");
  app.add_option("--cases", cases, "number of cases")->check(CLI::NonNegativeNumber);
  app.add_option("--first", first, "number of the first case")->check(CLI::NonNegativeNumber);
  app.add_option("--keep", keep, "file of rows");
  app.add_option("--files", files, "folder of the cases' files");
  app.add_option("--sampling", options.sampling, "options of wheeltap damage");
  app.add_flag("--check", check, "exit code 1 if there are faults");
  CLI11_PARSE(app, argc, argv);
  options.keep_records = !files.empty();
  if (options.program.find('/') != std::string::npos)
    options.program = std::filesystem::absolute(options.program);

  std::vector<RecordsRow> rows;
  std::set<int> known;
  if (std::ifstream kept(keep); !keep.empty() && kept)
    for (std::string line; std::getline(kept, line);) {
      rows.push_back(RecordsRow::from_line(line));
      known.insert(rows.back().number);
    }
  for (int i = first; i < first + cases; ++i) {
    if (known.contains(i)) continue;
    const std::filesystem::path whole =
        files.empty() ? std::filesystem::temp_directory_path() / "wheeltap-records"
                      : std::filesystem::path(files);
    options.folder = std::filesystem::absolute(whole / std::to_string(i));
    rows.push_back(run_records(frame_case(options.seed, i), options));
    if (files.empty()) std::filesystem::remove_all(options.folder);
    const RecordsRow& r = rows.back();
    std::printf(
        "case %d: %s, %d of %d modes, %s %.3f; P(damage) = %.3f, fit p = %.2g; %s, %.1f s + %.1f "
        "s\n",
        r.number, r.name.c_str(), r.modes, r.in_band, r.is_damaged ? "lost" : "intact,",
        r.reduction, r.probability, r.fit_p, r.converged ? "converged" : "NOT converged",
        r.seconds_modal, r.seconds_damage);
    std::fflush(stdout);
    if (!keep.empty()) std::ofstream(keep, std::ios::app) << r.to_line() << '\n' << std::flush;
  }
  std::printf("\n%s", records_report(rows).c_str());
  int faults = 0;
  for (const RecordsRow& r : rows) {
    if (r.is_damaged ? r.largest_shift > 0.01 && r.probability < 0.95 : r.probability > 0.95)
      ++faults;
    for (const auto& [name, u] : r.ranks)
      if (u < 0.0005 || u > 0.9995) ++faults;
  }
  return check && faults > 0 ? 1 : 0;
}
