// Sampling runs: one function per command that samples.
#include <pybind11/stl.h>

#include <algorithm>

#include "apps/commands/command_list.hpp"
#include "apps/report/report.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/job.hpp"
#include "python/run.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

using namespace apps;

/// The steps of run_case that write no files.
Run finished(CaseRun& run, JobWatch& watch) {
  const bool prepared = !run.estimate();
  run.prepare(watch);
  if (prepared) static_cast<void>(run.estimate());
  return {*run.sample(watch), watch.lines()};
}

/// Runs a case of one kind on a separate thread.
std::shared_ptr<Run> run(const MakeCaseRun& make, const std::string& path, const py::object& text,
                         const std::vector<std::string>& overrides, const py::dict& said,
                         const py::object& progress) {
  const RunOptions options = [&] {
    RunOptions read = run_options(said);
    read.common.case_path = path;
    return read;
  }();
  return guarded(path, [&] {
    static_cast<void>(evidence_methods(options.sampling.evidence));
    CaseFile file = case_of(path, text, overrides);
    std::shared_ptr<Run> out;
    watched(progress, [&](Job& job) {
      JobWatch watch(job);
      if (file.json.contains("sweep") && file.json.value("kind", Json()) == "sid")
        file.refuse(Pointer("/sweep"), "Python does not run sweeps: run the cases in a loop");
      const auto of_case = make(std::move(file), options.common, options.sampling);
      out = std::make_shared<Run>(finished(*of_case, watch));
    });
    return out;
  });
}

}  // namespace

inference::Posterior JobWatch::sample(const inference::Problem& problem,
                                      inference::Options options) {
  options.progress = [&](const inference::Options::Progress& p) {
    job_.publish({.stage = p.stage,
                  .fraction = p.fraction,
                  .evaluations = p.likelihood_evaluations,
                  .probabilities = p.model_probabilities});
    return !job_.stopped();
  };
  inference::Posterior posterior = inference::reversible_jump(problem, options);
  // Stopped chains may differ in length.
  std::size_t shortest = posterior.chains.front().size();
  for (const auto& chain : posterior.chains) shortest = std::min(shortest, chain.size());
  constexpr std::size_t kFewest = 100;
  if (shortest < kFewest)
    throw Failure(Exit::interrupted, "stopped before the first results: nothing to report");
  for (auto& chain : posterior.chains) chain.truncate(shortest);
  posterior.draws = static_cast<int>(shortest);
  return posterior;
}

void JobWatch::show(const char* stage, double fraction, const std::string& /*detail*/) {
  if (job_.stopped()) throw Failure(Exit::interrupted, "stopped before sampling");
  job_.publish({.stage = stage, .fraction = fraction});
}

void bind_runs(py::module_& m) {
  for (const Command& command : commands()) {
    if (!command.make_run) continue;
    m.def(
        command.name.c_str(),
        [make = command.make_run](const std::string& path, const py::object& text,
                                  const std::vector<std::string>& overrides,
                                  const py::dict& options, const py::object& progress) {
          return run(make, path, text, overrides, options, progress);
        },
        py::arg("path"), py::arg("text"), py::arg("overrides"), py::arg("options"),
        py::arg("progress"));
  }

  m.def(
      "keep",
      [](const std::string& folder, const std::string& summary, const std::string& text,
         const std::string& run_of, const std::string& draws) {
        return guarded(folder, [&] {
          RunFiles files(folder);
          const io::NetcdfLock lock;
          if (const auto failed = files.keep(Report::parse(summary), text, run_of,
                                             [&](io::AtomicFile& to) { to.write(draws); }))
            throw io::FileError(*failed);
        });
      },
      py::arg("folder"), py::arg("summary"), py::arg("text"), py::arg("run"), py::arg("draws"),
      "Writes the four files of a run into its folder: all four files, or none.");
  m.def(
      "report_page",
      [](const std::string& summary, const std::string& draws) {
        return guarded("report.html", [&] {
          const io::NetcdfLock lock;
          const io::NetcdfReader file(draws, "report/posterior.nc", kPosterior);
          return report_page("report", Report::parse(summary), &file);
        });
      },
      py::arg("summary"), py::arg("draws"), "Returns report.html as a string.");
}

}  // namespace wheeltap::python
