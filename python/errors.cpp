#include "python/errors.hpp"

namespace wheeltap::python {
namespace {

PyObject* error_of(apps::Exit exit) {
  const auto module = py::module_::import("wheeltap._core");
  switch (exit) {
    case apps::Exit::usage:
    case apps::Exit::bad_input:
      return module.attr("CaseError").ptr();
    case apps::Exit::no_input:
    case apps::Exit::cannot_create:
      return module.attr("FileError").ptr();
    case apps::Exit::interrupted:
      return PyExc_KeyboardInterrupt;
    default:
      return PyExc_RuntimeError;
  }
}

void make_error(py::module_& module, const char* name, PyObject* base, const char* text) {
  const std::string full = std::string("wheeltap.") + name;
  module.attr(name) = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), text, base, nullptr));
}

}  // namespace

void bind_errors(py::module_& module) {
  make_error(module, "CaseError", PyExc_ValueError,
             "A case or its data are invalid; the message states the file, the location, the value "
             "and the allowed values.");
  make_error(module, "FileError", PyExc_OSError,
             "A file is missing, cannot be read or cannot be written.");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const apps::Failure& failure) {
      PyErr_SetString(error_of(failure.exit()), failure.what());
    }
  });
}

}  // namespace wheeltap::python
