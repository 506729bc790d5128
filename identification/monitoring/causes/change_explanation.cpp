#include "identification/monitoring/causes/change_explanation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using inference::log_sum_exp;

constexpr std::array kInflations{0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};  // κ
constexpr std::array kFaultSizes{0.5, 1.5, 5.0, 15.0, 50.0};
constexpr std::array kOffsetSizes{0.1, 0.3, 1.0, 3.0};
constexpr std::size_t kThermometerInflations = 4;  // the first of kInflations
constexpr int kBinsPerSegment = 8;                 // bins of severity

double log_mean(double sum, std::size_t n) {
  return sum - std::log(static_cast<double>(n));
}

/// The exponent -½ q(t)/v with q(t) = a t² + 2 b t + c, on a segment t in [0, 1].
struct Segment {
  double a = 0.0, b = 0.0, c = 0.0;

  /// ln ∫ exp(-½ q(t)/v) dt.
  [[nodiscard]] double log_integral(double v) const {
    const double s = std::sqrt(a / v);
    if (s < 1e-2) {  // Simpson's rule
      const auto at = [&](double t) { return -0.5 * ((a * t + 2.0 * b) * t + c) / v; };
      return log_sum_exp(log_sum_exp(at(0.0), at(1.0)), std::log(4.0) + at(0.5)) - std::log(6.0);
    }
    double low = b / a * s, high = low + s;
    if (low > 0.0) {  // the lower tail is more accurate
      std::swap(low, high);
      low = -low;
      high = -high;
    }
    return -0.5 * (c - b * b / a) / v + 0.5 * std::log(kTwoPi * v / a) +
           inference::log_diff_exp(inference::log_normal_cdf(high), inference::log_normal_cdf(low));
  }
  [[nodiscard]] Segment part(int i, int parts) const {
    const double h = 1.0 / parts, t = i * h;
    return {a * h * h, (a * t + b) * h, (a * t + 2.0 * b) * t + c};
  }
  [[nodiscard]] double least() const {
    const double t = a > 0.0 ? std::clamp(-b / a, 0.0, 1.0) : (b < 0.0 ? 1.0 : 0.0);
    return std::max(0.0, (a * t + 2.0 * b) * t + c);
  }
};

Segment segment_of(const ShiftLikelihood::Component& one, const VectorXd& from,
                   const VectorXd& step) {
  const VectorXd d = from - one.mean, pulled = one.precision * d;
  return {.a = std::max(0.0, step.dot(one.precision * step)),
          .b = step.dot(pulled),
          .c = std::max(0.0, d.dot(pulled))};
}

/// A probability mass, uniform on an interval of a line, used to compute quantiles.
struct Mass {
  double from, to, mass;

  /// The mass below x.
  [[nodiscard]] double below(double x) const {
    const double low = std::min(from, to), length = std::abs(to - from);
    if (!(length > 0.0)) return x >= low ? mass : 0.0;
    return mass * std::clamp((x - low) / length, 0.0, 1.0);
  }
};

/// Quantile of masses whose intervals may overlap, by bisection.
double quantile_of(const std::vector<Mass>& masses, double total, double share) {
  constexpr int kHalvings = 100;
  double low = kInfinity, high = -kInfinity;
  for (const Mass& m : masses) {
    if (!(m.mass > 0.0)) continue;
    low = std::min({low, m.from, m.to});
    high = std::max({high, m.from, m.to});
  }
  if (!(low <= high)) return kNaN;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    double below = 0.0;
    for (const Mass& m : masses) below += m.below(middle);
    (below >= share * total ? high : low) = middle;
  }
  return high;
}

CentralInterval interval_of(const std::vector<Mass>& masses) {
  double total = 0.0;
  for (const Mass& m : masses) total += m.mass;
  return {quantile_of(masses, total, 0.05), quantile_of(masses, total, 0.5),
          quantile_of(masses, total, 0.95)};
}

class Explainer {
 public:
  Explainer(const ShiftLikelihood& likelihood, const CauseOptions& options)
      : likelihood_(likelihood), options_(options) {
    for (const auto& one : likelihood.components) informed_.push_back(informed(one));
  }

