#include "signals/modal/stochastic_subspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

/// Derivatives of f [Hz] and ζ with respect to λ: Δf = Re(f' Δλ), Δζ = Re(ζ' Δλ).
struct Slopes {
  Complex frequency, damping;
};

Slopes slopes(Complex lambda) {
  const double size = std::abs(lambda);
  return {.frequency = std::conj(lambda) / (size * 2.0 * std::numbers::pi),
          .damping = -1.0 / size + lambda.real() * std::conj(lambda) / (size * size * size)};
}

}  // namespace

/// The realisation of one order n. `up` and `down` contain the rows of U↑ and U↓.
struct StochasticSubspace::Realisation {
  int order = 0;
  MatrixXd a = {}, pseudo_inverse = {}, gram_inverse = {};  // A; U₁↑⁺; (U₁↑ᵀU₁↑)⁻¹
  VectorXcd mu = {};
  MatrixXcd right = {}, left = {};  // ψ as columns; χᴴ/(χᴴψ) as rows
  std::vector<int> pairs = {};      // indices with Im μ > 0, by frequency
};

MatrixXd block_hankel(const MatrixXd& stacked, Index channels, Index columns) {
  const Index references = stacked.cols(), rows = stacked.rows() - (columns - 1) * channels;
  MatrixXd h(rows, columns * references);
  for (Index j = 0; j < columns; ++j)
    h.middleCols(j * references, references) = stacked.middleRows(j * channels, rows);
  return h;
}

StochasticSubspace::StochasticSubspace(const OutputCovariances& covariances,
                                       SubspaceOptions options)
    : step_(options.step),
      channels_(covariances.channels()),
      blocks_(static_cast<int>(covariances.blocks.size())),
      scale_(covariances.scale) {
  const int columns = options.columns > 0 ? options.columns : covariances.lags / 2;
  const int p = covariances.lags - columns;  // R_{p+q} is the last covariance
  if (columns < 1 || p < 1)
    refuse("columns", columns,
           "must be positive and below " + std::to_string(covariances.lags) + " (number of lags)");
  const MatrixXd h = block_hankel(covariances.mean, channels_, columns);
  const double norm = 1.0 / std::sqrt(static_cast<double>(blocks_) * (blocks_ - 1.0));
  decompose(
      h,
      [&](int k) -> MatrixXd {
        return norm *
               (block_hankel(covariances.blocks[static_cast<std::size_t>(k)], channels_, columns) -
                h);
      },
      options);
}

StochasticSubspace::StochasticSubspace(const HankelFactor& factor, SubspaceOptions options)
    : step_(options.step),
      channels_(static_cast<int>(factor.scale.size())),
      blocks_(static_cast<int>(factor.moves.size())),
      scale_(factor.scale) {
  if (channels_ < 1 || factor.hankel.rows() < 2 * channels_ ||
      factor.hankel.rows() % channels_ != 0)
    refuse("rows", static_cast<double>(factor.hankel.rows()),
           "must be block rows of " + std::to_string(channels_) + " sensors, at least two");
  decompose(
      factor.hankel,
      [&](int k) -> const MatrixXd& { return factor.moves[static_cast<std::size_t>(k)]; }, options);
}

