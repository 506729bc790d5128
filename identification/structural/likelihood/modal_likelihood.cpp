#include "identification/structural/likelihood/modal_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "identification/structural/likelihood/mode_matching.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = fem::ParametricModes::Modes;

/// Number of additional computed modes with which measured modes may be matched.
constexpr int kFurtherModes = 3;

double frequency_of(const Modes& modes, Index i) {
  return std::sqrt(std::max(0.0, modes.eigenvalues[i])) / kTwoPi;
}

struct Turn {
  Index mode = -1;
  double tau = 0.0;
};

/// The closest other mode, and the sd of the rotation towards it.
Turn closest(const Modes& modes, Index i) {
  Turn turn;
  double least = ModalLikelihood::kClose;
  for (const Index k : {i - 1, i + 1}) {
    if (k < 0 || k >= modes.eigenvalues.size()) continue;
    const double mean = 0.5 * (modes.eigenvalues[i] + modes.eigenvalues[k]);
    const double gap = std::abs(modes.eigenvalues[i] - modes.eigenvalues[k]) / mean;
    if (gap >= least) continue;
    least = gap;
    turn.mode = k;
  }
  if (turn.mode < 0) return turn;
  // For twin modes, any large value is equivalent to a uniform angle.
  const double gap = std::max(least, 1e-2 * ModalLikelihood::kMixing);
  turn.tau =
      ModalLikelihood::kMixing *
      std::sqrt(1.0 / (gap * gap) - 1.0 / (ModalLikelihood::kClose * ModalLikelihood::kClose));
  return turn;
}

}  // namespace

double eigenvalue_of(double frequency_hz) {
  const double omega = kTwoPi * frequency_hz;
  const double lambda = omega * omega;
  // λ in floating point has twice the resolution of f: search the nearest few values.
  constexpr double kUp = std::numeric_limits<double>::infinity();
  double low = lambda, high = lambda;
  for (int i = 0; i < 8; ++i) {
    if (std::sqrt(low) / kTwoPi == frequency_hz) return low;
    if (std::sqrt(high) / kTwoPi == frequency_hz) return high;
    low = std::nextafter(low, -kUp);
    high = std::nextafter(high, kUp);
  }
  return lambda;
}

double mixing_sd(const ModalNoise& noise, double first, double second) {
  const double gap = std::abs(first - second), size = std::sqrt(std::max(0.0, first * second));
  return std::min(1.0, noise.mixing * 2.0 * noise.discrepancy * size / std::max(gap, 1e-12 * size));
}

ModalLikelihood::ModalLikelihood(ModalData data) : data_(std::move(data)) {
  const int n = data_.modes();
  const auto refuse = [](int mode, const std::string& message) {
    throw std::invalid_argument("mode " + std::to_string(mode + 1) + ": " + message);
  };
  shapes_.resize(static_cast<std::size_t>(n));
  entries_.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    if (!std::isnan(data_.frequencies_hz[static_cast<std::size_t>(i)]))
      with_frequency_.push_back(i);
  if (!(data_.doubt >= 0.0 && data_.doubt < 1.0))
    throw std::invalid_argument("doubt must be in [0, 1)");
  numbered_ = !data_.has_shapes() && (data_.cov_prior || data_.covariance.isDiagonal(0.0));
  if (!data_.has_shapes() && data_.doubt > 0.0) throw std::invalid_argument("doubt needs shapes");
  if (!data_.has_shapes()) return;
  if (data_.shapes.rows() != n || data_.shapes.cols() != static_cast<Index>(data_.sensors.size()))
    throw std::invalid_argument("shapes must have one row per mode and one column per sensor");
  for (int i = 0; i < n; ++i) {
    auto& entries = entries_[static_cast<std::size_t>(i)];
    for (Index s = 0; s < data_.shapes.cols(); ++s)
      if (!std::isnan(data_.shapes(i, s))) entries.push_back(static_cast<int>(s));
    if (entries.empty()) continue;
    try {
      shapes_[static_cast<std::size_t>(i)].emplace(
          data_.shapes.row(i).transpose()(entries),
          data_.shape_covariances.at(static_cast<std::size_t>(i))(entries, entries));
    } catch (const std::invalid_argument& error) {
      refuse(i, error.what());
    }
  }
}

int ModalLikelihood::measured() const {
  int sum = static_cast<int>(with_frequency_.size());
  for (const auto& shape : shapes_) sum += shape ? shape->freedoms() : 0;
  return sum;
}

int ModalLikelihood::candidates(int available) const {
  return std::min(available,
                  data_.modes() + data_.predict + (data_.has_shapes() ? kFurtherModes : 0));
}

