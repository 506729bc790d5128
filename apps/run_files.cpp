#include "apps/run_files.hpp"

#include <iostream>

#include "apps/report/report.hpp"
#include "apps/running.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

std::filesystem::path made(std::filesystem::path folder) {
  make_output_folder(folder);
  return folder;
}

}  // namespace

inference::Options engine_options(const CommonOptions& common, const SamplingOptions& options) {
  inference::Options engine;
  engine.seed = common.seed.value_or(1);
  engine.chains = options.chains;
  engine.threads = common.threads;
  engine.warmup = options.warmup;
  engine.draws = options.draws;
  engine.prior_only = options.prior_only;
  engine.searches = options.searches;
  engine.quick = options.quick;
  return engine;
}

RunFiles::RunFiles(std::filesystem::path folder)
    : folder_(made(std::move(folder))),
      posterior_(folder_ / "posterior.nc"),
      summary_(folder_ / "summary.json") {}

void RunFiles::keep(const Report& summary, const std::string& text) {
  write_text(summary_, summary.dump(1) + "\n");
  posterior_.commit();
  summary_.commit();
  write_text(folder_ / "summary.txt", text);
  write_report(folder_);
}

void print_results(const std::filesystem::path& folder, bool converged) {
  const auto shown = [&](const char* name) { return io::printable((folder / name).string()); };
  std::cout << "Results: " << shown("summary.json") << " (numbers), " << shown("posterior.nc")
            << " (every draw), " << shown("report.html") << " (pictures)\n";
  if (!converged) std::cout << "NOT CONVERGED: do not trust these numbers yet.\n";
}

}  // namespace wheeltap::apps
