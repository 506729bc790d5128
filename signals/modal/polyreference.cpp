#include "signals/modal/polyreference.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kTurn = 0.9;  // angle of Ω over the band, as a share of 2π
constexpr double kLowestDamping = -5e-4, kHighestDamping = 0.3;
constexpr int kLargestOrder = 80;
constexpr double kLeastLeft = 0.05;  // smallest remaining share of a line's residual
constexpr double kMoved = 0.05;      // largest distance of a refined pole from that of the diagram

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
  // Sums the normal equations of all outputs, without the part that the numerators explain.
  MatrixXcd normal = MatrixXcd::Zero(size, size);
  for (Index o = 0; o < f.outputs(); ++o) {
    MatrixXcd y(lines, size);
    for (Index k = 0; k < lines; ++k)
      for (Index j = 0; j <= n; ++j)
        y.row(k).segment(j * inputs, inputs) = powers(k, j) * f.h[index(k)].row(o);
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

/// Roots of det A(Ω) = 0: eigenvalues of the block companion matrix of Σ A_j Ω^j, A_n = I.
Roots roots(const Fraction& fit, double lowest, double highest) {
  const auto n = static_cast<Index>(fit.a.size()) - 1, inputs = fit.a[0].rows();
  MatrixXcd companion = MatrixXcd::Zero(n * inputs, n * inputs);
  for (Index j = 0; j + 1 < n; ++j)
    companion.block(j * inputs, (j + 1) * inputs, inputs, inputs).setIdentity();
  for (Index j = 0; j < n; ++j)
    companion.block((n - 1) * inputs, j * inputs, inputs, inputs) = -fit.a[index(j)];
  const Eigen::ComplexEigenSolver<MatrixXcd> eigen(companion, false);
  Roots out;
  if (eigen.info() != Eigen::Success) return out;
  for (Index r = 0; r < n * inputs; ++r) {
    const Complex omega = eigen.eigenvalues()[r];
    if (!(std::abs(omega) > 0.0)) continue;
    // Over the band, Ω rotates by -0.9 · 2π. The angle is counted from slightly before the band.
    double turned = -std::arg(omega);
    if (turned < -0.5 * (1.0 - kTurn) * kTwoPi) turned += kTwoPi;
    const Complex lambda =
        Complex(0.0, fit.first) + Complex(-std::log(std::abs(omega)), turned) / fit.step;
    const double size = std::abs(lambda), damping = -lambda.real() / size;
    if (!(lambda.imag() > 0.0 && size >= lowest && size <= highest) || damping < kLowestDamping ||
        damping > kHighestDamping)
      continue;
    // In H = B A⁻¹, the residue of A⁻¹ is v l_rᵀ with l_rᵀ A(Ω_r) = 0.
    out.lambda.push_back(lambda);
    MatrixXcd whole = MatrixXcd::Zero(inputs, inputs);
    Complex power = 1.0;
    for (Index j = 0; j <= n; ++j, power *= omega) whole += power * fit.a[index(j)];
    const Eigen::JacobiSVD<MatrixXcd> svd(whole, Eigen::ComputeFullU);
    Index largest = 0;
    VectorXcd left = svd.matrixU().col(inputs - 1).conjugate();
    left.cwiseAbs().maxCoeff(&largest);
    out.factors.emplace_back(left / left[largest]);
  }
  return out;
}

Pole pole_of(const ModalModel& model, Index r, int order) {
  const Complex lambda = model.eigenvalues[index(r)];
  Pole out{.order = order,
           .place = static_cast<int>(r),
           .eigenvalue = lambda,
           .frequency_hz = std::abs(lambda) / kTwoPi,
           .damping = -lambda.real() / std::abs(lambda),
           .shape = model.shapes.col(r),
           .frequency_sd = kNaN,
           .damping_sd = kNaN};
  Index largest = 0;
  if (out.shape.cwiseAbs().maxCoeff(&largest) > 0.0) out.shape /= Complex(out.shape[largest]);
  return out;
}

}  // namespace