MatrixXd ModalLikelihood::covariance(const ModalNoise& noise) const {
  MatrixXd c = data_.cov_prior ? MatrixXd::Zero(data_.modes(), data_.modes()) : data_.covariance;
  const double relative =
      (data_.cov_prior ? noise.cov * noise.cov : 0.0) + noise.discrepancy * noise.discrepancy;
  for (const int i : with_frequency_) {
    const double f = data_.frequencies_hz[static_cast<std::size_t>(i)];
    c(i, i) += relative * f * f;
    if (!noise.emulator_variance.empty())
      c(i, i) += noise.emulator_variance[static_cast<std::size_t>(i)];
  }
  return c;
}

VectorXd ModalLikelihood::entries(const MatrixXd& shapes, int mode, Index computed) const {
  return shapes.col(computed)(entries_[static_cast<std::size_t>(mode)]);
}

ShapeDensity::Comparison ModalLikelihood::compare(const Modes& modes, int mode, Index computed,
                                                  const ModalNoise& noise) const {
  const ShapeDensity& density = *shapes_[static_cast<std::size_t>(mode)];
  const double scale = noise.shape_sd * noise.shape_sd;
  const double more = noise.shape_discrepancy * noise.shape_discrepancy;
  const VectorXd shape = entries(modes.shapes, mode, computed);
  const Turn turn = closest(modes, computed);
  if (noise.mixing > 0.0 && noise.discrepancy > 0.0)
    return density.against(shape, mixing_of(modes, mode, computed, noise), scale, more);
  if (turn.tau == 0.0) return density.against(shape, scale, more);
  return density.against(shape, entries(modes.shapes, mode, turn.mode), turn.tau, scale, more);
}

ShapeDensity::Mixing ModalLikelihood::mixing_of(const Modes& modes, int mode, Index computed,
                                                const ModalNoise& noise) const {
  const Turn turn = closest(modes, computed);
  const auto size = static_cast<Index>(entries_[static_cast<std::size_t>(mode)].size());
  ShapeDensity::Mixing out{.others = MatrixXd(size, 0), .tau = VectorXd(0)};
  if (noise.mixing > 0.0 && noise.discrepancy > 0.0) {
    const Index others = modes.eigenvalues.size() - 1;
    out.others.resize(size, others);
    out.tau.resize(others);
    for (Index k = 0, at = 0; k <= others; ++k) {
      if (k == computed) continue;
      out.others.col(at) = entries(modes.shapes, mode, k);
      const double tau = mixing_sd(noise, modes.eigenvalues[computed], modes.eigenvalues[k]);
      out.tau[at++] = std::min(1.0, k == turn.mode ? std::hypot(tau, turn.tau) : tau);
    }
  } else if (turn.tau > 0.0) {
    out.others = entries(modes.shapes, mode, turn.mode);
    out.tau = VectorXd::Constant(1, std::min(1.0, turn.tau));
  }
  return out;
}

ModalLikelihood::ShapeErrors ModalLikelihood::shape_errors(const Modes& modes, int mode,
                                                           Index computed,
                                                           const ModalNoise& noise) const {
  const VectorXd& lambda = modes.eigenvalues;
  const VectorXd shape = entries(modes.shapes, mode, computed);
  // `moved` (below) contains the mixing by stiffness errors.
  ModalNoise unmixed = noise;
  unmixed.mixing = 0.0;
  const ShapeDensity::Mixing mixing = mixing_of(modes, mode, computed, unmixed);
  // ∂φ_j/∂a_p = Σ_k φ_k φ_kᵀ K_p φ_j / (λ_j - λ_k) over the computed modes.
  MatrixXd moved = MatrixXd::Zero(shape.size(), static_cast<Index>(modes.pieces.size()));
  for (Index k = 0; k < lambda.size(); ++k) {
    if (k == computed) continue;
    const double gap = lambda[computed] - lambda[k], least = kClose * lambda[computed];
    const double by = std::abs(gap) < least ? std::copysign(least, gap) : gap;
    const VectorXd other = entries(modes.shapes, mode, k);
    for (Index p = 0; p < moved.cols(); ++p)
      moved.col(p) += modes.pieces[static_cast<std::size_t>(p)](k, computed) / by * other;
  }
  ShapeErrors out;
  out.without = shapes_[static_cast<std::size_t>(mode)]->against(
      shape, mixing, noise.shape_sd * noise.shape_sd,
      noise.shape_discrepancy * noise.shape_discrepancy, moved, out.residual, out.sensitivities);
  return out;
}

