// A model of someone else's that predicts in place of ours: numbers in, numbers out.
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace wheeltap::identification {

/// A model that does not answer, or not as it should, after all that was tried.
class OutsideModelError : public std::runtime_error {
 public:
  enum class Kind {
    unreachable,  ///< there is no such program or server, or there is none any more
    bad_answer    ///< it answers, but not with what was asked for
  };
  OutsideModelError(Kind kind, const std::string& line) : std::runtime_error(line), kind_(kind) {}
  [[nodiscard]] Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// y(x), R^inputs → R^outputs. It may cost hours. Called from several threads at once.
class OutsideModel {
 public:
  virtual ~OutsideModel() = default;

  [[nodiscard]] virtual int inputs() const = 0;
  [[nodiscard]] virtual int outputs() const = 0;
  /// All of y, finite. Throws OutsideModelError.
  virtual void evaluate(std::span<const double> x, std::span<double> y) = 0;
  /// Optional: Σ_i sensitivity_i ∂y_i/∂x_j into slope_j. False where there are no derivatives.
  /// Throws OutsideModelError.
  virtual bool gradient(std::span<const double> /*x*/, std::span<const double> /*sensitivity*/,
                        std::span<double> /*slope*/) {
    return false;
  }
};

}  // namespace wheeltap::identification
