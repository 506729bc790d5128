#include "identification/structural/observed_states.hpp"

#include <algorithm>

namespace wheeltap::identification {

using Eigen::Index;

std::vector<inference::Parameter> ObservedStates::parameters() const {
  std::vector<inference::Parameter> out;
  for (const int p : unknown) out.push_back(model->parameters[static_cast<std::size_t>(p)]);
  if (per_kelvin) out.push_back({kPerKelvin, *per_kelvin});
  return out;
}

std::vector<double> ObservedStates::values(std::span<const double> theta,
                                           const ObservedState& state) const {
  std::vector<double> out(model->parameters.size());
  for (std::size_t i = 0; i < unknown.size(); ++i)
    out[static_cast<std::size_t>(unknown[i])] = theta[i];
  for (std::size_t i = 0; i < known.size(); ++i)
    out[static_cast<std::size_t>(known[i])] = state.known[i];
  return out;
}

ModalData ObservedStates::joined() const {
  ModalData out;
  Index n = 0;
  bool all_known = true;
  for (const ObservedState& s : list) {
    n += s.data.modes();
    all_known = all_known && !s.data.cov_prior;
  }
  if (all_known) out.covariance = Eigen::MatrixXd::Zero(n, n);
  Index at = 0;
  for (const ObservedState& s : list) {
    const Index m = s.data.modes();
    out.frequencies_hz.insert(out.frequencies_hz.end(), s.data.frequencies_hz.begin(),
                              s.data.frequencies_hz.end());
    if (all_known) out.covariance.block(at, at, m, m) = s.data.covariance;
    at += m;
    if (s.data.cov_prior) out.cov_prior = s.data.cov_prior;
    if (s.data.shape_sd_prior) out.shape_sd_prior = s.data.shape_sd_prior;
    if (!s.data.discrepancy.none()) out.discrepancy = s.data.discrepancy;
    if (!s.data.shape_discrepancy.none()) out.shape_discrepancy = s.data.shape_discrepancy;
    if (!s.data.mixing.none()) out.mixing = s.data.mixing;
    if (!s.data.stiffness_discrepancy.none())
      out.stiffness_discrepancy = s.data.stiffness_discrepancy;
    out.simulated = out.simulated || s.data.simulated;
    out.origin += (out.origin.empty() ? "" : "; ") + s.name + " " + s.data.origin;
  }
  return out;
}

bool ObservedStates::has_shapes() const {
  return std::ranges::any_of(list, [](const ObservedState& s) { return s.data.has_shapes(); });
}

bool ObservedStates::tells_sides() const {
  return has_shapes() || !uniform ||
         std::ranges::any_of(list, [](const ObservedState& s) { return !s.masses.empty(); });
}

}  // namespace wheeltap::identification
