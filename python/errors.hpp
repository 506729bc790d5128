// What Python hears of what goes wrong: the lines that the program ends with.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <filesystem>

#include "apps/runs/failure_of.hpp"

namespace wheeltap::python {

namespace py = pybind11;

/// Makes CaseError (a ValueError: invalid case or data), FileError (an OSError: missing,
/// unreadable, cannot be written) and the translation of Failure to them by its exit code.
void bind_errors(py::module_& module);

/// work(), with whatever it throws turned into a Failure; Python's own errors, and those of misuse
/// (std::invalid_argument: a ValueError), go through.
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
