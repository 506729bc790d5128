#include "inference/moves/between_models/conditional_proposal.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"

namespace wheeltap::inference {

namespace {

constexpr double kLogSqrtTwoPi = 0.91893853320467274178;

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& lower) {
  return lower.triangularView<Eigen::Lower>().solve(
      Eigen::MatrixXd::Identity(lower.rows(), lower.cols()));
}

}  // namespace

ConditionalMixtures::ConditionalMixtures(const ModelSpace& space, const PilotFit& fit, int kind)
    : conditionals_(static_cast<std::size_t>(space.size())) {
  const auto j = static_cast<std::size_t>(kind);
  const int width = static_cast<int>(space.width(kind));
  for (int m = 0; m < space.size(); ++m) {
    const auto& mixture = fit.density[static_cast<std::size_t>(m)];
    const int k = space[m].counts[j];
    if (!mixture || k == 0) continue;
    const int d = space[m].dimension;
    for (int l = 0; l < mixture->size(); ++l) {
      const NormalMixture::Component& component = (*mixture)[l];
      const Eigen::MatrixXd covariance = component.factor * component.factor.transpose();
      for (int c = 0; c < k; ++c) {
        const int first = static_cast<int>(space.component(m, kind, c).first);
        // Indices of the coordinates of the other components, then of component j.
        std::vector<int> rest, own;
        for (int i = 0; i < d; ++i) (i >= first && i < first + width ? own : rest).push_back(i);
        const Eigen::MatrixXd s_ii = covariance(rest, rest);
        const Eigen::MatrixXd s_ji = covariance(own, rest);
        const Eigen::MatrixXd s_jj = covariance(own, own);
        const Eigen::LLT<Eigen::MatrixXd> llt(s_ii);
        Conditional conditional;
        conditional.first = first;
        conditional.mean_rest = component.mean(rest);
        conditional.mean_own = component.mean(own);
        const Eigen::MatrixXd lower = llt.matrixL();
        conditional.inverse_rest = inverse_of(lower);
        conditional.regression = llt.solve(s_ji.transpose()).transpose();
        const Eigen::LLT<Eigen::MatrixXd> remaining(s_jj -
                                                    conditional.regression * s_ji.transpose());
        if (llt.info() != Eigen::Success || remaining.info() != Eigen::Success) continue;
        conditional.factor = remaining.matrixL();
        conditional.inverse_factor = inverse_of(conditional.factor);
        conditional.log_determinant = conditional.factor.diagonal().array().log().sum();
        conditional.log_weight = std::log(component.weight) - lower.diagonal().array().log().sum();
        conditionals_[static_cast<std::size_t>(m)].push_back(std::move(conditional));
      }
    }
  }
}

ConditionalProposal::ConditionalProposal(std::shared_ptr<const ConditionalMixtures> mixtures,
                                         const ModelSpace& space, int kind)
    : mixtures_(std::move(mixtures)),
      space_(&space),
      width_(static_cast<Eigen::Index>(
          space.kinds()[static_cast<std::size_t>(kind)].parameters.size())) {}

void ConditionalProposal::condition(const State& context, int kind, int skip, double) {
  used_ = 0;
  const int larger = skip >= 0 ? context.model : space_->neighbour(context.model, kind, +1);
  if (larger < 0) return;
  const auto& conditionals = mixtures_->of_model(larger);
  if (conditionals.empty()) return;
  const auto d = static_cast<Eigen::Index>(context.z.size());
  const Eigen::Index rest = skip >= 0 ? d - width_ : d;
  rest_.resize(rest);
  const Eigen::Index gap =
      skip >= 0 ? static_cast<Eigen::Index>(space_->component(context.model, kind, skip).first) : d;
  for (Eigen::Index i = 0; i < rest; ++i) {
    rest_[i] = context.z[static_cast<std::size_t>(i < gap ? i : i + width_)];
  }
  logs_.resize(conditionals.size());
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < conditionals.size(); ++s) {
    // |L_I⁻¹ (z_I - μ_I)|² row by row, because the matrices are small and lower triangular.
    double square = 0.0;
    for (Eigen::Index i = 0; i < rest; ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k <= i; ++k) {
        sum += conditionals[s].inverse_rest(i, k) * (rest_[k] - conditionals[s].mean_rest[k]);
      }
      square += sum * sum;
    }
    logs_[s] = conditionals[s].log_weight - 0.5 * square;
    top = std::max(top, logs_[s]);
  }
  double total = 0.0;
  for (double& value : logs_) total += value = std::exp(value - top);
  double kept = 0.0;
  for (std::size_t s = 0; s < conditionals.size(); ++s) {
    const double probability = logs_[s] / total;
    if (probability < kNegligible) continue;
    if (used_ == terms_.size()) terms_.emplace_back();
    Term& term = terms_[used_++];
    term.probability = probability;
    term.conditional = &conditionals[s];
    term.mean = conditionals[s].mean_own;
    term.mean.noalias() += conditionals[s].regression * (rest_ - conditionals[s].mean_rest);
    kept += probability;
  }
  for (std::size_t t = 0; t < used_; ++t) terms_[t].probability /= kept;
}

void ConditionalProposal::draw(base::Random& random, std::span<double> z) {
  if (used_ == 0 || random.uniform() < kDefensive) {
    for (double& value : z) value = random.normal();
    return;
  }
  double u = random.uniform();
  std::size_t t = 0;
  for (; t + 1 < used_; ++t) {
    u -= terms_[t].probability;
    if (u < 0.0) break;
  }
  scratch_.resize(width_);
  for (double& value : scratch_) value = random.normal();
  Eigen::Map<Eigen::VectorXd>(z.data(), width_) =
      terms_[t].mean + terms_[t].conditional->factor.triangularView<Eigen::Lower>() * scratch_;
}

double ConditionalProposal::log_density_ratio(std::span<const double> z) const {
  if (used_ == 0) return 0.0;
  const Eigen::Map<const Eigen::VectorXd> c(z.data(), width_);
  const double log_prior = -0.5 * c.squaredNorm() - kLogSqrtTwoPi * static_cast<double>(width_);
  double density = 0.0;
  for (std::size_t t = 0; t < used_; ++t) {
    const ConditionalMixtures::Conditional& conditional = *terms_[t].conditional;
    double square = 0.0;
    for (Eigen::Index i = 0; i < width_; ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k <= i; ++k)
        sum += conditional.inverse_factor(i, k) * (c[k] - terms_[t].mean[k]);
      square += sum * sum;
    }
    density +=
        terms_[t].probability * std::exp(-0.5 * square - conditional.log_determinant -
                                         kLogSqrtTwoPi * static_cast<double>(width_) - log_prior);
  }
  return std::log(kDefensive + (1.0 - kDefensive) * density);
}

}  // namespace wheeltap::inference
