#include "signals/modal/free_decay.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/random.hpp"
#include "signals/refuse.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int kSurrogates = 200;
constexpr int kMostHankelRows = 500;  // largest number of rows or columns of the Hankel matrix
constexpr int kSmallestOrders = 20, kLargestOrders = 60;
constexpr double kKeptBand = 0.4;  // decimate() keeps frequencies up to this share of the new rate
constexpr double kHankelRows = 1.2;
constexpr double kMovedPole = 0.05;  // distance of a refined pole from that of the diagram

/// Number of decimated samples at each end of a record that the filter of decimate() distorts, and
/// largest share of a decay's length, and of its energy at the start, that these samples may take.
constexpr Index kFilterReach = 32;
constexpr double kLostShare = 0.2;

Index shortest(const std::vector<MatrixXd>& decays) {
  Index length = decays.front().cols();
  for (const MatrixXd& d : decays) length = std::min(length, d.cols());
  return length;
}

/// The largest factor of decimation for which the distorted samples contain little of the decays.
double largest_decimation(const std::vector<MatrixXd>& decays) {
  const Index length = shortest(decays);
  VectorXd energy = VectorXd::Zero(length);  // summed over channels and decays, per sample
  for (const MatrixXd& d : decays) {
    const MatrixXd y = d.leftCols(length);
    energy += (y.colwise() - y.rowwise().mean()).colwise().squaredNorm().transpose();
  }
  const double most = kLostShare * energy.sum();
  Index first = 0;  // samples with this energy
  for (double sum = 0.0; first < length && sum + energy[first] <= most; ++first)
    sum += energy[first];
  const double of_length = 0.5 * kLostShare * static_cast<double>(length);
  return std::min(of_length, static_cast<double>(first)) / static_cast<double>(kFilterReach);
}

/// Decays of equal length, decimated to the band, without their final means. A decay starts
/// suddenly, so that the filter distorts its first and last samples; these are removed. The rest is
/// a free decay with the same poles.
std::vector<MatrixXd> prepared(const std::vector<MatrixXd>& decays, int factor) {
  const Index length = shortest(decays);
  std::vector<MatrixXd> out;
  for (const MatrixXd& d : decays) {
    MatrixXd one;
    for (Index c = 0; c < d.rows(); ++c) {
      std::vector<double> x(index(length));
      Eigen::Map<Eigen::RowVectorXd>(x.data(), length) = d.row(c).head(length);
      detrend(x, 0);
      const std::vector<double> less = factor > 1 ? decimate(x, factor) : x;
      if (c == 0) one.resize(d.rows(), static_cast<Index>(less.size()));
      one.row(c) = Eigen::Map<const Eigen::RowVectorXd>(less.data(), one.cols());
    }
    if (factor > 1) one = one.middleCols(kFilterReach, one.cols() - 2 * kFilterReach).eval();
    out.push_back(std::move(one));
  }
  return out;
}

/// Samples in the layout of OutputCovariances (R_1, R_2, … as block rows), one decay per reference.
MatrixXd stacked(const std::vector<MatrixXd>& decays, Index lags) {
  const Index channels = decays.front().rows();
  MatrixXd out(lags * channels, static_cast<Index>(decays.size()));
  for (std::size_t e = 0; e < decays.size(); ++e)
    out.col(static_cast<Index>(e)) = decays[e].leftCols(lags).reshaped();
  return out;
}

/// Model of all channels of all decays: sums over modes and a constant, y(t) = Re Σ c e^{λt} + c₀.
/// c and c₀ follow from least squares.
struct DecayModel {
  std::vector<Complex> poles;
  MatrixXd basis;     ///< samples × (2 · modes + 1): Re e^{λt}, -Im e^{λt}, 1
  MatrixXd factors;   ///< Re c, Im c, c₀ × (channels · decays)
  MatrixXd residual;  ///< samples × (channels · decays)
  Eigen::ColPivHouseholderQR<MatrixXd> qr;

  /// The part of x that is orthogonal to the basis.
  [[nodiscard]] MatrixXd across(const MatrixXd& x) const { return x - basis * qr.solve(x); }
  [[nodiscard]] double squares() const { return residual.squaredNorm(); }
};

