#include "identification/planning/normal_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "identification/planning/normal_kernels.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;

/// ln p of neglected terms is this far below the largest term: 32 for places, 18 for pairs.
constexpr double kNegligible = 32.0;
constexpr float kNegligiblePair = 18.0F;

double log_sum(const std::vector<double>& terms) {
  double most = -kInfinity, sum = 0.0;
  for (const double t : terms) most = std::max(most, t);
  if (!(most > -kInfinity)) return most;
  for (const double t : terms) sum += std::exp(t - most);
  return most + std::log(sum);
}

/// If the interaction of a pair changes the exponent by less, the pair's weight omits it.
constexpr float kSmallInteraction = 0.3F;

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
  double log_prior = 0.0;                   // ln Σ P(a) P(b) over the pairs
};

/// A defect at position p along the nodes of a place. Its effect is A = A_i + t (A_{i+1} - A_i)
/// with slope A'. Members are products of A and A' with the data and with each other, and the
/// component u of A along the typical node, with slope u'.
struct NormalTest::Position {
  Index node = 0, next = 0;
  std::size_t segment = 0;
  double t = 0.0;
  double y = 0.0, y_slope = 0.0;
  double square = 0.0, mixed = 0.0, slope_square = 0.0;  // A·A, A·A', A'·A'
  double u = 0.0, u_slope = 0.0;
};

NormalTest::NormalTest(std::vector<NormalPlace> places, std::vector<NormalModel> models, int pairs,
                       const std::vector<NormalInteraction>& interactions)
    : places_(std::move(places)),
      models_(std::move(models)),
      most_pairs_(static_cast<std::size_t>(std::max(pairs, 8))) {
  const Index rows = places_.empty() ? 0 : places_[0].nodes.rows();
  Index columns = 0;
  for (const NormalPlace& place : places_) {
    if (place.nodes.rows() != rows || place.nodes.cols() < 1)
      throw std::invalid_argument("every place must have the same number of data, and a node");
    first_.push_back(columns);
    columns += place.nodes.cols();
  }
  first_.push_back(columns);
  nodes_.resize(rows, columns);
  for (std::size_t a = 0; a < places_.size(); ++a) {
    const Eigen::MatrixXd& own = places_[a].nodes;
    nodes_.middleCols(first_[a], own.cols()) = own;
    const Index typical = typical_node(own.cols());
    const double norm = own.col(typical).norm();
    typical_.push_back(first_[a] + typical);
    typical_norm_.push_back(norm);
    std::vector<double>& along = along_.emplace_back();
    for (Index i = 0; i < own.cols(); ++i)
      along.push_back(norm > 0.0 ? own.col(i).dot(own.col(typical)) / norm : 0.0);
  }
  for (Index i = 0; i < columns; ++i) {
    squares_.push_back(nodes_.col(i).squaredNorm());
    next_products_.push_back(i + 1 < columns ? nodes_.col(i).dot(nodes_.col(i + 1)) : 0.0);
  }
  set_interactions(interactions);
  for (std::size_t m = 0; m < models_.size(); ++m) {
    std::vector<int> kinds;
    for (std::size_t k = 0; k < models_[m].counts.size(); ++k)
      kinds.insert(kinds.end(), index(models_[m].counts[k]), static_cast<int>(k));
    if (kinds.size() > 2) throw std::invalid_argument("a model has more than two defects");
    if (kinds.empty()) intact_ = static_cast<int>(m);
    for (const int kind : kinds)
      if (std::ranges::none_of(places_, [&](const auto& p) { return p.kind == kind; }))
        throw std::invalid_argument("kind " + std::to_string(kind) + " has no place");
    if (kinds.size() == 2 && gram_.size() == 0) gram_.noalias() = nodes_.transpose() * nodes_;
    pairs_.push_back(kinds.size() == 2 ? list_pairs(kinds) : nullptr);
  }
  if (intact_ < 0) throw std::invalid_argument("no model is without defects");
}

