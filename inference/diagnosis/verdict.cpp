#include "inference/diagnosis/verdict.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <functional>
#include <numeric>

#include "inference/diagnosis/convergence.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

// Probability that sequences of the same distribution have a larger ratio of the variance of
// their means to the mean variance within a sequence. Each sequence is equivalent to
// `effective` independent draws. The ratio then has a χ² distribution with sequences - 1
// degrees of freedom.
double chance(double between_to_within, double effective, std::size_t sequences) {
  const auto freedom = static_cast<double>(sequences - 1);
  const double chi2 = freedom * between_to_within * effective;
  return std::isnan(chi2) ? 0.0 : boost::math::gamma_q(0.5 * freedom, 0.5 * std::max(chi2, 0.0));
}

class Judge {
 public:
  Judge(const Posterior& posterior, const std::vector<Watched>& watched)
      : posterior_(posterior),
        space_(*posterior.space),
        models_(static_cast<std::size_t>(space_.size())),
        chains_(posterior.chains.size()),
        shares_(model_shares(posterior)),
        mixing_(mixing(posterior, shares_, watched)),
        standings_(standings(posterior, shares_, mixing_)),
        effective_(mixing_.effective(chains_)) {
    out_.models = standings_.models;
    out_.rhats = mixing_.rhats;
    out_.rhat_max = mixing_.rhat_max;
    out_.rhat_worst = mixing_.rhat_worst;
    out_.ess_model = mixing_.ess_model;
    out_.ess_log_posterior = mixing_.ess_log_posterior;
  }

  Verdict verdict() {
    if (posterior_.quick) add(QuickLook{});
    judge_models();
    judge_modes();
    judge_evidence();
    if (!posterior_.quick) {
      judge_mixtures();
      judge_chains();
      judge_parameters();
    }
    if (posterior_.tempered_draws && posterior_.ladder_round_trips < kLimits.round_trips) {
      add(TooFewRoundTrips{.completed = posterior_.ladder_round_trips,
                           .limit = kLimits.round_trips});
    }
    if (posterior_.stopped_early) add(StoppedEarly{});
    resolve();
    out_.converged = out_.not_established.empty();
    return std::move(out_);
  }

 private:
  void add(Reason reason) { out_.not_established.push_back(std::move(reason)); }
  [[nodiscard]] double prior(std::size_t m) const {
    return std::exp(space_[static_cast<int>(m)].log_prior);
  }
  [[nodiscard]] const ModelStanding& standing(std::size_t m) const { return out_.models[m]; }
  [[nodiscard]] Estimate implied(std::size_t m) const {
    return {.value = standings_.implied.mean[m], .mcse = standings_.implied.standard_error[m]};
  }

  // ---- models --------------------------------------------------------------------------------

