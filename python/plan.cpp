// Plans of tests.
#include <pybind11/stl.h>

#include <sstream>

#include "apps/report/plan_page.hpp"
#include "apps/results/planning/plan_summary.hpp"
#include "apps/runs/plan_run.hpp"
#include "apps/runs/running.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/job.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

/// Computes a plan on a separate thread. This takes about a minute and cannot be stopped.
std::shared_ptr<apps::PlanRun> planned(const std::string& path, const py::object& text,
                                       const std::vector<std::string>& overrides,
                                       const py::dict& said, int scenarios, int checks) {
  apps::CommonOptions common = run_options(said).common;
  if (scenarios < 1000 || scenarios > 10'000'000)
    throw py::value_error("scenarios: must be a whole number from 1000 to 10000000");
  if (checks < 0 || checks > 10'000)
    throw py::value_error("checks: must be a whole number from 0 to 10000");
  common.case_path = path;
  return guarded(path, [&] {
    const apps::PlanCaseFile parsed = apps::parse_plan_case(case_of(path, text, overrides));
    apps::check_plan_case(parsed, scenarios);
    std::shared_ptr<apps::PlanRun> out;
    watched(py::none(), [&](Job&) {
      out = std::make_shared<apps::PlanRun>(
          apps::run_plan(parsed, common, {.scenarios = scenarios, .checks = checks}));
    });
    return out;
  });
}

}  // namespace

void bind_plan(py::module_& m) {
  using apps::PlanRun;
  py::class_<PlanRun, std::shared_ptr<PlanRun>>(m, "Plan", "A plan of a test.")
      .def_property_readonly("summary", [](const PlanRun& self) { return self.summary.dump(); })
      .def_property_readonly("damage_case",
                             [](const PlanRun& self) { return self.damage_case.dump(); })
      .def_property_readonly("text",
                             [](const PlanRun& self) {
                               std::ostringstream out;
                               apps::print_plan(out, self.summary, false);
                               return out.str();
                             })
      .def("page", [](const PlanRun& self) { return apps::plan_page(self.summary); })
      .def("keep", [](const PlanRun& self, const std::string& folder) {
        guarded(folder, [&] {
          apps::claim_output_folder(folder);
          self.keep(folder);
        });
      });
  m.def("plan", &planned, py::arg("path"), py::arg("text"), py::arg("overrides"),
        py::arg("options"), py::arg("scenarios"), py::arg("checks"));
}

}  // namespace wheeltap::python
