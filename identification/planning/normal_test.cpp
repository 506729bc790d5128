#include "identification/planning/normal_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

/// ln p of neglected terms is this far below the largest term.
constexpr double kNegligible = 32.0;

double log_sum_of(const std::vector<double>& terms) {
  double most = -kInfinity, sum = 0.0;
  for (const double t : terms) most = std::max(most, t);
  if (!(most > -kInfinity)) return most;
  for (const double t : terms) sum += std::exp(t - most);
  return most + std::log(sum);
}

/// The direction in which the nodes of a place deviate most from its typical direction.
NormalTest::Bend find_bend(const Eigen::MatrixXd& nodes, const std::vector<double>& along) {
  NormalTest::Bend out{.of_nodes = Eigen::VectorXd::Zero(nodes.cols())};
  const Index typical = typical_node(nodes.cols());
  if (!(along[index(typical)] > 0.0)) return out;
  // Rounding errors decide on the direction of an effect near 0.
  const double least = 1e-3 * along[index(typical)];
  // The largest deviation d; y · d / |d| follows from the products of y with two nodes.
  double most = 0.0;
  Index bent = typical;
  for (Index i = 0; i < nodes.cols(); ++i) {
    const double deviation =
        std::sqrt(std::max(0.0, nodes.col(i).squaredNorm() - along[index(i)] * along[index(i)]));
    if (along[index(i)] > least) out.slope = std::max(out.slope, deviation / along[index(i)]);
    if (deviation > most) {
      most = deviation;
      bent = i;
    }
  }
  if (!(most > 1e-6 * along[index(typical)])) return out;
  out.of_nodes[bent] = 1.0 / most;
  out.of_nodes[typical] -= along[index(bent)] / along[index(typical)] / most;
  const Eigen::VectorXd v = nodes.col(typical) / along[index(typical)], w = nodes * out.of_nodes;
  out.tau = along[index(typical)];
  const double apart = along[index(bent)] * (along[index(bent)] - out.tau);
  out.alpha = std::abs(apart) > 1e-6 * out.tau * out.tau ? most / apart : 0.0;
  out.rest = 0.0;
  for (Index i = 0; i < nodes.cols(); ++i)
    if (const double c = along[index(i)]; c > least)
      out.rest =
          std::max(out.rest, (nodes.col(i) - c * v - out.alpha * c * (c - out.tau) * w).norm() / c);
  return out;
}

}  // namespace

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
      throw std::invalid_argument(
          "every location must have a node, and all locations must have the same number of data");
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
    bends_.push_back(find_bend(own, along));
  }
  for (Index i = 0; i < columns; ++i) {
    squares_.push_back(nodes_.col(i).squaredNorm());
    next_products_.push_back(i + 1 < columns ? nodes_.col(i).dot(nodes_.col(i + 1)) : 0.0);
  }
  const auto height = index(rows), width = index(columns);
  tiles_.assign((width + kTile - 1) / kTile * kTile * height, 0.0);
  for (std::size_t c = 0; c < width; ++c)
    for (std::size_t r = 0; r < height; ++r)
      tiles_[c / kTile * kTile * height + r * kTile + c % kTile] =
          nodes_(static_cast<Index>(r), static_cast<Index>(c));
  set_interactions(interactions);
  for (std::size_t m = 0; m < models_.size(); ++m) {
    std::vector<int> kinds;
    for (std::size_t k = 0; k < models_[m].counts.size(); ++k)
      kinds.insert(kinds.end(), index(models_[m].counts[k]), static_cast<int>(k));
    if (kinds.size() > 2) throw std::invalid_argument("a model has more than two defects");
    if (kinds.empty()) intact_ = static_cast<int>(m);
    for (const int kind : kinds)
      if (std::ranges::none_of(places_, [&](const auto& p) { return p.kind == kind; }))
        throw std::invalid_argument("kind " + std::to_string(kind) + " has no location");
    if (kinds.size() == 2 && gram_.size() == 0) gram_ = products(nodes_);
    pairs_.push_back(kinds.size() == 2 ? list_pairs(kinds) : nullptr);
  }
  if (intact_ < 0) throw std::invalid_argument("no model is without defects");
}

void NormalTest::set_interactions(const std::vector<NormalInteraction>& interactions) {
  const auto n = static_cast<Index>(places_.size());
  column_of_.setConstant(n, n, -1);
  constexpr auto kLanes = static_cast<Index>(kPairLanes);
  interactions_.setZero((nodes_.rows() + kLanes - 1) / kLanes * kLanes,
                        static_cast<Index>(interactions.size()));
  int column = 0;
  for (const NormalInteraction& one : interactions) {
    const double norms = typical_norm_[index(one.a)] * typical_norm_[index(one.b)];
    if (!(norms > 0.0)) continue;
    column_of_(one.a, one.b) = column;
    interactions_.col(column).head(one.data.size()) = one.data.cast<float>();
    interaction_square_.push_back(one.data.squaredNorm());
    interaction_first_.push_back(interaction_nodes_.size());
    for (const int place : {one.a, one.b})
      for (Index i = first_[index(place)]; i < first_[index(place) + 1]; ++i)
        interaction_nodes_.push_back(one.data.dot(nodes_.col(i)));
    ++column;
  }
}

Eigen::MatrixXd NormalTest::products(const Eigen::MatrixXd& data) const {
  const Index rows = nodes_.rows(), columns = nodes_.cols(), count = data.cols();
  constexpr auto kWidth = static_cast<Index>(kTile);
  Eigen::MatrixXd out(columns, count), rest;
  for (Index first = 0; first < columns; first += kWidth) {
    const double* const tile = tiles_.data() + first * rows;
    if (first + kWidth <= columns) {
      products_with_tile(tile, index(rows), data.data(), index(count), out.data() + first,
                         index(columns));
    } else {
      rest.resize(kWidth, count);
      products_with_tile(tile, index(rows), data.data(), index(count), rest.data(), kTile);
      out.bottomRows(columns - first) = rest.topRows(columns - first);
    }
  }
  return out;
}

double NormalTest::interaction_product(const float* data, Index column) const {
  return column < 0
             ? 0.0
             : scalar_product(interactions_.col(column).data(), data, index(interactions_.rows()));
}

const float* NormalTest::single_precision(const Measured& measured) const {
  thread_local std::vector<float> data;
  data.assign(std::max(index(interactions_.rows()), index(nodes_.rows())), 0.0F);
  for (std::size_t r = 0; r < index(nodes_.rows()); ++r)
    data[r] = static_cast<float>(measured.data[r]);
  return data.data();
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
  return fit_pair(measured.products, a, b,
                  interaction_product(single_precision(measured), column_of_(a, b)))
      .log_evidence();
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
NormalTest::Fit NormalTest::fit_pair(const double* products, int a, int b, double mixed) const {
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
  return {q, r, best, std::log(std::max(sa, 1.0) * std::max(sb, 1.0))};
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
    out.log_models[m] = log_sum_of(terms);
    damaged.push_back(out.log_models[m] + std::log(models_[m].prior));
  }
  out.log_odds = log_sum_of(damaged) - std::log(models_[index(intact_)].prior);
  damaged.push_back(std::log(models_[index(intact_)].prior));
  out.log_all = log_sum_of(damaged);
}

}  // namespace wheeltap::identification::planning
