#include "inference/verdict.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>

#include "inference/evidence/comparison.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr double kMaxRhat = 1.01;
constexpr double kMinEss = 400.0;
constexpr double kMinEssWithin = 20.0;    // of a model at the lower end of those judged
constexpr double kKnown = 0.001;          // an error of a probability that nobody cares about
constexpr double kExpectedVisits = 10.0;  // effective ones, from which none is no chance
constexpr double kSigmas = 4.5;
constexpr double kChance = 1e-6;  // of a scatter between chains that is called disagreement
constexpr double kSlackProbability = 0.005;
constexpr double kSlackNats = 0.5;
constexpr double kUsableError = 1.0;  // nats, of evidence by importance sampling
constexpr double kProbableModel = 0.05;
constexpr double kJudgedModel = 0.01;
constexpr double kJudgedMode = 0.01;
constexpr double kMaxRhatOfMode = 1.05;
constexpr std::size_t kFewestDraws = 100;  // of a chain within a model, to be judged
constexpr std::size_t kFewestForEss = 400;
constexpr long kFewestRoundTrips = 10;
constexpr std::size_t kNamed = 4;  // of many models alike

const char* const kRunLonger = " Run longer (--warmup, --draws).";
const char* const kSearchMore = " Search more (--search), or run longer (--warmup, --draws).";

std::string number(double x, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

std::string plus_minus(double x, double error) {
  return number(x, 3) + (std::isfinite(error) ? " ± " + number(error, 1) : "");
}

std::string fixed_plus_minus(double x, double error) {
  char text[80];
  std::snprintf(text, sizeof text, "%.2f ± %.2f", x, error);
  return text;
}

// "123 456"
std::string grouped(long n) {
  std::string text = std::to_string(n);
  for (auto at = static_cast<long>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), " ");
  }
  return text;
}

std::string percent(double share) {
  return number(100.0 * share, 2) + " %";
}

// Chance of chains that sample the same scattering by more than this: `between` over `within` are
// the variance of the sequences' means and the mean variance within them, each sequence worth
// `effective` independent draws. Their ratio is then χ² of one less than their number.
double chance(double between_to_within, double effective, std::size_t sequences) {
  const auto freedom = static_cast<double>(sequences - 1);
  const double chi2 = freedom * between_to_within * effective;
  return std::isnan(chi2) ? 0.0 : boost::math::gamma_q(0.5 * freedom, 0.5 * std::max(chi2, 0.0));
}

class Judge {
 public:
  Judge(const Posterior& posterior, const std::vector<Watched>& watched)
      : posterior_(posterior), space_(*posterior.space), watched_(watched) {
    models_ = static_cast<std::size_t>(space_.size());
    chains_ = posterior.chains.size();
    tally();
  }

  Verdict verdict() {
    judge_chains();
    weigh();
    say_models();
    say_modes();
    say_evidence();
    say_chains();
    say_parameters();
    if (posterior_.tempered_draws && posterior_.ladder_round_trips < kFewestRoundTrips) {
      say("The draws were tempered, but completed only " +
          std::to_string(posterior_.ladder_round_trips) +
          " round trips between prior and posterior (" + std::to_string(kFewestRoundTrips) +
          " are needed)." + kRunLonger);
    }
    if (posterior_.stopped_early) {
      say("The run was stopped early. Run it to its end.");
    }
    resolve();
    out_.converged = out_.not_established.empty();
    return std::move(out_);
  }

 private:
  void say(std::string sentence) { out_.not_established.push_back(std::move(sentence)); }
  [[nodiscard]] const std::string& name(std::size_t m) const {
    return space_[static_cast<int>(m)].name;
  }
  [[nodiscard]] double prior(std::size_t m) const {
    return std::exp(space_[static_cast<int>(m)].log_prior);
  }
  [[nodiscard]] ModelStanding& standing(std::size_t m) { return out_.models[m]; }

