// From a structure, its observations and its kinds of defects to a problem for the engine. Updating
// is the identification of damage without any kind of defect.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "identification/structural/defects/defect_kind.hpp"
#include "identification/structural/forward/mode_observation.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// What damage identification and updating share, kept together because the problem's likelihood
/// refers to it. The log likelihood is Σ ln p(data | prediction, noise) over the observations.
struct StructuralProblem {
  using Numbered = std::shared_ptr<const FrequencyObservation>;
  using Matched = std::shared_ptr<const ModeObservation>;

  std::shared_ptr<const ForwardModel> model = {};
  /// The first observation: of frequencies, which are numbered, or of modes, which are matched.
  std::variant<Numbered, Matched> observed = {};
  std::vector<DefectKind> kinds = {};  ///< of defects; none in an update
  inference::Problem problem = {};
  /// An observation, and where the parameters of its noise stand in a parameter vector.
  struct Placed {
    std::shared_ptr<const Observation> observation = {};
    std::size_t first = 0, count = 0;
  };
  std::vector<Placed> observations = {};  ///< the first, and those that were added
  /// Where the parameters of the intact structure, θ, stand in a parameter vector, and how many.
  int first_theta = 0, structural = 0;

  /// Modes are matched, and not numbered.
  [[nodiscard]] bool by_modes() const { return std::holds_alternative<Matched>(observed); }
  /// Throws std::bad_variant_access where frequencies are numbered.
  [[nodiscard]] const ModeObservation& modes() const { return *std::get<Matched>(observed); }
  /// Of modes in several states; or null.
  [[nodiscard]] const StatesLikelihood* states() const {
    return by_modes() ? modes().several_states() : nullptr;
  }
  /// Rows of the first observation.
  [[nodiscard]] int rows() const {
    return by_modes() ? modes().data().modes() : std::get<Numbered>(observed)->data().modes();
  }
  /// The state of a row, empty where there is one state, and its number there, from 1.
  struct Row {
    std::string state = {};
    int mode = 0;
  };
  [[nodiscard]] Row row(int mode) const;

  [[nodiscard]] std::span<const double> theta(std::span<const double> x) const {
    return x.subspan(static_cast<std::size_t>(first_theta), static_cast<std::size_t>(structural));
  }
  /// The parameters of an observation's noise.
  [[nodiscard]] std::span<const double> noise_of(const Placed& placed,
                                                 std::span<const double> x) const {
    return x.subspan(placed.first, placed.count);
  }
  /// The scatters of the state x. Throws std::bad_variant_access where frequencies are numbered.
  [[nodiscard]] ModalNoise modal_noise(std::span<const double> x) const {
    return modes().scatters().noise(noise_of(observations.front(), x));
  }
  /// Of the measured frequencies [Hz²], all rows. Throws as `modes`, as the next two do.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;
  [[nodiscard]] const std::optional<ShapeDensity>& shape(int mode) const;
  /// Numbers measured, scales of shapes not counted.
  [[nodiscard]] int measured() const;

  /// The defects of a parameter vector of a model, in the order of kinds.
  [[nodiscard]] std::vector<PlacedDefect> components(int m, std::span<const double> x) const {
    std::vector<PlacedDefect> list;
    components(m, x, list);
    return list;
  }
  /// The same, in place of what `to` held.
  void components(int m, std::span<const double> x, std::vector<PlacedDefect>& to) const;

  enum class First { noise, structure };
  /// Fills in `observations` and the places of parameters. Returns the parameters that all models
  /// have: θ = `intact` and the noise of `observed`, one of them first, then that of `added`.
  std::vector<inference::Parameter> place_parameters(
      First first, const std::vector<inference::Parameter>& intact,
      const std::vector<std::shared_ptr<const Observation>>& added);
};

/// Predictions of a problem, for one thread. Refers to problem and model.
class StructuralPredictor {
 public:
  explicit StructuralPredictor(const StructuralProblem& problem)
      : StructuralPredictor(problem, *problem.model) {}
  /// By `model`, in place of the problem's.
  StructuralPredictor(const StructuralProblem& problem, const ForwardModel& model)
      : problem_(problem), solver_(model.make_solver()) {}

  /// As ForwardModel::Solver has it.
  bool predict(int model, std::span<const double> x, ForwardModel::Quantity quantity,
               Prediction& out);
  /// Modes, and what the data say of them. False where there is no such structure.
  bool score(int model, std::span<const double> x, ModeObservation::Scored& out);
  /// The frequencies [Hz]: the `out.size()` lowest elastic ones, or those that match the measured
  /// modes. ∞ where there is no such structure.
  void solve(int model, std::span<const double> x, std::span<double> out);
  /// ∂ ln p(first observation | x)/∂x. False where there is none.
  bool gradient(int model, std::span<const double> x, std::span<double> out);

 private:
  bool gradient_of_frequencies(int model, std::span<const double> x, std::span<double> out);
  bool gradient_of_modes(std::span<const double> x, std::span<double> out);

  const StructuralProblem& problem_;
  std::unique_ptr<ForwardModel::Solver> solver_;
  std::vector<PlacedDefect> defects_;
  ModeObservation::Scored scratch_;
};

/// The likelihood of all observations, `model` predicting. Refers to both.
[[nodiscard]] inference::LikelihoodFactory likelihood_of(const StructuralProblem& problem,
                                                         const ForwardModel& model);

}  // namespace wheeltap::identification
