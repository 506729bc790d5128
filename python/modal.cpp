// Identification of modes from records.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <sstream>

#include "apps/commands/modal_command.hpp"
#include "apps/report/modal_page.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/job.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

/// Identified modes, with their case and options.
struct Modal {
  apps::ModalRun run;
  apps::CommonOptions common;
};

/// Identifies modes on a separate thread. This takes seconds and cannot be stopped.
template <class Make>
std::shared_ptr<Modal> identified(const std::string& path, const py::dict& said, const Make& make) {
  apps::CommonOptions common = run_options(said).common;
  common.case_path = path;
  return guarded(path, [&] {
    std::shared_ptr<Modal> out;
    watched(py::none(), [&](Job&) { out = std::make_shared<Modal>(Modal{make(common), common}); });
    return out;
  });
}

std::shared_ptr<Modal> of_case(const std::string& path, const py::object& text,
                               const std::vector<std::string>& overrides, const py::dict& said) {
  apps::CaseFile file = guarded(path, [&] { return case_of(path, text, overrides); });
  return identified(path, said, [&](const apps::CommonOptions& common) {
    return apps::identify_modal(std::move(file), common);
  });
}

/// `text`: the modal case that assigns roles to these columns.
std::shared_ptr<Modal> of_channels(const std::string& text,
                                   const std::map<std::string, std::vector<double>>& columns,
                                   const py::dict& said) {
  apps::CaseFile file = guarded("channels", [&] { return case_of("channels", py::str(text), {}); });
  signals::Record record;
  for (const auto& [name, values] : columns)
    record.columns.push_back({.header = name, .name = name, .values = values});
  return identified("channels", said, [&](const apps::CommonOptions& common) {
    return apps::identify_modal(std::move(file), common, std::move(record));
  });
}

}  // namespace

void bind_modal(py::module_& m) {
  py::class_<Modal, std::shared_ptr<Modal>>(m, "Modal", "Modes identified from records.")
      .def_property_readonly(
          "frequencies_hz",
          [](const Modal& self) -> const Eigen::VectorXd& { return self.run.modes.frequencies_hz; },
          py::return_value_policy::reference_internal)
      .def_property_readonly(
          "damping",
          [](const Modal& self) -> const Eigen::VectorXd& { return self.run.modes.damping; },
          py::return_value_policy::reference_internal)
      .def_property_readonly(
          "covariance",
          [](const Modal& self) -> const Eigen::MatrixXd& { return self.run.modes.covariance; },
          py::return_value_policy::reference_internal)
      .def_property_readonly(
          "shapes",
          [](const Modal& self) -> const Eigen::MatrixXcd& { return self.run.modes.shapes; },
          py::return_value_policy::reference_internal)
      .def_property_readonly("summary",
                             [](const Modal& self) { return self.run.summary(self.common).dump(); })
      .def_property_readonly("modes_json",
                             [](const Modal& self) { return modes_json(self.run.modes).dump(); })
      .def_property_readonly("text",
                             [](const Modal& self) {
                               std::ostringstream out;
                               self.run.print(out, false);
                               return out.str();
                             })
      .def("page",
           [](const Modal& self) {
             return apps::modal_page(self.run.summary(self.common), self.run.modes);
           })
      .def("keep", [](const Modal& self, const std::string& folder) {
        guarded(folder, [&] { self.run.keep(folder, self.common); });
      });
  m.def("modal", &of_case, py::arg("path"), py::arg("text"), py::arg("overrides"),
        py::arg("options"));
  m.def("modal_of_channels", &of_channels, py::arg("text"), py::arg("columns"), py::arg("options"));
}

}  // namespace wheeltap::python