  template <class Value>
  [[nodiscard]] ChainsOf all_draws(const Value& value) const {
    ChainsOf out(chains_);
    for (std::size_t c = 0; c < chains_; ++c) {
      const Chain& chain = posterior_.chains[c];
      out[c].resize(chain.model.size());
      for (std::size_t i = 0; i < out[c].size(); ++i) out[c][i] = value(chain, i);
    }
    return out;
  }

  // ---- what was counted ----------------------------------------------------------------------

  void tally() {
    out_.models.resize(models_);
    counts_.assign(chains_, std::vector<long>(models_));
    long all = 0;
    bool without_likelihood = posterior_.likelihood_evaluations == 0;
    for (std::size_t c = 0; c < chains_; ++c) {
      for (const int m : posterior_.chains[c].model) ++counts_[c][static_cast<std::size_t>(m)];
      all += static_cast<long>(posterior_.chains[c].model.size());
      for (const double l : posterior_.chains[c].log_likelihood) {
        without_likelihood = without_likelihood && l == 0.0;
      }
    }
    prior_only_ = without_likelihood && posterior_.found.empty();
    visits_.assign(models_, 0.0);
    weight_.assign(models_, 1.0);
    if (!posterior_.log_weight.empty()) {
      const double top = std::ranges::max(posterior_.log_weight);
      for (std::size_t m = 0; m < models_; ++m) {
        weight_[m] = std::max(std::exp(posterior_.log_weight[m] - top), 1e-300);
      }
    }
    double total = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      for (std::size_t c = 0; c < chains_; ++c) {
        visits_[m] += static_cast<double>(counts_[c][m]) / static_cast<double>(std::max(all, 1L));
        standing(m).visited += counts_[c][m] > 0 ? 1 : 0;
      }
      total += visits_[m] * weight_[m];
    }
    for (double& w : weight_) w /= total > 0.0 ? total : 1.0;
    share_.resize(models_);
    for (std::size_t m = 0; m < models_; ++m) share_[m] = visits_[m] * weight_[m];
    for (std::size_t a = 0; a < std::min(models_, posterior_.jumps_proposed.size()); ++a) {
      for (std::size_t b = 0; b < models_; ++b) {
        if (a == b) continue;
        standing(b).proposed += posterior_.jumps_proposed[a][b];
        standing(b).entered += posterior_.jumps_accepted[a][b];
        standing(a).left += posterior_.jumps_accepted[a][b];
      }
    }
  }

  // Error of P_m = w_m s_m / Σ w_k s_k by the delta method: the mean of w (indicator - P) / Σ w s.
  [[nodiscard]] double error_of_share(std::size_t m) const {
    return mcse_mean(all_draws([&](const Chain& chain, std::size_t i) {
      const auto at = static_cast<std::size_t>(chain.model[i]);
      return weight_[at] * ((at == m ? 1.0 : 0.0) - share_[m]);
    }));
  }
  // What one more or less effective visit of any model would change.
  [[nodiscard]] double least_error(std::size_t m) const {
    const double one = 1.0 / (out_.ess_model + 2.0);
    if (posterior_.log_weight.empty()) return one;
    double most = 0.0;
    for (std::size_t k = 0; k < models_; ++k) {
      if (visits_[k] == 0.0) continue;
      most = std::max(most, weight_[k] * (k == m ? 1.0 - share_[m] : share_[m]));
    }
    return one * most;
  }

  // ---- chains --------------------------------------------------------------------------------

  void judge_chains() {
    const Convergence of = convergence(all_draws([](const Chain& chain, std::size_t i) {
      return chain.log_prior[i] + chain.log_likelihood[i];
    }));
    out_.ess_log_posterior = std::min(of.ess_bulk, of.ess_tail);
    note_rhat("log posterior", of.rhat, true);
    error_.assign(models_, 0.0);
    for (std::size_t m = 0; m < models_; ++m) {
      if (visits_[m] > 0.0) error_[m] = error_of_share(m);
    }
    // A count whose probabilities are known to 0.001 is known, however few its excursions.
    const auto known = [&](double error) { return error <= kKnown; };
    double least = kInfinity;
    const auto mixed = [&](const std::string& what, const ChainsOf& draws, bool judged) {
      const auto [low, high] = range(draws);
      const double r = rhat(draws);
      note_rhat(what, r, judged);
      if (!(low < high)) return;
      const double ess = ess_mean(draws);
      if (judged || ess > kMinEss) least = std::min(least, ess);
      if (judged && !(ess > kMinEss)) few_ = true;
    };
    if (!space_.kinds().empty()) {
      for (std::size_t k = 0; k < space_.kinds().size(); ++k) {
        std::map<int, double> errors;  // of each count, those of its models added
        for (std::size_t m = 0; m < models_; ++m) {
          errors[space_[static_cast<int>(m)].counts[k]] += error_[m];
        }
        const double worst =
            std::ranges::max_element(errors, {}, [](const auto& e) { return e.second; })->second;
        mixed("number of " + space_.kinds()[k].plural,
              all_draws([&](const Chain& chain, std::size_t i) {
                return static_cast<double>(space_[chain.model[i]].counts[k]);
              }),
              !known(worst));
      }
    } else if (models_ > 1) {
      for (std::size_t m = 0; m < models_; ++m) {
        if (visits_[m] < kKnown || visits_[m] > 1.0 - kKnown) continue;
        mixed("P(" + name(m) + ")", all_draws([&](const Chain& chain, std::size_t i) {
                return chain.model[i] == static_cast<int>(m) ? 1.0 : 0.0;
              }),
              !known(error_[m]));
      }
    }
    out_.ess_model = std::isfinite(least) ? least : out_.ess_log_posterior;
    for (const Watched& w : watched_) note_rhat(w.name, rhat(w.draws), true);
    effective_ = std::min(out_.ess_log_posterior, out_.ess_model) / static_cast<double>(chains_);
  }

  static std::pair<double, double> range(const ChainsOf& draws) {
    double low = kInfinity, high = -kInfinity;
    for (const auto& chain : draws) {
      for (const double x : chain) low = std::min(low, x), high = std::max(high, x);
    }
    return {low, high};
  }

  void note_rhat(const std::string& what, double r, bool judged) {
    out_.rhats.emplace_back(what, r);
    if (!judged || (!out_.rhat_worst.empty() && r <= out_.rhat_max)) return;
    if (std::isnan(out_.rhat_max) && !out_.rhat_worst.empty()) return;
    out_.rhat_max = r;
    out_.rhat_worst = what;
  }

  void say_chains() {
    std::string why;
    const auto add = [&](const std::string& reason) { why += (why.empty() ? "" : ", ") + reason; };
    if (!(out_.rhat_max < kMaxRhat)) {
      add("R-hat of " + out_.rhat_worst + " is " + number(out_.rhat_max, 4) +
          " (must be below 1.01)");
    }
    if (!(out_.ess_log_posterior > kMinEss)) {
      add("the effective sample size of the log posterior is " + number(out_.ess_log_posterior, 3) +
          " (must exceed 400)");
    }
    if (few_) {
      add("the effective sample size of the " +
          std::string(space_.kinds().empty() ? "model" : "count") + " is " +
          number(out_.ess_model, 3) + " (must exceed 400)");
    }
    if (!why.empty()) {
      say("The chains have not converged: " + why + ". Do not trust these numbers yet." +
          kRunLonger);
    }
  }

  // ---- models --------------------------------------------------------------------------------

  // Bridge sampling knows the draws; importance sampling with a finite error has seen what it
  // weighs; annealing from the prior is the last resort.
  [[nodiscard]] Evidence evidence(std::size_t m) const {
    Evidence none{.log_evidence = kNaN, .standard_error = kNaN};
    if (prior_only_) return {.log_evidence = 0.0, .standard_error = 0.0};
    if (m >= posterior_.found.size()) return none;
    const ModelFindings& found = posterior_.found[m];
    if (std::isfinite(found.bridged.log_evidence)) return found.bridged;
    if (std::isfinite(found.sampled.log_evidence) && found.sampled.standard_error < kUsableError) {
      return found.sampled;
    }
    if (std::isfinite(found.annealed.log_evidence)) return found.annealed;
    return none;
  }

  // Whether the evidence is an average over the posterior's own draws or mixture.
  [[nodiscard]] bool of_draws(std::size_t m) const {
    if (prior_only_) return true;
    if (m >= posterior_.found.size()) return false;
    const ModelFindings& found = posterior_.found[m];
    return std::isfinite(found.bridged.log_evidence) ||
           (std::isfinite(found.sampled.log_evidence) &&
            found.sampled.standard_error < kUsableError);
  }

  void weigh() {
    std::vector<Evidence> evidences;
    double known_share = 0.0, known_mass = 0.0, top = -kInfinity;
    for (std::size_t m = 0; m < models_; ++m) {
      evidences.push_back(evidence(m));
      standing(m).log_evidence = evidences[m].log_evidence;
      standing(m).log_evidence_se = evidences[m].standard_error;
      if (visits_[m] > 0.0 && std::isfinite(evidences[m].log_evidence)) {
        top = std::max(top, evidences[m].log_evidence);
      }
    }
    for (std::size_t m = 0; m < models_; ++m) {
      if (visits_[m] == 0.0 || !std::isfinite(evidences[m].log_evidence)) continue;
      known_share += share_[m];
      known_mass += prior(m) * std::exp(evidences[m].log_evidence - top);
    }
    // A visited model of unknown evidence gets what its draws imply beside the known ones.
    const bool comparable = known_share > 0.0 && known_mass > 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (std::isfinite(evidences[m].log_evidence) && comparable) continue;
      const bool drawn = visits_[m] > 0.0;
      const double scale = comparable ? known_mass / known_share : 1.0;
      evidences[m] = {
          .log_evidence = drawn ? (comparable ? top : 0.0) + std::log(share_[m] * scale / prior(m))
                                : -kInfinity,
          .standard_error = drawn ? error_[m] / share_[m] : 0.0};
    }
    implied_ = implied_probabilities(space_, evidences);
    double by_evidence = 0.0, variance = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      ModelStanding& s = standing(m);
      const bool known = comparable && std::isfinite(s.log_evidence);
      const bool speaks = s.visited > 0 && !(known && missed(m));
      s.basis = speaks || !known ? Basis::draws : Basis::evidence;
      if (prior(m) == 0.0 && s.visited == 0) s.basis = Basis::evidence;
      if (s.basis == Basis::evidence) by_evidence += implied_.mean[m];
    }
    for (std::size_t n = 0; n < models_; ++n) {
      const bool inside = standing(n).basis == Basis::evidence;
      const double slope = implied_.mean[n] * ((inside ? 1.0 : 0.0) - by_evidence);
      if (slope != 0.0) variance += std::pow(slope * evidences[n].standard_error, 2.0);
    }
    double drawn = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (standing(m).basis == Basis::draws) drawn += share_[m];
    }
    for (std::size_t m = 0; m < models_; ++m) {
      ModelStanding& s = standing(m);
      if (s.basis == Basis::evidence) {
        s.probability = implied_.mean[m];
        s.mcse = implied_.standard_error[m];
      } else if (s.visited > 0) {
        const double share = share_[m] / drawn;
        s.probability = share * (1.0 - by_evidence);
        s.mcse = std::hypot((1.0 - by_evidence) * std::max(error_[m] / drawn, least_error(m)),
                            share * std::sqrt(variance));
      }
    }
  }

  // Whether a model that some chain lacks should have been in every chain.
  [[nodiscard]] bool missed(std::size_t m) const {
    const auto visited = static_cast<std::size_t>(out_.models[m].visited);
    if (visited == chains_) return false;
    // In draws: of models weighted to be drawn more often than they are probable, more.
    double drawn = 0.0;
    for (std::size_t k = 0; k < models_; ++k) drawn += implied_.mean[k] / weight_[k];
    const double expected = implied_.mean[m] / weight_[m] / drawn;
    if (visited == 0) return expected * effective_ > kExpectedVisits;
    const double looks = out_.ess_log_posterior / static_cast<double>(chains_);
    if (!(expected * looks > kExpectedVisits)) return false;
    // Visits in few long stays are fewer: as the chains that have them show.
    double own = 0.0;
    for (std::size_t c = 0; c < chains_; ++c) {
      if (counts_[c][m] == 0) continue;
      std::vector<double> indicator;
      for (const int at : posterior_.chains[c].model) {
        indicator.push_back(at == static_cast<int>(m) ? 1.0 : 0.0);
      }
      own += ess_mean({std::move(indicator)}) / static_cast<double>(visited);
    }
    return expected * std::min(looks, own) > kExpectedVisits;
  }

  void say_models() {
    std::vector<std::size_t> order(models_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t m) { return implied_.mean[m]; });
    std::vector<std::string> unknown, absent, partial;
    for (const std::size_t m : order) {
      const ModelStanding& s = standing(m);
      const std::string proposals = s.proposed > 0
                                        ? "was not entered in " + grouped(s.proposed) + " proposals"
                                        : "was never entered";
      if (s.visited == 0 && prior(m) > 0.0 && std::isnan(s.mcse) && s.basis == Basis::draws) {
        unknown.push_back("Model '" + name(m) + "' " + proposals +
                          "; nothing is known of its evidence." + kRunLonger);
      } else if (missed(m)) {
        const bool known = std::isfinite(s.log_evidence);
        const std::string p = "; its evidence puts it at P ≈ " +
                              plus_minus(implied_.mean[m], implied_.standard_error[m]);
        if (s.visited == 0) {
          absent.push_back("Model '" + name(m) + "' " + proposals + p + "." + kSearchMore);
        } else {
          partial.push_back("Model '" + name(m) + "' was drawn by " + std::to_string(s.visited) +
                            " of " + std::to_string(chains_) + " chains only" +
                            (known ? p : std::string()) + "." + kRunLonger);
        }
      }
    }
    for (auto* list : {&absent, &partial, &unknown}) {
      for (std::size_t i = 0; i < list->size() && i < kNamed; ++i) say(std::move((*list)[i]));
      if (list->size() > kNamed) {
        say("The same holds for " + std::to_string(list->size() - kNamed) + " more models.");
      }
    }
  }

  // ---- modes ---------------------------------------------------------------------------------

  void say_modes() {
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const auto& modes = posterior_.found[m].modes;
      if (modes.size() < 2 || standing(m).visited == 0) continue;
      // Effective draws of this model in each chain; never more than it has.
      std::vector<double> effective;
      for (std::size_t c = 0; c < chains_; ++c) {
        const auto n = static_cast<double>(counts_[c][m]);
        const auto length = static_cast<double>(posterior_.chains[c].model.size());
        effective.push_back(n * std::min(1.0, effective_ / length));
      }
      for (const FoundMode& mode : modes) say_mode(m, mode, effective);
    }
  }

  void say_mode(std::size_t m, const FoundMode& mode, const std::vector<double>& effective) {
    std::vector<double> drawn;
    std::size_t missing = 0;
    double mean = 0.0, within = 0.0;
    for (std::size_t c = 0; c < mode.drawn.size() && c < effective.size(); ++c) {
      if (!std::isfinite(mode.drawn[c])) continue;
      if (mode.drawn[c] == 0.0 && mode.share * effective[c] > kExpectedVisits) ++missing;
      if (!(effective[c] > 0.0)) continue;
      drawn.push_back(mode.drawn[c]);
      mean += mode.drawn[c];
      within += effective[c];
    }
    if (missing > 0) {
      say("A mode of model '" + name(m) + "' that the searches found, about " +
          percent(mode.share) + " of that model, is in the draws of " +
          (missing == mode.drawn.size() ? std::string("no chain.")
                                        : std::to_string(mode.drawn.size() - missing) + " of " +
                                              std::to_string(mode.drawn.size()) + " chains only.") +
          kRunLonger);
      return;
    }
    if (drawn.size() < 2) return;
    const auto n = static_cast<double>(drawn.size());
    mean /= n;
    within /= n;
    const double rarer = std::min(mean, 1.0 - mean);
    if (rarer < kJudgedMode || rarer * within < kExpectedVisits) return;
    double between = 0.0;
    for (const double d : drawn) between += (d - mean) * (d - mean) / (n - 1.0);
    const double ratio = between / (mean * (1.0 - mean));
    const double r = std::sqrt(1.0 + ratio);
    if (r < kMaxRhatOfMode || chance(ratio, within, drawn.size()) > kChance) return;
    const auto [low, high] = std::ranges::minmax(drawn);
    say("The chains disagree about a mode of model '" + name(m) + "': it has " + percent(low) +
        " to " + percent(high) + " of their draws of that model (R-hat " + number(r, 3) + ")." +
        kRunLonger);
  }

  // ---- evidence ------------------------------------------------------------------------------

  void say_evidence() {
    std::vector<std::string> sentences;
    for (std::size_t m = 0; m < std::min(models_, posterior_.found.size()); ++m) {
      const Evidence& annealed = posterior_.found[m].annealed;
      if (standing(m).visited == 0 || !of_draws(m)) continue;
      const Evidence drawn = evidence(m);
      const double excess = annealed.log_evidence - drawn.log_evidence;
      const double error = std::hypot(annealed.standard_error, drawn.standard_error);
      // Of a model that is negligible either way nobody asks.
      const bool matters = implied_.mean[m] * std::exp(std::min(excess, 700.0)) > kSlackProbability;
      if (matters && excess > kSigmas * error + kSlackNats) {
        sentences.push_back(
            "Annealing finds more evidence for model '" + name(m) +
            "' (ln Z = " + fixed_plus_minus(annealed.log_evidence, annealed.standard_error) +
            ") than its draws have (" + fixed_plus_minus(drawn.log_evidence, drawn.standard_error) +
            "): a mode may be missing from them." + kSearchMore);
      }
    }
    for (std::size_t m = 0; m < models_; ++m) {
      const ModelStanding& s = standing(m);
      if (s.basis != Basis::draws || s.visited == 0 || !of_draws(m)) continue;
      const double error = std::hypot(s.mcse, implied_.standard_error[m]);
      if (!(std::abs(s.probability - implied_.mean[m]) > kSigmas * error + kSlackProbability)) {
        continue;
      }
      sentences.push_back("Model '" + name(m) + "' has P = " + plus_minus(s.probability, s.mcse) +
                          " by its draws, but its evidence implies " +
                          plus_minus(implied_.mean[m], implied_.standard_error[m]) + "." +
                          kRunLonger);
    }
    for (std::size_t i = 0; i < sentences.size() && i < 2 * kNamed; ++i) say(sentences[i]);
  }

  // ---- parameters ----------------------------------------------------------------------------

  // Draws of something within a model, chains of one length; none where a chain has few.
  template <class Value>
  [[nodiscard]] ChainsOf within(std::size_t m, const Value& value) const {
    std::size_t n = std::numeric_limits<std::size_t>::max();
    ChainsOf chains;
    const auto width = static_cast<std::size_t>(posterior_.dimension);
    for (const Chain& chain : posterior_.chains) {
      std::vector<double> values;
      for (std::size_t i = 0; i < chain.model.size(); ++i) {
        if (chain.model[i] == static_cast<int>(m)) values.push_back(value(&chain.theta[i * width]));
      }
      if (values.size() < kFewestDraws) return {};
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

  void say_parameters() {
    std::vector<std::string> sentences;
    for (std::size_t m = 0; m < models_; ++m) {
      if (standing(m).probability < kJudgedModel || standing(m).visited == 0) continue;
      const Model& model = space_[static_cast<int>(m)];
      std::string worst;
      for (int i = 0; i < static_cast<int>(model.parameters.size()); ++i) {
        judge_parameter(m, space_.parameter_name(static_cast<int>(m), i), worst,
                        [i](const double* x) { return x[i]; });
      }
      for (std::size_t k = 0; k < model.counts.size(); ++k) {
        const auto& parameters = space_.kinds()[k].parameters;
        const auto size = static_cast<int>(parameters.size());
        const int count = model.counts[k], offset = model.offsets[k];
        for (int i = 0; count > 0 && i < size; ++i) {
          std::string what =
              (count > 1 ? "sum of " : "") + parameters[static_cast<std::size_t>(i)].name;
          if (model.counts.size() > 1) what = space_.kinds()[k].name + " " + what;
          judge_parameter(m, what, worst, [=](const double* x) {
            double total = 0.0;
            for (int c = 0; c < count; ++c) total += x[offset + c * size + i];
            return total;
          });
        }
      }
      if (!worst.empty()) sentences.push_back(std::move(worst));
    }
    for (std::size_t i = 0; i < sentences.size() && i < kNamed; ++i) say(std::move(sentences[i]));
    if (sentences.size() > kNamed) {
      say("The same holds for parameters of " + std::to_string(sentences.size() - kNamed) +
          " more models.");
    }
  }

  template <class Value>
  void judge_parameter(std::size_t m, const std::string& what, std::string& worst,
                       const Value& value) {
    const ChainsOf draws = within(m, value);
    if (draws.empty()) return;
    const double r = rhat(draws);
    note_rhat(name(m) + "/" + what, r, false);
    if (!worst.empty()) return;
    const double needed =
        std::clamp(2.0 * kMinEss * standing(m).probability, kMinEssWithin, kMinEss);
    const double ess = ess_bulk(draws);
    const std::string of = "Within model '" + name(m) + "' ";
    if (!(r < kMaxRhat)) {
      double effective = 0.0;  // of a half chain, chains judged one by one
      for (const auto& chain : draws) effective += ess_bulk({chain});
      const std::size_t halves = 2 * draws.size();
      effective /= static_cast<double>(halves);
      const double ratio = r * r - 1.0 + 2.0 / static_cast<double>(draws[0].size());
      if (chance(ratio, effective, halves) < kChance) {
        worst = of + "the chains disagree about " + what + " (R-hat " + number(r, 4) + ")." +
                kRunLonger;
        return;
      }
    }
    // Of few draws in few stays the estimate itself is too noisy to judge by.
    const bool enough =
        standing(m).probability > kProbableModel || draws[0].size() >= kFewestForEss;
    if (enough && !(ess > needed)) {
      worst = of + "the effective sample size of " + what + " is " + number(ess, 3) +
              " (must exceed " + number(needed, 3) + ")." + kRunLonger;
    }
  }

  // ---- resolution ----------------------------------------------------------------------------

  // (1 - p)^n = 0.01 where p is what a mode must hold to be missed by n climbs once in a hundred.
  void resolve() {
    double resolution = 0.0;
    for (std::size_t m = 0; m < models_; ++m) {
      if (space_[static_cast<int>(m)].dimension == 0 || prior(m) == 0.0) continue;
      const long climbs = m < posterior_.found.size() ? posterior_.found[m].climbs : 0;
      if (climbs == 0 && standing(m).probability < kJudgedModel) continue;
      resolution = std::max(
          resolution, climbs > 0 ? 1.0 - std::pow(0.01, 1.0 / static_cast<double>(climbs)) : 1.0);
    }
    out_.resolution = posterior_.found.empty() ? 1.0 : resolution;
  }

  const Posterior& posterior_;
  const ModelSpace& space_;
  const std::vector<Watched>& watched_;
  Verdict out_;
  std::size_t models_ = 0, chains_ = 0;
  std::vector<std::vector<long>> counts_;  ///< chains × models
  std::vector<double> visits_;             ///< share of the draws
  std::vector<double> weight_;             ///< of a draw of each model; 1 on average
  std::vector<double> share_;              ///< of the weight
  std::vector<double> error_;              ///< of `share_`, of the draws alone
  double effective_ = 0.0;                 ///< draws a chain
  bool few_ = false;                       ///< too few effective draws of a count
  bool prior_only_ = false;
  ImpliedProbabilities implied_;
};

}  // namespace

Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched) {
  return Judge(posterior, watched).verdict();
}

}  // namespace wheeltap::inference
