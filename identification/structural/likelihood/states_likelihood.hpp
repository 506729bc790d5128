// The joint likelihood of the modes of all states, given the parameters of the intact structure and
// the damages.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/parametric_modes.hpp"
#include "fem/structures/modes/subspace_modes.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "identification/structural/likelihood/reanalysed_modes.hpp"
#include "identification/structural/likelihood/stiffness_errors.hpp"
#include "identification/structural/observed_states.hpp"
#include "identification/structural/structure_family.hpp"

namespace wheeltap::identification {

/// The likelihood for states s, parameters θ of the intact structure and damages d (in the damaged
/// states),
///
///   ln p = Σ_s Σ_shapes ln p(ψ | φ(θ, d)) + ln N(f_obs; f(θ, d), C),
///   C = diag_s C_s + δ² Σ_m f_m f_mᵀ + Σ_{j<k} τ_jk² ℓ_jk ℓ_jkᵀ,
///
/// f_m contains the frequencies of mode m in all states with the same `known`, and 0 elsewhere. A
/// model error that multiplies a mode's frequency by a factor (discrepancy δ) is common to these
/// states, and is therefore not attributed to damage. For one state, ln p equals that of
/// ModalLikelihood.
///
/// The effect of damage on a frequency depends on the shapes. First-order shape errors cause only
/// second-order frequency errors. Let the model error mix c φ_k into φ_j and -c φ_j into φ_k, c ~
/// N(0, τ_jk²) (`mixing_sd`). The stiffness change δK_d due to damage then changes λ_j by an
/// additional 2c φ_jᵀ δK_d φ_k, and λ_k by the opposite amount. For a stiffness loss of rank one,
/// (φ_jᵀ δK_d φ_k)² = Δλ_j Δλ_k; for other losses, the left side is smaller. Let Δλ be the change
/// from the first healthy state with the same `known` to a damaged state. The entries of ℓ_jk for
/// each damaged state are
///
///   +2 √|Δλ_j Δλ_k| / (8π² f_j) at mode j,   -2 √|Δλ_j Δλ_k| / (8π² f_k) at mode k.
///
/// The likelihood integrates over stiffness errors of parts of the structure
/// (`ModalData::stiffness_discrepancy`), jointly for the frequencies and shapes of all states with
/// the same `known`; see StiffnessErrors.
///
/// ReanalysedModes solves each state's structure if only a few springs, point masses and scales of
/// the whole structure are unknown. The constructor compares `kReanalysed` solutions by reanalysis
/// with full solutions. Without reanalysis, each structure is assembled at θ, changed by its
/// damages and masses, and solved by SubspaceModes. States that differ only in temperature share
/// one solution of the eigenvalue problem. Matrices of another program, K = Σ q_j K_j, are solved
/// by ParametricModes: θ and damages change only the q_j, for any rank of K_j.
class StatesLikelihood {
 public:
  /// Number of solutions by reanalysis that the constructor compares with full solutions.
  static constexpr int kReanalysed = 8;

  /// `kinds` are the kinds of damages, empty for an update; `beam` is the beam that the nominal
  /// structure represents, or null. Throws std::invalid_argument for inconsistent data, naming
  /// state and mode; throws fem::InvalidStructure.
  StatesLikelihood(std::shared_ptr<const ObservedStates> states, std::vector<DefectKind> kinds,
                   const fem::Beam* beam = nullptr);

  [[nodiscard]] const ObservedStates& states() const { return *states_; }
  [[nodiscard]] int modes() const { return static_cast<int>(joined_.frequencies_hz.size()); }
  /// The frequencies of all states, concatenated. `place` gives the state of a mode and the index
  /// of the mode in this state.
  [[nodiscard]] const ModalData& data() const { return joined_; }
  struct Place {
    int state = 0, mode = 0;
  };
  [[nodiscard]] Place place(int mode) const { return places_[static_cast<std::size_t>(mode)]; }
  [[nodiscard]] const ModalLikelihood& of(int state) const {
    return likelihoods_[static_cast<std::size_t>(state)];
  }
  /// Number of measured values, minus one for each shape, because the scale of a shape is
  /// arbitrary.
  [[nodiscard]] int measured() const;
  /// C without the errors that states have in common, modes × modes.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;