PolyreferenceFit polyreference(const FrequencyResponses& f, int n) {
  const Index lines = f.lines();
  if (n < 1) refuse("polynomial order", n, "must be at least 1");
  if (lines < 2 * n + 2)
    refuse("lines", static_cast<double>(lines),
           "must be at least " + std::to_string(2 * n + 2) + " for order " + std::to_string(2 * n));
  if (!(f.frequencies_hz[0] > 0.0))
    refuse("first spectral line", f.frequencies_hz[0], "must be above 0 Hz");
  const Roots found =
      roots(fraction(f, n), kTwoPi * f.frequencies_hz[0], kTwoPi * f.frequencies_hz[lines - 1]);
  std::vector<std::size_t> order(found.lambda.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = r;
  std::ranges::sort(order, {}, [&](std::size_t r) { return std::abs(found.lambda[r]); });
  std::vector<Complex> lambda;
  MatrixXcd participation(f.inputs(), static_cast<Index>(order.size()));
  for (const std::size_t r : order) {
    participation.col(static_cast<Index>(lambda.size())) = found.factors[r];
    lambda.push_back(found.lambda[r]);
  }
  PolyreferenceFit out;
  out.model = fit_shapes(f, std::move(lambda), std::move(participation));
  for (std::size_t r = 0; r < out.model.eigenvalues.size(); ++r)
    out.poles.push_back(pole_of(out.model, static_cast<Index>(r), 2 * n));
  return out;
}

namespace {

/// Computes the covariance of the modes from replicates of the refined fit.
void bootstrap(ModalResult& out, const FrequencyResponses& f, const ModalModel& fit,
               const PolyreferenceOptions& options) {
  const auto count = static_cast<Index>(out.modes.size());
  const Index outputs = f.outputs(), replicates = options.replicates;
  MatrixXd values(2 * count, replicates);
  std::vector<MatrixXd> shapes(out.modes.size(), MatrixXd(2 * outputs, replicates));
  base::parallel_for(static_cast<int>(replicates), options.threads, [&](int b) {
    base::Random random(options.seed, 0, static_cast<std::uint64_t>(b), base::Purpose::simulation);
    FrequencyResponses again = f;
    for (Index k = 0; k < f.lines(); ++k) {
      const double re = random.normal(), im = random.normal();
      const double inflated = 1.0 / std::sqrt(std::max(kLeastLeft, 1.0 - fit.leverage[k]));
      const Complex w = inflated * Complex(re, im) / std::numbers::sqrt2;
      again.h[index(k)] = fit.fitted[index(k)] + w * (f.h[index(k)] - fit.fitted[index(k)]);
    }
    const ModalModel model = refine(again, fit);
    for (Index m = 0; m < count; ++m) {
      const Complex lambda = model.eigenvalues[index(m)];
      values(m, b) = std::abs(lambda) / kTwoPi;
      values(count + m, b) = -lambda.real() / std::abs(lambda);
      // The shapes of replicates are scaled by the same entry as the shape of the mode.
      Index top = 0;
      out.modes[index(m)].pole.shape.cwiseAbs().maxCoeff(&top);
      const VectorXcd shape = model.shapes.col(m) / model.shapes(top, m);
      shapes[index(m)].col(b).head(outputs) = shape.real();
      shapes[index(m)].col(b).tail(outputs) = shape.imag();
    }
  });
  const double scale = 1.0 / std::sqrt(static_cast<double>(replicates) - 1.0);
  const auto deviations = [&](const MatrixXd& of) -> MatrixXd {
    return scale * (of.colwise() - of.rowwise().mean());
  };
  const MatrixXd moves = deviations(values);
  out.covariance = moves * moves.transpose();
  for (Index m = 0; m < count; ++m) {
    Mode& mode = out.modes[index(m)];
    mode.pole.frequency_sd = moves.row(m).norm();
    mode.pole.damping_sd = moves.row(count + m).norm();
    const MatrixXd of_shape = deviations(shapes[index(m)]);
    mode.shape_covariance = of_shape * of_shape.transpose();
  }
}

}  // namespace

ModalResult identify_modes(const FrequencyResponses& responses,
                           const PolyreferenceOptions& options) {
  const double highest =
      options.highest_hz > 0.0 ? options.highest_hz : std::numeric_limits<double>::infinity();
  FrequencyResponses f =
      responses.band(std::max(options.lowest_hz, std::numeric_limits<double>::min()), highest);
  if (f.lines() < 8)
    refuse("lines", static_cast<double>(f.lines()), "must be at least 8 within the band");
  double size = 0.0;
  for (const MatrixXcd& h : f.h) {
    if (!h.allFinite()) throw std::invalid_argument("responses: must be finite");
    size = std::max(size, h.cwiseAbs().maxCoeff());
  }
  if (!(size > 0.0)) throw std::invalid_argument("responses: must not be zero throughout");
  for (MatrixXcd& h : f.h) h /= size;
  const int requested = options.largest_order > 0 ? options.largest_order / 2 * 2 : kLargestOrder;
  const int room = static_cast<int>((f.lines() - 2) / 4) * 2;
  const int largest = std::min(requested, room);
  ModalResult out{.method = ModalMethod::polyreference,
                  .lowest_hz = f.frequencies_hz[0],
                  .highest_hz = f.frequencies_hz[f.lines() - 1],
                  .largest_order = largest,
                  .lines = static_cast<long>(f.lines()),
                  .replicates = options.replicates};
  out.remarks.order_cut = largest < requested && options.largest_order > 0 ? requested : 0;
  std::vector<std::vector<Pole>> by_order(index(largest / 2));
  base::parallel_for(largest / 2, options.threads, [&](int i) {
    const int n = largest / 2 - i;
    by_order[index(n - 1)] = polyreference(f, n).poles;
  });
  out.diagram = stabilise(std::move(by_order),
                          {.lowest_hz = out.lowest_hz,
                           .highest_hz = out.highest_hz,
                           .smallest_order = 2,
                           .lowest_damping = kLowestDamping,
                           .largest_relative_sd = std::numeric_limits<double>::infinity(),
                           .threads = options.threads});
  std::vector<Complex> lambda;
  MatrixXcd participation(f.inputs(), static_cast<Index>(out.diagram.modes.size()));
  for (const ModeCluster& cluster : out.diagram.modes) {
    const Pole& pole = out.diagram.poles[index(cluster.chosen)];
    participation.col(static_cast<Index>(lambda.size())) =
        polyreference(f, pole.order / 2).model.participation.col(pole.place);
    lambda.emplace_back(std::min(pole.eigenvalue.real(), -1e-6 * std::abs(pole.eigenvalue)),
                        pole.eigenvalue.imag());
    out.modes.push_back({.present = static_cast<int>(cluster.members.size()),
                         .orders = cluster.orders,
                         .amplitude_kurtosis = 2.0});
  }
  const ModalModel model = refine(f, {.eigenvalues = lambda, .participation = participation});
  for (std::size_t m = 0; m < out.modes.size(); ++m) {
    const Pole& chosen = out.diagram.poles[index(out.diagram.modes[m].chosen)];
    Mode& mode = out.modes[m];
    mode.pole = pole_of(model, static_cast<Index>(m), chosen.order);
    mode.pole.place = chosen.place;
    mode.collinearity = phase_collinearity(mode.pole.shape);
    mode.phase_deviation = mean_phase_deviation(mode.pole.shape);
    if (pole_distance(mode.pole, chosen) > kMoved) ++out.remarks.moved;
  }
  if (!out.modes.empty()) bootstrap(out, f, model, options);
  const double spacing = (out.highest_hz - out.lowest_hz) / static_cast<double>(f.lines() - 1);
  for (const Mode& m : out.modes)
    if (2.0 * m.pole.damping * m.pole.frequency_hz < spacing) ++out.remarks.narrow;
  doubt_modes(out);
  return out;
}

}  // namespace wheeltap::signals
