#include "inference/diagnosis/standing.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kUsableError = 1.0;  // nats, of evidence by importance sampling

class Weigher {
 public:
  Weigher(const Posterior& posterior, const ModelShares& shares, const Mixing& mixing)
      : posterior_(posterior), space_(*posterior.space), shares_(shares), mixing_(mixing) {
    models_ = static_cast<std::size_t>(space_.size());
    chains_ = posterior.chains.size();
    out_.models.resize(models_);
  }

  Standings run() {
    count();
    choose_evidence();
    imply();
    out_.missed.resize(models_);
    for (std::size_t m = 0; m < models_; ++m) out_.missed[m] = missed(m);
    weigh();
    return std::move(out_);
  }

 private:
  [[nodiscard]] double prior(std::size_t m) const {
    return std::exp(space_[static_cast<int>(m)].log_prior);
  }

  void count() {
    bool without_likelihood = posterior_.likelihood_evaluations == 0;
    for (const Chain& chain : posterior_.chains) {
      for (const double l : chain.log_likelihood) {
        without_likelihood = without_likelihood && l == 0.0;
      }
    }
    prior_only_ = without_likelihood && posterior_.found.empty();
    for (std::size_t m = 0; m < models_; ++m) {
      ModelStanding& s = out_.models[m];
      for (const auto& counts : shares_.counts) s.visited += counts[m] > 0 ? 1 : 0;
      s.passed_over =
          s.visited == 0 && m < posterior_.found.size() && posterior_.found[m].passed_over;
    }
    for (std::size_t a = 0; a < std::min(models_, posterior_.jumps_proposed.size()); ++a) {
      for (std::size_t b = 0; b < models_; ++b) {
        if (a == b) continue;
        out_.models[b].proposed += posterior_.jumps_proposed[a][b];
        out_.models[b].entered += posterior_.jumps_accepted[a][b];
        out_.models[a].left += posterior_.jumps_accepted[a][b];
      }
    }
  }

