// The likelihood of the modes of all states together, at the parameters of the intact structure and
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
#include "identification/structural/likelihood/stiffness_errors.hpp"
#include "identification/structural/observed_states.hpp"
#include "identification/structural/structure_family.hpp"

namespace wheeltap::identification {

/// With s the states, θ the intact structure and d the damages (of those states that have them),
///
///   ln p = Σ_s Σ_shapes ln p(ψ | φ(θ, d)) + ln N(f_obs; f(θ, d), C),
///   C = diag_s C_s + δ² Σ_m f_m f_mᵀ + Σ_{j<k} τ_jk² ℓ_jk ℓ_jkᵀ,
///
/// f_m the frequencies of mode m in all states with the same `known`, 0 elsewhere: what the model
/// does wrong by a factor of a mode (discrepancy δ) it does wrong in all of these, so that it does
/// not pass for damage. With one state this is ModalLikelihood.
///
/// What damage does to a frequency goes by the shapes, and these err at first order where the
/// frequencies do at second. If the model's error mixes c φ_k into φ_j and -c φ_j into φ_k,
/// c ~ N(0, τ_jk²) (`mixing_sd`), the damage's δK_d moves λ_j by 2c φ_jᵀ δK_d φ_k more and λ_k by
/// as much less. For a loss along one strain (φ_jᵀ δK_d φ_k)² = Δλ_j Δλ_k; for others it is less.
/// So, with Δλ from the first healthy state with the same `known` to a damaged one,
///
///   ℓ_jk = +2 √|Δλ_j Δλ_k| / (8π² f_j) at mode j of each damaged state, less as much at mode k.
///
/// Where pieces of the structure may be stiffer or softer than the model has them
/// (`ModalData::stiffness_discrepancy`), that is integrated out of frequencies and shapes of all
/// states with the same `known` together: see StiffnessErrors.
///
/// Each state's structure is assembled at θ, changed by its damages and masses, and solved by
/// SubspaceModes. States that differ by temperature alone share a solution. Matrices of another
/// program, K = Σ q_j K_j, are solved by ParametricModes: what changes are the q_j, by θ and by the
/// damages, whatever the rank of K_j.
class StatesLikelihood {
 public:
  /// `kinds`: of the damages; none in an update. Throws std::invalid_argument for data that do not
  /// fit together, naming state and mode; fem::InvalidStructure.
  StatesLikelihood(std::shared_ptr<const ObservedStates> states, std::vector<DefectKind> kinds);

  [[nodiscard]] const ObservedStates& states() const { return *states_; }
  [[nodiscard]] int modes() const { return static_cast<int>(joined_.frequencies_hz.size()); }
  /// All frequencies in a row; a mode's state and its place there.
  [[nodiscard]] const ModalData& data() const { return joined_; }
  struct Place {
    int state = 0, mode = 0;
  };
  [[nodiscard]] Place place(int mode) const { return places_[static_cast<std::size_t>(mode)]; }
  [[nodiscard]] const ModalLikelihood& of(int state) const {
    return likelihoods_[static_cast<std::size_t>(state)];
  }
  /// Numbers measured, scales not counted.
  [[nodiscard]] int measured() const;
  /// C without what states have in common, modes × modes.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;

  /// The matches of all states in a row. `modes`: of each state.
  [[nodiscard]] ModalLikelihood::Score score(const std::vector<fem::ParametricModes::Modes>& modes,
                                             const ModalNoise& noise) const;

  /// C of the measured frequencies, with what the states have in common where it is counted; `with`
  /// says which modes of the row they are.
  [[nodiscard]] Eigen::MatrixXd frequency_covariance(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score, std::vector<int>& with) const;

  /// Whether pieces err.
  [[nodiscard]] bool with_errors(const ModalNoise& noise) const {
    return pieces_.count() > 0 && noise.stiffness_discrepancy > 0.0;
  }
  /// ln p(a mode | all others, θ) of each mode of the row, where pieces err.
  [[nodiscard]] Eigen::VectorXd single_mode_densities(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score) const;