  /// Adds the evidence of a path for each inflation κ, by exact integrals over its segments.
  void add(const DefectPath& path, double log_weight, std::vector<double>& evidence,
           std::vector<Mass>* severities, double* mass, double scale) const {
    const auto nodes = static_cast<Index>(path.severities.size());
    const Index segments = std::max<Index>(1, nodes - 1);
    const double log_each = log_weight - std::log(static_cast<double>(segments));
    for (Index s = 0; s < segments; ++s) {
      const VectorXd from = path.shifts.col(s);
      const VectorXd step =
          nodes > 1 ? VectorXd(path.shifts.col(s + 1) - from) : VectorXd::Zero(from.size());
      if (!from.allFinite() || !step.allFinite()) continue;
      for (std::size_t k = 0; k < likelihood_.components.size(); ++k) {
        const auto& one = likelihood_.components[k];
        const Segment segment = segment_of(one, from, step);
        const double log_one = one.log_weight + log_each;
        if (severities == nullptr) {
          for (std::size_t i = 0; i < evidence.size(); ++i) {
            const double v = 1.0 + kInflations[i] * kInflations[i];
            evidence[i] = log_sum_exp(
                evidence[i], log_one - 0.5 * informed_[k] * std::log(v) + segment.log_integral(v));
          }
          continue;
        }
        const double whole = std::exp(log_one + segment.log_integral(1.0) - scale);
        *mass += whole;
        if (whole < 1e-9) continue;
        const double low = path.severities[index(s)];
        const double high = path.severities[index(std::min(s + 1, nodes - 1))];
        for (int i = 0; i < kBinsPerSegment; ++i) {
          const double h = (high - low) / kBinsPerSegment;
          severities->push_back(
              {low + i * h, low + (i + 1) * h,
               std::exp(log_one - std::log(static_cast<double>(kBinsPerSegment)) +
                        segment.part(i, kBinsPerSegment).log_integral(1.0) - scale)});
        }
      }
    }
  }

  /// ln of the evidence of δ = d s, s ~ N(0, sd²); the covariance of L is multiplied by 1 + κ².
  [[nodiscard]] double along(const VectorXd& d, double sd, double inflation) const {
    const double v = 1.0 + inflation * inflation;
    double sum = -kInfinity;
    for (std::size_t k = 0; k < likelihood_.components.size(); ++k) {
      const auto& one = likelihood_.components[k];
      const VectorXd pulled = one.precision * one.mean;
      const double a = d.dot(one.precision * d) / v, h = d.dot(pulled) / v;
      sum = log_sum_exp(
          sum, one.log_weight - 0.5 * informed_[k] * std::log(v) - 0.5 * one.mean.dot(pulled) / v +
                   0.5 * h * h / (a + 1.0 / (sd * sd)) - 0.5 * std::log1p(a * sd * sd));
    }
    return sum;
  }

  /// Distance from a path, in standard deviations of the component of L with most weight.
  [[nodiscard]] double distance(const DefectPath& path) const {
    double least = kInfinity;
    const auto nodes = static_cast<Index>(path.severities.size());
    for (Index s = 0; s < std::max<Index>(1, nodes - 1); ++s) {
      const VectorXd from = path.shifts.col(s);
      const VectorXd step =
          nodes > 1 ? VectorXd(path.shifts.col(s + 1) - from) : VectorXd::Zero(from.size());
      if (from.allFinite() && step.allFinite())
        least = std::min(least, segment_of(likelihood_.components.front(), from, step).least());
    }
    return std::sqrt(least);
  }

 private:
  /// Number of directions of the shift that the rows say something about: the rank of the precision
  /// in units of the prior.
  [[nodiscard]] int informed(const ShiftLikelihood::Component& one) const {
    const VectorXd unit = 5.0 * options_.residual_sd;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(
        MatrixXd(unit.asDiagonal() * one.precision * unit.asDiagonal()), Eigen::EigenvaluesOnly);
    return static_cast<int>((solver.eigenvalues().array() > 0.1).count());
  }

  const ShiftLikelihood& likelihood_;
  const CauseOptions& options_;
  std::vector<int> informed_;
};

ExplainedDefect defect_of(const Explainer& explainer, const DefectKind& kind,
                          const std::vector<const DefectPath*>& paths, double evidence) {
  ExplainedDefect out{.by_cell = std::vector<double>(index(kind.line.cells()))};
  std::vector<Mass> severities, places;
  std::map<int, std::vector<Mass>> stretches;
  std::vector<double> unused;
  double total = 0.0;
  for (const DefectPath* path : paths) {
    double mass = 0.0;
    explainer.add(*path, path->log_prior, unused, &severities, &mass, evidence);
    total += mass;
    const int cell = kind.line.cell_at(0.5 * (path->from + path->to));
    out.by_cell[index(cell)] += mass;
    places.push_back({path->from, path->to, mass});
    stretches[kind.line.stretch_of_cell(cell)].push_back({path->from, path->to, mass});
  }
  if (!(total > 0.0)) return out;
  for (double& p : out.by_cell) p /= total;
  out.location = interval_of(places);
  out.severity = interval_of(severities);
  for (const auto& [number, masses] : stretches) {
    double own = 0.0;
    for (const Mass& m : masses) own += m.mass / total;
    if (own < 0.01) continue;
    const SiteLine::Stretch& stretch = kind.line.stretches()[index(number)];
    const double metres = stretch.size / (stretch.end - stretch.start);
    const CentralInterval at = interval_of(masses);
    out.places.push_back(
        {.stretch = number,
         .probability = own,
         .at = {(at.q5 - stretch.start) * metres, (at.q50 - stretch.start) * metres,
                (at.q95 - stretch.start) * metres}});
  }
  std::ranges::stable_sort(out.places, std::ranges::greater(), &ExplainedPlace::probability);
  return out;
}

}  // namespace

