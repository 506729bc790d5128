// What predicts the vibration of one structure with defects.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"

namespace wheeltap::identification {

/// The vibration of a structure at one parameter vector. The caller owns it and passes it again:
/// then no prediction allocates memory.
struct Prediction {
  std::vector<double> frequencies_hz = {};  ///< the lowest elastic ones
  /// ∂f/∂location [Hz/m] and ∂f/∂severity of each defect: row-major, a row a frequency, a column a
  /// defect.
  std::vector<double> by_location = {}, by_severity = {};
  /// Elastic modes at the sensors, of each state.
  std::vector<fem::ParametricModes::Modes> modes = {};
  /// Of what the model gets wrong [Hz²], one a frequency; empty: it is exact.
  std::vector<double> error_variance = {};
};

/// A structure whose elastic frequencies (and modes at sensors) follow from its parameters and its
/// defects. Immutable: threads share it, each with a solver of its own, which refers to it.
class ForwardModel {
 public:
  virtual ~ForwardModel() = default;

  enum class Quantity {
    frequencies,  ///< `frequencies_hz`, as many as the prediction holds
    slopes,       ///< these, `by_location` and `by_severity`
    modes         ///< `modes`
  };

  /// The scratch memory of one thread.
  class Solver {
   public:
    virtual ~Solver() = default;
    /// `theta`: parameters of the intact structure, where it has some. Fills in `quantity` and,
    /// where the model errs, `error_variance`, which is empty before. False, whatever `out` then
    /// holds, where parameters and defects leave no structure or the model has no such quantity.
    virtual bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
                         Quantity quantity, Prediction& out) = 0;
    /// Optional: ∂ ln p/∂θ_i into slope[i], of a structure without defects, and its modes, which
    /// `likelihood` says that of, into `out`. False, whatever these then hold, where there is none.
    virtual bool gradient(std::span<const double> /*theta*/, const ModalLikelihood& /*likelihood*/,
                          const ModalNoise& /*noise*/, Prediction& /*out*/,
                          std::span<double> /*slope*/) {
      return false;
    }
  };
  [[nodiscard]] virtual std::unique_ptr<Solver> make_solver() const = 0;

  /// All computed frequencies [Hz] of a structure with these defects, for its symmetries, at
  /// parameters of the intact structure that are no special place; empty where they leave none.
  /// Refers to the model, and is for one thread. Null of models that have no symmetries to look
  /// for.
  using AllFrequencies = std::function<std::vector<double>(const std::vector<PlacedDefect>&)>;
  [[nodiscard]] virtual AllFrequencies all_frequencies() const { return {}; }

  /// A prediction takes milliseconds to hours: of a program or a server.
  [[nodiscard]] virtual bool is_expensive() const { return false; }
};

}  // namespace wheeltap::identification
