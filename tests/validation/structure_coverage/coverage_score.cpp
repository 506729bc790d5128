#include "coverage_score.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

namespace wheeltap::coverage {
namespace {

constexpr double kByChance = 1e-4;
constexpr double kImprobable = 0.01;
constexpr double kTail = 0.0005;  // beyond the central 99.9 %
constexpr double kMissed = 3.0;   // ln p of the truth above that of every draw
constexpr std::array kWithinModel = {"severity", "deepest", "place"};

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 512> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

int total(const std::vector<int>& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0);
}

/// Two-sided p value of so many held of so many at 0.9.
double coverage_p(const Coverage& c) {
  const boost::math::binomial law(c.ranks, 0.9);
  const double below = cdf(law, c.held);
  const double above = c.held == 0 ? 1.0 : cdf(complement(law, c.held - 1));
  return std::min(1.0, 2.0 * std::min(below, above));
}

std::string words(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& s : list) out += (out.empty() ? "" : "; ") + s;
  return out.empty() ? "-" : out;
}

std::string truth_of(const Row& row) {
  std::string out;
  for (std::size_t k = 0; k < row.kinds.size(); ++k)
    out += (k ? ", " : "") + std::to_string(row.truth[k]) + " of " + std::to_string(row.most[k]) +
           " " + row.kinds[k];
  return out;
}

std::string reliability_table(const std::vector<Row>& rows, bool totals) {
  std::string out =
      "| P stated | of them | sum of P | true | p |\n| --- | ---: | ---: | ---: | ---: |\n";
  for (const Reliability& r : reliability(rows, totals))
    if (r.stated > 0)
      out += text("| %g to %g | %d | %.2f | %d | %.2f |\n", r.low, std::min(r.high, 1.0), r.stated,
                  r.expected, r.truths, r.p_value());
  return out;
}

}  // namespace

double Reliability::p_value() const {
  if (!(variance > 0.0)) return 1.0;
  const double off = std::max(0.0, std::abs(truths - expected) - 0.5) / std::sqrt(variance);
  return std::erfc(off / std::sqrt(2.0));
}

std::vector<Reliability> reliability(const std::vector<Row>& rows, bool totals) {
  constexpr std::array kEdges = {0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0 + 1e-9};
  std::vector<Reliability> bins;
  for (std::size_t i = 0; i + 1 < kEdges.size(); ++i)
    bins.push_back({.low = kEdges[i], .high = kEdges[i + 1]});
  const auto add = [&](double p, bool is_true) {
    for (Reliability& bin : bins) {
      if (p < bin.low || p >= bin.high) continue;
      ++bin.stated;
      bin.expected += p;
      bin.variance += p * (1.0 - p);
      bin.truths += is_true ? 1 : 0;
    }
  };
  for (const Row& row : rows) {
    std::map<int, double> by_total;
    for (const Row::Model& model : row.models) {
      if (!totals) add(model.probability, model.counts == row.truth);
      by_total[total(model.counts)] += model.probability;
    }
    if (!totals) continue;
    for (const auto& [count, p] : by_total) add(std::min(p, 1.0), count == total(row.truth));
  }
  return bins;
}

Coverage coverage(std::string function, const std::vector<double>& ranks) {
  Coverage out{.function = std::move(function), .ranks = static_cast<int>(ranks.size())};
  for (const double u : ranks) out.held += u >= 0.05 && u <= 0.95 ? 1 : 0;
  using boost::math::beta_distribution;
  if (out.held > 0)
    out.lowest = quantile(beta_distribution<>(out.held, out.ranks - out.held + 1), 0.025);
  if (out.held < out.ranks)
    out.highest = quantile(beta_distribution<>(out.held + 1, out.ranks - out.held), 0.975);
  const int bins = std::min(10, out.ranks / 5);
  if (bins < 2) return out;
  std::vector<int> count(static_cast<std::size_t>(bins));
  for (const double u : ranks)
    ++count[static_cast<std::size_t>(std::clamp(static_cast<int>(u * bins), 0, bins - 1))];
  const double each = static_cast<double>(out.ranks) / bins;
  double square = 0.0;
  for (const int n : count) square += (n - each) * (n - each) / each;
  out.uniform_p = cdf(complement(boost::math::chi_squared(bins - 1), square));
  return out;
}

std::vector<Coverage> coverages(const std::vector<Row>& rows) {
  std::map<std::string, std::vector<double>> all;
  for (const Row& row : rows)
    for (const auto& [name, values] : row.ranks)
      all[name].insert(all[name].end(), values.begin(), values.end());
  std::vector<Coverage> out;
  for (const char* name : kWithinModel)
    if (const auto found = all.find(name); found != all.end()) {
      out.push_back(coverage(name, found->second));
      all.erase(found);
    }
  for (const auto& [name, values] : all) out.push_back(coverage(name, values));
  return out;
}