  /// Evaluates the likelihood of all states. The result contains the matches of all states,
  /// concatenated. `modes` holds the computed modes of each state.
  [[nodiscard]] ModalLikelihood::Score score(const std::vector<fem::ParametricModes::Modes>& modes,
                                             const ModalNoise& noise) const;

  /// Computes ln p from the frequencies alone if there are no shapes and states have no common
  /// errors; also writes the computed frequencies [Hz]. Returns false if the caller must use
  /// `score` instead.
  bool density_of_frequencies(const std::vector<fem::ParametricModes::Modes>& modes,
                              const ModalNoise& noise, double& log_density,
                              std::vector<double>& frequencies_hz) const;

  /// C of the measured frequencies, including errors that states have in common, if any. `with`
  /// receives the indices of these frequencies in `data()`.
  [[nodiscard]] Eigen::MatrixXd frequency_covariance(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score, std::vector<int>& with) const;

  /// True if reanalysis solves the structures (ReanalysedModes).
  [[nodiscard]] bool by_reanalysis() const { return reanalysed_ != nullptr; }
  /// True if stiffness errors are included.
  [[nodiscard]] bool with_errors(const ModalNoise& noise) const {
    return pieces_.count() > 0 && noise.stiffness_discrepancy > 0.0;
  }
  /// ln p(mode | all other modes, θ) for each mode in `data()`, with stiffness errors.
  [[nodiscard]] Eigen::VectorXd single_mode_densities(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score) const;

  /// Working memory of one thread. The workspace caches the last assembled structure and its
  /// solution, because proposals that change only damages do not change the intact structure.
  struct Workspace {
    /// The intact structure, which all groups with the same `known` share.
    struct Intact {
      std::optional<std::vector<double>> values = {};  ///< parameters of this structure
      std::optional<fem::Mesh> mesh = {};
      fem::Discretisation discretisation = {};
    };
    struct Group {
      std::optional<fem::ParametricModes::Workspace> reduced = {};
      std::optional<std::vector<double>> values = {};  ///< parameter values of `found`
      fem::ParametricModes::Modes found = {};
    };
    std::vector<Intact> intact;
    std::vector<Group> groups;
    std::optional<ReanalysedModes::Workspace> reanalysed = {};
  };
  [[nodiscard]] Workspace make_workspace() const;

  /// Computes the modes of each state. Returns false if the structure is impossible. `x` has the
  /// values of ObservedStates::parameters.
  bool solve(std::span<const double> x, const std::vector<PlacedDefect>& defects,
             Workspace& workspace, std::vector<fem::ParametricModes::Modes>& out) const;

  /// All frequencies [Hz] at a generic prior draw, at which only true symmetries make frequencies
  /// equal. Empty if no draw gives a stable structure.
  [[nodiscard]] std::vector<double> frequencies_anywhere(
      const std::vector<PlacedDefect>& defects) const;

  /// Comparison with full solutions at `points` prior draws with defects of each kind: largest
  /// relative error of a frequency, and number of missed modes (from Sturm counts).
  struct Check {
    double largest_error = 0.0;
    int points = 0, missed = 0;
    double seconds_a_solution = 0.0;  ///< run time of one solution of all states [s]
  };
  [[nodiscard]] Check check(int points) const;

