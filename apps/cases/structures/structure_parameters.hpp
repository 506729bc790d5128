// The coefficients of a structure's case: numbers, or names of parameters that have priors.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::apps {

/// What a coefficient may be.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open = false;  ///< the ends themselves are not allowed
  const char* words = "a number";
};
inline constexpr Bounds kPositive = {.lower = 0.0, .open = true, .words = "positive"};
inline constexpr Bounds kNotNegative = {.lower = 0.0, .words = "at least 0"};

/// A number, or the parameter that stands for it.
struct Coefficient {
  double nominal = 0.0;  ///< of a parameter: the median of its prior
  int parameter = -1;    ///< -1: known

  [[nodiscard]] bool known() const { return parameter < 0; }
  [[nodiscard]] double at(std::span<const double> values) const {
    return known() ? nominal : values[static_cast<std::size_t>(parameter)];
  }
};

/// The parameters of a case, and the places that they stand for.
class StructureParameters {
 public:
  /// Reads /parameters. Throws Failure for an improper prior.
  explicit StructureParameters(const CaseFile& file);

  /// What stands at `where`. Throws Failure for a number out of bounds, a name that is no
  /// parameter's, and a parameter whose prior reaches out of bounds.
  [[nodiscard]] Coefficient coefficient(const Pointer& where, const Bounds& bounds);
  /// The same, put into its place in the structure by `set`, now and whenever the parameter
  /// changes.
  double place(const Pointer& where, const Bounds& bounds,
               std::function<void(identification::AnyStructure&, double)> set);
  /// Has `set` called whenever the coefficient's parameter changes.
  void follow(const Coefficient& coefficient,
              std::function<void(identification::AnyStructure&, double)> set);
  /// Has `set` called with all parameters.
  void follow_all(std::function<void(identification::AnyStructure&, std::span<const double>)> set);

  /// Of each parameter, its nominal value.
  [[nodiscard]] std::vector<double> nominal() const;

  /// The structure with its parameters. Throws Failure where a parameter stands nowhere.
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