std::vector<int> ModalLikelihood::match(const Modes& modes, const MatrixXd& covariance,
                                        const ModalNoise& noise) const {
  const int n = data_.modes();
  std::vector<int> out(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) out[static_cast<std::size_t>(i)] = i;
  if (!data_.has_shapes()) return out;
  const Index computed = modes.eigenvalues.size();
  const bool doubt = data_.doubt > 0.0;
  // Rows that are gaps are not matched.
  std::vector<int> rows;
  for (int i = 0; i < n; ++i)
    if (!data_.is_gap(i)) rows.push_back(i);
  for (int& j : out) j = std::min(j, static_cast<int>(computed) - 1);
  MatrixXd costs = MatrixXd::Zero(n, computed + (doubt ? n : 0));
  for (const int i : rows) {
    const double f = data_.frequencies_hz[static_cast<std::size_t>(i)];
    for (Index j = 0; j < computed; ++j) {
      const double r = f - frequency_of(modes, j);
      if (!std::isnan(f)) costs(i, j) += 0.5 * r * r / covariance(i, i);
      if (shapes_[static_cast<std::size_t>(i)])
        costs(i, j) -= compare(modes, i, j, noise).log_density;
    }
    if (!doubt) continue;
    costs.row(i).tail(n).setConstant(std::numeric_limits<double>::infinity());
    costs(i, computed + i) = -log_spurious(i) + std::log1p(-data_.doubt) -
                             (std::isnan(f) ? 0.0 : 0.5 * std::log(kTwoPi * covariance(i, i)));
  }
  const std::vector<int> assigned = least_cost_assignment(costs(rows, Eigen::all));
  for (std::size_t k = 0; k < rows.size(); ++k)
    out[static_cast<std::size_t>(rows[k])] = assigned[k];
  if (!doubt) return out;
  // A spurious mode is compared with the nearest computed mode that has no match.
  std::vector<bool> taken(static_cast<std::size_t>(computed));
  for (const int j : assigned)
    if (j < computed) taken[static_cast<std::size_t>(j)] = true;
  for (const int i : rows) {
    int& j = out[static_cast<std::size_t>(i)];
    if (j < computed) continue;
    j = -1;
    for (int k = 0; k < computed; ++k)
      if (!taken[static_cast<std::size_t>(k)] && (j < 0 || costs(i, k) < costs(i, j))) j = k;
    if (j >= 0) continue;
    Index nearest = 0;
    costs.row(i).head(computed).minCoeff(&nearest);
    j = static_cast<int>(nearest);
  }
  return out;
}

double ModalLikelihood::log_spurious(int mode) const {
  const auto i = static_cast<std::size_t>(mode);
  double out = std::log(data_.doubt);
  if (!std::isnan(data_.frequencies_hz[i])) {
    double highest = 0.0;
    for (const double f : data_.frequencies_hz)
      if (!std::isnan(f)) highest = std::max(highest, f);
    out -= std::log(kBand * highest);
  }
  if (shapes_[i]) out += shapes_[i]->log_uniform_density();
  return out;
}

