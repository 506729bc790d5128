#include "signals/polyreference.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/parallel.hpp"
#include "base/random.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTurn = 0.9;  // of Ω over the band
constexpr double kLowestDamping = -5e-4, kHighestDamping = 0.3;
constexpr int kLargestOrder = 80;
constexpr double kNear = 0.1;   // a replicate's pole is the same mode up to this distance
constexpr double kFound = 0.8;  // of the replicates

[[noreturn]] void refuse(const std::string& name, double value, const std::string& bound) {
  throw std::invalid_argument(name + " = " + std::to_string(value) + ": " + bound);
}

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// The matrix fraction of one polynomial order.
struct Fraction {
  double first = 0.0, step = 0.0;  ///< ω₁ [rad/s], T [s]
  std::vector<MatrixXcd> a;        ///< A_0 … A_n
};

Fraction fraction(const FrequencyResponses& f, int n) {
  const Index lines = f.lines(), inputs = f.inputs();
  Fraction out{.first = kTwoPi * f.frequencies_hz[0], .a = {}};
  out.step = kTurn / (f.frequencies_hz[lines - 1] - f.frequencies_hz[0]);
  MatrixXcd powers(lines, n + 1);
  for (Index k = 0; k < lines; ++k)
    for (Index j = 0; j <= n; ++j)
      powers(k, j) = std::polar(
          1.0, -(kTwoPi * f.frequencies_hz[k] - out.first) * out.step * static_cast<double>(j));
  const MatrixXcd q =
      Eigen::HouseholderQR<MatrixXcd>(powers).householderQ() * MatrixXcd::Identity(lines, n + 1);
  const Index size = inputs * (n + 1), unknown = inputs * n;
  // Rows of the outputs, freed of what their numerators explain.
  MatrixXcd normal = MatrixXcd::Zero(size, size);
  for (Index o = 0; o < f.outputs(); ++o) {
    MatrixXcd y(lines, size);
    for (Index k = 0; k < lines; ++k)
      for (Index j = 0; j <= n; ++j)
        y.row(k).segment(j * inputs, inputs) = powers(k, j) * f.h[at(k)].row(o);
    y -= q * (q.adjoint() * y);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(y.adjoint());
  }
  normal.triangularView<Eigen::StrictlyUpper>() = normal.adjoint();
  const MatrixXcd alpha = -normal.topLeftCorner(unknown, unknown)
                               .completeOrthogonalDecomposition()
                               .solve(normal.topRightCorner(unknown, inputs));
  for (Index j = 0; j < n; ++j) out.a.push_back(alpha.middleRows(j * inputs, inputs));
  out.a.push_back(MatrixXcd::Identity(inputs, inputs));
  return out;
}

struct Roots {
  std::vector<Complex> lambda;
  std::vector<VectorXcd> factors;  ///< l_r
};

/// Of det A(Ω) = 0: eigenvalues of the block companion matrix of Σ A_j Ω^j, A_n = I.
Roots roots(const Fraction& fit, double lowest, double highest) {
  const auto n = static_cast<Index>(fit.a.size()) - 1, inputs = fit.a[0].rows();
  MatrixXcd companion = MatrixXcd::Zero(n * inputs, n * inputs);
  for (Index j = 0; j + 1 < n; ++j)
    companion.block(j * inputs, (j + 1) * inputs, inputs, inputs).setIdentity();
  for (Index j = 0; j < n; ++j)
    companion.block((n - 1) * inputs, j * inputs, inputs, inputs) = -fit.a[at(j)];
  const Eigen::ComplexEigenSolver<MatrixXcd> eigen(companion, false);
  Roots out;
  if (eigen.info() != Eigen::Success) return out;
  for (Index r = 0; r < n * inputs; ++r) {
    const Complex omega = eigen.eigenvalues()[r];
    if (!(std::abs(omega) > 0.0)) continue;
    const Complex lambda = Complex(0.0, fit.first) - std::log(omega) / fit.step;
    const double size = std::abs(lambda), damping = -lambda.real() / size;
    if (!(lambda.imag() > 0.0 && size >= lowest && size <= highest) ||
        damping < kLowestDamping || damping > kHighestDamping)
      continue;
    // H = B A⁻¹: the residue of A⁻¹ is v l_rᵀ, l_rᵀ A(Ω_r) = 0.
    out.lambda.push_back(lambda);
    MatrixXcd whole = MatrixXcd::Zero(inputs, inputs);
    Complex power = 1.0;
    for (Index j = 0; j <= n; ++j, power *= omega) whole += power * fit.a[at(j)];
    const Eigen::JacobiSVD<MatrixXcd> svd(whole, Eigen::ComputeFullU);
    Index largest = 0;
    VectorXcd left = svd.matrixU().col(inputs - 1).conjugate();
    left.cwiseAbs().maxCoeff(&largest);
    out.factors.emplace_back(left / left[largest]);
  }
  return out;
}

}  // namespace