  void judge_models() {
    std::vector<std::size_t> order(models_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t m) { return standings_.implied.mean[m]; });
    std::vector<Reason> absent, partial, unknown;
    for (const std::size_t at : order) {
      const ModelStanding& s = standing(at);
      const int m = static_cast<int>(at);
      if (s.passed_over) {
        ++out_.passed_over;
      } else if (s.visited == 0 && prior(at) > 0.0 && std::isnan(s.mcse) &&
                 s.basis == Basis::draws) {
        unknown.emplace_back(ModelUnknown{.model = m, .proposed = s.proposed});
      } else if (standings_.missed[at] && s.visited == 0) {
        absent.emplace_back(
            ModelNotEntered{.model = m, .proposed = s.proposed, .by_evidence = implied(at)});
      } else if (standings_.missed[at]) {
        partial.emplace_back(ModelNotInEveryChain{
            .model = m,
            .visited = s.visited,
            .chains = static_cast<int>(chains_),
            .by_evidence = std::isfinite(s.log_evidence) ? implied(at) : Estimate{}});
      }
    }
    for (const auto* list : {&absent, &partial, &unknown}) {
      for (const Reason& reason : *list) add(reason);
    }
  }

  // ---- modes ---------------------------------------------------------------------------------

  void judge_modes() {
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const ModelFindings& found = posterior_.found[m];
      if (found.left_out_share > kLimits.judged_mode &&
          standing(m).probability > kLimits.judged_model)
        add(ModesLeftOut{
            .model = static_cast<int>(m), .modes = found.left_out, .share = found.left_out_share});
      const auto& modes = posterior_.found[m].modes;
      if (modes.size() < 2 || standing(m).visited == 0) continue;
      // Effective draws of this model in each chain, at most the number of its draws.
      std::vector<double> effective;
      for (std::size_t c = 0; c < chains_; ++c) {
        const auto n = static_cast<double>(shares_.counts[c][m]);
        const auto length = static_cast<double>(posterior_.chains[c].size());
        effective.push_back(n * std::min(1.0, effective_ / length));
      }
      for (const FoundMode& mode : modes) judge_mode(m, mode, effective);
    }
  }

  void judge_mode(std::size_t m, const FoundMode& mode, const std::vector<double>& effective) {
    std::vector<double> drawn;
    std::size_t missing = 0;
    double mean = 0.0, within = 0.0;
    for (std::size_t c = 0; c < mode.drawn.size() && c < effective.size(); ++c) {
      if (!std::isfinite(mode.drawn[c])) continue;
      if (mode.drawn[c] == 0.0 && mode.share * effective[c] > kLimits.expected_visits) ++missing;
      if (!(effective[c] > 0.0)) continue;
      drawn.push_back(mode.drawn[c]);
      mean += mode.drawn[c];
      within += effective[c];
    }
    if (missing > 0) {
      const auto chains = static_cast<int>(mode.drawn.size());
      add(ModeNotInEveryChain{.model = static_cast<int>(m),
                              .share = mode.share,
                              .visited = chains - static_cast<int>(missing),
                              .chains = chains});
      return;
    }
    if (drawn.size() < 2) return;
    const auto n = static_cast<double>(drawn.size());
    mean /= n;
    within /= n;
    const double rarer = std::min(mean, 1.0 - mean);
    if (rarer < kLimits.judged_mode || rarer * within < kLimits.expected_visits) return;
    double between = 0.0;
    for (const double d : drawn) between += (d - mean) * (d - mean) / (n - 1.0);
    const double ratio = between / (mean * (1.0 - mean));
    const double r = std::sqrt(1.0 + ratio);
    if (r < kLimits.rhat_apart || chance(ratio, within, drawn.size()) > kLimits.chance) return;
    const auto [low, high] = std::ranges::minmax(drawn);
    add(ModeSharesDisagree{.model = static_cast<int>(m),
                           .lowest = low,
                           .highest = high,
                           .rhat = r,
                           .limit = kLimits.rhat_apart});
  }

  // ---- evidence ------------------------------------------------------------------------------

  void judge_evidence() {
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const Evidence& annealed = posterior_.found[m].annealed;
      if (standing(m).visited == 0 || !standings_.evidence_of_draws[m]) continue;
      const Evidence& drawn = standings_.evidence[m];
      const double excess = annealed.log_evidence - drawn.log_evidence;
      const double error = std::hypot(annealed.standard_error, drawn.standard_error);
      // The evidence is not judged if both estimates give the model a negligible probability.
      const bool matters =
          implied(m).value * std::exp(std::min(excess, 700.0)) > kLimits.slack_probability;
      if (!matters || !(excess > kLimits.sigmas * error + kLimits.slack_nats)) continue;
      add(AnnealingFindsMore{
          .model = static_cast<int>(m),
          .annealed = {.value = annealed.log_evidence, .mcse = annealed.standard_error},
          .drawn = {.value = drawn.log_evidence, .mcse = drawn.standard_error}});
    }
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const ModelFindings& found = posterior_.found[m];
      // With enough draws of a probable model, judge_mixtures judges regions outside its mixture.
      const bool drawn = std::isfinite(found.bridged.log_evidence) &&
                         standing(m).probability > kLimits.judged_model;
      const double factor = std::exp(found.pareto.log_excess);
      if (!(found.pareto.shape > kHeavyTail) || drawn || models_ == 1 ||
          !(implied(m).value * (factor - 1.0) > kLimits.slack_probability))
        continue;
      add(EvidenceUnreliable{.model = static_cast<int>(m),
                             .pareto = found.pareto.shape,
                             .limit = kHeavyTail,
                             .by_evidence = implied(m),
                             .factor = factor});
    }
    for (std::size_t m = 0; m < models_; ++m) {
      const ModelStanding& s = standing(m);
      if (s.basis != Basis::draws || s.visited == 0 || !standings_.evidence_of_draws[m]) continue;
      const Estimate by_evidence = implied(m);
      const double error = std::hypot(s.mcse, by_evidence.mcse);
      if (!(std::abs(s.probability - by_evidence.value) >
            kLimits.sigmas * error + kLimits.slack_probability)) {
        continue;
      }
      add(EvidenceDisagrees{.model = static_cast<int>(m),
                            .by_draws = {.value = s.probability, .mcse = s.mcse},
                            .by_evidence = by_evidence});
    }
  }

  // ---- mixtures ------------------------------------------------------------------------------

  void judge_mixtures() {
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const ModelFindings& found = posterior_.found[m];
      if (standing(m).probability < kLimits.judged_model || standing(m).visited == 0) continue;
      const double share = found.beyond_mixture;
      const double visits = share * found.beyond_mixture_ess;
      if (lacks_annealed(found)) {
        add(AnnealingDrawsBeyond{
            .model = static_cast<int>(m), .annealed = found.annealed_beyond, .drawn = share});
      }
      if (!(share > kLimits.beyond_share) || visits > kLimits.beyond_visits) continue;
      add(DrawsBeyondMixture{.model = static_cast<int>(m),
                             .share = share,
                             .visits = visits,
                             .limit = kLimits.beyond_visits});
    }
  }

  // ---- chains --------------------------------------------------------------------------------

  void judge_chains() {
    if (!(mixing_.rhat_max < kLimits.rhat)) {
      add(ChainsDisagree{
          .quantity = mixing_.rhat_worst, .rhat = mixing_.rhat_max, .limit = kLimits.rhat});
    }
    if (!(mixing_.ess_log_posterior > kLimits.ess)) {
      add(TooFewEffectiveDraws{
          .quantity = "log posterior", .ess = mixing_.ess_log_posterior, .limit = kLimits.ess});
    }
    if (mixing_.too_few) {
      add(TooFewEffectiveDraws{.quantity = space_.kinds().empty() ? "model" : "count",
                               .ess = mixing_.ess_model,
                               .limit = kLimits.ess});
    }
  }

  // ---- parameters ----------------------------------------------------------------------------

  // value(draw) of all draws of a model. The chains are thinned to the same length; the result is
  // empty if a chain has too few draws.
  template <class Value>
  [[nodiscard]] ChainsOf within(std::size_t m, const Value& value) const {
    std::size_t n = std::numeric_limits<std::size_t>::max();
    ChainsOf chains;
    for (const Chain& chain : posterior_.chains) {
      std::vector<double> values;
      for (std::size_t i = 0; i < chain.size(); ++i) {
        if (chain.model[i] == static_cast<int>(m)) values.push_back(value(chain.draw(i, space_)));
      }
      chain.let_go();
      if (values.size() < kLimits.fewest_draws) return {};
      n = std::min(n, values.size());
      chains.push_back(std::move(values));
    }
    for (auto& values : chains) {
      const std::size_t all = values.size();
      for (std::size_t i = 0; i < n; ++i) values[i] = values[i * all / n];
      values.resize(n);
    }
    return chains;
  }

  // Reports the first parameter of each model that does not meet the limits.
  void judge_parameters() {
    for (std::size_t at = 0; at < models_; ++at) {
      if (standing(at).probability < kLimits.judged_model || standing(at).visited == 0) continue;
      const int m = static_cast<int>(at);
      const Model& model = space_[m];
      bool named = false;
      for (std::size_t i = 0; i < model.parameters.size(); ++i) {
        judge_parameter(at, space_.parameter_name(m, static_cast<int>(i)), named,
                        [i](const Draw& draw) { return draw.theta[i]; });
      }
      for (std::size_t k = 0; k < model.counts.size(); ++k) {
        const auto& parameters = space_.kinds()[k].parameters;
        const int kind = static_cast<int>(k), count = model.counts[k];
        for (std::size_t i = 0; count > 0 && i < parameters.size(); ++i) {
          std::string what = (count > 1 ? "sum of " : "") + parameters[i].name;
          if (model.counts.size() > 1) what = space_.kinds()[k].name + " " + what;
          judge_parameter(at, what, named, [=](const Draw& draw) {
            double total = 0.0;
            for (int c = 0; c < count; ++c) total += draw.component(kind, c)[i];
            return total;
          });
        }
      }
    }
  }

  template <class Value>
  void judge_parameter(std::size_t m, const std::string& what, bool& named, const Value& value) {
    const ChainsOf draws = within(m, value);
    if (draws.empty()) return;
    const int model = static_cast<int>(m);
    const Convergence found = convergence(draws);
    const double r = found.rhat;
    out_.rhats.emplace_back(space_[model].name + "/" + what, r);
    if (named) return;
    const double needed =
        std::clamp(2.0 * kLimits.ess * standing(m).probability, kLimits.ess_within, kLimits.ess);
    const double ess = found.ess_bulk;
    if (!(r < kLimits.rhat)) {
      double effective = 0.0;  // effective draws of half a chain, for the comparison of chains
      for (const auto& chain : draws) effective += ess_bulk({chain});
      const std::size_t halves = 2 * draws.size();
      effective /= static_cast<double>(halves);
      const double ratio = r * r - 1.0 + 2.0 / static_cast<double>(draws[0].size());
      if (chance(ratio, effective, halves) < kLimits.chance) {
        add(ParameterDisagrees{
            .model = model, .parameter = what, .rhat = r, .limit = kLimits.rhat});
        named = true;
        return;
      }
    }
    // For few draws in few visits, the estimated effective sample size has too large an error.
    const bool enough = standing(m).probability > kLimits.probable_model ||
                        draws[0].size() >= kLimits.fewest_for_ess;
    if (enough && !(ess > needed)) {
      add(ParameterMovesSlowly{.model = model, .parameter = what, .ess = ess, .limit = needed});
      named = true;
    } else if (enough && !(found.ess_tail > kLimits.ess_tail_share * needed)) {
      add(ParameterMovesSlowly{.model = model,
                               .parameter = what,
                               .ess = found.ess_tail,
                               .limit = kLimits.ess_tail_share * needed,
                               .tail = true});
      named = true;
    }
  }

  // ---- resolution ----------------------------------------------------------------------------

  // Computes p from (1 - p)^n = 0.01: n climbs miss a basin of share p with probability 0.01.
  void resolve() {
    double resolution = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (space_[static_cast<int>(m)].dimension == 0 || prior(m) == 0.0) continue;
      const long climbs = m < posterior_.found.size() ? posterior_.found[m].climbs : 0;
      if (m < posterior_.found.size() && posterior_.found[m].glanced &&
          standing(m).probability < kLimits.searched_model) {
        ++out_.glanced;
        continue;
      }
      if (climbs == 0 && standing(m).probability < kLimits.judged_model) continue;
      if (m < posterior_.found.size())
        out_.resolved_width = std::max(out_.resolved_width, posterior_.found[m].spacing);
      resolution = std::max(
          resolution, climbs > 0 ? 1.0 - std::pow(0.01, 1.0 / static_cast<double>(climbs)) : 1.0);
    }
    out_.resolution = posterior_.found.empty() ? 1.0 : resolution;
  }

  const Posterior& posterior_;
  const ModelSpace& space_;
  std::size_t models_, chains_;
  ModelShares shares_;
  Mixing mixing_;
  Standings standings_;
  double effective_;  ///< effective draws per chain
  Verdict out_;
};

}  // namespace

Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched) {
  return Judge(posterior, watched).verdict();
}

}  // namespace wheeltap::inference