ModalLikelihood::Score ModalLikelihood::score_with_doubt(const Modes& modes,
                                                         const ModalNoise& noise) const {
  const MatrixXd c = covariance(noise);
  const std::vector<int> matched = match(modes, c, noise);
  Score out;
  for (int i = 0; i < data_.modes(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Index j = matched[at];
    Match m{.computed = static_cast<int>(j), .frequency_hz = frequency_of(modes, j)};
    if (data_.is_gap(i)) {
      out.matches.push_back(std::move(m));
      continue;
    }
    double real = std::log1p(-data_.doubt), chi_square = 0.0;
    int freedoms = 0;
    if (const double f = data_.frequencies_hz[at]; !std::isnan(f)) {
      const double square = (f - m.frequency_hz) * (f - m.frequency_hz) / c(i, i);
      real -= 0.5 * (square + std::log(kTwoPi * c(i, i)));
      chi_square += square;
      ++freedoms;
    }
    if (shapes_[at]) {
      m.shape = compare(modes, i, j, noise);
      real += m.shape->log_density;
      chi_square += m.shape->chi_square;
      freedoms += shapes_[at]->freedoms();
    }
    const double spurious = log_spurious(i), most = std::max(real, spurious);
    m.log_likelihood = most + std::log(std::exp(real - most) + std::exp(spurious - most));
    m.spurious = std::exp(spurious - m.log_likelihood);
    out.log_likelihood += m.log_likelihood;
    if (m.spurious < 0.5) {
      out.chi_square += chi_square;
      out.freedoms += freedoms;
    }
    out.matches.push_back(std::move(m));
  }
  return out;
}

ModalLikelihood::Score ModalLikelihood::score(const Modes& modes, const ModalNoise& noise) const {
  if (data_.doubt > 0.0) return score_with_doubt(modes, noise);
  Score out;
  const MatrixXd c = covariance(noise);
  const std::vector<int> matched = match(modes, c, noise);
  for (int i = 0; i < data_.modes(); ++i) {
    const Index j = matched[static_cast<std::size_t>(i)];
    Match m{.computed = static_cast<int>(j), .frequency_hz = frequency_of(modes, j)};
    if (shapes_[static_cast<std::size_t>(i)]) {
      m.shape = compare(modes, i, j, noise);
      out.log_likelihood += m.shape->log_density;
      out.chi_square += m.shape->chi_square;
    }
    out.matches.push_back(std::move(m));
  }
  out.freedoms = measured();
  const auto n = static_cast<Index>(with_frequency_.size());
  if (n == 0) return out;
  VectorXd r(n);
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(with_frequency_[static_cast<std::size_t>(k)]);
    r[k] = data_.frequencies_hz[i] - out.matches[i].frequency_hz;
  }
  const Eigen::LLT<MatrixXd> llt(c(with_frequency_, with_frequency_));
  if (llt.info() != Eigen::Success) {
    out.log_likelihood = -std::numeric_limits<double>::infinity();
    return out;
  }
  const double chi_square = llt.matrixL().solve(r).squaredNorm();
  out.chi_square += chi_square;
  out.log_likelihood -= 0.5 * chi_square + 0.5 * static_cast<double>(n) * std::log(kTwoPi);
  for (Index k = 0; k < n; ++k) out.log_likelihood -= std::log(llt.matrixLLT()(k, k));
  return out;
}

bool ModalLikelihood::add_density_of_frequencies(const Modes& modes, const ModalNoise& noise,
                                                 double& log_density,
                                                 std::vector<double>& frequencies_hz) const {
  if (!numbered_) return false;
  const double relative =
      (data_.cov_prior ? noise.cov * noise.cov : 0.0) + noise.discrepancy * noise.discrepancy;
  for (std::size_t i = 0; i < data_.frequencies_hz.size(); ++i) {
    const double computed = frequency_of(modes, static_cast<Index>(i));
    frequencies_hz.push_back(computed);
    const double f = data_.frequencies_hz[i];
    if (std::isnan(f)) continue;
    const auto at = static_cast<Index>(i);
    double variance = relative * f * f + (data_.cov_prior ? 0.0 : data_.covariance(at, at));
    if (!noise.emulator_variance.empty()) variance += noise.emulator_variance[i];
    log_density -= 0.5 * ((f - computed) * (f - computed) / variance + std::log(kTwoPi * variance));
  }
  return true;
}

VectorXd ModalLikelihood::pulls(const Modes& modes, const std::vector<int>& matched,
                                const MatrixXd& covariance) const {
  const auto n = static_cast<Index>(with_frequency_.size());
  VectorXd r(n);
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(with_frequency_[static_cast<std::size_t>(k)]);
    r[k] = data_.frequencies_hz[i] - frequency_of(modes, matched[i]);
  }
  if (n == 0) return r;
  if (data_.doubt > 0.0) return r.cwiseQuotient(VectorXd(covariance.diagonal()(with_frequency_)));
  return covariance(with_frequency_, with_frequency_).llt().solve(r);
}

std::vector<double> ModalLikelihood::pulls(const Modes& modes, const ModalNoise& noise) const {
  const MatrixXd c = covariance(noise);
  const std::vector<int> matched = match(modes, c, noise);
  const VectorXd pull = pulls(modes, matched, c);
  std::vector<double> out(static_cast<std::size_t>(modes.eigenvalues.size()), 0.0);
  for (Index k = 0; k < pull.size(); ++k) {
    const auto i = static_cast<std::size_t>(with_frequency_[static_cast<std::size_t>(k)]);
    out[static_cast<std::size_t>(matched[i])] = pull[k];
  }
  return out;
}

VectorXd ModalLikelihood::real(const Modes& modes, const ModalNoise& noise) const {
  VectorXd out = VectorXd::Ones(data_.modes());
  if (data_.doubt == 0.0) return out;
  const Score found = score_with_doubt(modes, noise);
  for (Index i = 0; i < out.size(); ++i)
    out[i] -= found.matches[static_cast<std::size_t>(i)].spurious;
  return out;
}

