// Monitoring of a series.
#include <filesystem>
#include <sstream>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "apps/runs/monitor_run.hpp"
#include "base/parallel.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/job.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

/// Runs a monitor case into `folder`. Returns summary.json and the terminal output of the program.
py::tuple monitored(const std::string& path, const py::object& text,
                    const std::vector<std::string>& overrides, const std::string& folder,
                    bool resume, bool charts, const py::dict& said) {
  apps::CommonOptions common = run_options(said).common;
  common.case_path = path;
  common.output = folder;
  common.resume = resume;
  common.quiet = true;
  apps::CaseFile file = guarded(path, [&] { return case_of(path, text, overrides); });
  std::string summary, printed;
  guarded(path, [&] {
    watched(py::none(), [&](Job&) {
      std::filesystem::create_directories(common.output);
      const apps::MonitorCaseFile parsed =
          apps::parse_monitor_case(std::move(file), {.threads = base::thread_count(common.threads),
                                                     .seed = common.seed.value_or(1),
                                                     .kept = common.output / "modes"});
      const apps::MonitorRun run = apps::run_monitor(parsed, common, {.charts = charts});
      std::ostringstream out;
      apps::print_monitor(out, parsed, run.summary, false);
      summary = run.summary.dump();
      printed = out.str();
    });
  });
  return py::make_tuple(summary, printed);
}

}  // namespace

void bind_monitor(py::module_& m) {
  m.def("monitor", &monitored, py::arg("path"), py::arg("text"), py::arg("overrides"),
        py::arg("folder"), py::arg("resume"), py::arg("charts"), py::arg("options"));
}

}  // namespace wheeltap::python
