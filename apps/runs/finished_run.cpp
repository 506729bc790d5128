#include "apps/runs/finished_run.hpp"

#include <iostream>
#include <sstream>

#include "apps/results/terminal.hpp"
#include "apps/runs/running.hpp"

namespace wheeltap::apps {

std::string FinishedRun::text() const {
  std::ostringstream out;
  print(out, false);
  return out.str();
}

bool FinishedRun::converged() const {
  return summary.at("diagnostics").at("converged").get<bool>();
}

std::size_t FinishedRun::bytes_of_draws() const {
  std::size_t bytes = 0;
  for (const inference::Chain& chain : posterior->chains) bytes += chain.bytes();
  return bytes;
}

void deliver(const FinishedRun& run, RunFiles& files, const std::filesystem::path& folder,
             CheckpointFile& checkpoint) {
  const auto failed = files.keep(run.summary, run.text(), run.run, [&](io::AtomicFile& to) {
    io::write_netcdf(to, run.bytes_of_draws(), run.draws);
  });
  run.print(std::cout, colour_wanted());
  if (failed && !checkpoint.kept()) checkpoint.remove();  // remove parts without a checkpoint
  if (failed) throw *failed;
  print_how_to_resume(checkpoint, run.posterior->stopped_early);
  print_results(folder, run.converged());  // prints the convergence as the last line
  if (!run.posterior->stopped_early) checkpoint.remove();
}

}  // namespace wheeltap::apps
