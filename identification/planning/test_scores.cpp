#include "identification/planning/test_scores.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::planning {

double TestScorer::information(const TestTruth& truth, const NormalTest::Measured& measured,
                               const NormalTest::Answer& answer) const {
  // ln p(y | truth) / p(y | intact), and ln of the truth's prior.
  double log_truth = 0.0, log_prior = std::log(test_.models()[index(truth.model)].prior);
  if (!truth.defects.empty()) {
    const int a = truth.defects.front().place, b = truth.defects.back().place;
    if (a == b) {
      log_truth = answer.log_places[index(a)];
      log_prior += std::log(test_.places()[index(a)].prior);
    } else {
      log_truth = test_.log_pair(measured, std::min(a, b), std::max(a, b));
      log_prior += test_.log_pair_prior(truth.model, std::min(a, b), std::max(a, b));
    }
  }
  // The sampled estimate of a sum over pairs may be below one of the terms.
  const double ratio = std::min(log_truth - answer.log_all, -log_prior);
  return std::log((1.0 - kFloor) * std::exp(ratio) + kFloor);
}

/// Whether the median location, by the weights of places on the true site, is within the tolerance.
bool TestScorer::is_near(const std::vector<double>& weights,
                         const TestTruth::Defect& defect) const {
  double all = 0.0, sum = 0.0;
  for (const double w : weights) all += w;
  for (std::size_t a = 0; a < weights.size(); ++a) {
    if (!(weights[a] > 0.0)) continue;
    const double before = sum;
    sum += weights[a];
    if (sum < 0.5 * all) continue;
    const double share = (0.5 * all - before) / weights[a];
    const double median = spans_[a].start + share * (spans_[a].end - spans_[a].start);
    return std::abs(median - defect.at) <= tolerance_;
  }
  return false;
}

bool TestScorer::is_right(const TestTruth& truth, const NormalTest::Answer& answer) const {
  const auto& models = test_.models();
  const auto posterior = [&](std::size_t m) {
    return answer.log_models[m] + std::log(models[m].prior);
  };
  for (std::size_t m = 0; m < models.size(); ++m)
    if (posterior(m) > posterior(index(truth.model))) return false;
  if (truth.defects.empty()) return true;
  const auto& places = test_.places();
  const std::size_t slots = truth.defects.size();
  using Sites = std::array<int, 2>;
  struct Weighted {
    Sites at;  // places
    double weight;
  };
  std::vector<Weighted> list;
  double most = -kInfinity;
  if (slots == 1) {
    const int kind = places[index(truth.defects[0].place)].kind;
    for (std::size_t a = 0; a < places.size(); ++a) {
      if (places[a].kind != kind || !(places[a].prior > 0.0)) continue;
      list.push_back({{static_cast<int>(a), static_cast<int>(a)},
                      answer.log_places[a] + std::log(places[a].prior)});
    }
  } else {
    for (const auto& pair : answer.pairs[index(truth.model)])
      list.push_back({{std::min(pair.a, pair.b), std::max(pair.a, pair.b)}, pair.log_weight});
  }
  const auto sites_of = [&](const Sites& at) {
    return Sites{spans_[index(at[0])].site, spans_[index(at[1])].site};
  };
  for (const Weighted& w : list) most = std::max(most, w.weight);
  std::map<Sites, double> sites;
  for (Weighted& w : list) sites[sites_of(w.at)] += w.weight = std::exp(w.weight - most);
  const auto best = std::ranges::max_element(sites, {}, [](const auto& s) { return s.second; });
  const Sites true_places = {truth.defects.front().place, truth.defects.back().place};
  if (best == sites.end() || best->first != sites_of(true_places)) return false;
  for (std::size_t i = 0; i < slots; ++i) {
    std::vector<double> weights(places.size(), 0.0);
    for (const Weighted& w : list)
      if (sites_of(w.at) == best->first) weights[index(w.at[i])] += w.weight;
    if (!is_near(weights, truth.defects[i])) return false;
  }
  return true;
}

/// The share of a place within the tolerance of the true location.
double TestScorer::within_tolerance(int place, const TestTruth::Defect& defect) const {
  const PlaceSpan& span = spans_[index(place)];
  if (span.site != spans_[index(defect.place)].site) return 0.0;
  const double length = span.end - span.start;
  if (!(length > 0.0)) return std::abs(span.start - defect.at) <= tolerance_ ? 1.0 : 0.0;
  const double inside =
      std::min(span.end, defect.at + tolerance_) - std::max(span.start, defect.at - tolerance_);
  return std::clamp(inside / length, 0.0, 1.0);
}

