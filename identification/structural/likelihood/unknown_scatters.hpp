// Unknown noise parameters of measured modes, as parameters of the problem.
#pragma once

#include <span>
#include <vector>

#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

/// The noise parameters of `data` that have a prior (the others are constants), in this order:
/// "cov", "shape_sd", "discrepancy", "shape_discrepancy", "mixing", "stiffness_discrepancy".
class UnknownScatters {
 public:
  explicit UnknownScatters(const ModalData& data);

  [[nodiscard]] const std::vector<inference::Parameter>& parameters() const { return parameters_; }
  /// All noise parameters of a state; `values` are those of the unknown noise parameters.
  [[nodiscard]] ModalNoise noise(std::span<const double> values) const;
  /// True if a noise parameter is unknown, for example `contains(&ModalNoise::cov)`.
  [[nodiscard]] bool contains(double ModalNoise::*scatter) const;

 private:
  std::vector<inference::Parameter> parameters_;
  std::vector<double ModalNoise::*> places_;  // the ModalNoise member of each parameter
  ModalNoise known_;
};

/// Names of the noise parameters in an update.
[[nodiscard]] const std::vector<std::string>& scatter_names();

}  // namespace wheeltap::identification