DecayModel fit(const MatrixXd& y, std::vector<Complex> poles, double step) {
  DecayModel out{.poles = std::move(poles), .basis = {}, .factors = {}, .residual = {}, .qr = {}};
  out.basis.resize(y.rows(), 2 * static_cast<Index>(out.poles.size()) + 1);
  for (Index k = 0; k < y.rows(); ++k) {
    for (std::size_t m = 0; m < out.poles.size(); ++m) {
      const Complex x = std::exp(out.poles[m] * (step * static_cast<double>(k)));
      out.basis(k, 2 * static_cast<Index>(m)) = x.real();
      out.basis(k, 2 * static_cast<Index>(m) + 1) = -x.imag();
    }
    out.basis(k, out.basis.cols() - 1) = 1.0;
  }
  out.qr.compute(out.basis);
  out.factors = out.qr.solve(y);
  out.residual = y - out.basis * out.factors;
  return out;
}

/// ∂ (Re Σ c e^{λt})/∂λ of one mode, with respect to its real or imaginary part, with c fixed.
MatrixXd slope(const DecayModel& model, std::size_t mode, bool imaginary, double step) {
  const auto column = 2 * static_cast<Index>(mode);
  MatrixXd pair(model.basis.rows(), 2);
  for (Index k = 0; k < pair.rows(); ++k) {
    const Complex x(model.basis(k, column), -model.basis(k, column + 1));
    const Complex moved = step * static_cast<double>(k) * (imaginary ? Complex(0.0, 1.0) * x : x);
    pair(k, 0) = moved.real();
    pair(k, 1) = -moved.imag();
  }
  return pair * model.factors.middleRows(column, 2);
}

/// Columns ∂y/∂λ for the real and the imaginary part of each mode, each column over all of y. With
/// `across`, only their parts that are orthogonal to the basis.
MatrixXd decay_slopes(const DecayModel& model, double step, bool across) {
  MatrixXd out(model.residual.size(), 2 * static_cast<Index>(model.poles.size()));
  for (std::size_t m = 0; m < model.poles.size(); ++m)
    for (const bool imaginary : {false, true}) {
      const MatrixXd one = slope(model, m, imaginary, step);
      out.col(2 * static_cast<Index>(m) + (imaginary ? 1 : 0)) =
          (across ? model.across(one) : one).reshaped();
    }
  return out;
}

/// Fits poles and factors by least squares, starting from `poles`: variable projection (Golub &
/// Pereyra 1973) with Kaufman's Jacobian (1975).
DecayModel refine_decays(const MatrixXd& y, const std::vector<Complex>& poles, double step) {
  DecayModel out = fit(y, poles, step);
  if (poles.empty()) return out;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const VectorXd move = decay_slopes(out, step, true)
                              .colPivHouseholderQr()
                              .solve(VectorXd(out.residual.reshaped()));
    if (!move.allFinite()) break;
    double share = 1.0;
    bool down = false;
    for (int halving = 0; halving < 8 && !down; ++halving, share *= 0.5) {
      std::vector<Complex> next = out.poles;
      bool stable = true;
      for (std::size_t m = 0; m < next.size(); ++m) {
        const auto at_m = 2 * static_cast<Index>(m);
        next[m] += share * Complex(move[at_m], move[at_m + 1]);
        stable = stable && next[m].real() < 0.0 && next[m].imag() > 0.0;
      }
      if (!stable) continue;
      DecayModel tried = fit(y, std::move(next), step);
      if (!(tried.squares() < out.squares())) continue;
      down = true;
      if (out.squares() - tried.squares() < 1e-12 * out.squares()) iteration = 30;
      out = std::move(tried);
    }
    if (!down) break;
  }
  return out;
}

/// Selects the clusters that explain more of the decays than noise would. For a cluster of noise,
/// the residual sum of squares increases by a χ² of 2 · channels · decays numbers if the cluster is
/// removed. Because the frequency is free, the limit is that of the largest of as many such χ² as
/// there are samples. Clusters are removed one by one, the smallest first.
void drop_noise(Stabilisation& diagram, const MatrixXd& y, double step) {
  const auto numbers = static_cast<double>(2 * y.cols());
  const double least =
      numbers + 8.0 * std::sqrt(2.0 * numbers) + 4.0 * std::log(static_cast<double>(y.rows()));
  while (!diagram.modes.empty()) {
    std::vector<Complex> poles;
    for (const ModeCluster& c : diagram.modes)
      poles.push_back(diagram.poles[index(c.chosen)].eigenvalue);
    const double all = fit(y, poles, step).squares();
    double smallest = std::numeric_limits<double>::infinity();
    std::size_t which = 0;
    for (std::size_t m = 0; m < poles.size(); ++m) {
      std::vector<Complex> others = poles;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(m));
      const double more =
          (fit(y, others, step).squares() - all) * static_cast<double>(y.size()) / all;
      if (more < smallest) {
        smallest = more;
        which = m;
      }
    }
    if (!(smallest < least)) return;
    diagram.rejected.push_back({.cluster = diagram.modes[which], .why = Rejection::noise});
    diagram.modes.erase(diagram.modes.begin() + static_cast<std::ptrdiff_t>(which));
  }
}