template <class Move>
void StochasticSubspace::decompose(const MatrixXd& h, const Move& move,
                                   const SubspaceOptions& options) {
  if (!(step_ > 0.0)) refuse("step", step_, "must be positive");
  // The largest even order for U₁ without its last block row.
  const int most = static_cast<int>(std::min(h.rows() - channels_, h.cols())) / 2 * 2;
  largest_ = options.largest_order > 0 ? options.largest_order / 2 * 2 : most;
  if (largest_ < 2 || largest_ > most)
    refuse("largest order", options.largest_order,
           "must be from 2 to " + std::to_string(most) + " with these lags");
  const Eigen::BDCSVD<MatrixXd> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
  u_ = svd.matrixU();
  s_ = svd.singularValues();
  const MatrixXd& v = svd.matrixV();
  const Index m = h.rows(), common = s_.size();
  turns_.resize(m, static_cast<Index>(blocks_) * largest_);
  base::parallel_for(blocks_, options.threads, [&](int k) {
    const MatrixXd& moved = move(k);
    const MatrixXd p_ji = u_.transpose() * (moved * v.leftCols(largest_));
    const MatrixXd p_ij =
        v.leftCols(common).transpose() * (moved.transpose() * u_.leftCols(largest_));
    auto out = turns_.middleCols(static_cast<Index>(k) * largest_, largest_);
    for (Index i = 0; i < largest_; ++i) {
      out.col(i).head(i + 1).setZero();
      for (Index j = i + 1; j < m; ++j) {
        const double sj = j < common ? s_[j] : 0.0;
        const double crossed = j < common ? sj * p_ij(j, i) : 0.0;
        const double gap = (s_[i] - sj) * (s_[i] + sj);
        out(j, i) = gap > 0.0 ? (s_[i] * p_ji(j, i) + crossed) / gap : 0.0;
      }
    }
  });
}

StochasticSubspace::Realisation StochasticSubspace::realise(int order) const {
  if (order < 2 || order > largest_ || order % 2 != 0)
    refuse("order", order, "must be even, from 2 to " + std::to_string(largest_));
  const Index p = u_.rows() - channels_;
  const auto up = u_.topLeftCorner(p, order), down = u_.bottomLeftCorner(p, order);
  Realisation out{.order = order};
  // The columns of U are orthonormal, and U↑ lacks only one block row.
  const MatrixXd gram = up.transpose() * up;
  out.gram_inverse = gram.ldlt().solve(MatrixXd::Identity(order, order));
  out.pseudo_inverse = out.gram_inverse * up.transpose();
  out.a = out.pseudo_inverse * down;
  const Eigen::EigenSolver<MatrixXd> eigen(out.a);
  if (eigen.info() != Eigen::Success) return out;
  out.mu = eigen.eigenvalues();
  out.right = eigen.eigenvectors();
  out.left = out.right.partialPivLu().inverse();
  for (int i = 0; i < order; ++i)
    if (out.mu[i].imag() > 0.0) out.pairs.push_back(i);
  std::ranges::sort(out.pairs, {}, [&](int i) { return std::abs(std::log(out.mu[i])); });
  return out;
}

Pole StochasticSubspace::pole(const Realisation& model, int place) const {
  const Complex lambda = std::log(model.mu[place]) / step_;
  Pole out{.order = model.order,
           .place = place,
           .eigenvalue = lambda,
           .frequency_hz = std::abs(lambda) / (2.0 * std::numbers::pi),
           .damping = -lambda.real() / std::abs(lambda),
           .shape = scale_.asDiagonal() *
                    (u_.topLeftCorner(channels_, model.order) * model.right.col(place)),
           .frequency_sd = std::numeric_limits<double>::quiet_NaN(),
           .damping_sd = std::numeric_limits<double>::quiet_NaN()};
  Index largest = 0;
  out.shape.cwiseAbs().maxCoeff(&largest);
  out.shape /= Complex(out.shape[largest]);
  return out;
}

