// Conversion of a structure, its observations and kinds of defects to an inference problem. A model
// update is a damage identification without defects.
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

/// Data that damage identification and model updating have in common. The likelihood of `problem`
/// refers to these data. The log likelihood is Σ ln p(data | prediction, noise) over the
/// observations.
struct StructuralProblem {
  using Numbered = std::shared_ptr<const FrequencyObservation>;
  using Matched = std::shared_ptr<const ModeObservation>;

  std::shared_ptr<const ForwardModel> model = {};
  /// The first observation: frequencies identified by mode number, or matched modes.
  std::variant<Numbered, Matched> observed = {};
  std::vector<DefectKind> kinds = {};  ///< kinds of defects; empty for an update
  inference::Problem problem = {};
  /// An observation, and the position of its noise parameters in a parameter vector.
  struct Placed {
    std::shared_ptr<const Observation> observation = {};
    std::size_t first = 0, count = 0;
  };
  std::vector<Placed> observations = {};  ///< data of the case, then added observations
  /// Index of the first parameter θ of the intact structure in a parameter vector, and number of θ.
  int first_theta = 0, structural = 0;

  /// True if measured modes are matched to computed modes, not identified by mode number.
  [[nodiscard]] bool by_modes() const { return std::holds_alternative<Matched>(observed); }
  /// Throws std::bad_variant_access for numbered frequencies.
  [[nodiscard]] const ModeObservation& modes() const { return *std::get<Matched>(observed); }
  /// The likelihood of modes in several states; null for one state.
  [[nodiscard]] const StatesLikelihood* states() const {
    return by_modes() ? modes().several_states() : nullptr;
  }
  /// Number of rows (modes) of the first observation.
  [[nodiscard]] int rows() const {
    return by_modes() ? modes().data().modes() : std::get<Numbered>(observed)->data().modes();
  }
  /// The state of a row (empty for a single state), and the mode number in this state, from 1.
  struct Row {
    std::string state = {};
    int mode = 0;
  };
  [[nodiscard]] Row row(int mode) const;

  [[nodiscard]] std::span<const double> theta(std::span<const double> x) const {
    return x.subspan(static_cast<std::size_t>(first_theta), static_cast<std::size_t>(structural));
  }
  /// The noise parameters of an observation.
  [[nodiscard]] std::span<const double> noise_of(const Placed& placed,
                                                 std::span<const double> x) const {
    return x.subspan(placed.first, placed.count);
  }
  /// The noise parameters at x. Throws std::bad_variant_access for numbered frequencies.
  [[nodiscard]] ModalNoise modal_noise(std::span<const double> x) const {
    return modes().scatters().noise(noise_of(observations.front(), x));
  }
  /// Covariance of the measured frequencies [Hz²], all rows. This function and the next two throw
  /// the exceptions of `modes`.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;
  [[nodiscard]] const std::optional<ShapeDensity>& shape(int mode) const;
  /// Number of measured values, minus one for each shape, because the scale of a shape is
  /// arbitrary.
  [[nodiscard]] int measured() const;

  /// The defects in a parameter vector of model m, sorted by kind.
  [[nodiscard]] std::vector<PlacedDefect> components(int m, std::span<const double> x) const {
    std::vector<PlacedDefect> list;
    components(m, x, list);
    return list;
  }
  /// The same, written to `to`.
  void components(int m, std::span<const double> x, std::vector<PlacedDefect>& to) const;

  enum class First { noise, structure };
  /// Sets `observations` and the positions of parameters. Returns the parameters common to all
  /// models: `intact` (θ) and the noise parameters of `observed` in the order of `first`, then
  /// those of `added`.
  std::vector<inference::Parameter> place_parameters(
      First first, const std::vector<inference::Parameter>& intact,
      const std::vector<std::shared_ptr<const Observation>>& added);
};

/// Computes predictions of a problem in one thread. Problem and model must outlive the object.
class StructuralPredictor {
 public:
  explicit StructuralPredictor(const StructuralProblem& problem)
      : StructuralPredictor(problem, *problem.model) {}
  /// Predicts with `model` instead of the problem's forward model.
  StructuralPredictor(const StructuralProblem& problem, const ForwardModel& model)
      : problem_(problem), solver_(model.make_solver()) {}

  /// Predicts like ForwardModel::Solver::predict.
  bool predict(int model, std::span<const double> x, ForwardModel::Quantity quantity,
               Prediction& out);
  /// Computes modes and their score (log likelihood). Returns false if the structure is impossible.
  bool score(int model, std::span<const double> x, ModeObservation::Scored& out);
  /// Computes frequencies [Hz]: the `out.size()` lowest elastic frequencies, or the frequencies of
  /// the modes matched to the measured modes; ∞ if the structure is impossible.
  void solve(int model, std::span<const double> x, std::span<double> out);
  /// ∂ ln p(first observation | x)/∂x. Returns false if the gradient is not available.
  bool gradient(int model, std::span<const double> x, std::span<double> out);
  /// Like inference::Likelihood::gauss_newton, for the first observation, from exact derivatives of
  /// the modes.
  bool gauss_newton(std::span<const double> x, std::span<const double> steps,
                    std::span<double> gradient, std::span<double> information);

 private:
  bool gradient_of_frequencies(int model, std::span<const double> x, std::span<double> out);
  bool gradient_of_modes(std::span<const double> x, std::span<double> out);
  /// ∂ ln p/∂x_p and -∂² ln p/∂x_p² for one noise parameter, at the modes in `scratch_`.
  struct Bend {
    double slope = 0.0, curvature = 0.0;
  };
  [[nodiscard]] Bend by_scatter(std::span<const double> x, std::size_t p) const;

  const StructuralProblem& problem_;
  std::unique_ptr<ForwardModel::Solver> solver_;
  std::vector<PlacedDefect> defects_;
  ModeObservation::Scored scratch_;
  fem::ParametricModes::Slopes slopes_;
};

/// The likelihood of all observations, predicted by `model`. Both arguments must outlive it.
[[nodiscard]] inference::LikelihoodFactory likelihood_of(const StructuralProblem& problem,
                                                         const ForwardModel& model);

}  // namespace wheeltap::identification
