// Interpolants of a table's runs, and the description of each type: name in a case, accepted runs,
// training.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "emulator/table.hpp"

namespace wheeltap::emulator {

/// Leave-one-out predictions: each run is predicted from all other runs.
struct LeaveOneOut {
  RowMatrix mean;      ///< runs × responses
  RowMatrix variance;  ///< variance of the omitted run, including its noise
};

/// A function of a table's factors, R^d → R^responses, that approximates its runs. Several threads
/// may evaluate it at once; after a thread's first evaluation, it does not allocate.
class Interpolant {
 public:
  virtual ~Interpolant() = default;

  /// Writes all responses at x (one value per factor) to `out` (one value per response). Throws
  /// std::out_of_range for x outside `contains`: there is no extrapolation.
  virtual void evaluate(std::span<const double> x, std::span<double> out) const = 0;
  /// Writes all responses at x and the variances of the interpolation error. Throws
  /// std::logic_error if this type of interpolant gives no variances.
  virtual void evaluate(std::span<const double> x, std::span<double> out,
                        std::span<double> variance) const;
  /// True if x is in the domain of the interpolant.
  [[nodiscard]] virtual bool contains(std::span<const double> x) const = 0;
  /// Leave-one-out predictions; empty if this type of interpolant does not compute them.
  [[nodiscard]] virtual LeaveOneOut leave_one_out() const { return {}; }

 protected:
  Interpolant() = default;
  Interpolant(const Interpolant&) = default;
  Interpolant(Interpolant&&) = default;
  Interpolant& operator=(const Interpolant&) = default;
  Interpolant& operator=(Interpolant&&) = default;
};

struct TrainingOptions {
  int threads = 1;
  /// One entry per factor: true if responses oscillate along it, as mode frequencies do with the
  /// location of a damage. Along the other factors they are monotone. Empty: monotone along all
  /// factors.
  std::vector<bool> waves = {};
};

/// Description of an interpolant type, defined beside its class.
struct InterpolantType {
  enum class Runs { grid, scattered };
  /// Trains on a complete table. Fitted values are added to the table's parameters; existing ones
  /// are reused. Throws std::invalid_argument for an unsuitable table.
  using Train = std::unique_ptr<const Interpolant> (*)(Table& table,
                                                       const TrainingOptions& options);

  std::string_view name;   ///< "interpolation" in a case and in a table file
  std::string_view words;  ///< display name, e.g. "Gaussian process"
  Runs runs = Runs::grid;  ///< scattered runs may be a grid; a grid may not be scattered
  std::size_t most_factors = std::numeric_limits<std::size_t>::max();
  /// True if the domain is the convex hull of the runs instead of the whole box of the factors. The
  /// corners of the box are then added to designs.
  bool within_hull = false;
  bool slow = false;          ///< hundreds of microseconds per evaluation instead of a few
  bool has_variance = false;  ///< gives the variance of its error
  Train train = nullptr;
};

}  // namespace wheeltap::emulator
