// Translation of errors to Python exceptions with the program's messages.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <filesystem>

#include "apps/runs/failure_of.hpp"

namespace wheeltap::python {

namespace py = pybind11;

/// Defines CaseError (a ValueError, for an invalid case or data) and FileError (an OSError, for a
/// file that cannot be read or written). The exit code of a Failure determines its exception.
void bind_errors(py::module_& module);

/// Calls work() and converts its exceptions to Failure, except Python errors and
/// std::invalid_argument (wrong use of a function: a ValueError).
template <class Work>
auto guarded(const std::filesystem::path& case_path, const Work& work) {
  try {
    return work();
  } catch (const py::error_already_set&) {
    throw;
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::invalid_argument&) {
    throw;
  } catch (...) {
    throw apps::failure_of(std::current_exception(), case_path);
  }
}

}  // namespace wheeltap::python
