// Options of a run from Python, with the same bounds as on the command line.
#pragma once

#include <pybind11/pybind11.h>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::python {

namespace py = pybind11;

struct RunOptions {
  apps::CommonOptions common;
  apps::SamplingOptions sampling;
};

/// Reads {"seed": 1, "chains": 4, …}. Throws std::invalid_argument (with option, value and bound).
[[nodiscard]] RunOptions run_options(const py::dict& said);

/// Reads a case from the file `path` or, if `text` is not None, from this JSON as if it were the
/// content of that file. Throws Failure.
[[nodiscard]] apps::CaseFile case_of(const std::string& path, const py::object& text,
                                     const std::vector<std::string>& overrides);

}  // namespace wheeltap::python
