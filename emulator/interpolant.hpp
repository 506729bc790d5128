// Interpolants of the runs of a table, and the description of each interpolant type: name in a case
// file, accepted layout of the runs, and training function.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "emulator/table.hpp"

namespace wheeltap::emulator {

/// Leave-one-out predictions: the prediction of each run is based on all other runs.
struct LeaveOneOut {
  RowMatrix mean;      ///< runs × responses
  RowMatrix variance;  ///< variance of the prediction, including the noise of the run
};

/// A function of the factors of a table, R^d → R^responses, that approximates the runs of the
/// table. Several threads may call `evaluate` at once. Only the first evaluation of a thread
/// allocates memory.
class Interpolant {
 public:
  virtual ~Interpolant() = default;

  /// Writes all responses at x (one value per factor) to `out` (one value per response). Throws
  /// std::out_of_range if `contains(x)` is false, because interpolants do not extrapolate.
  virtual void evaluate(std::span<const double> x, std::span<double> out) const = 0;
  /// Writes all responses at x, and the variances of the interpolation errors. Throws
  /// std::logic_error if this interpolant type does not compute variances.
  virtual void evaluate(std::span<const double> x, std::span<double> out,
                        std::span<double> variance) const;
  /// True if x is in the domain of the interpolant.
  [[nodiscard]] virtual bool contains(std::span<const double> x) const = 0;
  /// Returns leave-one-out predictions; the result is empty if this interpolant type does not
  /// compute such predictions.
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
  /// One entry per factor: true if responses oscillate along this factor, for example natural
  /// frequencies along the location of a damaged element. Along the other factors, responses are
  /// monotone. If the list is empty, responses are monotone along all factors.
  std::vector<bool> waves = {};
};

/// Description of an interpolant type, defined in the same file as the class of the interpolant.
struct InterpolantType {
  enum class Runs { grid, scattered };
  /// Trains an interpolant on a complete table. Fitted parameters are added to Table::parameters;
  /// existing ones are reused. Throws std::invalid_argument for an unsuitable table.
  using Train = std::unique_ptr<const Interpolant> (*)(Table& table,
                                                       const TrainingOptions& options);

  std::string_view name;   ///< value of "interpolation" in a case and in a table file
  std::string_view words;  ///< display name, e.g. "Gaussian process"
  Runs runs = Runs::grid;  ///< accepted layout; types for scattered points also accept a grid
  std::size_t most_factors = std::numeric_limits<std::size_t>::max();
  /// True if the domain is the convex hull of the runs instead of the whole box of the factors. For
  /// these types, a design of experiments also contains the corners of this box.
  bool within_hull = false;
  bool slow = false;          ///< an evaluation takes hundreds of microseconds instead of a few
  bool has_variance = false;  ///< the interpolant computes the variance of its error
  Train train = nullptr;
};

}  // namespace wheeltap::emulator
