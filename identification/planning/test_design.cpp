#include "identification/planning/test_design.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::identification::planning {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// The value of a mode in a list with one value per mode; the last value applies to further modes.
double value_of_mode(const std::vector<double>& values, int mode, double otherwise) {
  return values.empty() ? otherwise : values[std::min(index(mode), values.size() - 1)];
}

}  // namespace

double TestNoise::frequency_cov(double frequency_hz, int mode) const {
  const double given = value_of_mode(covs, mode, cov);
  const double square = given > 0.0 ? given * given : damping / (kTwoPi * frequency_hz * seconds);
  return std::sqrt(square + discrepancy * discrepancy);
}

double TestNoise::shape_sd_now(int mode) const {
  return value_of_mode(shape_sds, mode, shape_sd) * std::sqrt(reference_seconds / seconds);
}

TestNumbers TestNumbers::draw(const PlannedStructure& structure, std::uint64_t seed,
                              std::uint64_t test) {
  base::Random random(seed, 1, test, base::Purpose::simulation);
  const Index n = structure.modes();
  TestNumbers out{VectorXd(n), VectorXd(n), VectorXd(n),
                  Eigen::MatrixXd(static_cast<Index>(structure.candidates().size()), n)};
  for (double& z : out.frequencies) z = random.normal();
  for (double& z : out.with_mass) z = random.normal();
  for (double& z : out.shapes.reshaped()) z = random.normal();
  for (double& z : out.turns) z = random.normal();
  return out;
}

TestData::TestData(const PlannedStructure& structure, const TestNoise& noise, TestDesign design)
    : structure_(structure),
      design_(std::move(design)),
      shape_sd_(structure.modes()),
      cov_(structure.modes()) {
  const TestModes& intact = structure.intact();
  const Index n = structure.modes();
  for (Index i = 0; i < n; ++i) {
    cov_[i] = noise.frequency_cov(std::exp(intact.in_order[i]), static_cast<int>(i));
    shape_sd_[i] = noise.shape_sd_now(static_cast<int>(i));
  }
  size_ = design_.mass >= 0 ? 2 * n : n;
  if (with_shapes()) take_shapes();
  whiten_unknowns();
}

void TestData::take_shapes() {
  const TestModes& intact = structure_.intact();
  const Index n = structure_.modes();
  const auto m = static_cast<Index>(design_.sensors.size());
  for (Index i = 0; i < n; ++i) {
    if (!structure_.has_shape(static_cast<int>(i))) continue;
    const VectorXd at = intact.shapes.col(i)(design_.sensors);
    const double norm = at.norm();
    if (!(norm > 1e-9 * intact.shapes.col(i).norm())) continue;
    Shape shape{.mode = static_cast<int>(i),
                .first = size_,
                .kappa = norm / (shape_sd_[i] * intact.shapes.col(i).cwiseAbs().maxCoeff()),
                .unit = at / norm,
                .turned = {}};
    if (const auto& turn = structure_.turn(static_cast<int>(i)); turn.mode >= 0) {
      VectorXd w = intact.shapes.col(turn.mode)(design_.sensors) / norm;
      w -= w.dot(shape.unit) * shape.unit;
      const double moved = shape.kappa * turn.tau * w.norm();
      if (moved > 1e-6) {
        shape.turned = w.normalized();
        shape.shrink = 1.0 / std::sqrt(1.0 + moved * moved);
      }
    }
    size_ += m;
    shapes_.push_back(std::move(shape));
  }
}

void TestData::whiten_unknowns() {
  const auto& steps = structure_.steps();
  const auto n = static_cast<Index>(steps.size());
  if (n == 0) return;
  effects_.resize(size_, n);
  VectorXd above(size_), below(size_);
  for (Index i = 0; i < n; ++i) {
    mean(steps[index(i)].above, above);
    mean(steps[index(i)].below, below);
    effects_.col(i) = 0.5 * (above - below);
  }
  // J Jᵀ and Jᵀ J have the same positive eigenvalues.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(effects_.transpose() * effects_);
  directions_.resize(size_, 0);
  reductions_.resize(0);
  for (Index i = 0; i < n; ++i) {
    const double lambda = solver.eigenvalues()[i];
    if (!(lambda > 1e-9)) continue;
    const Index k = reductions_.size();
    directions_.conservativeResize(Eigen::NoChange, k + 1);
    reductions_.conservativeResize(k + 1);
    directions_.col(k) = effects_ * solver.eigenvectors().col(i) / std::sqrt(lambda);
    reductions_[k] = 1.0 - 1.0 / std::sqrt(1.0 + lambda);
  }
  for (Index i = 0; i < n; ++i) whiten(effects_.col(i));
}

