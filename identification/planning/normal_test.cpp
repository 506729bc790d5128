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
  /// Column of the interaction (-1: none), its square and its components along both directions.
  std::vector<std::int32_t> column;
  std::vector<float> square, along_a, along_b;
  std::vector<double> log_prior;
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
  interactions_.resize(rows, static_cast<Index>(interactions.size()));
  for (std::size_t i = 0; i < interactions.size(); ++i) {
    interactions_.col(static_cast<Index>(i)) = interactions[i].data;
    interaction_of_[{interactions[i].a, interactions[i].b}] = static_cast<Index>(i);
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
        const auto found = interaction_of_.find({static_cast<int>(a), static_cast<int>(b)});
        list->column.push_back(-1);
        list->square.push_back(0.0F);
        list->along_a.push_back(0.0F);
        list->along_b.push_back(0.0F);
        if (found != interaction_of_.end() && norms > 0.0) {
          const auto both = interactions_.col(found->second);
          list->column.back() = static_cast<std::int32_t>(found->second);
          list->square.back() = static_cast<float>(both.squaredNorm());
          list->along_a.back() =
              static_cast<float>(both.dot(nodes_.col(typical_[a])) / typical_norm_[a]);
          list->along_b.back() =
              static_cast<float>(both.dot(nodes_.col(typical_[b])) / typical_norm_[b]);
        }
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
  Eigen::MatrixXd out(nodes_.cols() + interactions_.cols(), data.cols());
  out.topRows(nodes_.cols()).noalias() = nodes_.transpose() * data;
  if (interactions_.cols() > 0)
    out.bottomRows(interactions_.cols()).noalias() = interactions_.transpose() * data;
  return out;
}