std::vector<Pole> StochasticSubspace::poles(int order, const PoleWindow& window) const {
  const Realisation model = realise(order);
  const Index m = u_.rows(), p = m - channels_, rest = m - order;
  std::vector<Pole> out;
  for (const int place : model.pairs) {
    Pole one = pole(model, place);
    if (one.frequency_hz >= window.lowest_hz && one.frequency_hz <= window.highest_hz &&
        one.damping >= window.lowest_damping && one.damping <= window.highest_damping)
      out.push_back(std::move(one));
  }
  if (out.empty()) return out;
  // Δμ = [(0, a) - μ (a, 0)] ΔU ψ + e ΔU w, a = χ U↑⁺, e = ((U↓ - μ U↑) ψ, 0), w = χ (U↑ᵀU↑)⁻¹.
  const auto count = static_cast<Index>(out.size());
  MatrixXcd psi(order, count), chi(count, order);
  VectorXcd mu(count);
  for (Index i = 0; i < count; ++i) {
    const int place = out[static_cast<std::size_t>(i)].place;
    psi.col(i) = model.right.col(place);
    chi.row(i) = model.left.row(place);
    mu[i] = model.mu[place];
  }
  const MatrixXcd a = chi * model.pseudo_inverse, w = chi * model.gram_inverse;
  MatrixXcd b = MatrixXcd::Zero(count, m), e = MatrixXcd::Zero(count, m);
  b.rightCols(p) = a;
  b.leftCols(p) -= mu.asDiagonal() * a;
  const MatrixXcd upper = u_.topLeftCorner(p, order) * psi,
                  lower = u_.bottomLeftCorner(p, order) * psi;
  e.leftCols(p) = (lower - upper * mu.asDiagonal()).transpose();
  // Real and imaginary parts are stacked, so that only real products are needed.
  MatrixXd rows(4 * count, m);
  rows << b.real(), b.imag(), e.real(), e.imag();
  const MatrixXd turned = rows * u_.rightCols(rest);
  Eigen::ArrayXd squares_f = Eigen::ArrayXd::Zero(count), squares_z = squares_f;
  for (int k = 0; k < blocks_; ++k) {
    const MatrixXd z = turned * turns_.block(order, static_cast<Index>(k) * largest_, rest, order);
    for (Index i = 0; i < count; ++i) {
      const Complex first(0.0, 1.0);
      Complex moved = 0.0;
      for (Index c = 0; c < order; ++c)
        moved += (z(i, c) + first * z(count + i, c)) * psi(c, i) +
                 (z(2 * count + i, c) + first * z(3 * count + i, c)) * w(i, c);
      const Complex lambda = moved / (mu[i] * step_);
      const Slopes by = slopes(out[static_cast<std::size_t>(i)].eigenvalue);
      squares_f[i] += std::pow((by.frequency * lambda).real(), 2);
      squares_z[i] += std::pow((by.damping * lambda).real(), 2);
    }
  }
  for (Index i = 0; i < count; ++i) {
    out[static_cast<std::size_t>(i)].frequency_sd = std::sqrt(squares_f[i]);
    out[static_cast<std::size_t>(i)].damping_sd = std::sqrt(squares_z[i]);
  }
  return out;
}

