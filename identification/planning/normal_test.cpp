#include "identification/planning/normal_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;

/// Terms this far below the largest in ln p are neglected: e^-32.
constexpr double kNegligible = 32.0;

/// exp(x²) erfc(x), x >= 0.
double scaled_erfc(double x) {
  if (x < 20.0) return std::exp(x * x) * std::erfc(x);
  return std::numbers::inv_sqrtpi / x * (1.0 - 0.5 / (x * x));
}

double log_sum(const std::vector<double>& terms) {
  double most = -kInfinity, sum = 0.0;
  for (const double t : terms) most = std::max(most, t);
  if (!(most > -kInfinity)) return most;
  for (const double t : terms) sum += std::exp(t - most);
  return most + std::log(sum);
}

/// Nodes and weights of Gauss and Legendre on [-1, 1], the positive half of 16.
constexpr std::array<double, 8> kNodes = {
    0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
    0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr std::array<double, 8> kWeights = {
    0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
    0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

/// b x + c y - (hxx x² + 2 hxy x y + hyy y²) / 2 + constant over a rectangle.
struct Quadratic {
  double constant, bx, by, hxx, hxy, hyy;

  /// The best y for an x.
  [[nodiscard]] double best_y(double x, double low, double high) const {
    const double b = by - hxy * x;
    if (hyy > 0.0) return std::clamp(b / hyy, low, high);
    return b > 0.0 ? high : low;
  }
  [[nodiscard]] double best_x(double y, double low, double high) const {
    const double b = bx - hxy * y;
    if (hxx > 0.0) return std::clamp(b / hxx, low, high);
    return b > 0.0 ? high : low;
  }
  [[nodiscard]] double at(double x, double y) const {
    return constant + bx * x + by * y - 0.5 * (hxx * x * x + hyy * y * y) - hxy * x * y;
  }
  /// The best point of the rectangle.
  [[nodiscard]] std::array<double, 2> best(double x0, double x1, double y0, double y1) const {
    const double det = hxx * hyy - hxy * hxy;
    if (det > 1e-12 * hxx * hyy) {
      const double x = (bx * hyy - by * hxy) / det, y = (by * hxx - bx * hxy) / det;
      if (x >= x0 && x <= x1 && y >= y0 && y <= y1) return {x, y};
    }
    std::array<double, 2> found = {x0, best_y(x0, y0, y1)};
    for (const auto& [x, y] :
         {std::array{x1, best_y(x1, y0, y1)}, std::array{best_x(y0, x0, x1), y0},
          std::array{best_x(y1, x0, x1), y1}})
      if (at(x, y) > at(found[0], found[1])) found = {x, y};
    return found;
  }
  /// ln of the integral of its exponential, about the best point.
  [[nodiscard]] double log_integral(double x0, double x1, double y0, double y1,
                                    double best_x) const {
    if (x1 <= x0) return constant + log_normal_integral(by, hyy, y0, y1);
    const double curvature = std::max(hyy > 0.0 ? hxx - hxy * hxy / hyy : hxx, 1e-300);
    const double reach = 6.0 / std::sqrt(curvature);
    const double low = std::max(x0, best_x - reach), high = std::min(x1, best_x + reach);
    const double mid = 0.5 * (low + high), half = 0.5 * (high - low);
    std::array<double, 16> terms;
    double most = -kInfinity;
    for (std::size_t i = 0; i < 16; ++i) {
      const double x = mid + (i < 8 ? half : -half) * kNodes[i % 8];
      terms[i] = bx * x - 0.5 * hxx * x * x + log_normal_integral(by - hxy * x, hyy, y0, y1);
      most = std::max(most, terms[i]);
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < 16; ++i) sum += kWeights[i % 8] * std::exp(terms[i] - most);
    return constant + most + std::log(half * sum);
  }
};

}  // namespace

double log_normal_integral(double b, double h, double low, double high) {
  const double width = high - low;
  if (width <= 0.0) return b * low - 0.5 * h * low * low;
  // The exponent at both ends, and its slope there.
  const double slope = b - h * low, end_slope = b - h * high;
  if (h * width * width < 1e-9) {
    const double rise = 0.5 * (slope + end_slope) * width;
    const double from = b * low - 0.5 * h * low * low;
    return from + std::log(width) +
           (std::abs(rise) < 1e-6 ? 0.5 * rise
            : rise > 0.0          ? rise + std::log(-std::expm1(-rise) / rise)
                                  : std::log(std::expm1(rise) / rise));
  }
  const double root = std::sqrt(0.5 * h), scale = 0.5 * std::log(0.5 * kPi / h);
  if (slope > 0.0 && end_slope < 0.0)
    return 0.5 * b * b / h + scale +
           std::log(std::erf(-end_slope / h * root) + std::erf(slope / h * root));
  // The maximum is at one end.
  const double near = slope <= 0.0 ? -slope / h * root : end_slope / h * root;
  const double far = near + width * root;
  const double end = slope <= 0.0 ? low : high;
  return b * end - 0.5 * h * end * end + scale +
         std::log(scaled_erfc(near) - std::exp(near * near - far * far) * scaled_erfc(far));
}

/// The pairs of a model with two defects, with constants of their approximate weights.
struct NormalTest::PairList {
  std::vector<std::int32_t> a, b;
  std::vector<float> correlation, inverse;  // ρ of their directions, 1 / (1 - ρ²)
  std::vector<float> log_weight;            // prior, and share of the prior that fits
  std::vector<double> log_prior;
};

NormalTest::NormalTest(std::vector<NormalPlace> places, std::vector<NormalModel> models, int pairs)
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
    Index typical = own.cols() - 1;
    if (own.cols() > 2) typical = own.cols() / 2;
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
  for (std::size_t m = 0; m < models_.size(); ++m) {
    int total = 0;
    std::vector<int> kinds;
    for (std::size_t k = 0; k < models_[m].counts.size(); ++k) {
      total += models_[m].counts[k];
      for (int c = 0; c < models_[m].counts[k]; ++c) kinds.push_back(static_cast<int>(k));
    }
    if (total > 2) throw std::invalid_argument("a model has more than two defects");
    if (total == 0) intact_ = static_cast<int>(m);
    pairs_.push_back(nullptr);
    for (const int kind : kinds)
      if (std::ranges::none_of(places_, [&](const auto& p) { return p.kind == kind; }))
        throw std::invalid_argument("kind " + std::to_string(kind) + " has no place");
    if (total < 2) continue;
    auto list = std::make_shared<PairList>();
    double sum = 0.0;
    for (std::size_t a = 0; a < places_.size(); ++a) {
      if (places_[a].kind != kinds[0]) continue;
      for (std::size_t b = kinds[0] == kinds[1] ? a + 1 : 0; b < places_.size(); ++b) {
        if (places_[b].kind != kinds[1]) continue;
        const double prior = places_[a].prior * places_[b].prior;
        const double norms = typical_norm_[a] * typical_norm_[b];
        const double rho =
            norms > 0.0 ? nodes_.col(typical_[a]).dot(nodes_.col(typical_[b])) / norms : 0.0;
        const double room = std::max(1.0 - rho * rho, 1e-4);
        const auto share = [&](double top) {
          return std::log(std::min(1.0, 2.5 / std::max(top, 1e-9)));
        };
        list->a.push_back(static_cast<std::int32_t>(a));
        list->b.push_back(static_cast<std::int32_t>(b));
        list->correlation.push_back(static_cast<float>(rho));
        list->inverse.push_back(static_cast<float>(1.0 / room));
        list->log_weight.push_back(static_cast<float>(std::log(prior) + share(along_[a].back()) +
                                                      share(along_[b].back() * std::sqrt(room))));
        list->log_prior.push_back(std::log(prior));
        sum += prior;
      }
    }
    if (list->a.empty()) throw std::invalid_argument("two defects need two places; there is one");
    for (double& p : list->log_prior) p -= std::log(sum);
    pairs_.back() = std::move(list);
  }
  if (intact_ < 0) throw std::invalid_argument("no model is without defects");
}

