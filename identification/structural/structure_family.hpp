// Conversion of a structure with unknown parameters to fem::StructureFamily, for reduced bases.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_structure.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// θ are the parameters of `model` in their order, θ₀ the medians of their priors. A model given by
/// matrices is divided into its substructures. The result keeps `model` alive.
[[nodiscard]] fem::StructureFamily family_of(std::shared_ptr<const StructureModel> model);

/// Computes the scale factors 1 + α of the parts of a model given by matrices; slow to prepare,
/// fast to evaluate. Throws std::bad_variant_access for other structures.
using MatrixScales = std::function<std::vector<double>(std::span<const double> parameters)>;
[[nodiscard]] MatrixScales scales_of(const StructureModel& model);

/// Draws of the parameters from their priors; always the same draws.
[[nodiscard]] std::vector<std::vector<double>> prior_draws(const StructureModel& model, int count);

}  // namespace wheeltap::identification
