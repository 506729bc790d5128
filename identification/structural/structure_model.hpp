// The structure of a case (members, a chain, or matrices of another program); its coefficients may
// be unknown.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "fem/structures/structure_drawing.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

using AnyStructure = std::variant<fem::Structure, fem::LumpedChain, fem::MatrixStructure>;

/// A structure with parameters: named unknowns, each of which sets one or several coefficients.
struct StructureModel {
  /// The structure at the nominal parameter values (medians of the priors).
  AnyStructure nominal;
  /// The unknowns, sorted by name; empty if all coefficients are known.
  std::vector<inference::Parameter> parameters = {};
  /// Setter i writes parameter i to every coefficient that this parameter defines.
  std::vector<std::function<void(AnyStructure&, double)>> setters = {};
  /// Setters of coefficients that depend on several parameters, for example the stiffnesses of a
  /// section with unknown dimensions. They are called after the functions in `setters`, and
  /// throw std::invalid_argument for an impossible section.
  std::vector<std::function<void(AnyStructure&, std::span<const double>)>> dependent = {};

  /// The structure at these parameter values. Throws the exceptions of `dependent`.
  [[nodiscard]] AnyStructure at(std::span<const double> values) const {
    AnyStructure structure = nominal;
    for (std::size_t i = 0; i < values.size(); ++i) setters[i](structure, values[i]);
    for (const auto& place : dependent) place(structure, values);
    return structure;
  }
};

/// The matrices of a structure of any kind. Throws fem::InvalidStructure.
[[nodiscard]] inline fem::Discretisation discretise(const AnyStructure& structure) {
  if (const auto* members = std::get_if<fem::Structure>(&structure))
    return fem::Mesh(*members).discretisation();
  if (const auto* chain = std::get_if<fem::LumpedChain>(&structure)) return fem::discretise(*chain);
  return fem::discretise(std::get<fem::MatrixStructure>(structure));
}

/// The matrices and drawing of a structure of any kind. Throws fem::InvalidStructure.
[[nodiscard]] inline fem::DrawnStructure drawn(const AnyStructure& structure) {
  return std::visit([](const auto& kind) { return fem::drawn(kind); }, structure);
}

}  // namespace wheeltap::identification
