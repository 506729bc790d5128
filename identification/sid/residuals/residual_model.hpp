// Models of the residuals r = (measured - predicted) [SI] of one response.
//
// To add a residual model, write one file in this folder. If case files may name the model, also
// add a ResidualKind to the file and a line to the list in residual_list.cpp. Schema, parser,
// summary and output texts use this list.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

struct ResidualKind;

/// A parameter of a residual model, in addition to the standard deviation σ of each response.
struct ResidualParameter {
  std::string name;
  inference::Prior prior;
  std::string_view unit;  ///< SI unit of the parameter; "1": dimensionless
};

/// The parts of a phrase that names a residual model: "an" "autoregression" " of order 2".
struct ResidualWords {
  std::string_view article = {};
  std::string_view name = {};
  std::string detail = {};
  std::string_view remedy = {};  ///< advice to the user in case the innovations are not white
};

/// Innovations of the residuals: independent and N(0, variance) if the residual model is correct.
struct Innovations {
  std::vector<double> values;
  double variance;
};

/// The Gaussian joint density p(r | σ, c) of the N residuals of a response. σ is the standard
/// deviation of each r_n; predictive bands use σ. `c` contains the parameter values.
class ResidualModel {
 public:
  virtual ~ResidualModel() = default;

  [[nodiscard]] virtual ResidualWords words() const = 0;
  /// The kind of the residual model, and its value in a case file; null and 0 if a case file cannot
  /// name the residual model.
  [[nodiscard]] virtual const ResidualKind* kind() const { return nullptr; }
  [[nodiscard]] virtual int value() const { return 0; }
  /// The parameters for one response, in the order of `c`. `channel` is a part of each name, so
  /// that names are unique: "[2]", or empty if the case has one response.
  [[nodiscard]] virtual std::vector<ResidualParameter> parameters(
      const std::string& channel) const = 0;
  /// True if p(r | σ) = ∏ N(r_n | 0, σ²), so that the likelihood needs only Σ r_n².
  [[nodiscard]] virtual bool is_white() const { return false; }

  /// ln p(r | σ, c); -∞ for σ or c outside the allowed range.
  [[nodiscard]] virtual double log_density(std::span<const double> residuals, double sigma,
                                           std::span<const double> c) const = 0;
  /// N innovations e for σ = 1, linear in r: ln p(r | σ, c) = f(c) - N ln σ - ½ Σ e_n² / σ².
  /// `out` may be `residuals`.
  virtual void standardise(std::span<const double> residuals, std::span<const double> c,
                           std::span<double> out) const = 0;
  /// Returns the innovations for tests of whiteness, which are linear functions of the residuals. A
  /// residual model may omit the first few innovations. The default implementation returns the
  /// result of `standardise`, with variance σ².
  [[nodiscard]] virtual Innovations innovations(std::span<const double> residuals, double sigma,
                                                std::span<const double> c) const;
};

/// The model of independent residuals, which is the default.
[[nodiscard]] std::shared_ptr<const ResidualModel> white_residuals();

/// Residual models that a case file names by {"residuals": {key: value}}. The value 0 means white
/// residuals; "auto" calls `choose`.
struct ResidualKind {
  std::string_view key;
  std::string_view description;        ///< description of the object, for the schema
  std::string_view value_description;  ///< description of the value, for the schema
  int highest;                         ///< highest allowed value
  std::shared_ptr<const ResidualModel> (*make)(int value);
  /// Chooses the value from the residuals of one response. These residuals come from the best fit
  /// under the assumption of white residuals.
  int (*choose)(std::span<const double> residuals);
  std::string_view criterion;  ///< criterion by which `choose` selects
};
[[nodiscard]] std::span<const ResidualKind* const> residual_kinds();

/// Stationary autoregressions of order `value`. The parameters "ar[1]" … of an autoregression are
/// the partial autocorrelations in (-1, 1), each with the prior U(-1, 1).
extern const ResidualKind kAutoregressive;

}  // namespace wheeltap::identification