double TestScorer::located(const TestTruth& truth, const NormalTest::Answer& answer) const {
  const double prior = test_.models()[index(truth.model)].prior;
  if (truth.defects.empty()) return prior * std::exp(-answer.log_all);
  const auto& places = test_.places();
  double sum = 0.0;
  if (truth.defects.size() == 1) {
    const TestTruth::Defect& defect = truth.defects[0];
    for (std::size_t a = 0; a < places.size(); ++a)
      if (places[a].kind == places[index(defect.place)].kind)
        if (const double share = within_tolerance(static_cast<int>(a), defect); share > 0.0)
          sum += share * places[a].prior * std::exp(answer.log_places[a] - answer.log_all);
  } else {
    for (const auto& pair : answer.pairs[index(truth.model)]) {
      const double share = within_tolerance(std::min(pair.a, pair.b), truth.defects[0]) *
                           within_tolerance(std::max(pair.a, pair.b), truth.defects[1]);
      if (share > 0.0) sum += share * std::exp(pair.log_weight - answer.log_all);
    }
  }
  return std::min(1.0, prior * sum);
}

TestOutcome TestScorer::score(const TestTruth& truth, const NormalTest::Measured& measured,
                              const NormalTest::Answer& answer) const {
  return {.model = truth.model,
          .log_odds = answer.log_odds,
          .information = information(truth, measured, answer),
          .right = is_right(truth, answer),
          .located = located(truth, answer)};
}

namespace {

/// The log odds of the tests of each model, sorted.
using SortedOdds = std::vector<std::vector<double>>;

/// Interpolates the (1 - α) quantile between order statistics.
double threshold_at(const std::vector<double>& intact, double alpha) {
  const auto n = static_cast<double>(intact.size());
  const double at = std::clamp((1.0 - alpha) * n - 0.5, 0.0, n - 1.0);
  const auto i = static_cast<std::size_t>(at);
  const std::size_t next = std::min(i + 1, intact.size() - 1);
  return std::lerp(intact[i], intact[next], at - static_cast<double>(i));
}

struct Share {
  double value = 0.0, variance = 0.0;
};
Share share_above(const std::vector<double>& sorted, double threshold) {
  const auto n = static_cast<double>(sorted.size());
  const auto hits = static_cast<double>(sorted.end() - std::ranges::upper_bound(sorted, threshold));
  // Wilson's centre keeps the variance positive if all tests or no tests exceed the threshold.
  const double p = (hits + 0.5) / (n + 1.0);
  return {hits / n, p * (1.0 - p) / n};
}

constexpr int kPoints = 60;
/// Ascending false-alarm probabilities, from one alarm in all intact tests to an alarm in every
/// test.
double alpha_of(int point, double intact_tests) {
  return std::pow(intact_tests, static_cast<double>(point) / kPoints - 1.0);
}

/// P(detected | at least one defect), with the variance, if the tests of every model exist.
Share detection_above(const SortedOdds& odds, const std::vector<NormalModel>& models,
                      std::size_t intact, double threshold) {
  Share out;
  double damaged = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (m == intact || odds[m].empty()) continue;
    const Share one = share_above(odds[m], threshold);
    damaged += models[m].prior;
    out.value += models[m].prior * one.value;
    out.variance += models[m].prior * models[m].prior * one.variance;
  }
  if (damaged > 0.0) {
    out.value /= damaged;
    out.variance /= damaged * damaged;
  }
  return out;
}

std::vector<TestScores::HeldOut> held_out(const SortedOdds& chosen, const SortedOdds& tested,
                                          const std::vector<NormalModel>& models,
                                          std::size_t intact) {
  std::vector<TestScores::HeldOut> out;
  if (chosen[intact].empty() || tested[intact].empty()) return out;
  for (int i = 0; i < kPoints; ++i) {
    const double alpha = alpha_of(i, static_cast<double>(chosen[intact].size()));
    const double threshold = threshold_at(chosen[intact], alpha);
    const Share alarm = share_above(tested[intact], threshold);
    const Share detection = detection_above(tested, models, intact, threshold);
    out.push_back({.chosen = {alpha, detection_above(chosen, models, intact, threshold).value},
                   .tested = {alarm.value, detection.value},
                   .variance = {alarm.variance, detection.variance}});
  }
  // An alarm in every test.
  out.push_back({.chosen = {1.0, 1.0}, .tested = {1.0, 1.0}, .variance = {}});
  return out;
}

}  // namespace

