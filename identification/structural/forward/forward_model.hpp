// What predicts the vibration of one structure with defects.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/defects/placed_defect.hpp"

namespace wheeltap::identification {

/// A structure whose elastic frequencies (and modes at sensors) follow from its defects. Immutable:
/// threads share it, each with a solver of its own, which refers to it.
class ForwardModel {
 public:
  virtual ~ForwardModel() = default;

  /// ∂f/∂location [Hz/m] and ∂f/∂severity of each defect: row-major, a row a frequency, a column a
  /// defect.
  struct Slopes {
    std::vector<double> by_location = {}, by_severity = {};
  };

  /// The scratch memory of one thread.
  class Solver {
   public:
    virtual ~Solver() = default;
    /// The `out.size()` lowest elastic frequencies [Hz]. False, whatever `out` then holds, where
    /// the defects leave no structure.
    virtual bool frequencies(const std::vector<PlacedDefect>& defects, std::span<double> out) = 0;
    /// The same with their slopes. False, and nothing done, where the model has none.
    virtual bool differentiate(const std::vector<PlacedDefect>& /*defects*/,
                               std::span<double> /*out*/, Slopes& /*slopes*/) {
      return false;
    }
    /// Elastic modes at the model's sensors. False where the defects leave no structure, or where
    /// the model has no sensors.
    virtual bool modes(const std::vector<PlacedDefect>& /*defects*/,
                       fem::ParametricModes::Modes& /*out*/) {
      return false;
    }
  };
  [[nodiscard]] virtual std::unique_ptr<Solver> make_solver() const = 0;

  /// All computed frequencies [Hz] of a structure with these defects, for its symmetries; empty
  /// where they leave none. Refers to the model, and is for one thread. Null of models that have no
  /// symmetries to look for.
  using AllFrequencies = std::function<std::vector<double>(const std::vector<PlacedDefect>&)>;
  [[nodiscard]] virtual AllFrequencies all_frequencies() const { return {}; }

  /// A prediction takes milliseconds to hours: of a program or a server.
  [[nodiscard]] virtual bool is_expensive() const { return false; }
};

}  // namespace wheeltap::identification
