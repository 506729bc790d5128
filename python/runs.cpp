// Runs that sample: damage, update, sid.
#include <pybind11/stl.h>

#include <algorithm>

#include "apps/report/report.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/damage_run.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "apps/runs/update_run.hpp"
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

Run damage(CaseFile file, const RunOptions& options, JobWatch& watch) {
  const auto parsed = std::make_shared<const DamageCaseFile>(parse_damage_case(std::move(file)));
  require_affordable(parsed->file, Pointer("/predictor"), cost_of_tables(parsed->damage),
                     options.common);
  require_affordable(parsed->file, Pointer(),
                     cost_of_damages(parsed->damage, options.common, options.sampling),
                     options.common);
  const auto problem = prepare_damage(*parsed, options.common, watch);
  return {*sample_damage(parsed, problem, options.common, options.sampling, watch), {}};
}

Run update(CaseFile file, const RunOptions& options, JobWatch& watch) {
  const auto parsed = std::make_shared<const UpdateCaseFile>(parse_update_case(std::move(file)));
  require_affordable(parsed->file, Pointer("/structure"), cost_of_basis(*parsed), options.common);
  const auto problem = prepare_update(*parsed, options.common, watch);
  require_affordable(parsed->file, Pointer(),
                     cost_of_update(*problem, options.common, options.sampling), options.common);
  return {*sample_update(parsed, problem, options.common, options.sampling, watch), {}};
}

Run sid(CaseFile file, const RunOptions& options, JobWatch& watch) {
  if (file.json.contains("sweep"))
    file.refuse(Pointer("/sweep"), "a sweep is the program's: in Python, run the cases in a loop");
  require_room_for_truth(file, options.common);
  const auto parsed = std::make_shared<const SidCaseFile>(parse_sid_case(std::move(file)));
  require_affordable(parsed->file, Pointer(),
                     cost_of_sid(*parsed, options.common, options.sampling), options.common);
  return {*sample_sid(parsed, options.common, options.sampling, watch), {}};
}

/// The work of one of the three on a thread of its own.
template <class Work>
std::shared_ptr<Run> run(const Work& work, const std::string& path, const py::object& text,
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
      out = std::make_shared<Run>(work(std::move(file), options, watch));
      out->lines = watch.lines();
    });
    return out;
  });
}

}  // namespace

inference::Posterior JobWatch::sample(const inference::Problem& problem,
                                      inference::Options options) {
  options.progress = [&](const inference::Options::Progress& p) {
    job_.tell({.stage = p.stage,
               .fraction = p.fraction,
               .evaluations = p.likelihood_evaluations,
               .probabilities = p.model_probabilities});
    return !job_.stopped();
  };
  inference::Posterior posterior = inference::reversible_jump(problem, options);
  // Chains that were stopped may differ in length.
  std::size_t shortest = posterior.chains.front().size();
  for (const auto& chain : posterior.chains) shortest = std::min(shortest, chain.size());
  constexpr std::size_t kFewest = 100;
  if (shortest < kFewest)
    throw Failure(Exit::interrupted, "stopped before anything was found: nothing to report");
  for (auto& chain : posterior.chains) chain.truncate(shortest);
  posterior.draws = static_cast<int>(shortest);
  return posterior;
}

void JobWatch::show(const char* stage, double fraction, const std::string& /*detail*/) {
  if (job_.stopped()) throw Failure(Exit::interrupted, "stopped before anything was sampled");
  job_.tell({.stage = stage, .fraction = fraction});
}

void bind_runs(py::module_& m) {
  const auto bind = [&](const char* name, auto work) {
    m.def(
        name,
        [work](const std::string& path, const py::object& text,
               const std::vector<std::string>& overrides, const py::dict& options,
               const py::object& progress) {
          return run(work, path, text, overrides, options, progress);
        },
        py::arg("path"), py::arg("text"), py::arg("overrides"), py::arg("options"),
        py::arg("progress"));
  };
  bind("damage", damage);
  bind("update", update);
  bind("sid", sid);

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
      "Writes the four files of a run into its folder, all of them or none.");
  m.def(
      "report_page",
      [](const std::string& summary, const std::string& draws) {
        return guarded("report.html", [&] {
          const io::NetcdfLock lock;
          const io::NetcdfReader file(draws, "report/posterior.nc", kPosterior);
          return report_page("report", Report::parse(summary), &file);
        });
      },
      py::arg("summary"), py::arg("draws"), "report.html as text.");
}

}  // namespace wheeltap::python
