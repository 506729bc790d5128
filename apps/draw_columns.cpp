#include "apps/draw_columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace wheeltap::apps {

std::string variable_of(const std::string& parameter) {
  // Names need no conversion by netcdf_name, because cases reject invalid names.
  std::string name = parameter;
  std::ranges::replace(name, '/', '_');
  while (!name.empty() && name.back() == ' ') name.pop_back();
  if (name == "model" || name == "chain" || name == "draw") name += "_";
  return name;
}

DrawColumn model_column(const inference::Posterior& posterior) {
  std::string names;
  for (const auto& model : posterior.space->models())
    names += (names.empty() ? "" : ";") + model.name;
  return {.name = "model",
          .value = [](const auto& chain, std::size_t i, std::size_t) { return chain.model[i]; },
          .whole = true,
          .names = std::move(names)};
}

DrawColumn parameter_column(const inference::Posterior& posterior, int parameter, std::string name,
                            std::string unit) {
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<int> places;  // index of this parameter in each model
  for (const auto& m : posterior.space->models()) {
    const auto found = std::ranges::find(m.parameters, parameter);
    places.push_back(found == m.parameters.end() ? -1
                                                 : static_cast<int>(found - m.parameters.begin()));
  }
  auto value = [places = std::move(places), width](const inference::Chain& c, std::size_t i,
                                                   std::size_t) {
    const int at = places[static_cast<std::size_t>(c.model[i])];
    return at < 0 ? std::nan("") : c.theta[i * width + static_cast<std::size_t>(at)];
  };
  return {.name = std::move(name), .value = std::move(value), .unit = std::move(unit)};
}

std::vector<DrawColumn> parameter_columns(const inference::Posterior& posterior) {
  std::vector<DrawColumn> columns = {model_column(posterior)};
  const auto& parameters = posterior.space->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p)
    columns.push_back(
        parameter_column(posterior, static_cast<int>(p), variable_of(parameters[p].name)));
  return columns;
}

void write_draws(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                 const std::vector<DrawColumn>& columns) {
  const int group = file.group("posterior");
  const int chain = file.dimension(group, "chain", posterior.chains.size(), 0);
  const int draw = file.dimension(group, "draw", posterior.chains[0].size(), 0);
  std::map<std::string, int> slots;
  for (const DrawColumn& column : columns) {
    std::vector<int> dimensions = {chain, draw};
    if (!column.slot.empty()) {
      if (!slots.contains(column.slot))
        slots[column.slot] = file.dimension(group, column.slot.c_str(), column.slots, 1);
      dimensions.push_back(slots[column.slot]);
    }
    const auto put = [&](auto number) {
      return file.put_rows<decltype(number)>(
          group, column.name, dimensions,
          [&](std::size_t c, auto& row) { column.append(posterior.chains[c], row); });
    };
    const int id = column.whole ? put(int{}) : put(double{});
    if (!column.unit.empty()) file.text(group, id, "units", column.unit);
    if (!column.names.empty()) file.text(group, id, "names", column.names);
  }
}

}  // namespace wheeltap::apps