PolyreferenceFit polyreference(const FrequencyResponses& f, int n) {
  const Index lines = f.lines(), inputs = f.inputs(), outputs = f.outputs();
  if (n < 1) refuse("polynomial order", n, "must be at least 1");
  if (lines < 2 * n + 2)
    refuse("lines", static_cast<double>(lines),
           "must be at least " + std::to_string(2 * n + 2) + " for order " + std::to_string(2 * n));
  if (!(f.frequencies_hz[0] > 0.0))
    refuse("first line", f.frequencies_hz[0], "must be above 0 Hz");
  const Roots found = roots(fraction(f, n), kTwoPi * f.frequencies_hz[0],
                            kTwoPi * f.frequencies_hz[lines - 1]);
  const auto count = static_cast<Index>(found.lambda.size());
  // Real unknowns of each output: ψ (real, imaginary), then L, U, V of each input.
  const Index unknowns = 2 * count + 6 * inputs, rows = 2 * lines * inputs;
  MatrixXd matrix = MatrixXd::Zero(rows, unknowns);
  MatrixXd right(rows, outputs);
  const double top = kTwoPi * f.frequencies_hz[lines - 1];
  for (Index k = 0; k < lines; ++k) {
    const double omega = kTwoPi * f.frequencies_hz[k];
    const double scaled = omega / top;
    const std::array<double, 3> rest = {1.0 / (scaled * scaled), 1.0, scaled * scaled};
    for (Index j = 0; j < inputs; ++j) {
      const Index row = 2 * (k * inputs + j);
      for (Index r = 0; r < count; ++r) {
        const Complex l = found.factors[at(r)][j], lambda = found.lambda[at(r)];
        const Complex a = l / (Complex(0.0, omega) - lambda),
                      b = std::conj(l) / (Complex(0.0, omega) - std::conj(lambda));
        const Complex real = a + b, imaginary = Complex(0.0, 1.0) * (a - b);
        matrix(row, 2 * r) = real.real(), matrix(row + 1, 2 * r) = real.imag();
        matrix(row, 2 * r + 1) = imaginary.real(), matrix(row + 1, 2 * r + 1) = imaginary.imag();
      }
      for (Index t = 0; t < 3; ++t) {
        const Index column = 2 * count + 6 * j + 2 * t;
        matrix(row, column) = matrix(row + 1, column + 1) = rest[at(t)];
      }
      for (Index o = 0; o < outputs; ++o) {
        right(row, o) = f.h[at(k)](o, j).real();
        right(row + 1, o) = f.h[at(k)](o, j).imag();
      }
    }
  }
  const VectorXd sizes = matrix.colwise().norm().transpose().cwiseMax(1e-300);
  matrix = matrix * sizes.cwiseInverse().asDiagonal();
  const MatrixXd solved = matrix.colPivHouseholderQr().solve(right);
  PolyreferenceFit out{.parameters = static_cast<double>(unknowns) / static_cast<double>(rows)};
  const MatrixXd fitted = matrix * solved;
  for (Index k = 0; k < lines; ++k) {
    MatrixXcd one(outputs, inputs);
    for (Index j = 0; j < inputs; ++j)
      for (Index o = 0; o < outputs; ++o)
        one(o, j) = {fitted(2 * (k * inputs + j), o), fitted(2 * (k * inputs + j) + 1, o)};
    out.fitted.push_back(std::move(one));
  }
  std::vector<std::size_t> order(found.lambda.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = r;
  std::ranges::sort(order, {}, [&](std::size_t r) { return std::abs(found.lambda[r]); });
  out.participation.resize(inputs, count);
  for (const std::size_t r : order) {
    const auto column = static_cast<Index>(r);
    Pole pole{.order = 2 * n,
              .place = static_cast<int>(out.poles.size()),
              .eigenvalue = found.lambda[r],
              .frequency_hz = std::abs(found.lambda[r]) / kTwoPi,
              .damping = -found.lambda[r].real() / std::abs(found.lambda[r]),
              .shape = VectorXcd(outputs),
              .frequency_sd = kNaN,
              .damping_sd = kNaN};
    for (Index o = 0; o < outputs; ++o)
      pole.shape[o] = {solved(2 * column, o) / sizes[2 * column],
                       solved(2 * column + 1, o) / sizes[2 * column + 1]};
    Index largest = 0;
    if (pole.shape.cwiseAbs().maxCoeff(&largest) > 0.0) pole.shape /= Complex(pole.shape[largest]);
    out.participation.col(static_cast<Index>(out.poles.size())) = found.factors[r];
    out.poles.push_back(std::move(pole));
  }
  return out;
}

namespace {

/// What every mode is in each replicate: frequency, damping, shape.
void bootstrap(ModalResult& out, const FrequencyResponses& f, const PolyreferenceFit& fit,
               const PolyreferenceOptions& options) {
  const auto count = static_cast<Index>(out.modes.size());
  const Index outputs = f.outputs(), replicates = options.replicates;
  const double inflated = 1.0 / std::sqrt(std::max(0.1, 1.0 - fit.parameters));
  std::vector<int> orders;
  for (const Mode& m : out.modes) orders.push_back(m.pole.order);
  std::ranges::sort(orders);
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  // Rows: frequencies, dampings; NaN where a replicate lost the mode.
  MatrixXd values = MatrixXd::Constant(2 * count, replicates, kNaN);
  std::vector<MatrixXd> shapes(out.modes.size(), MatrixXd::Zero(2 * outputs, replicates));
  base::parallel_for(static_cast<int>(replicates), options.threads, [&](int b) {
    base::Random random(options.seed, 0, static_cast<std::uint64_t>(b), base::Purpose::simulation);
    FrequencyResponses again = f;
    for (Index k = 0; k < f.lines(); ++k) {
      const double re = random.normal(), im = random.normal();
      const Complex w = inflated * Complex(re, im) / std::numbers::sqrt2;
      again.h[at(k)] = fit.fitted[at(k)] + w * (f.h[at(k)] - fit.fitted[at(k)]);
    }
    for (const int order : orders) {
      const std::vector<Pole> poles = polyreference(again, order / 2).poles;
      for (Index m = 0; m < count; ++m) {
        const Pole& own = out.modes[at(m)].pole;
        if (own.order != order || poles.empty()) continue;
        const auto nearest = std::ranges::min_element(
            poles, {}, [&](const Pole& p) { return pole_distance(p, own); });
        if (!(pole_distance(*nearest, own) < kNear)) continue;
        values(m, b) = nearest->frequency_hz;
        values(count + m, b) = nearest->damping;
        // Scaled as the mode itself is: its largest entry.
        Index top = 0;
        own.shape.cwiseAbs().maxCoeff(&top);
        const VectorXcd shape = nearest->shape / nearest->shape[top];
        shapes[at(m)].col(b).head(outputs) = shape.real();
        shapes[at(m)].col(b).tail(outputs) = shape.imag();
      }
    }
  });
  // Deviations of those that were found; a lost one deviates by nothing, and is counted.
  MatrixXd moves = MatrixXd::Zero(2 * count, replicates);
  for (Index m = 0; m < count; ++m) {
    std::vector<Index> found;
    for (Index b = 0; b < replicates; ++b)
      if (!std::isnan(values(m, b))) found.push_back(b);
    Mode& mode = out.modes[at(m)];
    const auto had = static_cast<double>(found.size());
    if (had < kFound * static_cast<double>(replicates)) ++out.remarks.lost;
    mode.shape_covariance = MatrixXd::Zero(2 * outputs, 2 * outputs);
    if (found.size() < 2) {
      mode.pole.frequency_sd = mode.pole.damping_sd = kNaN;
      continue;
    }
    double f_mean = 0.0, z_mean = 0.0;
    VectorXd shape_mean = VectorXd::Zero(2 * outputs);
    for (const Index b : found) {
      f_mean += values(m, b) / had;
      z_mean += values(count + m, b) / had;
      shape_mean += shapes[at(m)].col(b) / had;
    }
    for (const Index b : found) {
      const double scale = 1.0 / std::sqrt(had - 1.0);
      moves(m, b) = scale * (values(m, b) - f_mean);
      moves(count + m, b) = scale * (values(count + m, b) - z_mean);
      const VectorXd d = scale * (shapes[at(m)].col(b) - shape_mean);
      mode.shape_covariance += d * d.transpose();
    }
    mode.pole.frequency_sd = moves.row(m).norm();
    mode.pole.damping_sd = moves.row(count + m).norm();
  }
  out.covariance = moves * moves.transpose();
}

}  // namespace

ModalResult identify_modes(const FrequencyResponses& responses,
                           const PolyreferenceOptions& options) {
  const double highest = options.highest_hz > 0.0 ? options.highest_hz
                                                  : std::numeric_limits<double>::infinity();
  FrequencyResponses f = responses.band(
      std::max(options.lowest_hz, std::numeric_limits<double>::min()), highest);
  if (f.lines() < 8)
    refuse("lines", static_cast<double>(f.lines()), "must be at least 8 within the band");
  double size = 0.0;
  for (const MatrixXcd& h : f.h) {
    if (!h.allFinite()) throw std::invalid_argument("responses: must be finite");
    size = std::max(size, h.cwiseAbs().maxCoeff());
  }
  if (!(size > 0.0)) throw std::invalid_argument("responses: must not be zero throughout");
  for (MatrixXcd& h : f.h) h /= size;
  const int asked = options.largest_order > 0 ? options.largest_order / 2 * 2 : kLargestOrder;
  const int room = static_cast<int>((f.lines() - 2) / 4) * 2;
  const int largest = std::min(asked, room);
  ModalResult out{.method = ModalMethod::polyreference,
                  .lowest_hz = f.frequencies_hz[0],
                  .highest_hz = f.frequencies_hz[f.lines() - 1],
                  .largest_order = largest,
                  .lines = static_cast<long>(f.lines()),
                  .replicates = options.replicates};
  out.remarks.order_cut = largest < asked && options.largest_order > 0 ? asked : 0;
  std::vector<std::vector<Pole>> by_order(at(largest / 2));
  base::parallel_for(largest / 2, options.threads, [&](int i) {
    const int n = largest / 2 - i;
    by_order[at(n - 1)] = polyreference(f, n).poles;
  });
  out.diagram = stabilise(std::move(by_order),
                          {.lowest_hz = out.lowest_hz,
                           .highest_hz = out.highest_hz,
                           .smallest_order = 2,
                           .lowest_damping = kLowestDamping,
                           .largest_relative_sd = std::numeric_limits<double>::infinity(),
                           .threads = options.threads});
  int order = 0;
  for (const ModeCluster& cluster : out.diagram.modes) {
    const Pole& pole = out.diagram.poles[at(cluster.chosen)];
    order = std::max(order, pole.order);
    out.modes.push_back({.pole = pole,
                         .collinearity = phase_collinearity(pole.shape),
                         .phase_deviation = mean_phase_deviation(pole.shape),
                         .present = static_cast<int>(cluster.members.size()),
                         .orders = cluster.orders,
                         .amplitude_kurtosis = 2.0});
  }
  if (!out.modes.empty()) bootstrap(out, f, polyreference(f, order / 2), options);
  const double spacing = (out.highest_hz - out.lowest_hz) / static_cast<double>(f.lines() - 1);
  for (const Mode& m : out.modes)
    if (2.0 * m.pole.damping * m.pole.frequency_hz < spacing) ++out.remarks.narrow;
  doubt_modes(out);
  return out;
}

}  // namespace wheeltap::signals