void NormalTest::set_interactions(const std::vector<NormalInteraction>& interactions) {
  const auto n = static_cast<Index>(places_.size());
  column_of_.setConstant(n, n, -1);
  interactions_.resize(nodes_.rows(), static_cast<Index>(interactions.size()));
  int column = 0;
  for (const NormalInteraction& one : interactions) {
    const double norms = typical_norm_[index(one.a)] * typical_norm_[index(one.b)];
    if (!(norms > 0.0)) continue;
    column_of_(one.a, one.b) = column;
    interactions_.col(column) = one.data;
    interaction_square_.push_back(one.data.squaredNorm());
    interaction_first_.push_back(interaction_nodes_.size());
    for (const int place : {one.a, one.b})
      for (Index i = first_[index(place)]; i < first_[index(place) + 1]; ++i)
        interaction_nodes_.push_back(one.data.dot(nodes_.col(i)));
    ++column;
  }
}

std::shared_ptr<const NormalTest::PairList> NormalTest::list_pairs(
    const std::vector<int>& kinds) const {
  auto list = std::make_shared<PairList>();
  list->kinds = kinds;
  for (std::size_t b = 0; b < places_.size(); ++b)
    if (places_[b].kind == kinds[1]) list->places.push_back(static_cast<int>(b));
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
      sum += prior;
      ++row.count;
    }
    while (list->correlation.size() % kPairLanes != 0) {
      list->correlation.push_back(0.0F);
      list->inverse.push_back(1.0F);
      list->log_weight.push_back(-std::numeric_limits<float>::infinity());
      list->interaction.push_back(0.0F);
    }
    if (row.count > 0) list->rows.push_back(row);
  }
  if (list->rows.empty()) throw std::invalid_argument("two defects need two places; there is one");
  list->log_prior = std::log(sum);
  return list;
}

Eigen::MatrixXd NormalTest::products(const Eigen::MatrixXd& data) const {
  return nodes_.transpose() * data;
}

double NormalTest::interaction_product(const Measured& measured, Index column) const {
  return column < 0 ? 0.0
                    : interactions_.col(column).dot(
                          Eigen::Map<const Eigen::VectorXd>(measured.data, nodes_.rows()));
}

double NormalTest::log_pair_prior(int model, int a, int b) const {
  const PairList& list = *pairs_[index(model)];
  if (places_[index(a)].kind != list.kinds[0] || places_[index(b)].kind != list.kinds[1])
    return -kInfinity;
  return std::log(places_[index(a)].prior) + std::log(places_[index(b)].prior) - list.log_prior;
}