double NormalTest::log_pair_prior(int model, int a, int b) const {
  const PairList& list = *pairs_[index(model)];
  for (std::size_t i = 0; i < list.a.size(); ++i)
    if (list.a[i] == a && list.b[i] == b) return list.log_prior[i];
  return -kInfinity;
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
  const Index n = data();
  const auto segments = [&](int place) {
    return static_cast<double>(first_[index(place) + 1] - first_[index(place)] - 1);
  };
  const double sa = segments(a), sb = segments(b);
  const auto position = [&](int place, double value) {
    const std::vector<double>& along = along_[index(place)];
    for (std::size_t i = 1; i < along.size(); ++i)
      if (along[i] >= value)
        return static_cast<double>(i - 1) +
               std::clamp((value - along[i - 1]) / std::max(along[i] - along[i - 1], 1e-300), 0.0,
                          1.0);
    return static_cast<double>(along.size() - 1);
  };
  // Begin at the amplitudes along the typical directions, with the interaction.
  const double na = typical_norm_[index(a)], nb = typical_norm_[index(b)];
  const auto found = interaction_of_.find({a, b});
  const bool interacts = found != interaction_of_.end() && na > 0.0 && nb > 0.0;
  const double* both = interacts ? interactions_.col(found->second).data() : nullptr;
  const Eigen::Map<const Eigen::VectorXd> y(measured.data, n);
  double ca = 0.0, cb = 0.0;
  if (na > 0.0 && nb > 0.0) {
    const auto va = nodes_.col(typical_[index(a)]), vb = nodes_.col(typical_[index(b)]);
    const double rho = va.dot(vb) / (na * nb), room = std::max(1.0 - rho * rho, 1e-4);
    const double ga = measured.products[typical_[index(a)]] / na;
    const double gb = measured.products[typical_[index(b)]] / nb;
    double ia = 0.0, ib = 0.0;
    if (interacts) {
      const Eigen::Map<const Eigen::VectorXd> mixed(both, n);
      ia = mixed.dot(va) / na;
      ib = mixed.dot(vb) / nb;
    }
    for (int step = 0; step < (interacts ? 4 : 1); ++step) {
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
  double pa = position(a, ca), pb = position(b, cb);
  thread_local Eigen::VectorXd mean, slope_a, slope_b;
  mean.resize(n);
  slope_a.resize(n);
  slope_b.resize(n);
  const auto at = [&](int place, double p, double most, Eigen::VectorXd& slope, double& u,
                      double& du) {
    const double segment = std::clamp(std::floor(p), 0.0, std::max(most - 1.0, 0.0));
    const Index node = first_[index(place)] + static_cast<Index>(segment);
    const double t = p - segment, norm = typical_norm_[index(place)];
    const std::vector<double>& along = along_[index(place)];
    const auto i = static_cast<std::size_t>(segment);
    if (most > 0.0)
      slope = nodes_.col(node + 1) - nodes_.col(node);
    else
      slope.setZero();
    mean += nodes_.col(node) + t * slope;
    du = most > 0.0 && norm > 0.0 ? (along[i + 1] - along[i]) / norm : 0.0;
    u = norm > 0.0 ? along[i] / norm + t * du : 0.0;
  };
  Quadratic q{};
  for (int step = 0; step < 6; ++step) {
    double ua = 0.0, ub = 0.0, dua = 0.0, dub = 0.0;
    mean.setZero();
    at(a, pa, sa, slope_a, ua, dua);
    at(b, pb, sb, slope_b, ub, dub);
    if (interacts) {
      const Eigen::Map<const Eigen::VectorXd> mixed(both, n);
      mean += ua * ub * mixed;
      slope_a += dua * ub * mixed;
      slope_b += ua * dub * mixed;
    }
    q = {.constant = y.dot(mean) - 0.5 * mean.squaredNorm(),
         .bx = slope_a.dot(y - mean),
         .by = slope_b.dot(y - mean),
         .hxx = slope_a.squaredNorm(),
         .hxy = slope_a.dot(slope_b),
         .hyy = slope_b.squaredNorm()};
    const auto [x, z] = q.best(-pa, sa - pa, -pb, sb - pb);
    // At most one segment a step: slopes change between segments.
    const double to_a = std::clamp(pa + std::clamp(x, -1.0, 1.0), 0.0, sa);
    const double to_b = std::clamp(pb + std::clamp(z, -1.0, 1.0), 0.0, sb);
    const double moved = std::max(std::abs(to_a - pa), std::abs(to_b - pb));
    if (moved < 0.02 || step == 5) break;
    pa = to_a;
    pb = to_b;
  }
  const auto best = q.best(-pa, sa - pa, -pb, sb - pb);
  return q.log_integral(-pa, sa - pa, -pb, sb - pb, best[0]) - std::log(std::max(sa, 1.0)) -
         std::log(std::max(sb, 1.0));
}

void NormalTest::add_pairs(const Measured& measured, const PairList& list,
                           std::vector<Pair>& out) const {
  out.clear();
  const std::size_t n = list.a.size();
  thread_local std::vector<float> amplitude, norm, weight;
  amplitude.resize(places_.size());
  norm.resize(places_.size());
  weight.resize(n);
  for (std::size_t a = 0; a < places_.size(); ++a) {
    norm[a] = static_cast<float>(std::max(typical_norm_[a], 1e-30));
    amplitude[a] =
        typical_norm_[a] > 0.0
            ? static_cast<float>(measured.products[index(typical_[a])] / typical_norm_[a])
            : 0.0F;
  }
  const double* with_both = measured.products + nodes_.cols();
  float most = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const auto a = static_cast<std::size_t>(list.a[i]), b = static_cast<std::size_t>(list.b[i]);
    const float ga = amplitude[a], gb = amplitude[b], rho = list.correlation[i];
    const float one = std::max(0.0F, std::max(ga, gb));
    float best = 0.5F * one * one;
    float ca = (ga - rho * gb) * list.inverse[i], cb = (gb - rho * ga) * list.inverse[i];
    if (ca > 0.0F && cb > 0.0F) {
      const auto gain = [&](float by) {
        const float mixed =
            list.column[i] < 0 ? 0.0F : static_cast<float>(with_both[list.column[i]]);
        return ca * ga + cb * gb + by * mixed -
               0.5F * (ca * ca + cb * cb + by * by * list.square[i]) - rho * ca * cb -
               by * (ca * list.along_a[i] + cb * list.along_b[i]);
      };
      float by = 0.0F;
      if (list.column[i] >= 0)
        for (int step = 0; step < 3; ++step) {
          by = ca / norm[a] * cb / norm[b];
          const float fa = ga - by * list.along_a[i], fb = gb - by * list.along_b[i];
          ca = std::max(0.0F, (fa - rho * fb) * list.inverse[i]);
          cb = std::max(0.0F, (fb - rho * fa) * list.inverse[i]);
        }
      by = list.column[i] < 0 ? 0.0F : ca / norm[a] * cb / norm[b];
      best = std::max(best, gain(by));
    }
    weight[i] = best + list.log_weight[i];
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
    out.push_back({a, b, log_pair(measured, a, b) + list.log_prior[i] + log_factor});
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
