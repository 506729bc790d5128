#include "python/run.hpp"

#include <pybind11/stl.h>

#include "io/netcdf/netcdf_library.hpp"
#include "io/netcdf/netcdf_writer.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"

namespace wheeltap::python {
namespace {

/// One chain of a posterior. The object keeps the posterior alive.
struct ChainOfRun {
  std::shared_ptr<const inference::Posterior> posterior;
  std::size_t number = 0;

  [[nodiscard]] const inference::Chain& chain() const { return posterior->chains[number]; }
};

/// Returns {name: (array, dimensions, unit, names)} of the draws, arrays (chain, draw[, slot]).
py::dict columns_of(const Run& run) {
  py::dict out;
  const auto chains = static_cast<py::ssize_t>(run.finished.posterior->chains.size());
  const auto draws = static_cast<py::ssize_t>(run.finished.posterior->draws);
  for (const apps::DrawColumn& column : run.finished.columns()) {
    std::vector<py::ssize_t> shape = {chains, draws};
    py::list dimensions;
    dimensions.append("chain");
    dimensions.append("draw");
    if (!column.slot.empty()) {
      shape.push_back(static_cast<py::ssize_t>(column.slots));
      dimensions.append(column.slot);
    }
    const auto numbers = [&](auto number) -> py::array {
      std::vector<decltype(number)> values;
      for (const inference::Chain& chain : run.finished.posterior->chains)
        column.append(chain, values);
      return owned(std::move(values), shape);
    };
    const py::array array = column.whole ? numbers(int{}) : numbers(double{});
    out[py::str(column.name)] =
        py::make_tuple(array, py::tuple(dimensions), column.unit, column.names);
  }
  return out;
}

template <class Number>
auto member_of_chain(inference::DrawList<Number> inference::Chain::*member) {
  return [member](const py::object& self) {
    const auto& of = self.cast<const ChainOfRun&>();
    const auto& values = of.chain().*member;
    return view(values.data(), {static_cast<py::ssize_t>(values.size())}, self);
  };
}

}  // namespace

void bind_run(py::module_& m) {
  py::class_<Progress>(m, "Progress", "Progress of a run.")
      .def_readonly("stage", &Progress::stage)
      .def_readonly("fraction", &Progress::fraction, "Completed fraction of the stage.")
      .def_readonly("evaluations", &Progress::evaluations, "Likelihood evaluations so far.")
      .def_readonly("probabilities", &Progress::probabilities, "Model probabilities so far.")
      .def("__repr__", [](const Progress& p) {
        return "<Progress: " + p.stage + " " + std::to_string(static_cast<int>(100 * p.fraction)) +
               " %>";
      });

  py::class_<ChainOfRun>(m, "Chain", "Draws of one chain: a read-only view of the engine's memory.")
      .def("__len__", [](const ChainOfRun& self) { return self.chain().size(); })
      .def_property_readonly("model", member_of_chain(&inference::Chain::model),
                             "model index of each draw")
      .def_property_readonly("log_prior", member_of_chain(&inference::Chain::log_prior))
      .def_property_readonly("log_likelihood", member_of_chain(&inference::Chain::log_likelihood))
      .def_property_readonly("accepted", member_of_chain(&inference::Chain::accepted))
      .def_property_readonly(
          "theta",
          [](const py::object& self) {
            const auto& of = self.cast<const ChainOfRun&>();
            return view(of.chain().theta.data(),
                        {static_cast<py::ssize_t>(of.chain().size()),
                         static_cast<py::ssize_t>(of.posterior->dimension)},
                        self);
          },
          "parameters of each draw's model (draws × largest dimension), NaN beyond its dimension");

  py::class_<Run, std::shared_ptr<Run>>(m, "Run", "A finished run.")
      .def_property_readonly("summary", [](const Run& run) { return run.finished.summary.dump(); })
      .def_property_readonly("text", [](const Run& run) { return run.finished.text(); })
      .def_property_readonly("run_id", [](const Run& run) { return run.finished.run; })
      .def_property_readonly("stopped_early",
                             [](const Run& run) { return run.finished.posterior->stopped_early; })
      .def_readonly("lines", &Run::lines)
      .def("posterior_nc",
           [](const Run& run) {
             return guarded("posterior.nc", [&] {
               const io::NetcdfLock lock;
               io::NetcdfWriter file("posterior.nc");
               run.finished.draws(file);
               return py::bytes(file.close());
             });
           })
      .def("columns", &columns_of)
      .def("chains", [](const Run& run) {
        std::vector<ChainOfRun> chains;
        for (std::size_t c = 0; c < run.finished.posterior->chains.size(); ++c)
          chains.push_back({run.finished.posterior, c});
        return chains;
      });
}

}  // namespace wheeltap::python
