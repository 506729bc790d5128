#include "identification/structural/structure_family.hpp"

#include "base/random.hpp"

namespace wheeltap::identification {

fem::StructureFamily family_of(std::shared_ptr<const StructureModel> model) {
  fem::StructureFamily family;
  for (const auto& parameter : model->parameters)
    family.nominal.push_back(parameter.prior.from_standard_normal(0.0));
  family.at = [model](std::span<const double> theta) { return discretise(model->at(theta)); };
  if (const auto* matrices = std::get_if<fem::MatrixStructure>(&model->nominal)) {
    for (const auto& part : matrices->parts) family.parts.push_back(part.stiffness);
    family.scales = scales_of(*model);
  }
  return family;
}

MatrixScales scales_of(const StructureModel& model) {
  // Omits the matrices, because copying them would take longer than a solution.
  auto light = std::make_shared<StructureModel>(model);
  auto& matrices = std::get<fem::MatrixStructure>(light->nominal);
  matrices.mass = {};
  for (auto& part : matrices.parts) part.stiffness = {};
  return [light](std::span<const double> parameters) {
    const AnyStructure at = light->at(parameters);
    std::vector<double> scales;
    for (const auto& part : std::get<fem::MatrixStructure>(at).parts)
      scales.push_back(1.0 + part.change);
    return scales;
  };
}

std::vector<std::vector<double>> prior_draws(const StructureModel& model, int count) {
  base::Random random(1, 0, 0, base::Purpose::fit);
  std::vector<std::vector<double>> out(static_cast<std::size_t>(count));
  for (auto& theta : out)
    for (const auto& parameter : model.parameters)
      theta.push_back(parameter.prior.from_standard_normal(random.normal()));
  return out;
}

}  // namespace wheeltap::identification
