#include "inference/diagnosis/mixing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/constants.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

bool varies(const ChainsOf& draws) {
  double low = kInfinity, high = -kInfinity;
  for (const auto& chain : draws) {
    for (const double x : chain) low = std::min(low, x), high = std::max(high, x);
  }
  return low < high;
}

class Mixer {
 public:
  explicit Mixer(Mixing& out) : out_(out) {}

  void note(const std::string& quantity, double r, bool judged) {
    out_.rhats.emplace_back(quantity, r);
    if (!judged || (!out_.rhat_worst.empty() && r <= out_.rhat_max)) return;
    if (std::isnan(out_.rhat_max) && !out_.rhat_worst.empty()) return;
    out_.rhat_max = r;
    out_.rhat_worst = quantity;
  }

  void add(const std::string& quantity, const ChainsOf& draws, bool judged) {
    note(quantity, rhat(draws), judged);
    if (!varies(draws)) return;
    const double ess = ess_mean(draws);
    if (judged || ess > kLimits.ess) least_ = std::min(least_, ess);
    if (judged && !(ess > kLimits.ess)) out_.too_few = true;
  }

  [[nodiscard]] double least() const { return least_; }

 private:
  Mixing& out_;
  double least_ = kInfinity;  ///< effective sample size of a count or an indicator
};

}  // namespace

double Mixing::effective(std::size_t chains) const {
  return std::min(ess_log_posterior, ess_model) / static_cast<double>(chains);
}

Mixing mixing(const Posterior& posterior, const ModelShares& shares,
              const std::vector<Watched>& watched) {
  const ModelSpace& space = *posterior.space;
  Mixing out;
  Mixer mixer(out);
  const Convergence of =
      convergence(of_all_draws(posterior, [](const Draw& draw) { return draw.log_posterior(); }));
  out.ess_log_posterior = std::min(of.ess_bulk, of.ess_tail);
  mixer.note("log posterior", of.rhat, true);
  const auto known = [](double error) { return error <= kLimits.known; };
  if (!space.kinds().empty()) {
    for (std::size_t k = 0; k < space.kinds().size(); ++k) {
      std::map<int, double> errors;  // per count, the sum over its models
      for (int m = 0; m < space.size(); ++m) {
        errors[space[m].counts[k]] += shares.error[static_cast<std::size_t>(m)];
      }
      const double worst =
          std::ranges::max_element(errors, {}, [](const auto& e) { return e.second; })->second;
      mixer.add("number of " + space.kinds()[k].plural,
                of_all_draws(posterior,
                             [&](const Draw& draw) {
                               return static_cast<double>(draw.count(static_cast<int>(k)));
                             }),
                !known(worst));
    }
  } else if (space.size() > 1) {
    for (int m = 0; m < space.size(); ++m) {
      const auto at = static_cast<std::size_t>(m);
      if (shares.visits[at] < kLimits.known || shares.visits[at] > 1.0 - kLimits.known) continue;
      mixer.add("P(" + space[m].name + ")", posterior.indicator(m), !known(shares.error[at]));
    }
  }
  out.ess_model = std::isfinite(mixer.least()) ? mixer.least() : out.ess_log_posterior;
  for (const Watched& w : watched) mixer.note(w.name, rhat(w.draws()), true);
  return out;
}

}  // namespace wheeltap::inference