void ModalLikelihood::slope(const Modes& modes, const fem::ParametricModes::Slopes& slopes,
                            const ModalNoise& noise, std::span<double> out) const {
  const MatrixXd c = covariance(noise);
  const std::vector<int> matched = match(modes, c, noise);
  std::ranges::fill(out, 0.0);
  const auto computed = [&](int i) {
    return static_cast<Index>(matched[static_cast<std::size_t>(i)]);
  };
  const VectorXd real = this->real(modes, noise);
  VectorXd pull = pulls(modes, matched, c);
  for (Index k = 0; k < pull.size(); ++k) {
    const int i = with_frequency_[static_cast<std::size_t>(k)];
    // f = √λ / 2π:  ∂f = ∂λ / (8π² f).
    const double rate =
        pull[k] * real[i] / (2.0 * kTwoPi * kTwoPi * frequency_of(modes, computed(i)));
    for (std::size_t p = 0; p < out.size(); ++p)
      out[p] += rate * slopes.eigenvalues(computed(i), static_cast<Index>(p));
  }
  const double scale = noise.shape_sd * noise.shape_sd;
  const double more = noise.shape_discrepancy * noise.shape_discrepancy;
  std::vector<int> turned;
  for (int i = 0; i < data_.modes(); ++i) {
    const auto& density = shapes_[static_cast<std::size_t>(i)];
    if (!density) continue;
    const Index j = computed(i);
    if (closest(modes, j).tau > 0.0 || (noise.mixing > 0.0 && noise.discrepancy > 0.0)) {
      turned.push_back(i);
      continue;
    }
    const VectorXd s = real[i] * density->slope(entries(modes.shapes, i, j), scale, more);
    for (std::size_t p = 0; p < out.size(); ++p) out[p] += s.dot(entries(slopes.shapes[p], i, j));
  }
  if (turned.empty()) return;
  constexpr double kStep = 1e-5;  // relative change of the modes
  Modes moved;
  for (std::size_t p = 0; p < out.size(); ++p) {
    const VectorXd by = slopes.eigenvalues.col(static_cast<Index>(p));
    const double fastest =
        std::max((by.array() / modes.eigenvalues.array()).abs().maxCoeff(),
                 slopes.shapes[p].norm() / std::max(modes.shapes.norm(), 1e-300));
    if (!(fastest > 0.0)) continue;
    const double step = kStep / fastest;
    for (const double way : {step, -step}) {
      moved.eigenvalues = modes.eigenvalues + way * by;
      moved.shapes = modes.shapes + way * slopes.shapes[p];
      for (const int i : turned)
        out[p] += real[i] * compare(moved, i, computed(i), noise).log_density / (2.0 * way);
    }
  }
}

MatrixXd ModalLikelihood::information(const Modes& modes,
                                      const fem::ParametricModes::Slopes& slopes,
                                      const ModalNoise& noise) const {
  const MatrixXd c = covariance(noise);
  const std::vector<int> matched = match(modes, c, noise);
  const Index d = slopes.eigenvalues.cols();
  const auto n = static_cast<Index>(with_frequency_.size());
  const VectorXd real = this->real(modes, noise);
  MatrixXd out = MatrixXd::Zero(d, d);
  MatrixXd frequencies(n, d);
  for (Index k = 0; k < n; ++k) {
    const int i = with_frequency_[static_cast<std::size_t>(k)];
    const Index j = matched[static_cast<std::size_t>(i)];
    frequencies.row(k) = std::sqrt(real[i]) / (2.0 * kTwoPi * kTwoPi * frequency_of(modes, j)) *
                         slopes.eigenvalues.row(j);
  }
  if (n > 0)
    out += frequencies.transpose() *
           MatrixXd(c(with_frequency_, with_frequency_)).llt().solve(frequencies);
  for (int i = 0; i < data_.modes(); ++i) {
    const auto& density = shapes_[static_cast<std::size_t>(i)];
    if (!density) continue;
    const Index j = matched[static_cast<std::size_t>(i)];
    const VectorXd shape = entries(modes.shapes, i, j);
    MatrixXd moved(shape.size(), d), moves;
    for (Index p = 0; p < d; ++p)
      moved.col(p) = entries(slopes.shapes[static_cast<std::size_t>(p)], i, j);
    VectorXd residual;
    static_cast<void>(density->against(
        shape, mixing_of(modes, i, j, noise), noise.shape_sd * noise.shape_sd,
        noise.shape_discrepancy * noise.shape_discrepancy, moved, residual, moves));
    out += real[i] * moves.transpose() * moves;
  }
  return out;
}

}  // namespace wheeltap::identification