TestScores summarise(const std::vector<TestOutcome>& outcomes,
                     const std::vector<NormalModel>& models, double false_alarm) {
  std::size_t intact = 0;
  for (std::size_t m = 0; m < models.size(); ++m)
    if (std::ranges::all_of(models[m].counts, [](int c) { return c == 0; })) intact = m;
  SortedOdds odds(models.size());
  std::array<SortedOdds, 2> halves = {SortedOdds(models.size()), SortedOdds(models.size())};
  for (const TestOutcome& o : outcomes) {
    const auto m = index(o.model);
    halves[odds[m].size() % 2][m].push_back(o.log_odds);
    odds[m].push_back(o.log_odds);
  }
  for (SortedOdds* lists : {&odds, &halves[0], &halves[1]})
    for (std::vector<double>& list : *lists) std::ranges::sort(list);
  const std::vector<double>& healthy = odds[intact];
  if (healthy.empty()) throw std::invalid_argument("the scores need tests of the intact structure");
  const auto intact_tests = static_cast<double>(healthy.size());
  TestScores out;
  for (const std::size_t half : {0u, 1u})
    out.halves[half] = held_out(halves[half], halves[1 - half], models, intact);
  out.threshold = threshold_at(healthy, false_alarm);
  const double alpha_se = std::sqrt(false_alarm * (1.0 - false_alarm) / intact_tests);
  const double step = std::min(std::max(2.0 * alpha_se, 1.0 / intact_tests), 0.5 * false_alarm);
  const double lower = threshold_at(healthy, false_alarm + step);
  const double upper = threshold_at(healthy, false_alarm - step);
  struct Sums {
    double n = 0, detected = 0, easier = 0, harder = 0, right = 0, right_easier = 0,
           right_harder = 0, information = 0, squares = 0;
  };
  std::vector<Sums> sums(models.size());
  for (const TestOutcome& o : outcomes) {
    Sums& s = sums[index(o.model)];
    s.n += 1.0;
    s.detected += o.log_odds > out.threshold;
    s.easier += o.log_odds > lower;
    s.harder += o.log_odds > upper;
    s.right += o.right && o.log_odds > out.threshold;
    s.right_easier += o.right && o.log_odds > lower;
    s.right_harder += o.right && o.log_odds > upper;
    s.information += o.information;
    s.squares += o.information * o.information;
  }
  double damaged = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m)
    if (m != intact && sums[m].n > 0) damaged += models[m].prior;
  for (int i = 0; i <= kPoints; ++i) {
    const double alpha = alpha_of(i, intact_tests);
    const double detection =
        detection_above(odds, models, intact, threshold_at(healthy, alpha)).value;
    out.operating.push_back({alpha, i == kPoints ? 1.0 : detection});
  }
  double detection_slope = 0.0, right_slope = 0.0, detection_variance = 0.0, right_variance = 0.0,
         information_variance = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const Sums& s = sums[m];
    out.detection_by_model.push_back({kNaN, kNaN});
    if (s.n == 0) continue;
    const double mean = s.information / s.n, pi = models[m].prior;
    out.information.value += pi * mean;
    information_variance += pi * pi * std::max(0.0, s.squares / s.n - mean * mean) / s.n;
    if (m == intact) continue;
    const double share = pi / damaged;
    // Wilson's centre keeps the variance positive if all tests or no tests detect damage.
    const auto variance = [&](double hits) {
      const double p = (hits + 0.5) / (s.n + 1.0);
      return p * (1.0 - p) / s.n;
    };
    const double slope = (s.easier - s.harder) / s.n / (2.0 * step);
    out.detection.value += share * s.detected / s.n;
    out.right_place.value += share * s.right / s.n;
    detection_variance += share * share * variance(s.detected);
    right_variance += share * share * variance(s.right);
    detection_slope += share * slope;
    right_slope += share * (s.right_easier - s.right_harder) / s.n / (2.0 * step);
    out.detection_by_model.back() = {s.detected / s.n,
                                     std::hypot(std::sqrt(variance(s.detected)), slope * alpha_se)};
  }
  out.information.mcse = std::sqrt(information_variance);
  out.detection.mcse = std::hypot(std::sqrt(detection_variance), detection_slope * alpha_se);
  out.right_place.mcse = std::hypot(std::sqrt(right_variance), right_slope * alpha_se);
  return out;
}

}  // namespace wheeltap::identification::planning
