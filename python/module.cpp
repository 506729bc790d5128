// The module wheeltap._core: what the package `wheeltap` is a shell of.
//
// Cases and summaries cross as JSON text, numbers as arrays. It stands on apps, not on
// identification alone, since a case is parsed and a run is written there: by one reader and one
// writer, whoever asks.
#include "python/bindings.hpp"
#include "python/errors.hpp"

PYBIND11_MODULE(_core, m) {
  m.doc() = "Wheeltap's libraries, bound.";
  m.attr("__version__") = WHEELTAP_VERSION;
  wheeltap::python::bind_errors(m);
  wheeltap::python::bind_run(m);
  wheeltap::python::bind_runs(m);
  wheeltap::python::bind_cases(m);
  wheeltap::python::bind_modal(m);
  wheeltap::python::bind_engine(m);
  wheeltap::python::bind_rig(m);
}
