// NumPy arrays that share memory with C++.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <vector>

namespace wheeltap::python {

namespace py = pybind11;

/// A read-only view of memory that `owner` keeps alive.
template <class Number>
py::array view(const Number* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  py::array_t<Number> array(std::move(shape), data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// A read-only array that takes ownership of `values` without a copy.
template <class Number>
py::array owned(std::vector<Number> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<Number>>(std::move(values));
  const Number* data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<Number>*>(p); });
  static_cast<void>(kept.release());
  return view(data, std::move(shape), owner);
}

}  // namespace wheeltap::python
