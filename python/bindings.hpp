// Functions that define the parts of the Python module. Each function has its own source file.
#pragma once

#include <pybind11/pybind11.h>

namespace wheeltap::python {

void bind_cases(pybind11::module_& module);   ///< modes, simulate, data, schemas
void bind_engine(pybind11::module_& module);  ///< user-defined likelihoods
void bind_modal(pybind11::module_& module);
void bind_plan(pybind11::module_& module);
void bind_monitor(pybind11::module_& module);
void bind_rig(pybind11::module_& module);   ///< chains with user-defined force laws
void bind_run(pybind11::module_& module);   ///< a finished run and its draws
void bind_runs(pybind11::module_& module);  ///< damage, update, sid

}  // namespace wheeltap::python