double NormalTest::log_place(const double* products, int a) const {
  const auto first = index(first_[index(a)]), end = index(first_[index(a) + 1]);
  if (end - first == 1) return products[first] - 0.5 * squares_[first];
  double most = -kInfinity;
  for (std::size_t i = first; i < end; ++i) most = std::max(most, products[i] - 0.5 * squares_[i]);
  std::array<double, 64> terms;
  std::size_t count = 0;
  for (std::size_t i = first; i + 1 < end; ++i) {
    const double at = products[i] - 0.5 * squares_[i];
    const double b = products[i + 1] - products[i] - (next_products_[i] - squares_[i]);
    const double h = std::max(0.0, squares_[i + 1] + squares_[i] - 2.0 * next_products_[i]);
    const double peak = b <= 0.0 ? at : b >= h ? at + b - 0.5 * h : at + 0.5 * b * b / h;
    if (peak < most - kNegligible) continue;
    terms[count++] = at + log_normal_integral(b, h, 0.0, 1.0);
    most = std::max(most, terms[count - 1]);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += std::exp(terms[i] - most);
  return most + std::log(sum / static_cast<double>(end - first - 1));
}

double NormalTest::log_pair(const Measured& measured, int a, int b) const {
  return pair_evidence(measured.products, a, b, interaction_product(measured, column_of_(a, b)));
}

NormalTest::Position NormalTest::position(const double* products, int place, double p) const {
  const std::vector<double>& along = along_[index(place)];
  const double norm = typical_norm_[index(place)];
  const std::size_t last = along.size() - 1;
  Position out;
  out.segment = std::min(static_cast<std::size_t>(std::max(p, 0.0)), last > 0 ? last - 1 : 0);
  out.node = first_[index(place)] + static_cast<Index>(out.segment);
  out.next = last > 0 ? out.node + 1 : out.node;  // one node: the slope is 0
  out.t = p - static_cast<double>(out.segment);
  const double square = squares_[index(out.node)], cross = gram_(out.node, out.next);
  out.y_slope = products[out.next] - products[out.node];
  out.y = products[out.node] + out.t * out.y_slope;
  out.slope_square = std::max(0.0, squares_[index(out.next)] + square - 2.0 * cross);
  out.mixed = cross - square + out.t * out.slope_square;
  out.square = square + out.t * (cross - square + out.mixed);
  if (norm > 0.0) {
    out.u_slope = last > 0 ? (along[out.segment + 1] - along[out.segment]) / norm : 0.0;
    out.u = along[out.segment] / norm + out.t * out.u_slope;
  }
  return out;
}

/// `mixed` = y · I. All quantities follow from products of nodes, interaction and data.
double NormalTest::pair_evidence(const double* products, int a, int b, double mixed) const {
  const auto segments = [&](int place) {
    return static_cast<double>(along_[index(place)].size() - 1);
  };
  const double sa = segments(a), sb = segments(b);
  const int column = column_of_(a, b);
  const double* const with_a =
      column < 0 ? nullptr : interaction_nodes_.data() + interaction_first_[index(column)];
  const double* const with_b = column < 0 ? nullptr : with_a + along_[index(a)].size();
  const double square = column < 0 ? 0.0 : interaction_square_[index(column)];
  // Start from the best amplitudes along the typical directions, interaction included.
  const double na = typical_norm_[index(a)], nb = typical_norm_[index(b)];
  double ca = 0.0, cb = 0.0;
  if (na > 0.0 && nb > 0.0) {
    const Index va = typical_[index(a)], vb = typical_[index(b)];
    const double rho = gram_(va, vb) / (na * nb), room = std::max(1.0 - rho * rho, 1e-4);
    const double ga = products[va] / na, gb = products[vb] / nb;
    const double ia = column < 0 ? 0.0 : with_a[va - first_[index(a)]] / na;
    const double ib = column < 0 ? 0.0 : with_b[vb - first_[index(b)]] / nb;
    for (int step = 0; step < (column < 0 ? 1 : 4); ++step) {
      const double by = ca / na * cb / nb, fa = ga - by * ia, fb = gb - by * ib;
      ca = (fa - rho * fb) / room;
      cb = (fb - rho * fa) / room;
      if (ca < 0.0) {
        cb = std::max(fb, 0.0);
        ca = 0.0;
      } else if (cb < 0.0) {
        ca = std::max(fa, 0.0);
        cb = 0.0;
      }
    }
  }
  const auto start = [&](int place, double value) {
    const std::vector<double>& along = along_[index(place)];
    for (std::size_t i = 1; i < along.size(); ++i)
      if (along[i] >= value)
        return static_cast<double>(i - 1) +
               std::clamp((value - along[i - 1]) / std::max(along[i] - along[i - 1], 1e-300), 0.0,
                          1.0);
    return static_cast<double>(along.size() - 1);
  };
  double pa = start(a, ca), pb = start(b, cb);
  Quadratic q{};
  Rectangle r{};
  std::array<double, 2> best{};
  for (int step = 0;; ++step) {
    const Position at = position(products, a, pa), bt = position(products, b, pb);
    const double g00 = gram_(bt.node, at.node), g10 = gram_(bt.node, at.next),
                 g01 = gram_(bt.next, at.node), g11 = gram_(bt.next, at.next);
    const double slope_node = g10 - g00, slope_next = g11 - g01;   // A' · nodes of b
    const double slopes = slope_next - slope_node;                 // A' · B'
    const double slope_b = slope_node + bt.t * slopes;             // A' · B
    const double b_slope = g01 - g00 + at.t * slopes;              // A · B'
    const double both = g00 + at.t * slope_node + bt.t * b_slope;  // A · B
    double ia = 0.0, ib = 0.0, ia_slope = 0.0, ib_slope = 0.0;     // products with I
    if (column >= 0) {
      ia_slope = with_a[at.segment + index(at.next - at.node)] - with_a[at.segment];
      ib_slope = with_b[bt.segment + index(bt.next - bt.node)] - with_b[bt.segment];
      ia = with_a[at.segment] + at.t * ia_slope;
      ib = with_b[bt.segment] + bt.t * ib_slope;
    }
    // The mean is A + B + w I, with slopes A' + α I and B' + β I.
    const double w = at.u * bt.u, alpha = at.u_slope * bt.u, beta = at.u * bt.u_slope;
    const double i_rest = mixed - ia - ib - w * square;  // I · (y - mean)
    q = {.constant = at.y + bt.y + w * mixed - 0.5 * (at.square + bt.square + w * w * square) -
                     both - w * (ia + ib),
         .bx = at.y_slope - at.mixed - slope_b - w * ia_slope + alpha * i_rest,
         .by = bt.y_slope - bt.mixed - b_slope - w * ib_slope + beta * i_rest,
         .hxx = std::max(0.0, at.slope_square + alpha * (2.0 * ia_slope + alpha * square)),
         .hxy = slopes + beta * ia_slope + alpha * ib_slope + alpha * beta * square,
         .hyy = std::max(0.0, bt.slope_square + beta * (2.0 * ib_slope + beta * square))};
    r = {-pa, sa - pa, -pb, sb - pb};
    best = best_point(q, r);
    // Move at most one segment per step, because slopes change between segments.
    const double to_a = std::clamp(pa + std::clamp(best[0], -1.0, 1.0), 0.0, sa);
    const double to_b = std::clamp(pb + std::clamp(best[1], -1.0, 1.0), 0.0, sb);
    const double moved = std::max(std::abs(to_a - pa), std::abs(to_b - pb));
    if (moved < 0.02 || step == 5) break;
    pa = to_a;
    pb = to_b;
  }
  return log_integral(q, r, best) - std::log(std::max(sa, 1.0) * std::max(sb, 1.0));
}

/// The largest exponent over the amplitudes of one defect, or of two defects that interact.
double NormalTest::interacting_exponent(int a, int b, Index column, double ga, double gb,
                                        double rho, double mixed) const {
  const double na = typical_norm_[index(a)], nb = typical_norm_[index(b)];
  const double* const with_a = interaction_nodes_.data() + interaction_first_[index(column)];
  const double* const with_b = with_a + along_[index(a)].size();
  const double ia = with_a[typical_[index(a)] - first_[index(a)]] / na;
  const double ib = with_b[typical_[index(b)] - first_[index(b)]] / nb;
  const double room = std::max(1.0 - rho * rho, 1e-4);
  double ca = std::max(0.0, (ga - rho * gb) / room), cb = std::max(0.0, (gb - rho * ga) / room);
  for (int step = 0; step < 3; ++step) {
    const double by = ca / na * cb / nb, fa = ga - by * ia, fb = gb - by * ib;
    ca = std::max(0.0, (fa - rho * fb) / room);
    cb = std::max(0.0, (fb - rho * fa) / room);
  }
  const double by = ca / na * cb / nb;
  const double two = ca * ga + cb * gb + by * mixed -
                     0.5 * (ca * ca + cb * cb + by * by * interaction_square_[index(column)]) -
                     rho * ca * cb - by * (ca * ia + cb * ib);
  const double one = std::max({0.0, ga, gb});
  return std::max(0.5 * one * one, two);
}

void NormalTest::add_pairs(const Measured& measured, const PairList& list,
                           std::vector<Pair>& out) const {
  out.clear();
  const std::size_t n = list.correlation.size();
  thread_local std::vector<float> amplitude, second, weight, extra;
  amplitude.resize(places_.size());
  second.assign(list.places.size() + kPairLanes, 0.0F);
  weight.resize(n);
  extra.resize(n);
  for (std::size_t a = 0; a < places_.size(); ++a)
    amplitude[a] =
        typical_norm_[a] > 0.0
            ? static_cast<float>(measured.products[index(typical_[a])] / typical_norm_[a])
            : 0.0F;
  for (std::size_t k = 0; k < list.places.size(); ++k) second[k] = amplitude[index(list.places[k])];
  const auto square = static_cast<float>(
      Eigen::Map<const Eigen::VectorXd>(measured.data, nodes_.rows()).squaredNorm());
  float most = -std::numeric_limits<float>::infinity();
  for (const PairList::Row& row : list.rows)
    most = std::max(most,
                    screen_pairs({.amplitude = amplitude[index(row.a)],
                                  .amplitudes = second.data() + row.second,
                                  .correlation = list.correlation.data() + row.first,
                                  .inverse = list.inverse.data() + row.first,
                                  .log_weight = list.log_weight.data() + row.first,
                                  .interaction = list.interaction.data() + row.first,
                                  .size = (row.count + kPairLanes - 1) / kPairLanes * kPairLanes},
                                 square, weight.data() + row.first, extra.data() + row.first));
  // Pairs with a relevant weight. The weight includes the interaction if this changes the weight.
  struct Candidate {
    int a = 0, b = 0;
    double weight = 0.0;  // at first ln of the weight
    double mixed = kNaN;  // y · I, if known
  };
  thread_local std::vector<Candidate> alive;
  alive.clear();
  for (const PairList::Row& row : list.rows)
    for (std::size_t k = 0; k < row.count; ++k) {
      const std::size_t i = row.first + k;
      if (!(weight[i] + extra[i] > most - kNegligiblePair)) continue;
      Candidate c{.a = row.a, .b = list.places[row.second + k], .weight = weight[i]};
      if (extra[i] > kSmallInteraction) {
        const Index column = column_of_(c.a, c.b);
        c.mixed = interaction_product(measured, column);
        c.weight = list.log_weight[i] +
                   interacting_exponent(c.a, c.b, column, amplitude[index(c.a)],
                                        amplitude[index(c.b)], list.correlation[i], c.mixed);
      }
      most = std::max(most, static_cast<float>(c.weight));
      alive.push_back(c);
    }
  std::erase_if(alive, [&](const Candidate& c) { return c.weight < most - kNegligiblePair; });
  double sum = 0.0;
  for (Candidate& c : alive) {
    c.weight = std::exp(c.weight - static_cast<double>(most));
    sum += c.weight;
  }
  const auto add = [&](const Candidate& c, double log_factor) {
    const double mixed =
        std::isnan(c.mixed) ? interaction_product(measured, column_of_(c.a, c.b)) : c.mixed;
    const double log_prior = std::log(places_[index(c.a)].prior * places_[index(c.b)].prior);
    out.push_back({c.a, c.b,
                   pair_evidence(measured.products, c.a, c.b, mixed) + log_prior - list.log_prior +
                       log_factor});
  };
  if (alive.size() <= most_pairs_) {
    for (const Candidate& c : alive) add(c, 0.0);
    return;
  }
  // Keep all pairs above the threshold; each sampled pair below it represents several pairs.
  double threshold = sum / static_cast<double>(most_pairs_);
  for (int pass = 0; pass < 4; ++pass) {
    std::size_t full = 0;
    double rest = 0.0;
    for (const Candidate& c : alive) {
      if (c.weight >= threshold)
        ++full;
      else
        rest += c.weight;
    }
    if (full >= most_pairs_) break;
    threshold = rest / static_cast<double>(most_pairs_ - full);
  }
  double passed = 0.5 * threshold;
  for (const Candidate& c : alive) {
    if (c.weight >= threshold) {
      add(c, 0.0);
      continue;
    }
    passed += c.weight;
    if (passed < threshold) continue;
    passed -= threshold;
    add(c, std::log(threshold / c.weight));
  }
}

void NormalTest::answer(const Measured& measured, Answer& out) const {
  out.log_models.assign(models_.size(), 0.0);
  out.log_places.resize(places_.size());
  out.pairs.resize(models_.size());
  for (std::size_t a = 0; a < places_.size(); ++a)
    out.log_places[a] = log_place(measured.products, static_cast<int>(a));
  std::vector<double> damaged, terms;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    out.pairs[m].clear();
    if (static_cast<int>(m) == intact_) continue;
    terms.clear();
    if (pairs_[m]) {
      add_pairs(measured, *pairs_[m], out.pairs[m]);
      for (const Pair& pair : out.pairs[m]) terms.push_back(pair.log_weight);
    } else {
      for (std::size_t a = 0; a < places_.size(); ++a)
        if (models_[m].counts[index(places_[a].kind)] == 1 && places_[a].prior > 0.0)
          terms.push_back(out.log_places[a] + std::log(places_[a].prior));
    }
    out.log_models[m] = log_sum(terms);
    damaged.push_back(out.log_models[m] + std::log(models_[m].prior));
  }
  out.log_odds = log_sum(damaged) - std::log(models_[index(intact_)].prior);
  damaged.push_back(std::log(models_[index(intact_)].prior));
  out.log_all = log_sum(damaged);
}

}  // namespace wheeltap::identification::planning
