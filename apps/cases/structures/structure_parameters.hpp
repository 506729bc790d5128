// Coefficients of a structure: numbers, or names of parameters with priors.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// Allowed interval of a coefficient.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open = false;  ///< true if the bounds themselves are excluded
  const char* words = "a number";
};
inline constexpr Bounds kPositive = {.lower = 0.0, .open = true, .words = "positive"};
inline constexpr Bounds kNotNegative = {.lower = 0.0, .words = "at least 0"};

/// A coefficient of a structure: a number, or a parameter.
struct Coefficient {
  double nominal = 0.0;  ///< the number, or the median of the parameter's prior
  int parameter = -1;    ///< index of the parameter; -1: a known number

  [[nodiscard]] bool known() const { return parameter < 0; }
  [[nodiscard]] double at(std::span<const double> values) const {
    return known() ? nominal : values[static_cast<std::size_t>(parameter)];
  }
};

/// The parameters of a case, and the coefficients of the structure that depend on them.
class StructureParameters {
 public:
  /// Parses /parameters. Throws Failure for an improper prior.
  explicit StructureParameters(const CaseFile& file);

  /// Parses the coefficient at `where`. Throws Failure for a number out of bounds, an unknown
  /// parameter, and a parameter whose prior exceeds the bounds.
  [[nodiscard]] Coefficient coefficient(const Pointer& where, const Bounds& bounds);
  /// Parses a coefficient and returns its nominal value. The function `set` stores a value in the
  /// structure. `set` is called at each change of the parameter.
  double place(const Pointer& where, const Bounds& bounds,
               std::function<void(identification::AnyStructure&, double)> set);
  /// Registers the function `set`, which is called whenever the parameter of the coefficient
  /// changes.
  void follow(const Coefficient& coefficient,
              std::function<void(identification::AnyStructure&, double)> set);
  /// Registers the function `set`, which is called with the values of all parameters.
  void follow_all(std::function<void(identification::AnyStructure&, std::span<const double>)> set);

  /// Nominal value of each parameter.
  [[nodiscard]] std::vector<double> nominal() const;

  /// The structure with its parameters. Throws Failure if a parameter of the case is not used.
  [[nodiscard]] identification::StructureModel model(identification::AnyStructure nominal) &&;

 private:
  const CaseFile& file_;
  std::vector<inference::Parameter> parameters_;
  std::vector<bool> used_;
  std::vector<std::vector<std::function<void(identification::AnyStructure&, double)>>> setters_;
  std::vector<std::function<void(identification::AnyStructure&, std::span<const double>)>>
      dependent_;
};

}  // namespace wheeltap::apps
