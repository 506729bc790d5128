// The scatters of measured modes that are parameters.
#pragma once

#include <span>
#include <vector>

#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

/// Those of `data` that have a prior, in this order: "cov", "shape_sd", "discrepancy",
/// "shape_discrepancy", "mixing", "stiffness_discrepancy". The others are known.
class UnknownScatters {
 public:
  explicit UnknownScatters(const ModalData& data);

  [[nodiscard]] const std::vector<inference::Parameter>& parameters() const { return parameters_; }
  /// The scatters of a state with these values of the parameters.
  [[nodiscard]] ModalNoise noise(std::span<const double> values) const;
  /// Whether this one is a parameter: `contains(&ModalNoise::cov)`.
  [[nodiscard]] bool contains(double ModalNoise::*scatter) const;

 private:
  std::vector<inference::Parameter> parameters_;
  std::vector<double ModalNoise::*> places_;  // of each parameter
  ModalNoise known_;
};

/// Names that scatters have as parameters of an update.
[[nodiscard]] const std::vector<std::string>& scatter_names();

}  // namespace wheeltap::identification
