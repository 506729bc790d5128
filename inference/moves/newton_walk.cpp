#include "inference/moves/newton_walk.hpp"

#include <cmath>

#include "base/eigen_solvers.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kLeastContraction = 1e-3;  // smallest 1 - ρ
constexpr double kNewtonStep = 1e-4;  // scales the exact derivatives; z is standard normal a priori

}  // namespace

const NewtonWalk::Local* NewtonWalk::about(const State& state, Target& target) {
  for (std::size_t k = 0; k < known_.size(); ++k) {
    if (known_[k].model != state.model || known_[k].z != state.z) continue;
    oldest_ = 1 - k;
    return &known_[k];
  }
  Local& local = known_[oldest_];
  local.model = -1;
  const auto d = static_cast<Eigen::Index>(state.z.size());
  const std::vector<double> steps(state.z.size(), kNewtonStep);
  std::vector<double> gradient(state.z.size()), information(state.z.size() * state.z.size());
  at_.model = state.model;
  at_.z = state.z;
  if (!target.gauss_newton(at_, steps, gradient, information)) return nullptr;
  const Eigen::LLT<Eigen::MatrixXd> llt(
      Eigen::Map<const Eigen::MatrixXd>(information.data(), d, d));
  if (llt.info() != Eigen::Success) return nullptr;
  local.newton = llt.solve(Eigen::Map<const Eigen::VectorXd>(gradient.data(), d));
  local.factor = llt.matrixL();
  local.log_determinant = local.factor.diagonal().array().log().sum();
  if (!local.newton.allFinite() || !std::isfinite(local.log_determinant)) return nullptr;
  local.model = state.model;
  local.z = state.z;
  oldest_ = 1 - oldest_;
  return &local;
}

std::optional<double> NewtonWalk::propose(const State& from, const Step& step, State& to) {
  if (from.z.empty() || !step.target.has_exact_derivatives()) return std::nullopt;
  const Local* here = about(from, step.target);
  if (here == nullptr) return std::nullopt;
  const auto d = static_cast<Eigen::Index>(from.z.size());
  const double share = std::pow(kLeastContraction, step.random.uniform());  // 1 - ρ
  const double scale = std::sqrt(share * (2.0 - share));                    // √(1 - ρ²)
  Eigen::VectorXd u(d);
  for (double& v : u) v = step.random.normal();
  const Eigen::Map<const Eigen::VectorXd> z(from.z.data(), d);
  Eigen::Map<Eigen::VectorXd> end(to.z.data(), d);
  end = z + share * here->newton +
        scale * here->factor.transpose().triangularView<Eigen::Upper>().solve(u);
  const double log_forward = here->log_determinant - 0.5 * u.squaredNorm();
  const Local* there = about(to, step.target);
  if (there == nullptr) return std::nullopt;
  const Eigen::VectorXd back =
      there->factor.transpose() * (z - end - share * there->newton) / scale;
  return there->log_determinant - 0.5 * back.squaredNorm() - log_forward;
}

}  // namespace wheeltap::inference