/// Surrogates of the residual: normal noise with the spectra and cross-spectra of the residual,
/// averaged over neighbouring lines. Lines of the modes are excluded, because the fit has reduced
/// their residuals.
class Surrogates {
 public:
  /// `noise`: one channel per row. `fitted`: the modes' frequencies, in lines.
  Surrogates(const MatrixXd& noise, const std::vector<double>& fitted)
      : lines_(noise.rows(), noise.cols() / 2 + 1) {
    samples_ = noise.cols();
    Eigen::FFT<double> fft;
    for (Index c = 0; c < noise.rows(); ++c) {
      const VectorXcd in = noise.row(c).transpose().cast<Complex>();
      VectorXcd out;
      fft.fwd(out, in);
      lines_.row(c) = out.head(lines_.cols()).transpose();
    }
    reach_ = std::max<Index>(kReach, lines_.cols() / 20);
    for (Index j = 0; j < lines_.cols(); ++j)
      left_.push_back(std::ranges::none_of(
          fitted, [&](double f) { return std::abs(static_cast<double>(j) - f) < kFitted; }));
  }

  [[nodiscard]] MatrixXd draw(base::Random& random) const {
    MatrixXcd spectrum = MatrixXcd::Zero(lines_.rows(), samples_);
    const Index last = lines_.cols() - 1;
    for (Index k = 1; k <= (samples_ - 1) / 2; ++k) {
      const Index from = std::max<Index>(1, k - reach_), to = std::min(last, k + reach_);
      const auto begin = left_.begin();
      const auto used = std::count(begin + from, begin + to + 1, true);
      const bool all = 2 * used < to - from + 1;  // most lines are lines of modes
      const double share = 1.0 / std::sqrt(2.0 * static_cast<double>(all ? to - from + 1 : used));
      for (Index j = from; j <= to; ++j) {
        if (!all && !left_[index(j)]) continue;
        const double re = random.normal(), im = random.normal();
        spectrum.col(k) += share * Complex(re, im) * lines_.col(j);
      }
      spectrum.col(samples_ - k) = spectrum.col(k).conjugate();
    }
    Eigen::FFT<double> fft;
    MatrixXd out(lines_.rows(), samples_);
    for (Index c = 0; c < out.rows(); ++c) {
      const VectorXcd in = spectrum.row(c).transpose();
      VectorXcd back;
      fft.inv(back, in);
      out.row(c) = back.real().transpose();
    }
    return out;
  }

 private:
  static constexpr Index kReach = 10;
  static constexpr double kFitted = 1.5;  // distance of excluded lines from a mode, in lines
  std::vector<bool> left_;
  MatrixXcd lines_;
  Index samples_ = 0, reach_ = 0;
};

/// The common shape of all decays: the first left singular vector of channels × decays factors.
VectorXcd decay_shape_of(const MatrixXd& factors, std::size_t mode, Index channels) {
  const auto row = 2 * static_cast<Index>(mode);
  VectorXcd c(factors.cols());
  c.real() = factors.row(row).transpose();
  c.imag() = factors.row(row + 1).transpose();
  const MatrixXcd table = c.reshaped(channels, factors.cols() / channels);
  if (table.cols() == 1) return table.col(0);
  return Eigen::JacobiSVD<MatrixXcd>(table, Eigen::ComputeThinU).matrixU().col(0);
}