ChangeExplanation explain_change(const ShiftLikelihood& likelihood, const MatrixXd& slopes,
                                 const std::vector<DefectKind>& kinds,
                                 const std::vector<DefectPath>& paths,
                                 const CauseOptions& options) {
  const Index p = options.residual_sd.size(), c = options.covariate_sd.size();
  const Explainer explainer(likelihood, options);
  std::vector<std::vector<const DefectPath*>> of_kind(kinds.size());
  for (const DefectPath& path : paths) of_kind[index(path.kind)].push_back(&path);

  // ln(prior · evidence) of each cause.
  std::vector<double> defects(kinds.size(), -kInfinity), evidence(kinds.size());
  std::vector<double> features(index(p)), thermometers(index(c), -kInfinity);
  double other = -kInfinity, distance = kInfinity;
  double damage_share = 0.0, mass_share = 0.0;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    (options.is_mass[k] ? mass_share : damage_share) += options.share[k];
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const bool mass = options.is_mass[k];
    std::vector<double> inflated(mass ? 1 : kInflations.size(), -kInfinity);
    for (const DefectPath* path : of_kind[k]) {
      explainer.add(*path, path->log_prior, inflated, nullptr, nullptr, 0.0);
      if (!mass) distance = std::min(distance, explainer.distance(*path));
    }
    evidence[k] = inflated[0];
    const double share = options.share[k] / (mass ? mass_share : damage_share);
    defects[k] =
        inflated[0] + std::log(share * (mass ? options.weights.mass : options.weights.damage));
    for (std::size_t i = 1; i < inflated.size(); ++i)
      other = log_sum_exp(other, log_mean(inflated[i], kInflations.size() - 1) +
                                     std::log(share * options.weights.other));
  }
  const auto usable = (options.covariate_sd.array() > 0.0).count();
  const double of_features = usable > 0 ? 0.5 * options.weights.sensor : options.weights.sensor;
  for (Index j = 0; j < p; ++j) {
    double sum = -kInfinity;
    for (const double size : kFaultSizes)
      sum = log_sum_exp(sum,
                        explainer.along(VectorXd::Unit(p, j), size * options.residual_sd[j], 0.0));
    features[index(j)] =
        log_mean(sum, kFaultSizes.size()) + std::log(of_features / static_cast<double>(p));
  }
  for (Index i = 0; i < c; ++i) {
    if (!(options.covariate_sd[i] > 0.0)) continue;
    double sum = -kInfinity;
    for (const double size : kOffsetSizes)
      for (std::size_t n = 0; n < kThermometerInflations; ++n)
        sum = log_sum_exp(
            sum, explainer.along(slopes.col(i), size * options.covariate_sd[i], kInflations[n]));
    thermometers[index(i)] = log_mean(sum, kOffsetSizes.size() * kThermometerInflations) +
                             std::log(0.5 * options.weights.sensor / static_cast<double>(usable));
  }

  double total = other;
  for (const auto* list : {&defects, &features, &thermometers})
    for (const double x : *list) total = log_sum_exp(total, x);
  ChangeExplanation out{.other = std::exp(other - total), .distance_to_damage = distance};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    out.defects.push_back(defect_of(explainer, kinds[k], of_kind[k], evidence[k]));
    out.defects.back().probability = std::exp(defects[k] - total);
    (options.is_mass[k] ? out.mass : out.damage) += out.defects.back().probability;
  }
  for (const double x : features) out.feature_faults.push_back(std::exp(x - total));
  for (const double x : thermometers) out.covariate_faults.push_back(std::exp(x - total));
  for (const auto* list : {&out.feature_faults, &out.covariate_faults})
    for (const double x : *list) out.sensor += x;
  return out;
}

}  // namespace wheeltap::identification::monitoring
