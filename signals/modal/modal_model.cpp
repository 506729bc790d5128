#include "signals/modal/modal_model.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr Complex kI{0.0, 1.0};
constexpr int kMostSteps = 30, kMostHalvings = 8;
constexpr double kSettled = 1e-12;  // relative change of the sum of squares at convergence

/// The linear problem for given poles. Rows are lines × inputs, first real parts, then imaginary
/// parts. Columns are ψ (real, imaginary) of each mode, and L, U, V of each input.
struct Linear {
  MatrixXd matrix, right;
  VectorXd sizes;
  MatrixXd solved;  ///< unknowns × outputs
  MatrixXd residual;
  Eigen::HouseholderQR<MatrixXd> qr;

  /// The part of x that is orthogonal to the columns of the linear parameters.
  [[nodiscard]] MatrixXd across(const MatrixXd& x) const {
    MatrixXd turned = qr.householderQ().transpose() * x;
    turned.topRows(matrix.cols()).setZero();
    return qr.householderQ() * turned;
  }
};

Index row_of(Index line, Index input, Index inputs) {
  return 2 * (line * inputs + input);
}

void set_columns(MatrixXd& m, Index row, Index column, Complex a, Complex b) {
  const Complex real = a + b, imaginary = kI * (a - b);
  m(row, column) = real.real(), m(row + 1, column) = real.imag();
  m(row, column + 1) = imaginary.real(), m(row + 1, column + 1) = imaginary.imag();
}

Linear solve(const FrequencyResponses& f, const std::vector<Complex>& lambda,
             const MatrixXcd& participation) {
  const Index lines = f.lines(), inputs = f.inputs(), outputs = f.outputs();
  const auto count = static_cast<Index>(lambda.size());
  const Index unknowns = 2 * count + 6 * inputs, rows = 2 * lines * inputs;
  Linear out;
  out.matrix = MatrixXd::Zero(rows, unknowns);
  out.right.resize(rows, outputs);
  const double top = kTwoPi * f.frequencies_hz[lines - 1];
  for (Index k = 0; k < lines; ++k) {
    const double omega = kTwoPi * f.frequencies_hz[k], scaled = omega / top;
    const std::array<double, 3> rest = {1.0 / (scaled * scaled), 1.0, scaled * scaled};
    for (Index j = 0; j < inputs; ++j) {
      const Index row = row_of(k, j, inputs);
      for (Index r = 0; r < count; ++r) {
        const Complex l = participation(j, r);
        set_columns(out.matrix, row, 2 * r, l / (kI * omega - lambda[index(r)]),
                    std::conj(l) / (kI * omega - std::conj(lambda[index(r)])));
      }
      for (Index t = 0; t < 3; ++t) {
        const Index column = 2 * count + 6 * j + 2 * t;
        out.matrix(row, column) = out.matrix(row + 1, column + 1) = rest[index(t)];
      }
      for (Index o = 0; o < outputs; ++o) {
        out.right(row, o) = f.h[index(k)](o, j).real();
        out.right(row + 1, o) = f.h[index(k)](o, j).imag();
      }
    }
  }
  out.sizes = out.matrix.colwise().norm().transpose().cwiseMax(1e-300);
  out.matrix = out.matrix * out.sizes.cwiseInverse().asDiagonal();
  out.solved =
      out.sizes.cwiseInverse().asDiagonal() * out.matrix.colPivHouseholderQr().solve(out.right);
  out.matrix = out.matrix * out.sizes.asDiagonal();
  out.residual = out.right - out.matrix * out.solved;
  return out;
}

/// The real parameters of λ (relative to |λ|), then of l except the largest entries.
struct Free {
  Index mode, input;  ///< input -1: λ
  bool imaginary;
};

std::vector<Free> free_of(const MatrixXcd& participation) {
  std::vector<Free> out;
  for (Index r = 0; r < participation.cols(); ++r) {
    for (const bool imaginary : {false, true}) out.push_back({r, -1, imaginary});
    Index largest = 0;
    participation.col(r).cwiseAbs().maxCoeff(&largest);
    for (Index j = 0; j < participation.rows(); ++j)
      for (const bool imaginary : {false, true})
        if (j != largest) out.push_back({r, j, imaginary});
  }
  return out;
}

/// Computes ∂ residual/∂p by Kaufman's approximation, for all outputs one after the other.
MatrixXd jacobian(const FrequencyResponses& f, Linear& linear, const std::vector<Complex>& lambda,
                  const MatrixXcd& participation, const std::vector<Free>& free) {
  const Index lines = f.lines(), inputs = f.inputs(), outputs = f.outputs(),
              rows = linear.matrix.rows();
  linear.qr.compute(linear.matrix * linear.sizes.cwiseInverse().asDiagonal());
  MatrixXd out(rows * outputs, static_cast<Index>(free.size()));
  MatrixXd pair(rows, 2);
  for (std::size_t p = 0; p < free.size(); ++p) {
    const Free& one = free[p];
    const Complex own = lambda[index(one.mode)];
    const Complex by = one.imaginary ? kI : Complex(1.0);
    pair.setZero();
    for (Index k = 0; k < lines; ++k) {
      const Complex near = kI * (kTwoPi * f.frequencies_hz[k]) - own,
                    far = kI * (kTwoPi * f.frequencies_hz[k]) - std::conj(own);
      for (Index j = 0; j < inputs; ++j) {
        if (one.input >= 0 && j != one.input) continue;
        const Complex l = participation(j, one.mode);
        const Index row = row_of(k, j, inputs);
        if (one.input < 0) {
          const double scale = std::abs(own);
          set_columns(pair, row, 0, scale * by * l / (near * near),
                      scale * std::conj(by) * std::conj(l) / (far * far));
        } else {
          set_columns(pair, row, 0, by / near, std::conj(by) / far);
        }
      }
    }
    const MatrixXd moved = -linear.across(pair * linear.solved.middleRows(2 * one.mode, 2));
    for (Index o = 0; o < outputs; ++o)
      out.col(static_cast<Index>(p)).segment(o * rows, rows) = moved.col(o);
  }
  return out;
}