 private:
  /// Number of unknown stiffness errors: two per part of the structure, for the stiffness of the
  /// part and for the stiffness that damage removes from it.
  [[nodiscard]] int errors() const { return 2 * pieces_.count(); }
  /// Quantities of the joint density with stiffness errors: frequencies with covariance and
  /// sensitivities, and shapes, one per mode in `data()`.
  struct Parts {
    std::vector<int> with;
    Eigen::MatrixXd covariance, sensitivities;
    Eigen::VectorXd residual;
    std::vector<std::optional<ModalLikelihood::ShapeErrors>> shapes;
  };
  [[nodiscard]] Parts parts(const std::vector<fem::ParametricModes::Modes>& modes,
                            const ModalNoise& noise, const ModalLikelihood::Score& score) const;
  struct Joint {
    double log_density = 0.0, chi_square = 0.0;
  };
  /// Density of the data without mode `without` (-1: of all data), integrated over the stiffness
  /// errors.
  [[nodiscard]] Joint joint(const Parts& parts, const ModalNoise& noise, int without) const;
  /// ∂f/∂a_p of the frequencies `with`, one row per frequency. For each set of values of `known`,
  /// there are `errors()` columns, one per stiffness error.
  [[nodiscard]] Eigen::MatrixXd frequency_sensitivities(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalLikelihood::Score& score,
      const std::vector<int>& with) const;
  /// The covariance C without the effect of stiffness errors.
  [[nodiscard]] Eigen::MatrixXd covariance_of_noise(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score, std::vector<int>& with) const;
  /// Adds the covariance of the errors that several states have in common to C; `with` lists the
  /// measured modes.
  void add_common(const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
                  const ModalLikelihood::Score& score, const std::vector<int>& with,
                  Eigen::MatrixXd& covariance) const;
  struct Group {
    std::vector<int> states;                   // states that differ only in temperature
    int modes = 1;                             // number of elastic modes
    std::vector<fem::SparseRow> motions = {};  // displacements at all sensors
    std::size_t intact = 0;                    // index of the intact structure in Workspace
    std::shared_ptr<const fem::SubspaceModes> solver = {};
    std::shared_ptr<const fem::ParametricModes> reduced = {};  // for matrices, instead of `solver`
  };
  /// Prior draw i: every fourth draw has no damages; the others have 1, 2, … damages of each kind.
  /// For i = -1: the prior medians.
  struct Draw {
    std::vector<double> x;
    std::vector<PlacedDefect> defects;
  };
  [[nodiscard]] Draw draw(int i) const;
  [[nodiscard]] std::shared_ptr<const fem::ParametricModes> reduced_basis(const Group& group,
                                                                          int modes) const;
  /// Sets `reanalysed_` if the solutions of ReanalysedModes agree with full solutions.
  void try_reanalysis(const fem::Beam* beam);
  [[nodiscard]] bool agrees_with_full(const Group& group, int draw) const;
  [[nodiscard]] ReanalysedModes::Outcome reanalyse(const Group& group,
                                                   const std::vector<double>& values,
                                                   const std::vector<PlacedDefect>& defects,
                                                   Workspace& workspace,
                                                   fem::ParametricModes::Modes& out) const;
  /// Computes the modes of a group's assembled structure. Throws the exceptions of SubspaceModes.
  bool solve_assembled(const Group& group, const std::vector<double>& values,
                       const std::vector<PlacedDefect>& defects, Workspace& workspace,
                       fem::ParametricModes::Modes& out) const;
  /// Computes the modes of a group. Each shape lists the components at the sensors of all states of
  /// the group, one state after the other.
  bool solve(const Group& group, std::span<const double> x,
             const std::vector<PlacedDefect>& defects, Workspace& workspace,
             Workspace::Group& own) const;
  /// Assembles the structure if `values` differ from those of `out`. Throws std::invalid_argument.
  void assemble(const std::vector<double>& values, Workspace::Intact& out) const;
  /// The factor q_j of each matrix.
  [[nodiscard]] std::vector<double> scales(std::span<const double> x,
                                           const std::vector<PlacedDefect>& defects,
                                           const ObservedState& state) const;
  /// The changed structure of a state. Throws ImpossibleChange, std::invalid_argument.
  [[nodiscard]] fem::Discretisation structure(std::span<const double> x,
                                              const std::vector<PlacedDefect>& defects,
                                              const ObservedState& state) const;
  [[nodiscard]] fem::StructureChange change_of(const Workspace::Intact& intact,
                                               const std::vector<PlacedDefect>& defects,
                                               const ObservedState& state) const;
  [[nodiscard]] fem::Discretisation changed(const Workspace::Intact& intact,
                                            const std::vector<PlacedDefect>& defects,
                                            const ObservedState& state) const;

  std::shared_ptr<const ObservedStates> states_;
  std::vector<DefectKind> kinds_;
  ModalData joined_;
  std::vector<ModalLikelihood> likelihoods_;
  std::vector<Place> places_;
  std::vector<Group> groups_;
  std::shared_ptr<const ReanalysedModes> reanalysed_;
  MatrixScales scales_;  // for matrices
  StiffnessPieces pieces_;
  std::vector<int> family_;  // per state: states with the same `known` have common errors
};

}  // namespace wheeltap::identification
