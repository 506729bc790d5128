// What joins the runs of a table to a function, and how a type of it is described: its name in a
// case, the runs that it takes, how it is trained.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "emulator/table.hpp"

namespace wheeltap::emulator {

/// Leave-one-out predictions: each run from all the others.
struct LeaveOneOut {
  RowMatrix mean;      ///< runs × responses
  RowMatrix variance;  ///< of the run that was left out, its noise included
};

/// A function of a table's factors, R^d → R^responses, that keeps to its runs. Evaluations may run
/// in several threads at once and do not allocate once a thread has made its first one.
class Interpolant {
 public:
  virtual ~Interpolant() = default;

  /// All responses at x (one value per factor), written to `out` (one value per response). Throws
  /// std::out_of_range where x lies outside what `contains` says: there is no extrapolation.
  virtual void evaluate(std::span<const double> x, std::span<double> out) const = 0;
  /// And the variances of its own error. Throws std::logic_error where the type has none.
  virtual void evaluate(std::span<const double> x, std::span<double> out,
                        std::span<double> variance) const;
  /// Whether it answers at x.
  [[nodiscard]] virtual bool contains(std::span<const double> x) const = 0;
  /// Without rows where the type has none.
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
  /// For each factor whether responses rise and fall along it, as a mode's do with the place of a
  /// damage; along the others they only rise, or only fall. Empty: along none.
  std::vector<bool> waves = {};
};

/// A type of interpolant. Everything that is particular to it stands here, beside its class.
struct InterpolantType {
  enum class Runs { grid, scattered };
  /// Takes the runs of a table without missing ones. What it fits, it adds to the table's
  /// parameters; what it finds there already, it does not fit again. Throws std::invalid_argument
  /// for a table that it does not take.
  using Train = std::unique_ptr<const Interpolant> (*)(Table& table,
                                                       const TrainingOptions& options);

  std::string_view name;   ///< "interpolation" in a case and in a table file
  std::string_view words;  ///< begins a sentence about it: "Gaussian process"
  Runs runs = Runs::grid;  ///< scattered runs may be a grid; a grid may not be scattered
  std::size_t most_factors = std::numeric_limits<std::size_t>::max();
  /// It answers in the convex hull of its runs, not in the whole box of the factors: designs for it
  /// gain the corners of the box.
  bool within_hull = false;
  bool slow = false;          ///< hundreds of microseconds an evaluation, rather than a few
  bool has_variance = false;  ///< it knows the variance of its own error
  Train train = nullptr;
};

}  // namespace wheeltap::emulator
