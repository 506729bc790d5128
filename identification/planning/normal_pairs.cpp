// Evidences of pairs of defects: approximate weights of all pairs, and integrals for the relevant
// pairs.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "identification/planning/normal_kernels.hpp"
#include "identification/planning/normal_test.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;

/// Pairs with a smaller ln of the weight, relative to the largest weight, are neglected.
constexpr float kNegligiblePair = 18.0F;
/// Pairs with a smaller share of the sum of the weights are sampled.
constexpr double kSmallShare = 1.0 / 400.0;
constexpr float kLowest = -std::numeric_limits<float>::infinity();

/// The inverse of the scalar products of the directions of two places; see PairRow. `directions`:
/// scalar products of the directions v and w of all places.
std::array<float, kSymmetric> gram_inverse(const Eigen::MatrixXd& directions, std::size_t a,
                                           std::size_t b) {
  const std::array<Index, 4> at = {static_cast<Index>(2 * a), static_cast<Index>(2 * a + 1),
                                   static_cast<Index>(2 * b), static_cast<Index>(2 * b + 1)};
  Eigen::Matrix4d gram = directions(at, at);
  // A direction may be zero, or parallel to a direction of the other place.
  gram.diagonal().array() += 1e-4;
  const Eigen::Matrix4d inverse = gram.llt().solve(Eigen::Matrix4d::Identity());
  std::array<float, kSymmetric> out{};
  std::size_t k = 0;
  for (Index i = 0; i < 4; ++i)
    for (Index j = i; j < 4; ++j) out[k++] = static_cast<float>(inverse(i, j));
  return out;
}

}  // namespace

/// The pairs of a model with two defects, and the constants of their approximate weights. A row has
/// the pairs of one place a, padded to a multiple of kPairLanes entries.
struct NormalTest::PairList {
  struct Row {
    int a = 0;
    std::size_t first = 0;   // first entry in the lists of pairs
    std::size_t count = 0;   // without the padding
    std::size_t second = 0;  // first place b in `places`
  };
  std::vector<int> kinds;
  std::vector<Row> rows;
  std::vector<int> places;                  // places b
  std::vector<float> correlation, inverse;  // ρ of their directions, 1 / (1 - ρ²)
  std::vector<float> log_weight;            // ln(prior · share of the prior that fits the data)
  std::vector<float> interaction;           // |I| / (|Δ_a| |Δ_b|)
  std::vector<float> gram_inverse;          // see PairRow: one array after the other
  std::vector<float> vw, wv, ww;            // see CurvedPairs
  std::vector<float> slopes, limits;        // of `places`, padded
  double log_prior = 0.0;                   // ln Σ P(a) P(b) over the pairs
};

/// Relevant pairs with the ln of their weights, the largest weight and, for pairs with a fit, the
/// index of the fit.
struct NormalTest::Screened {
  struct Candidate {
    int a = 0, b = 0, fit = -1;
    float extra = 0.0F;  // bound of the change of `weight` by a fit
    std::size_t entry = 0;
  };
  std::vector<Candidate> pairs;
  std::vector<float> weights;
  float most = kLowest;
  std::vector<Fit> fits;
  std::vector<float> amplitude, bend;  // y · v, y · w of each place
};

