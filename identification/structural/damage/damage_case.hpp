// What is asked of a damaged beam: the intact beam, the measured frequencies, what may be wrong
// with it, and what predicts.
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
#include "identification/structural/modal_data.hpp"
#include "identification/structural/observed_states.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// A simulation asked for by the case.
struct Simulation {
  int modes = 10;
  double cv = 0.0;  ///< noise: sd = cv · true frequency
  std::uint64_t seed = 1;
  double shape_sd = 0.0;  ///< of entries, shapes scaled to a largest entry of 1; 0: no shapes
};

/// The undamaged structure's frequencies [Hz], measured (NaN where not) and as the model has them;
/// see identification/structural/damage/baseline.hpp.
struct Baseline {
  std::vector<double> measured_hz = {}, model_hz = {};
};

struct DamageCase {
  std::string title = {};
  bool balance = false;                                  ///< sample models evenly and reweight
  fem::Beam beam = {};                                   ///< where there is no structure
  double beam_depth = 0.0;                               ///< height of its section, for cracks
  std::shared_ptr<const StructureModel> structure = {};  ///< in place of the beam
  int rigid_body_modes = 0;  ///< of the intact beam; data and predictions leave them out
  FrequencyData data = {};   ///< empty frequencies where it is to be simulated
  /// Where shapes were measured, or frequencies have a covariance: all that was measured, and
  /// `data` is the part of it that is frequencies. Shapes belong to the structure that is solved.
  std::shared_ptr<const ModalData> modal = {};
  std::optional<Baseline> baseline = {};  ///< that `data` are compared with already
  /// Where coefficients of the intact structure are unknown, or several states were measured: all
  /// that was measured; `modal` and `data` are then that in a row.
  std::shared_ptr<const ObservedStates> states = {};
  std::optional<Simulation> simulation = {};
  std::vector<DefectKind> kinds = {};
  std::optional<EmulatorSpec> emulator = {};  ///< none: the FE solution itself

  /// Modes that predictions are needed for.
  [[nodiscard]] int modes() const {
    return data.modes() > 0 ? data.modes() : (simulation ? simulation->modes : 0);
  }
  [[nodiscard]] fem::Defects true_defects() const;
  /// A structure, or a beam with defects that only structures know (a crack, a mass, an extent), or
  /// with shapes.
  [[nodiscard]] bool solved_as_structure() const;
  /// What is solved then. Throws std::invalid_argument.
  [[nodiscard]] AnyStructure solved_structure() const;
};

/// What the truth makes of a case that is solved as a structure.
[[nodiscard]] fem::Discretisation true_structure(const DamageCase& damage_case);
/// Shapes with noise as `Simulation` has it, at the sensors of `modal`: a row a mode, largest entry
/// 1 before the noise. Throws InvalidInput.
[[nodiscard]] Eigen::MatrixXd simulated_shapes(const DamageCase& damage_case, int modes,
                                               std::uint64_t seed);
/// Its elastic frequencies [Hz] by the full solve, `modes` of them.
[[nodiscard]] std::vector<double> true_frequencies(const DamageCase& damage_case, int modes);

/// Degrees of freedom that rigid supports leave.
[[nodiscard]] int free_degrees_of_freedom(const fem::Beam& beam);
/// Motions of the intact beam that cost no energy.
[[nodiscard]] int rigid_body_modes(const fem::Beam& beam);

/// Fills in what follows from the rest (rigid-body modes, equal weights of counts where none are
/// given) and checks that a run is possible. Throws InvalidInput.
void complete(DamageCase& damage_case);

/// The elastic frequencies [Hz] of the beam under these defects, by the full solve, `modes` of
/// them.
[[nodiscard]] std::vector<double> elastic_frequencies(const fem::Beam& beam,
                                                      const fem::Defects& defects, int modes);

/// Frequencies of the true structure with Gaussian noise, sd = cv · true frequency. Throws
/// InvalidInput where the case has no truth, or no number for the noise.
[[nodiscard]] FrequencyData simulate(const DamageCase& damage_case, std::uint64_t seed);

}  // namespace wheeltap::identification
