// Conversion of a structure with parameters to the families of fem/ for reduced bases.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_structure.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// θ are the parameters in their order, θ₀ the medians of their priors. A model of matrices is
/// divided into its substructures. The result keeps `model` alive.
[[nodiscard]] fem::StructureFamily family_of(std::shared_ptr<const StructureModel> model);

/// The scales 1 + α of the parts of a model of matrices; expensive to prepare, fast to evaluate.
/// Throws std::bad_variant_access for other structures.
using MatrixScales = std::function<std::vector<double>(std::span<const double> parameters)>;
[[nodiscard]] MatrixScales scales_of(const StructureModel& model);

/// Reproducible draws of the parameters' priors.
[[nodiscard]] std::vector<std::vector<double>> prior_draws(const StructureModel& model, int count);

}  // namespace wheeltap::identification