MovedPoles StochasticSubspace::moved_poles(int order, const std::vector<int>& places) const {
  const Realisation model = realise(order);
  const Index m = u_.rows(), p = m - channels_, rest = m - order;
  const auto count = static_cast<Index>(places.size());
  MovedPoles out{.poles = {},
                 .frequency_moves = MatrixXd(count, blocks_),
                 .damping_moves = MatrixXd(count, blocks_),
                 .shape_moves = {}};
  std::vector<VectorXcd> raw;
  std::vector<Index> largest;
  for (const int place : places) {
    if (place < 0 || place >= order) refuse("index", place, "must be less than the model order");
    out.poles.push_back(pole(model, place));
    out.shape_moves.emplace_back(2 * channels_, blocks_);
    raw.emplace_back(scale_.asDiagonal() *
                     (u_.topLeftCorner(channels_, order) * model.right.col(place)));
    raw.back().cwiseAbs().maxCoeff(&largest.emplace_back());
  }
  // Coordinates of ΔU₁ along the other singular vectors.
  const auto others = u_.rightCols(rest);
  const MatrixXd into_down = model.pseudo_inverse * others.bottomRows(p),
                 into_up = model.pseudo_inverse * others.topRows(p),
                 residual = others.topRows(p).transpose() *
                            (u_.bottomLeftCorner(p, order) - u_.topLeftCorner(p, order) * model.a);
  for (int k = 0; k < blocks_; ++k) {
    const auto z = turns_.block(order, static_cast<Index>(k) * largest_, rest, order);
    // ΔA = U↑⁺ (ΔU↓ - ΔU↑ A) + (U↑ᵀU↑)⁻¹ ΔU↑ᵀ (U↓ - U↑ A)
    const MatrixXd da =
        into_down * z - into_up * z * model.a + model.gram_inverse * (z.transpose() * residual);
    const MatrixXd dc = others.topRows(channels_) * z;
    for (Index i = 0; i < count; ++i) {
      const int place = places[static_cast<std::size_t>(i)];
      const Complex mu = model.mu[place];
      VectorXcd mixed = model.left * (da * model.right.col(place));
      const Complex lambda = mixed[place] / (mu * step_);
      const Slopes by = slopes(out.poles[static_cast<std::size_t>(i)].eigenvalue);
      out.frequency_moves(i, k) = (by.frequency * lambda).real();
      out.damping_moves(i, k) = (by.damping * lambda).real();
      // Δψ = Σ_{j ≠ i} χ_j ΔA ψ_i / (μ_i - μ_j) ψ_j; the component along ψ_i is only a scale.
      for (Index j = 0; j < order; ++j)
        mixed[j] = j == place ? Complex(0.0) : Complex(mixed[j] / (mu - model.mu[j]));
      const VectorXcd dphi =
          scale_.asDiagonal() * (dc * model.right.col(place) +
                                 u_.topLeftCorner(channels_, order) * (model.right * mixed));
      // φ / φ_m: Δ = (Δφ - φ/φ_m Δφ_m) / φ_m.
      const Index top = largest[static_cast<std::size_t>(i)];
      const VectorXcd& phi = raw[static_cast<std::size_t>(i)];
      const VectorXcd moved = (dphi - phi * (dphi[top] / phi[top])) / phi[top];
      out.shape_moves[static_cast<std::size_t>(i)].col(k) << moved.real(), moved.imag();
    }
  }
  for (Index i = 0; i < count; ++i) {
    out.poles[static_cast<std::size_t>(i)].frequency_sd = out.frequency_moves.row(i).norm();
    out.poles[static_cast<std::size_t>(i)].damping_sd = out.damping_moves.row(i).norm();
  }
  return out;
}

double modal_assurance(const Eigen::Ref<const VectorXcd>& a, const Eigen::Ref<const VectorXcd>& b) {
  const double sizes = a.squaredNorm() * b.squaredNorm();
  return sizes > 0.0 ? std::norm(a.dot(b)) / sizes : 0.0;
}

namespace {

struct Spread {
  double real, imaginary, mixed;
};

Spread spread(const Eigen::Ref<const VectorXcd>& shape) {
  return {.real = shape.real().squaredNorm(),
          .imaginary = shape.imag().squaredNorm(),
          .mixed = shape.real().dot(shape.imag())};
}

}  // namespace

double phase_collinearity(const Eigen::Ref<const VectorXcd>& shape) {
  const Spread s = spread(shape);
  const double sum = s.real + s.imaginary, difference = s.real - s.imaginary;
  return sum > 0.0 ? (difference * difference + 4.0 * s.mixed * s.mixed) / (sum * sum) : 0.0;
}

double mean_phase_deviation(const Eigen::Ref<const VectorXcd>& shape) {
  const Spread s = spread(shape);
  const double line = 0.5 * std::atan2(2.0 * s.mixed, s.real - s.imaginary);
  double sum = 0.0, weights = 0.0;
  for (const Complex x : shape) {
    const Complex turned = x * std::polar(1.0, -line);
    const double size = std::abs(x);
    sum += size * std::atan2(std::abs(turned.imag()), std::abs(turned.real()));
    weights += size;
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace wheeltap::signals
