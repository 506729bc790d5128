// The module wheeltap._core behind the package `wheeltap`.
//
// Cases and summaries are passed as JSON text, numbers as arrays. The module uses apps, which has
// the only parser of cases and the only writer of runs.
#include "python/bindings.hpp"
#include "python/errors.hpp"

PYBIND11_MODULE(_core, m) {
  m.doc() = "Bindings of Wheeltap's libraries.";
  m.attr("__version__") = WHEELTAP_VERSION;
  wheeltap::python::bind_errors(m);
  wheeltap::python::bind_run(m);
  wheeltap::python::bind_runs(m);
  wheeltap::python::bind_cases(m);
  wheeltap::python::bind_modal(m);
  wheeltap::python::bind_plan(m);
  wheeltap::python::bind_monitor(m);
  wheeltap::python::bind_engine(m);
  wheeltap::python::bind_rig(m);
}