Eigen::MatrixXd NormalTest::products(const Eigen::MatrixXd& data) const {
  return nodes_.transpose() * data;
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

double NormalTest::log_pair(const double* products, int a, int b) const {
  const auto segments = [&](int place) {
    return static_cast<double>(first_[index(place) + 1] - first_[index(place)] - 1);
  };
  const double sa = segments(a), sb = segments(b);
  // Begin at the amplitudes along the typical directions.
  const auto amplitude = [&](int place) {
    const double norm = typical_norm_[index(place)];
    return norm > 0.0 ? products[index(typical_[index(place)])] / norm : 0.0;
  };
  const auto position = [&](int place, double value) {
    const std::vector<double>& along = along_[index(place)];
    for (std::size_t i = 1; i < along.size(); ++i)
      if (along[i] >= value)
        return static_cast<double>(i - 1) +
               std::clamp((value - along[i - 1]) / std::max(along[i] - along[i - 1], 1e-300), 0.0,
                          1.0);
    return static_cast<double>(along.size() - 1);
  };
  const double norms = typical_norm_[index(a)] * typical_norm_[index(b)];
  const double rho =
      norms > 0.0 ? nodes_.col(typical_[index(a)]).dot(nodes_.col(typical_[index(b)])) / norms
                  : 0.0;
  const double ga = amplitude(a), gb = amplitude(b), room = std::max(1.0 - rho * rho, 1e-4);
  double ca = (ga - rho * gb) / room, cb = (gb - rho * ga) / room;
  if (ca < 0.0) {
    cb = std::max(gb, 0.0);
    ca = 0.0;
  } else if (cb < 0.0) {
    ca = std::max(ga, 0.0);
    cb = 0.0;
  }
  double pa = position(a, ca), pb = position(b, cb);
  Quadratic q{};
  double ia = 0.0, ib = 0.0;
  for (int step = 0; step < 4; ++step) {
    ia = std::clamp(std::floor(pa), 0.0, std::max(sa - 1.0, 0.0));
    ib = std::clamp(std::floor(pb), 0.0, std::max(sb - 1.0, 0.0));
    const Index na = first_[index(a)] + static_cast<Index>(ia);
    const Index nb = first_[index(b)] + static_cast<Index>(ib);
    const Index ta = sa > 0.0 ? na + 1 : na, tb = sb > 0.0 ? nb + 1 : nb;
    const double m00 = nodes_.col(na).dot(nodes_.col(nb));
    const double m10 = ta == na ? m00 : nodes_.col(ta).dot(nodes_.col(nb));
    const double m01 = tb == nb ? m00 : nodes_.col(na).dot(nodes_.col(tb));
    const double m11 = ta == na ? m01 : tb == nb ? m10 : nodes_.col(ta).dot(nodes_.col(tb));
    const auto along = [&](Index n, Index t) {
      return t == n ? 0.0
                    : products[t] - products[n] - (next_products_[index(n)] - squares_[index(n)]);
    };
    const auto square = [&](Index n, Index t) {
      return t == n ? 0.0
                    : std::max(0.0, squares_[index(t)] + squares_[index(n)] -
                                        2.0 * next_products_[index(n)]);
    };
    q = {.constant =
             products[na] + products[nb] - 0.5 * (squares_[index(na)] + squares_[index(nb)]) - m00,
         .bx = along(na, ta) - (m10 - m00),
         .by = along(nb, tb) - (m01 - m00),
         .hxx = square(na, ta),
         .hxy = m11 - m10 - m01 + m00,
         .hyy = square(nb, tb)};
    const auto [x, y] = q.best(-ia, sa - ia, -ib, sb - ib);
    const double to_a = std::clamp(ia + x, 0.0, sa), to_b = std::clamp(ib + y, 0.0, sb);
    const auto same = [](double to, double segment, double most) {
      return std::clamp(std::floor(to), 0.0, std::max(most - 1.0, 0.0)) == segment;
    };
    const bool done = same(to_a, ia, sa) && same(to_b, ib, sb);
    pa = to_a;
    pb = to_b;
    if (done) break;
  }
  return q.log_integral(-ia, sa - ia, -ib, sb - ib, pa - ia) - std::log(std::max(sa, 1.0)) -
         std::log(std::max(sb, 1.0));
}

void NormalTest::add_pairs(const double* products, const PairList& list,
                           std::vector<Pair>& out) const {
  out.clear();
  const std::size_t n = list.a.size();
  thread_local std::vector<float> amplitude, weight;
  amplitude.resize(places_.size());
  weight.resize(n);
  for (std::size_t a = 0; a < places_.size(); ++a)
    amplitude[a] = static_cast<float>(
        typical_norm_[a] > 0.0 ? products[index(typical_[a])] / typical_norm_[a] : 0.0);
  float most = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const float ga = amplitude[static_cast<std::size_t>(list.a[i])];
    const float gb = amplitude[static_cast<std::size_t>(list.b[i])], rho = list.correlation[i];
    const float fa = ga - rho * gb, fb = gb - rho * ga;
    const float one = std::max(0.0F, std::max(ga, gb));
    const float both = (ga * fa + gb * fb) * list.inverse[i];
    weight[i] = 0.5F * (fa > 0.0F && fb > 0.0F ? both : one * one) + list.log_weight[i];
    most = std::max(most, weight[i]);
  }
  double sum = 0.0;
  std::size_t alive = 0;
  for (std::size_t i = 0; i < n; ++i) {
    weight[i] = weight[i] < most - 24.0F ? 0.0F : std::exp(weight[i] - most);
    sum += static_cast<double>(weight[i]);
    alive += weight[i] > 0.0F;
  }
  const auto add = [&](std::size_t i, double log_factor) {
    const int a = list.a[i], b = list.b[i];
    out.push_back({a, b, log_pair(products, a, b) + list.log_prior[i] + log_factor});
  };
  if (alive <= most_pairs_) {
    for (std::size_t i = 0; i < n; ++i)
      if (weight[i] > 0.0F) add(i, 0.0);
    return;
  }
  // Pairs above the threshold count fully; the others stand for several.
  double threshold = sum / static_cast<double>(most_pairs_), rest = sum;
  std::size_t full = 0;
  for (int pass = 0; pass < 4; ++pass) {
    full = 0;
    rest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (static_cast<double>(weight[i]) >= threshold)
        ++full;
      else
        rest += static_cast<double>(weight[i]);
    }
    if (full >= most_pairs_) break;
    threshold = rest / static_cast<double>(most_pairs_ - full);
  }
  double passed = 0.5 * threshold;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(weight[i] > 0.0F)) continue;
    const auto w = static_cast<double>(weight[i]);
    if (w >= threshold) {
      add(i, 0.0);
      continue;
    }
    passed += w;
    if (passed < threshold) continue;
    passed -= threshold;
    add(i, std::log(threshold / w));
  }
}

void NormalTest::answer(const double* products, Answer& out) const {
  out.log_models.assign(models_.size(), 0.0);
  out.log_places.resize(places_.size());
  out.pairs.resize(models_.size());
  for (std::size_t a = 0; a < places_.size(); ++a)
    out.log_places[a] = log_place(products, static_cast<int>(a));
  std::vector<double> damaged, terms;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    out.pairs[m].clear();
    if (static_cast<int>(m) == intact_) continue;
    terms.clear();
    if (pairs_[m]) {
      add_pairs(products, *pairs_[m], out.pairs[m]);
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
