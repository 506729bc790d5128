#include "inference/moves/between_models/mixture_transport.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::inference {

namespace {

// Replaces ln w_l N_l(z) by ln p(l | z).
void normalise_logs(std::vector<double>& logs) {
  const double top = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double v : logs) sum += std::exp(v - top);
  for (double& v : logs) v -= top + std::log(sum);
}

double log_phi(double u) {
  return -0.5 * u * u - 0.91893853320467274178;
}

}  // namespace

std::optional<double> MixtureTransport::propose(const State& from, const Step& step, State& to) {
  double log_ratio = 0.0;
  to.model = propose_model(*fit_, from.model, step.random, log_ratio);
  if (to.model < 0) return std::nullopt;
  const auto& old_mixture = fit_->density[static_cast<std::size_t>(from.model)];
  const auto& new_mixture = fit_->density[static_cast<std::size_t>(to.model)];
  const std::size_t d = from.z.size();
  const auto d_new = static_cast<std::size_t>(step.target.space()[to.model].dimension);
  u_.assign(std::max(d, d_new), 0.0);

  if (old_mixture) {
    logs_.resize(static_cast<std::size_t>(old_mixture->size()));
    old_mixture->component_log_densities(from.z, logs_);
    normalise_logs(logs_);
    double v = step.random.uniform();
    std::size_t l = 0;
    for (; l + 1 < logs_.size(); ++l) {
      v -= std::exp(logs_[l]);
      if (v < 0.0) break;
    }
    const int component = static_cast<int>(l);
    old_mixture->standardise(component, from.z, std::span(u_).first(d));
    log_ratio += std::log((*old_mixture)[component].weight) - logs_[l] -
                 old_mixture->log_determinant(component);
  }
  for (std::size_t i = d_new; i < d; ++i) log_ratio += log_phi(u_[i]);
  for (std::size_t i = d; i < d_new; ++i) {
    u_[i] = step.random.normal();
    log_ratio -= log_phi(u_[i]);
  }
  to.z.resize(d_new);
  if (new_mixture) {
    const int component = new_mixture->sample_component(step.random);
    new_mixture->unstandardise(component, std::span(u_).first(d_new), to.z);
    if (!step.target.is_sorted(to)) return std::nullopt;
    logs_.resize(static_cast<std::size_t>(new_mixture->size()));
    new_mixture->component_log_densities(to.z, logs_);
    normalise_logs(logs_);
    log_ratio += logs_[static_cast<std::size_t>(component)] -
                 std::log((*new_mixture)[component].weight) +
                 new_mixture->log_determinant(component);
  }
  if (!std::isfinite(log_ratio)) return std::nullopt;
  return log_ratio;
}

}  // namespace wheeltap::inference