void TestData::whiten(Eigen::Ref<VectorXd> out) const {
  if (reductions_.size() == 0) return;
  const VectorXd along = (directions_.transpose() * out).cwiseProduct(reductions_);
  out -= directions_ * along;
}

VectorXd TestData::unknown_effect(const VectorXd& z) const {
  return effects_ * z;
}

bool TestData::has_shape(int mode) const {
  return std::ranges::any_of(shapes_, [mode](const Shape& s) { return s.mode == mode; });
}

void TestData::place(const Shape& shape, const VectorXd& measured, Eigen::Ref<VectorXd> out) const {
  const double along = measured.dot(shape.unit), norm = measured.norm();
  auto to = out.segment(shape.first, measured.size());
  if (!(norm > 0.0)) {
    to.setZero();
    return;
  }
  to = shape.kappa * ((along < 0.0 ? -1.0 : 1.0) / norm * measured - shape.unit);
  if (shape.turned.size() > 0) to += (shape.shrink - 1.0) * to.dot(shape.turned) * shape.turned;
}

void TestData::frequencies(const TestModes& modes, Eigen::Ref<VectorXd> out) const {
  const TestModes& intact = structure_.intact();
  const Index n = cov_.size();
  const VectorXd& f = with_shapes() ? modes.log_frequencies : modes.in_order;
  const VectorXd& f0 = with_shapes() ? intact.log_frequencies : intact.in_order;
  out.head(n) = (f - f0).cwiseQuotient(cov_);
  if (design_.mass >= 0)
    out.segment(n, n) = (modes.with_mass.col(design_.mass) - intact.with_mass.col(design_.mass))
                            .cwiseQuotient(cov_);
}

void TestData::mean(const TestModes& modes, Eigen::Ref<VectorXd> out) const {
  frequencies(modes, out);
  for (const Shape& shape : shapes_)
    place(shape, modes.shapes.col(shape.mode)(design_.sensors), out);
  whiten(out);
}

VectorXd TestData::measured_shape(const TestModes& modes, const TestNumbers& numbers,
                                  int mode) const {
  VectorXd shape = modes.shapes.col(mode)(design_.sensors);
  const double largest = std::max(modes.shapes.col(mode).cwiseAbs().maxCoeff(), 1e-300);
  if (const auto& turn = structure_.turn(mode); turn.mode >= 0)
    shape += turn.tau * numbers.turns[mode] * modes.shapes.col(turn.mode)(design_.sensors);
  shape /= largest;
  return shape + shape_sd_[mode] * numbers.shapes.col(mode)(design_.sensors);
}

void TestData::measured(const TestModes& modes, const TestNumbers& numbers,
                        Eigen::Ref<VectorXd> out) const {
  frequencies(modes, out);
  const Index n = cov_.size();
  out.head(n) += numbers.frequencies;
  if (design_.mass >= 0) out.segment(n, n) += numbers.with_mass;
  for (const Shape& shape : shapes_) place(shape, measured_shape(modes, numbers, shape.mode), out);
  whiten(out);
}

namespace {

/// Pairs of places at which two defects are possible together.
std::vector<std::pair<int, int>> possible_pairs(const PlannedStructure& structure) {
  std::vector<std::pair<int, int>> out;
  for (const NormalModel& model : count_models(structure.kinds())) {
    if (std::reduce(model.counts.begin(), model.counts.end()) != 2) continue;
    const auto n = static_cast<int>(structure.places().size());
    for (int a = 0; a < n; ++a)
      for (int b = a + 1; b < n; ++b) {
        std::vector<int> counts(model.counts.size(), 0);
        ++counts[index(structure.places()[index(a)].kind)];
        ++counts[index(structure.places()[index(b)].kind)];
        if (counts == model.counts) out.emplace_back(a, b);
      }
  }
  return out;
}

}  // namespace