/// Computes the modes and their changes by surrogates e: Δλ = J⁺e, Δc = B⁺(e - ∂y/∂λ Δλ).
void describe_decay(ModalResult& out, const DecayModel& model, Index channels, double step,
                    std::uint64_t seed) {
  const auto count = static_cast<Index>(model.poles.size());
  if (count == 0) return;
  MatrixXd moves(2 * count, out.replicates);
  std::vector<MatrixXd> shapes(model.poles.size());
  std::vector<Index> tops;
  for (std::size_t m = 0; m < model.poles.size(); ++m) {
    Mode& mode = out.modes[m];
    const Complex lambda = model.poles[m];
    mode.pole.eigenvalue = lambda;
    mode.pole.frequency_hz = std::abs(lambda) / (2.0 * std::numbers::pi);
    mode.pole.damping = -lambda.real() / std::abs(lambda);
    mode.pole.shape = decay_shape_of(model.factors, m, channels);
    Index top = 0;
    mode.pole.shape.cwiseAbs().maxCoeff(&top);
    mode.pole.shape /= Complex(mode.pole.shape[top]);
    mode.collinearity = phase_collinearity(mode.pole.shape);
    mode.phase_deviation = mean_phase_deviation(mode.pole.shape);
    tops.push_back(top);
    shapes[m].resize(2 * channels, out.replicates);
  }
  const auto rows = static_cast<double>(model.basis.rows());
  const MatrixXd direct = decay_slopes(model, step, false);
  const Eigen::ColPivHouseholderQR<MatrixXd> solver(decay_slopes(model, step, true));
  std::vector<double> lines;
  for (const Complex& lambda : model.poles)
    lines.push_back(lambda.imag() / (2.0 * std::numbers::pi) * step * rows);
  std::vector<Surrogates> of_decays;
  for (Index e = 0; e < model.residual.cols(); e += channels)
    of_decays.emplace_back(model.residual.middleCols(e, channels).transpose(), lines);
  for (int b = 0; b < out.replicates; ++b) {
    base::Random random(seed, 0, static_cast<std::uint64_t>(b), base::Purpose::simulation);
    MatrixXd noise(model.residual.rows(), model.residual.cols());
    for (std::size_t e = 0; e < of_decays.size(); ++e)
      noise.middleCols(static_cast<Index>(e) * channels, channels) =
          of_decays[e].draw(random).transpose();
    const VectorXd by = solver.solve(VectorXd(noise.reshaped()));
    const VectorXd explained = direct * by;
    const MatrixXd factors =
        model.factors + model.qr.solve(noise - explained.reshaped(noise.rows(), noise.cols()));
    for (Index m = 0; m < count; ++m) {
      const Complex lambda = model.poles[index(m)];
      const Complex d(by[2 * m], by[2 * m + 1]);
      const double size = std::abs(lambda), grows = (std::conj(lambda) * d).real() / size;
      moves(m, b) = grows / (2.0 * std::numbers::pi);
      moves(count + m, b) = -d.real() / size + lambda.real() * grows / (size * size);
      const VectorXcd whole = decay_shape_of(factors, index(m), channels);
      const VectorXcd moved = whole / whole[tops[index(m)]] - out.modes[index(m)].pole.shape;
      shapes[index(m)].col(b).head(channels) = moved.real();
      shapes[index(m)].col(b).tail(channels) = moved.imag();
    }
  }
  moves /= std::sqrt(static_cast<double>(out.replicates));
  out.covariance = moves * moves.transpose();
  for (Index m = 0; m < count; ++m) {
    Mode& mode = out.modes[index(m)];
    mode.pole.frequency_sd = moves.row(m).norm();
    mode.pole.damping_sd = moves.row(count + m).norm();
    mode.shape_covariance = shapes[index(m)] * shapes[index(m)].transpose() / out.replicates;
  }
}

}  // namespace

