// The case of a damage identification: intact structure, measured modes, kinds of defects and
// emulator.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"
#include "identification/emulation/emulator_spec.hpp"
#include "identification/structural/defects/defect_kind.hpp"
#include "identification/structural/likelihood/noise_model.hpp"
#include "identification/structural/measured_modes.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// The noise and seed with which a case simulates data.
struct Simulation {
  int modes = 10;
  double cv = 0.0;  ///< noise sd divided by the true frequency
  std::uint64_t seed = 1;
  double shape_sd = 0.0;  ///< sd of shape entries, if the largest entry is 1; 0: no shapes
};

/// Frequencies [Hz] of the undamaged structure, measured (NaN: not measured) and computed; see
/// identification/structural/damage/baseline.hpp.
struct Baseline {
  std::vector<double> measured_hz = {}, model_hz = {};
};

struct DamageCase {
  std::string title = {};
  bool balance = false;                                  ///< true: draw models evenly and reweight
  fem::Beam beam = {};                                   ///< beam, if the case has no structure
  double beam_depth = 0.0;                               ///< depth of the section, for cracks
  std::shared_ptr<const StructureModel> structure = {};  ///< if set, replaces the beam
  int rigid_body_modes = 0;  ///< rigid-body modes of the intact beam; absent from the data
  FrequencyData data = {};   ///< empty until frequencies are simulated
  /// Present only if shapes were measured, frequencies have a covariance, coefficients of the
  /// intact structure are unknown or several states were measured. `data` then contains only the
  /// frequencies of the measured modes. Shapes refer to solved_structure().
  MeasuredModes measured = {};
  std::optional<Baseline> baseline = {};  ///< if set, `data` are already divided by b/m
  std::optional<Simulation> simulation = {};
  std::vector<DefectKind> kinds = {};
  std::optional<EmulatorSpec> emulator = {};  ///< empty: only FE solutions are used

  [[nodiscard]] const ModalData* modal() const { return measured.modal(); }
  [[nodiscard]] std::shared_ptr<const ObservedStates> states() const { return measured.states(); }
  /// Number of modes that the model has to predict.
  [[nodiscard]] int modes() const {
    return data.modes() > 0 ? data.modes() : (simulation ? simulation->modes : 0);
  }
  [[nodiscard]] fem::Defects true_defects() const;
  /// The intact beam; null if the case defines a structure.
  [[nodiscard]] const fem::Beam* intact_beam() const { return structure ? nullptr : &beam; }
  /// True if the case defines a structure or shapes, or if its beam has defects that the beam model
  /// does not support (a crack, a mass, an extent).
  [[nodiscard]] bool solved_as_structure() const;
  /// The structure whose modes are computed. Throws std::invalid_argument.
  [[nodiscard]] AnyStructure solved_structure() const;
};

/// The structure with its true defects, for a case with `solved_as_structure()`.
[[nodiscard]] fem::Discretisation true_structure(const DamageCase& damage_case);
/// Shapes with noise (`Simulation`) at the sensors of `modal`: one row per mode, largest entry 1
/// before the noise. Throws InvalidInput.
[[nodiscard]] Eigen::MatrixXd simulated_shapes(const DamageCase& damage_case, int modes,
                                               std::uint64_t seed);
/// The `modes` lowest elastic frequencies [Hz] of the true structure, by the full solution.
[[nodiscard]] std::vector<double> true_frequencies(const DamageCase& damage_case, int modes);

/// Number of degrees of freedom that rigid supports leave free.
[[nodiscard]] int free_degrees_of_freedom(const fem::Beam& beam);
/// Number of rigid-body modes of the intact beam.
[[nodiscard]] int rigid_body_modes(const fem::Beam& beam);

/// Sets derived members (rigid-body modes; equal prior weights of defect counts if none are given)
/// and checks the case. Throws InvalidInput.
void complete(DamageCase& damage_case);

/// The `modes` lowest elastic frequencies [Hz] of the beam with these defects, by the full
/// solution.
[[nodiscard]] std::vector<double> elastic_frequencies(const fem::Beam& beam,
                                                      const fem::Defects& defects, int modes);

/// Simulates frequencies of the true structure with Gaussian noise, sd = cv · true frequency.
/// Throws InvalidInput if the case has no true defects, or if its noise is not a number.
[[nodiscard]] FrequencyData simulate(const DamageCase& damage_case, std::uint64_t seed);

}  // namespace wheeltap::identification
