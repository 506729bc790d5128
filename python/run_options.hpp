// What a Python caller may say of a run, held to the same bounds as the command line.
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

/// From {"seed": 1, "chains": 4, …}. Throws std::invalid_argument, naming option, value and bound.
[[nodiscard]] RunOptions run_options(const py::dict& said);

/// A case: the file `path`, or, where `text` is not None, this JSON as if it stood there. Throws
/// Failure.
[[nodiscard]] apps::CaseFile case_of(const std::string& path, const py::object& text,
                                     const std::vector<std::string>& overrides);

}  // namespace wheeltap::python
