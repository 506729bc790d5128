// Functions without sampling: natural frequencies, simulation, measured files, schemas.
#include <pybind11/stl.h>

#include "apps/cases/simulation.hpp"
#include "apps/commands/data_command.hpp"
#include "apps/runs/found_modes.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

/// Returns {"columns": {name: array}, "units": {name: unit}, "sample_rate": Hz or None}.
py::dict record_of(signals::Record record, std::optional<double> sample_rate) {
  py::dict columns, units;
  const int time = record.find_time();
  if (!sample_rate && time >= 0) sample_rate = signals::sample_rate_hz(record, time);
  for (io::Column& column : record.columns) {
    const auto n = static_cast<py::ssize_t>(column.values.size());
    units[py::str(column.name)] = column.unit;
    columns[py::str(column.name)] = owned(std::move(column.values), {n});
  }
  py::dict out;
  out["columns"] = columns;
  out["units"] = units;
  out["sample_rate"] = sample_rate ? py::object(py::float_(*sample_rate)) : py::none();
  return out;
}

py::object simulate(const std::string& path, const py::object& text,
                    const std::vector<std::string>& overrides, const py::dict& said) {
  RunOptions options = run_options(said);
  options.common.case_path = path;
  return guarded(path, [&]() -> py::object {
    apps::CaseFile file = case_of(path, text, overrides);
    const apps::Json kind = file.json.value("kind", apps::Json());
    if (kind == "sid") {
      apps::require_room_for_truth(file, options.common);
      return record_of(apps::simulated_record(std::move(file), options.common.seed).record, {});
    }
    const apps::SimulatedCase made =
        kind == "update" ? apps::simulated_update(std::move(file), options.common.seed)
                         : apps::simulated_damage(std::move(file), options.common.seed);
    return py::str(made.json.dump());
  });
}

}  // namespace

void bind_cases(py::module_& m) {
  m.def(
      "modes",
      [](const std::string& path, const py::object& text, const std::vector<std::string>& overrides,
         std::optional<int> count, bool truth) {
        if (count && (*count < 1 || *count > 1'000'000'000))
          throw std::invalid_argument("n = " + std::to_string(*count) +
                                      ", must be a whole number from 1 to 1000000000");
        return guarded(path, [&] {
          return apps::find_modes(case_of(path, text, overrides),
                                  {.modes = count, .truth = truth, .shapes = true, .vtk = {}})
              .report.dump();
        });
      },
      py::arg("path"), py::arg("text"), py::arg("overrides"), py::arg("n"), py::arg("truth"));
  m.def("simulate", &simulate, py::arg("path"), py::arg("text"), py::arg("overrides"),
        py::arg("options"));
  m.def(
      "data",
      [](const std::string& path, std::optional<double> sample_rate) {
        return guarded(path, [&] {
          return apps::data_report(apps::look_at(path, {.sample_rate_hz = sample_rate})).dump();
        });
      },
      py::arg("path"), py::arg("sample_rate"));
  m.def(
      "read_record",
      [](const std::string& path, const std::vector<std::string>& columns,
         std::optional<double> sample_rate) {
        return guarded(path, [&] {
          return record_of(signals::read_record(path, {.columns = columns}), sample_rate);
        });
      },
      py::arg("path"), py::arg("columns"), py::arg("sample_rate"));
  m.def(
      "schema",
      [](const std::string& kind) {
        return guarded(kind, [&] { return apps::schema(kind).dump(); });
      },
      py::arg("kind"));
}

}  // namespace wheeltap::python
