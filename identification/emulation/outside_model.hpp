// The interface to an external model that replaces the built-in model.
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace wheeltap::identification {

/// Thrown if an external model gives no response, or a malformed response, in every attempt.
class OutsideModelError : public std::runtime_error {
 public:
  enum class Kind {
    unreachable,  ///< the program or server does not exist or has stopped
    bad_answer    ///< the response does not have the required format
  };
  OutsideModelError(Kind kind, const std::string& line) : std::runtime_error(line), kind_(kind) {}
  [[nodiscard]] Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// A model y(x), R^inputs → R^outputs. A call may take hours. Implementations must be thread-safe.
class OutsideModel {
 public:
  virtual ~OutsideModel() = default;

  [[nodiscard]] virtual int inputs() const = 0;
  [[nodiscard]] virtual int outputs() const = 0;
  /// Computes all entries of y, which must be finite. Throws OutsideModelError.
  virtual void evaluate(std::span<const double> x, std::span<double> y) = 0;
  /// Optional: writes Σ_i sensitivity_i ∂y_i/∂x_j into slope_j. Returns false if the model provides
  /// no derivatives. Throws OutsideModelError.
  virtual bool gradient(std::span<const double> /*x*/, std::span<const double> /*sensitivity*/,
                        std::span<double> /*slope*/) {
    return false;
  }
};

}  // namespace wheeltap::identification
