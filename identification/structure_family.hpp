// A structure with parameters, as the reduced bases of fem/ want it.
#pragma once

#include <memory>

#include "fem/structures/parametric_structure.hpp"
#include "identification/structure_model.hpp"

namespace wheeltap::identification {

/// θ are the parameters in their order, θ₀ the medians of their priors. Matrices are told apart
/// into their substructures. Keeps the model alive.
[[nodiscard]] fem::StructureFamily family_of(std::shared_ptr<const StructureModel> model);

/// Draws of the parameters' priors, reproducibly.
[[nodiscard]] std::vector<std::vector<double>> prior_draws(const StructureModel& model, int count);

}  // namespace wheeltap::identification