  // Excess of the share of SMC draws outside the mixture over that of the chains' draws. The
  // probability and evidence of the model may be larger by this share.
  [[nodiscard]] double unseen(std::size_t m) const {
    return m < posterior_.found.size() ? annealed_excess(posterior_.found[m]) : 0.0;
  }
  // Effect of this excess on the model's share of all draws.
  [[nodiscard]] double unseen_share(std::size_t m) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < models_; ++k)
      sum += std::pow(((k == m ? 1.0 : 0.0) - shares_.share[k]) * unseen(k), 2.0);
    return shares_.share[m] * std::sqrt(sum);
  }

  void choose_evidence() {
    for (std::size_t m = 0; m < models_; ++m) {
      Evidence best{.log_evidence = kNaN, .standard_error = kNaN};
      bool of_draws = false;
      if (prior_only_) {
        best = {.log_evidence = 0.0, .standard_error = 0.0};
        of_draws = true;
      } else if (m < posterior_.found.size()) {
        const ModelFindings& found = posterior_.found[m];
        if (found.impossible) {
          best = found.sampled;
        } else if (std::isfinite(found.bridged.log_evidence)) {
          best = found.bridged;
          of_draws = true;
        } else if (std::isfinite(found.sampled.log_evidence) &&
                   found.sampled.standard_error < kUsableError) {
          best = found.sampled;
          of_draws = true;
        } else if (std::isfinite(found.annealed.log_evidence)) {
          best = found.annealed;
        }
      }
      if (of_draws) best.standard_error = std::hypot(best.standard_error, unseen(m));
      out_.models[m].log_evidence = best.log_evidence;
      out_.models[m].log_evidence_se = best.standard_error;
      out_.evidence.push_back(std::move(best));
      out_.evidence_of_draws.push_back(of_draws);
    }
  }

  // Computes the probabilities from the evidences. A visited model without evidence gets the share
  // of its draws relative to the models with evidence.
  void imply() {
    evidences_ = out_.evidence;
    // With a heavy tail, the scatter of the weights is smaller than the error, because a longer
    // sample would give larger weights.
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const ModelFindings& found = posterior_.found[m];
      if (!std::isfinite(found.bridged.log_evidence) && found.pareto.shape > kHeavyTail)
        evidences_[m].standard_error =
            std::hypot(evidences_[m].standard_error, found.pareto.log_excess);
    }
    double known_share = 0.0, known_mass = 0.0, top = -kInfinity;
    for (std::size_t m = 0; m < models_; ++m) {
      if (shares_.visits[m] > 0.0 && std::isfinite(evidences_[m].log_evidence)) {
        top = std::max(top, evidences_[m].log_evidence);
      }
    }
    for (std::size_t m = 0; m < models_; ++m) {
      if (shares_.visits[m] == 0.0 || !std::isfinite(evidences_[m].log_evidence)) continue;
      known_share += shares_.share[m];
      known_mass += prior(m) * std::exp(evidences_[m].log_evidence - top);
    }
    comparable_ = known_share > 0.0 && known_mass > 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (std::isfinite(evidences_[m].log_evidence) && comparable_) continue;
      const bool drawn = shares_.visits[m] > 0.0;
      const double scale = comparable_ ? known_mass / known_share : 1.0;
      evidences_[m] = {.log_evidence = drawn ? (comparable_ ? top : 0.0) +
                                                   std::log(shares_.share[m] * scale / prior(m))
                                             : -kInfinity,
                       .standard_error = drawn ? shares_.error[m] / shares_.share[m] : 0.0};
    }
    out_.implied = implied_probabilities(space_, evidences_);
    // Expected shares of draws before normalisation; they are larger for models with small weights.
    for (std::size_t k = 0; k < models_; ++k) drawn_ += out_.implied.mean[k] / shares_.weight[k];
  }

  // True if some chain did not visit the model, although every chain should have visited it.
  [[nodiscard]] bool missed(std::size_t m) const {
    const auto visited = static_cast<std::size_t>(out_.models[m].visited);
    if (visited == chains_) return false;
    const double expected = out_.implied.mean[m] / shares_.weight[m] / drawn_;
    if (visited == 0) return expected * mixing_.effective(chains_) > kLimits.expected_visits;
    const double looks = mixing_.ess_log_posterior / static_cast<double>(chains_);
    if (!(expected * looks > kLimits.expected_visits)) return false;
    // A few long visits are few effective visits. Chains with visits show their effective number.
    double own = 0.0;
    for (std::size_t c = 0; c < chains_; ++c) {
      if (shares_.counts[c][m] == 0) continue;
      std::vector<double> indicator;
      for (const int at : posterior_.chains[c].model) {
        indicator.push_back(at == static_cast<int>(m) ? 1.0 : 0.0);
      }
      own += ess_mean({std::move(indicator)}) / static_cast<double>(visited);
    }
    return expected * std::min(looks, own) > kLimits.expected_visits;
  }

  // Change of the share of the model due to one effective visit more or less of any model.
  [[nodiscard]] double least_error(std::size_t m) const {
    const double one = 1.0 / (mixing_.ess_model + 2.0);
    if (posterior_.log_weight.empty()) return one;
    double most = 0.0;
    for (std::size_t k = 0; k < models_; ++k) {
      if (shares_.visits[k] == 0.0) continue;
      most =
          std::max(most, shares_.weight[k] * (k == m ? 1.0 - shares_.share[m] : shares_.share[m]));
    }
    return one * most;
  }

  void weigh() {
    double by_evidence = 0.0, variance = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      ModelStanding& s = out_.models[m];
      const bool known = comparable_ && std::isfinite(s.log_evidence);
      const bool speaks = s.visited > 0 && !(known && out_.missed[m]);
      s.basis = speaks || !known ? Basis::draws : Basis::evidence;
      const bool impossible = m < posterior_.found.size() && posterior_.found[m].impossible;
      if ((prior(m) == 0.0 || impossible) && s.visited == 0) s.basis = Basis::evidence;
      if (s.basis == Basis::evidence) by_evidence += out_.implied.mean[m];
    }
    for (std::size_t n = 0; n < models_; ++n) {
      const bool inside = out_.models[n].basis == Basis::evidence;
      const double slope = out_.implied.mean[n] * ((inside ? 1.0 : 0.0) - by_evidence);
      if (slope != 0.0) variance += std::pow(slope * evidences_[n].standard_error, 2.0);
    }
    double drawn = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (out_.models[m].basis == Basis::draws) drawn += shares_.share[m];
    }
    for (std::size_t m = 0; m < models_; ++m) {
      ModelStanding& s = out_.models[m];
      if (s.basis == Basis::evidence) {
        s.probability = out_.implied.mean[m];
        s.mcse = out_.implied.standard_error[m];
      } else if (s.visited > 0) {
        const double share = shares_.share[m] / drawn;
        s.probability = share * (1.0 - by_evidence);
        const double error =
            std::hypot(std::max(shares_.error[m] / drawn, least_error(m)), unseen_share(m) / drawn);
        s.mcse = std::hypot((1.0 - by_evidence) * error, share * std::sqrt(variance));
      }
    }
  }

  const Posterior& posterior_;
  const ModelSpace& space_;
  const ModelShares& shares_;
  const Mixing& mixing_;
  Standings out_;
  std::size_t models_ = 0, chains_ = 0;
  bool prior_only_ = false;
  bool comparable_ = false;          ///< true if some model has both draws and evidence
  std::vector<Evidence> evidences_;  ///< also for models without evidence, from draws
  double drawn_ = 0.0;
};

}  // namespace

Standings standings(const Posterior& posterior, const ModelShares& shares, const Mixing& mixing) {
  return Weigher(posterior, shares, mixing).run();
}

Estimate log_bayes_factor(const Posterior& posterior, int a, int b) {
  const ModelSpace& space = *posterior.space;
  const ModelShares shares = model_shares(posterior);
  const Mixing mixed = mixing(posterior, shares, {});
  const Standings all = standings(posterior, shares, mixed);
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  const ModelStanding &one = all.models[i], &other = all.models[j];
  if (a == b) return {.value = 0.0, .mcse = 0.0};
  if (one.basis == Basis::evidence || other.basis == Basis::evidence) {
    // The evidences give the ratio even if the probabilities underflow.
    return {.value = one.log_evidence - other.log_evidence,
            .mcse = std::hypot(one.log_evidence_se, other.log_evidence_se)};
  }
  if (shares.share[i] == 0.0 || shares.share[j] == 0.0) return {};
  const double error = mcse_mean(of_all_draws(posterior, [&](const Draw& draw) {
    return draw.model == a   ? 1.0 / shares.visits[i]
           : draw.model == b ? -1.0 / shares.visits[j]
                             : 0.0;
  }));
  const double rarer = std::min(shares.visits[i], shares.visits[j]);
  return {.value = std::log(shares.share[i]) - std::log(shares.share[j]) -
                   (space[a].log_prior - space[b].log_prior),
          .mcse = std::max(error, 1.0 / ((mixed.ess_model + 2.0) * rarer))};
}

}  // namespace wheeltap::inference
