// Interface of forward models, which predict the vibration of one structure with defects.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"

namespace wheeltap::identification {

/// Predicted vibration at one parameter vector. The caller reuses the object, so that predictions
/// do not allocate memory.
struct Prediction {
  std::vector<double> frequencies_hz = {};  ///< lowest elastic frequencies
  /// ∂f/∂location [Hz/m] and ∂f/∂severity of each defect: row-major, one row per frequency, one
  /// column per defect.
  std::vector<double> by_location = {}, by_severity = {};
  /// Elastic modes of each state, with shapes at the sensors.
  std::vector<fem::ParametricModes::Modes> modes = {};
  /// Error variance of the model [Hz²], one per frequency; empty: exact.
  std::vector<double> error_variance = {};
};

/// Computes elastic frequencies (and mode shapes at sensors) of a structure from its parameters and
/// defects. Immutable and shared by threads. Each thread has a separate solver; the model must
/// outlive all solvers.
class ForwardModel {
 public:
  virtual ~ForwardModel() = default;

  enum class Quantity {
    frequencies,  ///< as many frequencies as out.frequencies_hz has entries
    slopes,       ///< frequencies, `by_location` and `by_severity`
    modes         ///< `modes`
  };

  /// Computes predictions in one thread, with separate working memory.
  class Solver {
   public:
    virtual ~Solver() = default;
    /// Computes `quantity` and, if the model is inexact, `error_variance` (empty before the call).
    /// `theta` has the unknown parameters of the intact structure, if any. Returns false, with
    /// `out` undefined, if the structure is impossible or the model does not provide the quantity.
    virtual bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
                         Quantity quantity, Prediction& out) = 0;
    /// Optional: for a structure without defects, writes the modes into `out` and their derivatives
    /// with respect to θ into `slopes`. If the derivatives are not available, returns false, and
    /// `out` and `slopes` are undefined.
    virtual bool differentiate_modes(std::span<const double> /*theta*/, Prediction& /*out*/,
                                     fem::ParametricModes::Slopes& /*slopes*/) {
      return false;
    }
    /// Optional: for a structure without defects, writes ∂ ln p/∂θ_i of `likelihood` into slope[i]
    /// and the modes into `out`. Returns false, with both undefined, if the gradient is not
    /// available.
    virtual bool gradient(std::span<const double> theta, const ModalLikelihood& likelihood,
                          const ModalNoise& noise, Prediction& out, std::span<double> slope) {
      fem::ParametricModes::Slopes slopes;
      if (!differentiate_modes(theta, out, slopes)) return false;
      likelihood.slope(out.modes[0], slopes, noise, slope);
      return true;
    }
  };
  [[nodiscard]] virtual std::unique_ptr<Solver> make_solver() const = 0;

  /// True if `differentiate_modes` succeeds for all possible structures, or for nearly all.
  [[nodiscard]] virtual bool differentiates_modes() const { return false; }

  /// Computes all frequencies [Hz] of a structure with these defects at generic parameters of the
  /// intact structure, to test symmetries; empty if the structure is impossible. The model must
  /// outlive the function, which is not thread-safe. Null for models without symmetries.
  using AllFrequencies = std::function<std::vector<double>(const std::vector<PlacedDefect>&)>;
  [[nodiscard]] virtual AllFrequencies all_frequencies() const { return {}; }

  /// True if a prediction is slow (milliseconds to hours), for example because an external program
  /// or a server computes it.
  [[nodiscard]] virtual bool is_expensive() const { return false; }
};

}  // namespace wheeltap::identification