  /// Scratch memory of one thread. What was assembled and solved last is kept: moves of damages
  /// leave the intact structure as it was.
  struct Workspace {
    /// An intact structure, of all groups with the same `known`.
    struct Intact {
      std::optional<std::vector<double>> values = {};  ///< its parameters
      std::optional<fem::Mesh> mesh = {};
      fem::Discretisation discretisation = {};
    };
    struct Group {
      std::optional<fem::ParametricModes::Workspace> reduced = {};
      std::optional<std::vector<double>> values = {};  ///< `found` is theirs, without damages
      fem::ParametricModes::Modes found = {};
    };
    std::vector<Intact> intact;
    std::vector<Group> groups;
  };
  [[nodiscard]] Workspace make_workspace() const;

  /// The modes of each state. False where there is no such structure. `x`: as
  /// `ObservedStates::parameters`.
  bool solve(std::span<const double> x, const std::vector<PlacedDefect>& defects,
             Workspace& workspace, std::vector<fem::ParametricModes::Modes>& out) const;

  /// All computed frequencies [Hz] at a draw of the priors that is no special place: what is alike
  /// there is alike. Empty where there is no such structure.
  [[nodiscard]] std::vector<double> frequencies_anywhere(
      const std::vector<PlacedDefect>& defects) const;

  /// Largest relative error of a frequency against full solutions at `points` draws of the priors,
  /// defects of each kind among them, and how many modes Sturm's count misses.
  struct Check {
    double largest_error = 0.0;
    int points = 0, missed = 0;
    double seconds_a_solution = 0.0;  ///< of all states
  };
  [[nodiscard]] Check check(int points) const;

 private:
  /// Unknown errors: of each piece, and of what damage takes from it.
  [[nodiscard]] int errors() const { return 2 * pieces_.count(); }
  /// What the density of all states is made of where pieces err: frequencies with their covariance
  /// and sensitivities, and shapes, one a mode of the row.
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
  /// Errors of pieces integrated out of all modes, or of all but one.
  [[nodiscard]] Joint joint(const Parts& parts, const ModalNoise& noise, int without) const;
  /// ∂f/∂a_p of the frequencies `with`, by the pieces of states with one `known` after the other.
  [[nodiscard]] Eigen::MatrixXd frequency_sensitivities(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalLikelihood::Score& score,
      const std::vector<int>& with) const;
  /// C, without errors of pieces.
  [[nodiscard]] Eigen::MatrixXd covariance_of_noise(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
      const ModalLikelihood::Score& score, std::vector<int>& with) const;
  /// Where C has what states have in common: `with` are the modes that were measured.
  void add_common(const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise,
                  const ModalLikelihood::Score& score, const std::vector<int>& with,
                  Eigen::MatrixXd& covariance) const;
  struct Group {
    std::vector<int> states;  // that differ by temperature alone
    std::size_t intact = 0;   // of Workspace
    std::shared_ptr<const fem::SubspaceModes> solver = {};
    std::shared_ptr<const fem::ParametricModes> reduced = {};  // in its place, of matrices
  };
  /// A draw of the priors, every fourth without damages, the others with 1, 2, … of each kind; the
  /// medians at -1.
  struct Draw {
    std::vector<double> x;
    std::vector<PlacedDefect> defects;
  };
  [[nodiscard]] Draw draw(int i) const;
  [[nodiscard]] std::shared_ptr<const fem::ParametricModes> reduced_basis(const Group& group,
                                                                          int modes) const;
  /// Modes of the structure of a group, shapes at the sensors of its states one after the other.
  bool solve(const Group& group, std::span<const double> x,
             const std::vector<PlacedDefect>& defects, Workspace& workspace,
             Workspace::Group& own) const;
  /// Assembles it where `values` are others. Throws std::invalid_argument.
  void assemble(const std::vector<double>& values, Workspace::Intact& out) const;
  /// q_j of each matrix.
  [[nodiscard]] std::vector<double> scales(std::span<const double> x,
                                           const std::vector<PlacedDefect>& defects,
                                           const ObservedState& state) const;
  /// The structure of a state, changed. Throws ImpossibleChange, std::invalid_argument.
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
  MatrixScales scales_;  // of matrices
  StiffnessPieces pieces_;
  std::vector<int> family_;  // of each state: those with the same `known` err alike
};

}  // namespace wheeltap::identification