std::vector<Surprise> surprises(const std::vector<Row>& rows) {
  std::vector<Surprise> out;
  for (const Row& row : rows) {
    Surprise s{.row = &row, .what = {}};
    if (row.probability_of_truth() < kImprobable)
      s.what.push_back(text("P(truth) = %.2g", row.probability_of_truth()));
    for (const auto& [name, values] : row.ranks)
      for (const double u : values)
        if (u < kTail || u > 1.0 - kTail) s.what.push_back(name + text(": rank %.5f", u));
    if (row.truth_above_draws > kMissed)
      s.what.push_back(text("ln p of the truth %.1f above every draw", row.truth_above_draws));
    if (!s.what.empty()) out.push_back(std::move(s));
  }
  return out;
}

Expected expected_surprises(const std::vector<Row>& rows) {
  Expected out{};
  for (const Row& row : rows) {
    for (const Row::Model& model : row.models)
      if (model.probability < kImprobable) out.improbable_truths += model.probability;
    for (const auto& [name, values] : row.ranks)
      out.extreme_ranks += 2.0 * kTail * static_cast<double>(values.size());
  }
  return out;
}

std::vector<std::string> faults(const std::vector<Row>& rows) {
  std::vector<std::string> out;
  for (const Coverage& c : coverages(rows)) {
    if (c.ranks > 0 && coverage_p(c) < kByChance)
      out.push_back(text("%s: 90 %% intervals held %d of %d", c.function.c_str(), c.held, c.ranks));
    if (c.uniform_p < kByChance)
      out.push_back(text("%s: ranks are not uniform, p = %.1e", c.function.c_str(), c.uniform_p));
  }
  for (const bool totals : {false, true})
    for (const Reliability& r : reliability(rows, totals))
      if (r.p_value() < kByChance && std::abs(r.truths - r.expected) > 1.5)
        out.push_back(
            text("P from %g to %g: %d true, %.2f expected", r.low, r.high, r.truths, r.expected));
  for (const Row& row : rows) {
    if (row.warned()) continue;
    if (row.truth_above_draws > kMissed || row.probability_of_truth() < kByChance)
      out.push_back(
          text("case %d: P(truth) = %.1e, ln p of the truth %.1f above every draw, "
               "without a warning",
               row.number, row.probability_of_truth(), row.truth_above_draws));
  }
  return out;
}

std::string report(const std::vector<Row>& rows) {
  const auto converged = std::ranges::count_if(rows, [](const Row& row) { return row.converged; });
  double seconds = 0.0, calls = 0.0;
  int right = 0;
  double said = 0.0;
  for (const Row& row : rows) {
    seconds += row.seconds;
    calls += row.likelihood_calls;
    const auto best = std::ranges::max_element(row.models, {}, &Row::Model::probability);
    if (best == row.models.end()) continue;
    right += best->counts == row.truth ? 1 : 0;
    said += best->probability;
  }
  std::string out = text("%zu cases, %td converged; %.0f s, %.3g likelihood calls\n\n", rows.size(),
                         converged, seconds, calls);
  out += text(
      "The most probable combination of counts is the true one in %d; the sum of its "
      "probabilities is %.1f\n\n",
      right, said);
  out += "Every combination of counts:\n\n" + reliability_table(rows, false);
  out += "\nThe number of defects, whatever their kind:\n\n" + reliability_table(rows, true);
  out +=
      "\n| function | ranks | 90 % intervals held | share, 95 % bounds | uniform, p |\n"
      "| --- | ---: | ---: | --- | ---: |\n";
  for (const Coverage& c : coverages(rows))
    out +=
        text("| %s | %d | %d | %.3f, %.3f to %.3f | %.2f |\n", c.function.c_str(), c.ranks, c.held,
             static_cast<double>(c.held) / std::max(1, c.ranks), c.lowest, c.highest, c.uniform_p);
  const Expected chance = expected_surprises(rows);
  out += text(
      "\nSurprises; by chance %.2f cases of P(truth) < 0.01 and %.2f ranks beyond 99.9 %%:\n\n",
      chance.improbable_truths, chance.extreme_ranks);
  out += "| case | truth | surprise | converged | warnings |\n| ---: | --- | --- | --- | --- |\n";
  for (const Surprise& s : surprises(rows))
    out += "| " + std::to_string(s.row->number) + " " + s.row->family + " | " + truth_of(*s.row) +
           " | " + words(s.what) + " | " +
           (s.row->converged ? "yes" : "no: " + words(s.row->why_not)) + " | " +
           words(s.row->warnings) + " |\n";
  return out;
}

}  // namespace wheeltap::coverage
