// The states in which a structure's modes were measured: healthy and damaged, with masses added, at
// different temperatures, with coefficients that were set.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/structures/defects/structure_change.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

struct ObservedState {
  std::string name = {};  ///< "healthy", "state 2", "damaged"
  ModalData data = {};    ///< its scatters, where unknown, are those of all states
  bool damaged = false;   ///< the damages of the case are in it
  std::vector<fem::StructureChange::Mass> masses = {};  ///< added, known
  double temperature = 0.0;                             ///< above the reference [K]
  /// Of the coefficients that every state has set, in the order of `ObservedStates::known`.
  std::vector<double> known = {};
};

/// What was measured, and what is unknown of the intact structure. θ are the parameters of the
/// model that are not `known`; a state at ΔT has the stiffness K (1 + c ΔT), c the unknown
/// `per_kelvin`, supports included.
struct ObservedStates {
  std::shared_ptr<const StructureModel> model = {};
  std::vector<int> unknown = {};  ///< parameters of the model: θ
  std::vector<int> known = {};    ///< those that the states set
  std::optional<inference::Prior> per_kelvin = {};
  std::vector<ObservedState> list = {};
  bool uniform = false;  ///< every parameter acts on the whole structure alike: E of a beam

  /// θ and, where it is unknown, c.
  [[nodiscard]] std::vector<inference::Parameter> parameters() const;
  /// All parameters of the model in a state.
  [[nodiscard]] std::vector<double> values(std::span<const double> theta,
                                           const ObservedState& state) const;
  /// All frequencies in a row, and what is common to all states; no shapes, which belong to one
  /// state's sensors.
  [[nodiscard]] ModalData joined() const;
  [[nodiscard]] bool has_shapes() const;
  /// Something but frequencies tells one end of a symmetric beam from the other: shapes, added
  /// masses, unknown or set coefficients that are not of the whole beam.
  [[nodiscard]] bool tells_sides() const;
};

/// What the parameter of the temperature is called.
inline constexpr const char* kPerKelvin = "stiffness_per_kelvin";

}  // namespace wheeltap::identification
