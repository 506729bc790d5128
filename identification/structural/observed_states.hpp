// States of a structure in which its modes were measured: healthy or damaged, with added masses, at
// different temperatures, or with specified coefficients.
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
  ModalData data = {};    ///< unknown noise parameters are common to all states
  bool damaged = false;   ///< true if the state contains the damages of the case
  std::vector<fem::StructureChange::Mass> masses = {};  ///< known added masses
  double temperature = 0.0;                             ///< temperature above the reference [K]
  /// Values of the specified coefficients, in the order of `ObservedStates::known`.
  std::vector<double> known = {};
};

/// Measured states and unknowns of the intact structure. θ are the parameters of the model that are
/// not in `known`. At the temperature difference ΔT, the stiffness (supports included) is K (1 + c
/// ΔT), with c the unknown `per_kelvin`.
struct ObservedStates {
  std::shared_ptr<const StructureModel> model = {};
  std::vector<int> unknown = {};  ///< indices of the model's parameters that θ contains
  std::vector<int> known = {};    ///< indices of the parameters that each state specifies
  std::optional<inference::Prior> per_kelvin = {};
  std::vector<ObservedState> list = {};
  bool uniform = false;  ///< true: every parameter acts on the whole structure (E of a beam)

  /// The unknowns: θ and, if its prior is given, c.
  [[nodiscard]] std::vector<inference::Parameter> parameters() const;
  /// Values of all parameters of the model in a state.
  [[nodiscard]] std::vector<double> values(std::span<const double> theta,
                                           const ObservedState& state) const;
  /// The frequencies of all states, concatenated, with the settings common to all states. Shapes
  /// are omitted, because they refer to the sensors of one state.
  [[nodiscard]] ModalData joined() const;
  [[nodiscard]] bool has_shapes() const;
  /// True if the data distinguish the ends of a symmetric beam, by shapes, added masses, or
  /// coefficients (unknown or specified) that act only on a part of the beam.
  [[nodiscard]] bool tells_sides() const;
};

/// Name of the parameter c, the temperature coefficient of the stiffness.
inline constexpr const char* kPerKelvin = "stiffness_per_kelvin";

}  // namespace wheeltap::identification