Eigen::MatrixXd NormalTest::directions_gram() const {
  const auto n = static_cast<Index>(places_.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(nodes_.rows(), 2 * n);
  for (Index a = 0; a < n; ++a) {
    const double norm = typical_norm_[index(a)];
    if (!(norm > 0.0)) continue;
    directions.col(2 * a) = nodes_.col(typical_[index(a)]) / norm;
    directions.col(2 * a + 1) = places_[index(a)].nodes * bends_[index(a)].of_nodes;
  }
  return directions.transpose() * directions;
}

std::shared_ptr<const NormalTest::PairList> NormalTest::list_pairs(
    const std::vector<int>& kinds) const {
  auto list = std::make_shared<PairList>();
  list->kinds = kinds;
  for (std::size_t b = 0; b < places_.size(); ++b)
    if (places_[b].kind == kinds[1]) list->places.push_back(static_cast<int>(b));
  const Eigen::MatrixXd directions = directions_gram();
  std::vector<std::array<float, kSymmetric>> inverses;
  double sum = 0.0;
  std::size_t before = 0;  // number of places of kind 1 up to and including place a
  for (std::size_t a = 0; a < places_.size(); ++a) {
    if (places_[a].kind != kinds[0]) continue;
    if (kinds[0] == kinds[1]) ++before;
    PairList::Row row{
        .a = static_cast<int>(a), .first = list->correlation.size(), .second = before};
    for (std::size_t k = before; k < list->places.size(); ++k) {
      const auto b = index(list->places[k]);
      const double prior = places_[a].prior * places_[b].prior;
      const double norms = typical_norm_[a] * typical_norm_[b];
      const double rho = norms > 0.0 ? gram_(typical_[a], typical_[b]) / norms : 0.0;
      const double room = std::max(1.0 - rho * rho, 1e-4);
      const auto share = [&](double top) {
        return std::log(std::min(1.0, 2.5 / std::max(top, 1e-9)));
      };
      list->correlation.push_back(static_cast<float>(rho));
      list->inverse.push_back(static_cast<float>(1.0 / room));
      list->log_weight.push_back(static_cast<float>(std::log(prior) + share(along_[a].back()) +
                                                    share(along_[b].back() * std::sqrt(room))));
      const int column = column_of_(static_cast<Index>(a), static_cast<Index>(b));
      list->interaction.push_back(
          column < 0 ? 0.0F
                     : static_cast<float>(std::sqrt(interaction_square_[index(column)]) / norms));
      inverses.push_back(gram_inverse(directions, a, b));
      const auto va = static_cast<Index>(2 * a), vb = static_cast<Index>(2 * b);
      list->vw.push_back(static_cast<float>(directions(va, vb + 1)));
      list->wv.push_back(static_cast<float>(directions(va + 1, vb)));
      list->ww.push_back(static_cast<float>(directions(va + 1, vb + 1)));
      sum += prior;
      ++row.count;
    }
    while (list->correlation.size() % kPairLanes != 0) {
      list->correlation.push_back(0.0F);
      list->inverse.push_back(1.0F);
      list->log_weight.push_back(-std::numeric_limits<float>::infinity());
      list->interaction.push_back(0.0F);
      inverses.emplace_back();
      for (auto* array : {&list->vw, &list->wv, &list->ww}) array->push_back(0.0F);
    }
    if (row.count > 0) list->rows.push_back(row);
  }
  if (list->rows.empty())
    throw std::invalid_argument("two defects need two possible locations, but there is only one");
  list->log_prior = std::log(sum);
  for (std::size_t k = 0; k < kSymmetric; ++k)
    for (const auto& one : inverses) list->gram_inverse.push_back(one[k]);
  list->slopes.assign(list->places.size() + kPairLanes, 0.0F);
  list->limits = list->slopes;
  for (std::size_t k = 0; k < list->places.size(); ++k) {
    list->slopes[k] = static_cast<float>(bends_[index(list->places[k])].slope);
    list->limits[k] = static_cast<float>(along_[index(list->places[k])].back());
  }
  return list;
}

double NormalTest::log_pair_prior(int model, int a, int b) const {
  const PairList& list = *pairs_[index(model)];
  if (places_[index(a)].kind != list.kinds[0] || places_[index(b)].kind != list.kinds[1])
    return -kInfinity;
  return std::log(places_[index(a)].prior) + std::log(places_[index(b)].prior) - list.log_prior;
}

/// Approximate weights of all pairs, and the pairs that may be relevant.
void NormalTest::screen(const Measured& measured, const PairList& list, const float* data,
                        Screened& out) const {
  const std::size_t n = list.correlation.size();
  thread_local std::vector<float> amplitudes, bends, weight, extra;
  std::vector<float>&amplitude = out.amplitude, &bend = out.bend;
  amplitude.assign(places_.size(), 0.0F);
  bend.assign(places_.size(), 0.0F);
  amplitudes.assign(list.places.size() + kPairLanes, 0.0F);
  bends.assign(list.places.size() + kPairLanes, 0.0F);
  weight.resize(n);
  extra.resize(n);
  for (std::size_t a = 0; a < places_.size(); ++a) {
    if (!(typical_norm_[a] > 0.0)) continue;
    amplitude[a] = static_cast<float>(measured.products[index(typical_[a])] / typical_norm_[a]);
    const Eigen::VectorXd& of_nodes = bends_[a].of_nodes;
    bend[a] = static_cast<float>(of_nodes.dot(
        Eigen::Map<const Eigen::VectorXd>(measured.products + first_[a], of_nodes.size())));
  }
  for (std::size_t k = 0; k < list.places.size(); ++k) {
    amplitudes[k] = amplitude[index(list.places[k])];
    bends[k] = bend[index(list.places[k])];
  }
  const auto square = static_cast<float>(
      Eigen::Map<const Eigen::VectorXd>(measured.data, nodes_.rows()).squaredNorm());
  out.most = kLowest;
  for (const PairList::Row& row : list.rows)
    out.most = std::max(
        out.most, screen_pairs({.amplitude = amplitude[index(row.a)],
                                .bend = bend[index(row.a)],
                                .slope = static_cast<float>(bends_[index(row.a)].slope),
                                .limit = static_cast<float>(along_[index(row.a)].back()),
                                .amplitudes = amplitudes.data() + row.second,
                                .bends = bends.data() + row.second,
                                .slopes = list.slopes.data() + row.second,
                                .limits = list.limits.data() + row.second,
                                .correlation = list.correlation.data() + row.first,
                                .inverse = list.inverse.data() + row.first,
                                .log_weight = list.log_weight.data() + row.first,
                                .interaction = list.interaction.data() + row.first,
                                .gram_inverse = list.gram_inverse.data() + row.first,
                                .stride = n,
                                .size = (row.count + kPairLanes - 1) / kPairLanes * kPairLanes},
                               square, weight.data() + row.first, extra.data() + row.first));
  out.pairs.clear();
  out.weights.clear();
  out.fits.clear();
  // The pair with the largest weight: if its weight is uncertain, a fit gives a lower bound of the
  // largest final weight.
  const std::size_t top = index(std::ranges::max_element(weight) - weight.begin());
  int top_fit = -1;
  if (extra[top] > kSmallChange) {
    const auto row = std::prev(std::ranges::upper_bound(list.rows, top, {}, &PairList::Row::first));
    const int a = row->a, b = list.places[row->second + top - row->first];
    top_fit = 0;
    out.fits.push_back(
        fit_pair(measured.products, a, b, interaction_product(data, column_of_(a, b))));
    extra[top] = 0.0F;
    weight[top] = list.log_weight[top] + static_cast<float>(out.fits.back().exponent());
    out.most = std::max(out.most, weight[top]);
  }
  for (const PairList::Row& row : list.rows)
    for (std::size_t k = 0; k < row.count; ++k) {
      const std::size_t i = row.first + k;
      if (!(weight[i] + extra[i] > out.most - kNegligiblePair)) continue;
      out.pairs.push_back({.a = row.a,
                           .b = list.places[row.second + k],
                           .fit = i == top ? top_fit : -1,
                           .extra = extra[i],
                           .entry = i});
      out.weights.push_back(weight[i]);
    }
}

/// Replaces the weights of uncertain pairs by those of curved lines.
void NormalTest::fit_curved(const PairList& list, float square, Screened& out) const {
  thread_local std::vector<std::size_t> pairs;
  thread_local std::vector<float> arrays, exponents, extras;
  pairs.clear();
  for (std::size_t i = 0; i < out.pairs.size(); ++i)
    if (out.pairs[i].extra > kSmallChange && out.pairs[i].fit < 0 &&
        out.weights[i] + out.pairs[i].extra > out.most - kNegligiblePair)
      pairs.push_back(i);
  const std::size_t stride = (pairs.size() + kPairLanes - 1) / kPairLanes * kPairLanes;
  arrays.assign(CurvedPairs::count * stride, 0.0F);
  exponents.resize(stride);
  extras.resize(stride);
  // The cosine of two random directions of n data exceeds 3/√n with a probability of 0.3 %.
  const double cosine = std::min(1.0, 3.0 / std::sqrt(static_cast<double>(nodes_.rows())));
  for (std::size_t j = 0; j < pairs.size(); ++j) {
    const Screened::Candidate& c = out.pairs[pairs[j]];
    float* const to = arrays.data() + j;
    const auto set = [&](CurvedPairs::Array array, float value) { to[array * stride] = value; };
    const auto set_place = [&](std::size_t place, CurvedPairs::Array first) {
      const Bend& bend = bends_[place];
      const float values[] = {out.amplitude[place],
                              out.bend[place],
                              static_cast<float>(along_[place].back()),
                              static_cast<float>(bend.alpha),
                              static_cast<float>(bend.tau),
                              static_cast<float>(cosine * bend.rest)};
      for (std::size_t k = 0; k < std::size(values); ++k) to[(first + k) * stride] = values[k];
    };
    set_place(index(c.a), CurvedPairs::v_a);
    set_place(index(c.b), CurvedPairs::v_b);
    set(CurvedPairs::rho, list.correlation[c.entry]);
    set(CurvedPairs::vw, list.vw[c.entry]);
    set(CurvedPairs::wv, list.wv[c.entry]);
    set(CurvedPairs::ww, list.ww[c.entry]);
    set(CurvedPairs::interaction, list.interaction[c.entry]);
  }
  fit_curved_pairs({arrays.data(), stride, stride}, square, exponents.data(), extras.data());
  for (std::size_t j = 0; j < pairs.size(); ++j) {
    Screened::Candidate& c = out.pairs[pairs[j]];
    out.weights[pairs[j]] = list.log_weight[c.entry] + exponents[j];
    c.extra = extras[j];
    if (c.extra <= kSmallChange) out.most = std::max(out.most, out.weights[pairs[j]]);
  }
}

/// Fits the severities of pairs whose weights may change by more than kSmallChange, until no other
/// such pair can be relevant.
void NormalTest::fit_uncertain(const Measured& measured, const PairList& list, const float* data,
                               Screened& out) const {
  const auto fit = [&](std::size_t i) {
    Screened::Candidate& c = out.pairs[i];
    c.fit = static_cast<int>(out.fits.size());
    out.fits.push_back(
        fit_pair(measured.products, c.a, c.b, interaction_product(data, column_of_(c.a, c.b))));
    out.weights[i] = list.log_weight[c.entry] + static_cast<float>(out.fits.back().exponent());
    out.most = std::max(out.most, out.weights[i]);
  };
  const auto square = static_cast<float>(
      Eigen::Map<const Eigen::VectorXd>(measured.data, nodes_.rows()).squaredNorm());
  fit_curved(list, square, out);
  thread_local std::vector<std::pair<float, std::size_t>> uncertain;  // bound, index of the pair
  uncertain.clear();
  for (std::size_t i = 0; i < out.pairs.size(); ++i)
    if (out.pairs[i].extra > kSmallChange && out.pairs[i].fit < 0)
      uncertain.emplace_back(out.weights[i] + out.pairs[i].extra, i);
  std::ranges::make_heap(uncertain);
  for (; !uncertain.empty(); uncertain.pop_back()) {
    std::ranges::pop_heap(uncertain);
    const auto [bound, i] = uncertain.back();
    if (bound < out.most - kNegligiblePair) break;
    fit(i);
  }
  // The remaining pairs are irrelevant.
  for (const auto& [bound, i] : uncertain) out.weights[i] = kLowest;
}

void NormalTest::add_pairs(const Measured& measured, const PairList& list,
                           std::vector<Pair>& out) const {
  out.clear();
  thread_local Screened found;
  const float* const data = single_precision(measured);
  screen(measured, list, data, found);
  fit_uncertain(measured, list, data, found);
  std::vector<float>& weights = found.weights;
  const std::size_t count = weights.size();
  weights.resize((count + kPairLanes - 1) / kPairLanes * kPairLanes, kLowest);
  exponentials(weights.data(), weights.size(), found.most);
  const float negligible = std::exp(-kNegligiblePair);
  std::size_t kept = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (weights[i] < negligible) continue;
    found.pairs[kept] = found.pairs[i];
    weights[kept] = weights[i];
    sum += weights[i];
    ++kept;
  }
  const auto add = [&](const Screened::Candidate& c, double log_factor) {
    const double log_evidence =
        (c.fit >= 0 ? found.fits[index(c.fit)]
                    : fit_pair(measured.products, c.a, c.b,
                               interaction_product(data, column_of_(c.a, c.b))))
            .log_evidence();
    const double log_prior = std::log(places_[index(c.a)].prior * places_[index(c.b)].prior);
    out.push_back({c.a, c.b, log_evidence + log_prior - list.log_prior + log_factor});
  };
  // Keep all pairs above the threshold; each sampled pair below it represents several pairs.
  double threshold = sum * kSmallShare;
  if (kept > most_pairs_) {
    threshold = sum / static_cast<double>(most_pairs_);
    for (int pass = 0; pass < 4; ++pass) {
      std::size_t full = 0;
      double rest = 0.0;
      for (std::size_t i = 0; i < kept; ++i) {
        if (weights[i] >= threshold)
          ++full;
        else
          rest += weights[i];
      }
      if (full >= most_pairs_) break;
      threshold = rest / static_cast<double>(most_pairs_ - full);
    }
    threshold = std::max(threshold, sum * kSmallShare);
  }
  double passed = 0.5 * threshold;
  for (std::size_t i = 0; i < kept; ++i) {
    if (weights[i] >= threshold) {
      add(found.pairs[i], 0.0);
      continue;
    }
    passed += weights[i];
    if (passed < threshold) continue;
    passed -= threshold;
    add(found.pairs[i], std::log(threshold / weights[i]));
  }
}

}  // namespace wheeltap::identification::planning