PlacePredictions predict_places(const PlannedStructure& structure, int segments, int threads) {
  const auto n = structure.places().size();
  PlacePredictions out{.modes = std::vector<std::vector<TestModes>>(n),
                       .severities = std::vector<std::vector<double>>(n)};
  const int blocks = static_cast<int>((n + 7) / 8);
  base::parallel_for(blocks, threads, [&](int block) {
    PlannedStructure::Solver solver(structure);
    for (std::size_t a = 8 * index(block); a < std::min(n, 8 * index(block) + 8); ++a) {
      const TestPlace& place = structure.places()[a];
      const DefectKind& kind = structure.kinds()[index(place.kind)];
      const inference::Prior* prior = kind.severity_prior();
      for (int i = 0; i <= (prior ? segments : 0); ++i) {
        double severity = kind.known_severity();
        if (prior != nullptr) {
          // Unbounded priors are cut off at the quantiles 1/1000 and 999/1000.
          const double p = std::clamp(static_cast<double>(i) / segments, 1e-3, 1.0 - 1e-3);
          severity = i == 0 && std::isfinite(prior->lower()) ? prior->lower()
                     : i == segments && std::isfinite(prior->upper())
                         ? prior->upper()
                         : prior->from_standard_normal(inference::normal_quantile(p));
        }
        TestModes modes;
        const bool possible = solver.predict({{place.kind, place.location, severity}}, modes);
        if (!possible) modes = out.modes[a].empty() ? structure.intact() : out.modes[a].back();
        out.modes[a].push_back(std::move(modes));
        out.severities[a].push_back(severity);
      }
    }
  });
  const auto pairs = possible_pairs(structure);
  out.pairs.resize(pairs.size());
  constexpr int kTogether = 64;
  const int units = (static_cast<int>(pairs.size()) + kTogether - 1) / kTogether;
  base::parallel_for(units, threads, [&](int unit) {
    PlannedStructure::Solver solver(structure);
    const std::size_t first = index(unit * kTogether);
    for (std::size_t i = first; i < std::min(pairs.size(), first + kTogether); ++i) {
      const auto [a, b] = pairs[i];
      std::vector<PlacedDefect> defects;
      for (const int p : {a, b}) {
        const auto& severities = out.severities[index(p)];
        const TestPlace& place = structure.places()[index(p)];
        defects.push_back({place.kind, place.location,
                           severities[index(typical_node(static_cast<Index>(severities.size())))]});
      }
      out.pairs[i].a = a;
      out.pairs[i].b = solver.predict(defects, out.pairs[i].modes) ? b : -1;
    }
  });
  std::erase_if(out.pairs, [](const auto& pair) { return pair.b < 0; });
  return out;
}

std::vector<NormalModel> count_models(const std::vector<DefectKind>& kinds) {
  std::vector<NormalModel> list = {{{}, 1.0}};
  for (const DefectKind& kind : kinds) {
    std::vector<NormalModel> longer;
    for (const NormalModel& head : list)
      for (int n = kind.min_count; n <= kind.max_count; ++n) {
        NormalModel next = head;
        next.counts.push_back(n);
        next.prior *= kind.weights[index(n - kind.min_count)];
        if (next.prior > 0.0) longer.push_back(std::move(next));
      }
    list = std::move(longer);
  }
  return list;
}

NormalTest make_normal_test(const PlannedStructure& structure, const PlacePredictions& predictions,
                            const TestData& data) {
  std::vector<NormalPlace> places;
  for (std::size_t a = 0; a < predictions.modes.size(); ++a) {
    const auto& modes = predictions.modes[a];
    NormalPlace place{.kind = structure.places()[a].kind,
                      .prior = structure.places()[a].prior,
                      .nodes = Eigen::MatrixXd(data.size(), static_cast<Index>(modes.size()))};
    for (std::size_t i = 0; i < modes.size(); ++i)
      data.mean(modes[i], place.nodes.col(static_cast<Index>(i)));
    places.push_back(std::move(place));
  }
  std::vector<NormalInteraction> interactions;
  for (const PlacePredictions::Pair& pair : predictions.pairs) {
    NormalInteraction one{.a = pair.a, .b = pair.b, .data = Eigen::VectorXd(data.size())};
    data.mean(pair.modes, one.data);
    for (const int p : {pair.a, pair.b}) {
      const Eigen::MatrixXd& nodes = places[index(p)].nodes;
      one.data -= nodes.col(typical_node(nodes.cols()));
    }
    interactions.push_back(std::move(one));
  }
  constexpr int kPairs = 48;
  return NormalTest(std::move(places), count_models(structure.kinds()), kPairs, interactions);
}

}  // namespace wheeltap::identification::planning
