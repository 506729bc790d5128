#include "inference/evidence/multiple_importance_sampling.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kDrawsPerJob = 250;      // draws per job
constexpr std::size_t kTogether = 32;  // likelihoods per batch: a few vectors full

void accumulate(double& sum, double term) {
  sum = log_sum_exp(sum, term);
}

}  // namespace

void MultipleImportanceSampler::add(const NormalMixture& proposal, int n) {
  const auto d = static_cast<std::size_t>(proposal.dimension());
  const std::size_t before = log_posterior_.size();
  const auto total = before + static_cast<std::size_t>(n);
  z_.resize(total * d);
  log_posterior_.resize(total);
  const int blocks = (n + kDrawsPerJob - 1) / kDrawsPerJob;
  std::vector<long> counted(static_cast<std::size_t>(blocks), 0);
  base::parallel_for(
      blocks, threads_,
      [&](int block) {
        ModelPosterior posterior(problem_, model_);
        base::Random random(seed_, static_cast<std::uint64_t>(block) | (std::uint64_t{1} << 61U),
                            static_cast<std::uint64_t>(model_) |
                                static_cast<std::uint64_t>(proposals_.size()) << 32U,
                            base::Purpose::evidence);
        const auto begin = before + static_cast<std::size_t>(block) * kDrawsPerJob;
        const auto end = std::min(begin + kDrawsPerJob, total);
        for (std::size_t i = begin; i < end; ++i) proposal.sample(random, {z_.data() + i * d, d});
        std::vector<ModelPosterior::Value> values(end - begin);
        for (std::size_t i = begin; i < end; i += kTogether) {
          const std::size_t n_here = std::min(kTogether, end - i);
          if (stop_ && stop_()) return;
          posterior.evaluate({z_.data() + i * d, n_here * d},
                             std::span(values).subspan(i - begin, n_here));
        }
        for (std::size_t i = begin; i < end; ++i)
          log_posterior_[i] = values[i - begin].log_posterior();
        counted[static_cast<std::size_t>(block)] = posterior.evaluations();
      },
      base::carriage([&](int block, auto& parcel) {
        const auto begin = before + static_cast<std::size_t>(block) * kDrawsPerJob;
        const auto size = std::min<std::size_t>(kDrawsPerJob, total - begin);
        parcel(std::span(z_).subspan(begin * d, size * d),
               std::span(log_posterior_).subspan(begin, size),
               counted[static_cast<std::size_t>(block)]);
      }));
  for (const long c : counted) evaluations_ += c;
  // Computes the density of the mixture of all proposals at the old and the new draws.
  log_proposals_.resize(total, -kInfinity);
  for (std::size_t i = 0; i < before; ++i)
    accumulate(log_proposals_[i], std::log(n) + proposal.log_density({z_.data() + i * d, d}));
  for (std::size_t i = before; i < total; ++i) {
    for (std::size_t r = 0; r < proposals_.size(); ++r)
      accumulate(log_proposals_[i],
                 std::log(sizes_[r]) + proposals_[r].log_density({z_.data() + i * d, d}));
    accumulate(log_proposals_[i], std::log(n) + proposal.log_density({z_.data() + i * d, d}));
  }
  proposals_.push_back(proposal);
  sizes_.push_back(n);
  weigh(total);
}

double MultipleImportanceSampler::efficiency() const {
  return effective_ / static_cast<double>(std::max<std::size_t>(1, weights_.size()));
}

std::span<const double> MultipleImportanceSampler::z(std::size_t i) const {
  const std::size_t d = z_.size() / log_posterior_.size();
  return {z_.data() + i * d, d};
}

Evidence MultipleImportanceSampler::evidence() const {
  Evidence e = kNoEvidence;
  e.likelihood_evaluations = evaluations_;
  if (!(effective_ > 1.0)) return e;
  e.log_evidence = log_mean_;
  const auto n = static_cast<double>(weights_.size());
  e.standard_error = std::sqrt(std::max(0.0, (n / effective_ - 1.0) / (n - 1.0)));
  return e;
}

double MultipleImportanceSampler::log_proposal(std::span<const double> z) const {
  double sum = -kInfinity;
  for (std::size_t r = 0; r < proposals_.size(); ++r)
    accumulate(sum, std::log(sizes_[r]) + proposals_[r].log_density(z));
  return sum - std::log(static_cast<double>(log_posterior_.size()));
}

Eigen::MatrixXd MultipleImportanceSampler::resampled(Eigen::Index n, base::Random& random) const {
  const std::size_t d = z_.size() / log_posterior_.size();
  Eigen::MatrixXd out(n, static_cast<Eigen::Index>(d));
  const double u = random.uniform();
  double cumulative = weights_.front();
  std::size_t from = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double pointer = (static_cast<double>(i) + u) / static_cast<double>(n);
    while (from + 1 < weights_.size() && cumulative <= pointer) cumulative += weights_[++from];
    out.row(i) = Eigen::Map<const Eigen::RowVectorXd>(z(from).data(), static_cast<Eigen::Index>(d));
  }
  return out;
}

void MultipleImportanceSampler::weigh(std::size_t total) {
  weights_.assign(total, 0.0);
  double top = -kInfinity;
  for (std::size_t i = 0; i < total; ++i) {
    // π / ((1/N) Σ n_r q_r), apart from the factor N
    weights_[i] =
        log_posterior_[i] == -kInfinity ? -kInfinity : log_posterior_[i] - log_proposals_[i];
    top = std::max(top, weights_[i]);
  }
  effective_ = 0.0;
  log_mean_ = -kInfinity;
  if (top == -kInfinity) {
    weights_.assign(total, 0.0);
    return;
  }
  double sum = 0.0, squares = 0.0;
  for (double& w : weights_) {
    w = std::exp(w - top);
    sum += w;
    squares += w * w;
  }
  for (double& w : weights_) w /= sum;
  effective_ = sum * sum / squares;
  // Σ π / Σ_r n_r q_r is the estimate of Z by the balance heuristic.
  log_mean_ = top + std::log(sum);
}

}  // namespace wheeltap::inference