MatrixXd orthonormal(const MatrixXd& columns) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

/// Call this function after jacobian(), whose columns are orthogonal to the linear columns.
VectorXd leverage(const FrequencyResponses& f, const Linear& linear, const MatrixXd& by_free) {
  const Index inputs = f.inputs(), outputs = f.outputs(), rows = linear.matrix.rows();
  const MatrixXd shared = orthonormal(linear.matrix * linear.sizes.cwiseInverse().asDiagonal());
  const VectorXd sizes = by_free.colwise().norm().transpose().cwiseMax(1e-300);
  const MatrixXd own = orthonormal(by_free * sizes.cwiseInverse().asDiagonal());
  VectorXd out(f.lines());
  const auto numbers = static_cast<double>(2 * inputs);
  for (Index k = 0; k < f.lines(); ++k) {
    double sum = static_cast<double>(outputs) *
                 shared.middleRows(row_of(k, 0, inputs), 2 * inputs).squaredNorm();
    for (Index o = 0; o < outputs; ++o)
      sum += own.middleRows(o * rows + row_of(k, 0, inputs), 2 * inputs).squaredNorm();
    out[k] = sum / (numbers * static_cast<double>(outputs));
  }
  return out;
}

ModalModel model_of(const FrequencyResponses& f, std::vector<Complex> lambda,
                    MatrixXcd participation, const Linear& linear) {
  const Index inputs = f.inputs(), outputs = f.outputs();
  ModalModel out{.eigenvalues = std::move(lambda),
                 .participation = std::move(participation),
                 .squares = linear.residual.squaredNorm()};
  const MatrixXd fitted = linear.right - linear.residual;
  for (Index k = 0; k < f.lines(); ++k) {
    MatrixXcd one(outputs, inputs);
    for (Index j = 0; j < inputs; ++j)
      for (Index o = 0; o < outputs; ++o)
        one(o, j) = {fitted(row_of(k, j, inputs), o), fitted(row_of(k, j, inputs) + 1, o)};
    out.fitted.push_back(std::move(one));
  }
  const auto count = static_cast<Index>(out.eigenvalues.size());
  out.shapes.resize(outputs, count);
  for (Index r = 0; r < count; ++r)
    for (Index o = 0; o < outputs; ++o)
      out.shapes(o, r) = {linear.solved(2 * r, o), linear.solved(2 * r + 1, o)};
  return out;
}

}  // namespace

ModalModel fit_shapes(const FrequencyResponses& f, std::vector<Complex> eigenvalues,
                      MatrixXcd participation) {
  if (f.lines() < 1 || !(f.frequencies_hz[0] > 0.0))
    throw std::invalid_argument("first spectral line: must be above 0 Hz");
  if (participation.rows() != f.inputs() ||
      participation.cols() != static_cast<Index>(eigenvalues.size()))
    throw std::invalid_argument("participation: must be inputs × modes");
  const Linear linear = solve(f, eigenvalues, participation);
  return model_of(f, std::move(eigenvalues), std::move(participation), linear);
}

ModalModel refine(const FrequencyResponses& f, const ModalModel& start) {
  std::vector<Complex> lambda = start.eigenvalues;
  MatrixXcd participation = start.participation;
  Linear linear = solve(f, lambda, participation);
  if (lambda.empty()) return model_of(f, lambda, participation, linear);
  double squares = linear.residual.squaredNorm();
  const std::vector<Free> free = free_of(participation);
  for (int step = 0; step < kMostSteps; ++step) {
    const MatrixXd j = jacobian(f, linear, lambda, participation, free);
    const VectorXd residual = linear.residual.reshaped();
    const VectorXd sizes = j.colwise().norm().transpose().cwiseMax(1e-300);
    const VectorXd scaled =
        (j * sizes.cwiseInverse().asDiagonal()).colPivHouseholderQr().solve(residual);
    const VectorXd move = -scaled.cwiseQuotient(sizes);
    if (!move.allFinite()) break;
    bool down = false;
    double share = 1.0;
    for (int halving = 0; halving < kMostHalvings && !down; ++halving, share *= 0.5) {
      std::vector<Complex> next = lambda;
      MatrixXcd factors = participation;
      bool stable = true;
      for (std::size_t p = 0; p < free.size(); ++p) {
        const Free& one = free[p];
        const Complex by =
            (one.imaginary ? kI : Complex(1.0)) * share * move[static_cast<Index>(p)];
        if (one.input < 0) {
          next[index(one.mode)] += std::abs(lambda[index(one.mode)]) * by;
        } else {
          factors(one.input, one.mode) += by;
        }
      }
      for (const Complex& l : next) stable = stable && l.real() < 0.0 && l.imag() > 0.0;
      if (!stable) continue;
      Linear tried = solve(f, next, factors);
      const double now = tried.residual.squaredNorm();
      if (!(now < squares)) continue;
      down = true;
      const bool settled = squares - now < kSettled * squares;
      squares = now;
      lambda = std::move(next);
      participation = std::move(factors);
      linear = std::move(tried);
      if (settled) step = kMostSteps;
    }
    if (!down) break;
  }
  const MatrixXd by_free = jacobian(f, linear, lambda, participation, free);
  ModalModel out = model_of(f, lambda, participation, linear);
  out.leverage = leverage(f, linear, by_free);
  return out;
}

}  // namespace wheeltap::signals