ModalResult identify_decays(const std::vector<MatrixXd>& decays, const ModalOptions& options,
                            std::uint64_t seed) {
  if (!(options.sample_rate_hz > 0.0))
    refuse("sample rate", options.sample_rate_hz, "must be positive");
  if (decays.empty()) refuse("decays", 0, "must be at least one");
  const Index channels = decays.front().rows();
  for (const MatrixXd& d : decays) {
    if (d.rows() != channels || channels < 1)
      refuse("channels", static_cast<double>(d.rows()), "must be the same in all decays");
    if (!d.allFinite()) throw std::invalid_argument("decays: must be finite");
    for (Index c = 0; c < channels; ++c)
      if (d.cols() < 1 || !((d.row(c).array() - d(c, 0)).abs().maxCoeff() > 0.0))
        throw ChannelError(c, "is constant");
  }
  ModalResult out{.method = ModalMethod::realisation,
                  .lowest_hz = options.lowest_hz,
                  .highest_hz = options.highest_hz};
  const double most = 0.45 * options.sample_rate_hz;
  if (!(out.highest_hz > 0.0)) out.highest_hz = most;
  if (!(out.lowest_hz >= 0.0 && out.lowest_hz < out.highest_hz))
    refuse("lowest frequency", out.lowest_hz, "must be at least 0 and below the highest");
  out.highest_hz = std::min(out.highest_hz, 0.5 * options.sample_rate_hz);
  const double by_band = kKeptBand * options.sample_rate_hz / out.highest_hz;
  out.decimated = static_cast<int>(std::max(1.0, std::min(by_band, largest_decimation(decays))));
  out.sample_rate_hz = options.sample_rate_hz / out.decimated;
  const std::vector<MatrixXd> y = prepared(decays, out.decimated);
  const auto events = static_cast<Index>(y.size());
  const Index length = y.front().cols();
  // The number of samples for which H is square, within the limit of its size.
  const Index room = kMostHankelRows / channels + kMostHankelRows / events;
  const Index lags = std::min<Index>(length, options.lags > 0 ? options.lags : room);
  if (lags < 8)
    refuse("samples", static_cast<double>(length), "must be at least 8 after decimation");
  Index columns = std::clamp<Index>(lags * channels / (channels + events), 1, lags - 1);
  const Index largest = std::min((lags - columns) * channels, columns * events);
  const int requested = options.largest_order > 0 ? options.largest_order / 2 * 2
                                                  : std::clamp(static_cast<int>(10 * channels),
                                                               kSmallestOrders, kLargestOrders);
  out.largest_order =
      std::min(requested, static_cast<int>(static_cast<double>(largest) / kHankelRows) / 2 * 2);
  if (out.largest_order < 2)
    refuse("samples", static_cast<double>(length), "too few for any model order");
  out.remarks.order_cut = out.largest_order < requested ? requested : 0;
  out.lags = static_cast<int>(lags);
  out.replicates = options.blocks > 0 ? options.blocks : kSurrogates;
  const double step = 1.0 / out.sample_rate_hz;
  OutputCovariances samples;
  samples.lags = out.lags;
  samples.samples = static_cast<long>(length);
  samples.scale = samples.zero_lag = VectorXd::Ones(channels);
  samples.mean = stacked(y, lags);
  for (Index e = 0; e < events; ++e) samples.references.push_back(static_cast<int>(e));
  // The diagram has no standard deviations, because there are no data blocks.
  samples.blocks.assign(2, samples.mean);
  const StochasticSubspace subspace(samples, {.step = step,
                                              .columns = static_cast<int>(columns),
                                              .largest_order = out.largest_order,
                                              .threads = options.threads});
  out.singular_values = subspace.singular_values();
  out.diagram = stabilise(
      subspace,
      {.lowest_hz = out.lowest_hz, .highest_hz = out.highest_hz, .threads = options.threads});
  MatrixXd all(length, channels * events);
  for (Index e = 0; e < events; ++e)
    all.middleCols(e * channels, channels) = y[index(e)].transpose();
  drop_noise(out.diagram, all, step);
  std::vector<Complex> poles;
  for (const ModeCluster& cluster : out.diagram.modes) {
    Pole pole = out.diagram.poles[index(cluster.chosen)];
    poles.emplace_back(std::min(pole.eigenvalue.real(), -1e-9 * std::abs(pole.eigenvalue)),
                       pole.eigenvalue.imag());
    out.modes.push_back({.pole = std::move(pole),
                         .present = static_cast<int>(cluster.members.size()),
                         .orders = cluster.orders,
                         .amplitude_kurtosis = 2.0});
  }
  const DecayModel model = refine_decays(all, poles, step);
  describe_decay(out, model, channels, step, seed);
  for (std::size_t m = 0; m < out.modes.size(); ++m)
    if (pole_distance(out.modes[m].pole, out.diagram.poles[index(out.diagram.modes[m].chosen)]) >
        kMovedPole)
      ++out.remarks.moved;
  doubt_modes(out);
  return out;
}

}  // namespace wheeltap::signals
