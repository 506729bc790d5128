#include "identification/modal/bayesian_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "base/eigen_solvers.hpp"
#include "base/number.hpp"
#include "inference/diagnosis/reason.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostModes = 3;
using Small = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using SmallVector = Eigen::Matrix<Complex, Eigen::Dynamic, 1, 0, 3, 1>;

constexpr double kLeastDamping = 1e-4, kMostDamping = 0.2;
constexpr double kDecades =
    1e-10;  // lower bound divided by upper bound of the priors of S and of S_e

[[noreturn]] void refuse(const std::string& name, double value, const std::string& bound) {
  throw std::invalid_argument(name + " = " + std::to_string(value) + ": " + bound);
}

/// The principal direction of Re Σ F Fᴴ over the lines within 0.5 % of the peak, at least three.
VectorXd direction_at(const BandLines& lines, double peak_hz) {
  Index nearest = 0;
  (lines.frequencies_hz.array() - peak_hz).abs().minCoeff(&nearest);
  MatrixXd sum = MatrixXd::Zero(lines.transform.rows(), lines.transform.rows());
  for (Index k = 0; k < lines.frequencies_hz.size(); ++k)
    if (std::abs(k - nearest) <= 1 || std::abs(lines.frequencies_hz[k] / peak_hz - 1.0) < 0.005)
      sum += (lines.transform.col(k) * lines.transform.col(k).adjoint()).real();
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(sum).eigenvectors().rightCols(1);
}

/// An orthonormal basis of the complement of u.
MatrixXd complement(const VectorXd& u) {
  const Eigen::HouseholderQR<MatrixXd> qr(u);
  const MatrixXd q = qr.householderQ();
  return q.rightCols(u.size() - 1);
}

class BandLikelihood final : public inference::Likelihood {
 public:
  explicit BandLikelihood(const BandProblem& of) : of_(of) {}
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    return of_.log_likelihood(x);
  }

 private:
  const BandProblem& of_;
};

}  // namespace

BandLines band_lines(const Eigen::Ref<const MatrixXd>& records, double sample_rate_hz,
                     const ModalBand& band) {
  if (!(sample_rate_hz > 0.0)) refuse("sample rate", sample_rate_hz, "must be positive");
  if (!(band.lowest_hz > 0.0 && band.lowest_hz < band.highest_hz))
    refuse("lowest frequency", band.lowest_hz, "must be positive and below the highest frequency");
  if (band.highest_hz >= 0.5 * sample_rate_hz)
    refuse("highest frequency", band.highest_hz, "must be below half the sampling rate");
  const Index n = records.cols();
  const double step = sample_rate_hz / static_cast<double>(std::max<Index>(n, 1));
  const auto first = static_cast<Index>(std::ceil(band.lowest_hz / step));
  const auto last = static_cast<Index>(std::floor(band.highest_hz / step));
  const Index lines = std::max<Index>(0, last - first + 1);
  if (lines < BandProblem::kFewestLines * static_cast<Index>(band.peaks_hz.size()))
    refuse("lines", static_cast<double>(lines),
           "must be at least 20 per mode: widen the band, or record for longer");
  BandLines out{.frequencies_hz = VectorXd::LinSpaced(lines, static_cast<double>(first) * step,
                                                      static_cast<double>(last) * step),
                .transform = MatrixXcd(records.rows(), lines)};
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  const double scale = std::sqrt(2.0 / (sample_rate_hz * static_cast<double>(n)));
  for (Index c = 0; c < records.rows(); ++c) {
    const double mean = records.row(c).mean();
    std::vector<double> x(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = records(c, i) - mean;
    std::vector<Complex> half;
    fft.fwd(half, x);
    for (Index k = 0; k < lines; ++k)
      out.transform(c, k) = scale * half[static_cast<std::size_t>(first + k)];
  }
  return out;
}

BandProblem::BandProblem(BandLines lines, ModalBand band)
    : lines_(std::move(lines)), band_(std::move(band)) {
  const std::size_t m = band_.peaks_hz.size();
  if (m < 1 || m > kMostModes) refuse("modes", static_cast<double>(m), "must be 1 to 3 in a band");
  if (channels() < 2) refuse("channels", channels(), "must be at least 2");
  for (std::size_t i = 0; i < m; ++i) {
    if (band_.peaks_hz[i] < band_.lowest_hz || band_.peaks_hz[i] > band_.highest_hz)
      refuse("peak", band_.peaks_hz[i], "must lie within the band");
    if (i > 0 && !(band_.peaks_hz[i] > band_.peaks_hz[i - 1]))
      refuse("peak", band_.peaks_hz[i], "must be above the previous peak");
  }
  if (lines_.frequencies_hz.size() < kFewestLines * static_cast<Index>(m))
    refuse("lines", static_cast<double>(lines_.frequencies_hz.size()),
           "must be at least 20 per mode");
  power_ = lines_.transform.squaredNorm();
  const double largest = lines_.transform.colwise().squaredNorm().maxCoeff();
  using namespace inference;
  for (std::size_t i = 0; i < m; ++i) {
    const std::string n = "[" + std::to_string(i + 1) + "]";
    parameters_.push_back({"f" + n, Uniform{band_.lowest_hz, band_.highest_hz}});
    parameters_.push_back({"zeta" + n, LogUniform{kLeastDamping, kMostDamping}});
    parameters_.push_back({"S" + n, LogUniform{kDecades * largest, largest}});
    for (int s = 1; s < channels(); ++s)
      parameters_.push_back({"b" + n + std::to_string(s), Normal{0.0, 1.0}});
    for (std::size_t j = 0; j < i; ++j)
      for (const char* part : {"re", "im"})
        parameters_.push_back({"L" + n + std::to_string(j + 1) + part, Normal{0.0, 1.0}});
    directions_.push_back(direction_at(lines_, band_.peaks_hz[i]));
    complements_.push_back(complement(directions_.back()));
  }
  parameters_.push_back({"S_e", LogUniform{kDecades * largest, largest}});
}

MatrixXd BandProblem::shapes(std::span<const double> x) const {
  const Index n = channels();
  MatrixXd out(n, modes());
  std::size_t at = 0;
  for (int i = 0; i < modes(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    at += 3;
    out.col(i) = (directions_[place] +
                  complements_[place] * Eigen::Map<const VectorXd>(x.data() + at, n - 1))
                     .normalized();
    at += static_cast<std::size_t>(n - 1) + 2 * place;
  }
  return out;
}

double BandProblem::log_likelihood(std::span<const double> x) const {
  const Index n = channels(), m = modes();
  std::array<double, kMostModes> f{}, zeta{}, root{};
  Small triangle = Small::Zero(m, m);
  std::size_t at = 0;
  for (Index i = 0; i < m; ++i) {
    const auto place = static_cast<std::size_t>(i);
    f[place] = x[at];
    zeta[place] = x[at + 1];
    root[place] = std::sqrt(x[at + 2]);
    if (i > 0 && !(f[place] > f[place - 1])) return -std::numeric_limits<double>::infinity();
    at += 3 + static_cast<std::size_t>(n - 1);
    for (Index j = 0; j < i; ++j, at += 2) triangle(i, j) = Complex(x[at], x[at + 1]);
    triangle(i, i) = 1.0;
    triangle.row(i) *= root[place] / triangle.row(i).norm();
  }
  const double noise = x[at];
  const Small force = triangle * triangle.adjoint();
  const MatrixXd phi = shapes(x);
  const Small gram = (phi.transpose() * phi).cast<Complex>();
  const Index lines = lines_.frequencies_hz.size();
  double log_determinants = 0.0, explained = 0.0;
  Small response(m, m), system(m, m);
  SmallVector h(m);
  const MatrixXcd projected = phi.transpose() * lines_.transform;
  for (Index k = 0; k < lines; ++k) {
    for (Index i = 0; i < m; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const double beta = f[place] / lines_.frequencies_hz[k];
      h[i] = 1.0 / Complex(1.0 - beta * beta, -2.0 * zeta[place] * beta);
    }
    response = h.asDiagonal() * force * h.conjugate().asDiagonal();
    // |S_e I + Φ H Φᵀ| = S_e^(n-m) |S_e I + H G|; its inverse by Woodbury.
    system = response * gram;
    system.diagonal().array() += noise;
    const SmallVector y = projected.col(k);
    if (m == 1) {
      log_determinants += std::log(system(0, 0).real());
      explained += std::norm(y[0]) * response(0, 0).real() / system(0, 0).real();
    } else {
      const Eigen::PartialPivLU<Small> lu(system);
      log_determinants += std::log(std::abs(lu.determinant()));
      explained += y.dot(lu.solve(response * y)).real();
    }
  }
  return -static_cast<double>(lines) * (static_cast<double>(n - m) * std::log(noise) +
                                        static_cast<double>(n) * std::log(std::numbers::pi)) -
         log_determinants - (power_ - explained) / noise;
}

inference::Problem BandProblem::problem() const {
  std::vector<std::string> names;
  for (const inference::Parameter& p : parameters_) names.push_back(p.name);
  return {.space = inference::ModelSpace::of_models(parameters_, {{"modes", 1.0, names}}),
          .likelihood = [this] { return std::make_unique<BandLikelihood>(*this); }};
}

BayesianBand identify_band(const Eigen::Ref<const MatrixXd>& records, double sample_rate_hz,
                           const ModalBand& band, const BayesianBandOptions& options) {
  const BandProblem of(band_lines(records, sample_rate_hz, band), band);
  const inference::Problem problem = of.problem();
  const inference::Posterior posterior =
      inference::reversible_jump(problem, {.seed = options.seed,
                                           .threads = options.threads,
                                           .warmup = options.warmup,
                                           .draws = options.draws,
                                           .searches = options.searches});
  const Index m = of.modes(), n = of.channels();
  const auto width = static_cast<std::size_t>(posterior.dimension);
  Index count = 0;
  for (const auto& chain : posterior.chains) count += static_cast<Index>(chain.size());
  MatrixXd both(2 * m, count);
  std::vector<MatrixXd> shapes(static_cast<std::size_t>(m), MatrixXd(n, count));
  Index draw = 0;
  for (const auto& chain : posterior.chains)
    for (std::size_t i = 0; i < chain.size(); ++i, ++draw) {
      const std::span<const double> x(chain.theta.data() + i * width, width);
      const MatrixXd phi = of.shapes(x);
      std::size_t at = 0;
      for (Index j = 0; j < m; ++j) {
        both(j, draw) = x[at];
        both(m + j, draw) = x[at + 1];
        shapes[static_cast<std::size_t>(j)].col(draw) = phi.col(j);
        at += 3 + static_cast<std::size_t>(n - 1) + 2 * static_cast<std::size_t>(j);
      }
    }
  const auto covariance_of = [count](const MatrixXd& x) -> MatrixXd {
    const MatrixXd centred = x.colwise() - x.rowwise().mean();
    return centred * centred.transpose() / static_cast<double>(count - 1);
  };
  const VectorXd mean = both.rowwise().mean();
  BayesianBand out{.frequencies_hz = mean.head(m),
                   .damping = mean.tail(m),
                   .covariance = covariance_of(both),
                   .shapes = MatrixXd(n, m),
                   .shape_covariances = {},
                   .converged = posterior.converged(),
                   .likelihood_evaluations = posterior.likelihood_evaluations};
  for (Index j = 0; j < m; ++j) {
    MatrixXd& all = shapes[static_cast<std::size_t>(j)];
    Index top = 0;
    all.rowwise().mean().cwiseAbs().maxCoeff(&top);
    for (Index d = 0; d < count; ++d) all.col(d) /= all(top, d);
    out.shapes.col(j) = all.rowwise().mean();
    out.shape_covariances.push_back(covariance_of(all));
  }
  for (const inference::Reason& reason : posterior.why_not())
    out.not_established.push_back(inference::describe(reason, *posterior.space));
  return out;
}

signals::ModalResult identify_bands(const Eigen::Ref<const MatrixXd>& records,
                                    double sample_rate_hz, const std::vector<ModalBand>& bands,
                                    const BayesianBandOptions& options) {
  signals::ModalResult out{.method = signals::ModalMethod::bayesian,
                           .sample_rate_hz = sample_rate_hz};
  std::vector<ModalBand> sorted = bands;
  std::ranges::sort(sorted, {}, &ModalBand::lowest_hz);
  for (std::size_t b = 0; b + 1 < sorted.size(); ++b)
    if (sorted[b].highest_hz > sorted[b + 1].lowest_hz)
      refuse("band", sorted[b + 1].lowest_hz, "must not overlap the previous band");
  std::vector<BayesianBand> found;
  Index count = 0;
  for (const ModalBand& band : sorted) {
    found.push_back(identify_band(records, sample_rate_hz, band, options));
    count += found.back().frequencies_hz.size();
  }
  if (sorted.empty()) return out;
  out.lowest_hz = sorted.front().lowest_hz;
  out.highest_hz = sorted.back().highest_hz;
  out.covariance = MatrixXd::Zero(2 * count, 2 * count);
  const Index n = records.rows();
  Index first = 0;
  for (std::size_t b = 0; b < found.size(); ++b) {
    const BayesianBand& band = found[b];
    const Index m = band.frequencies_hz.size();
    for (const Index row : {Index{0}, Index{1}})
      for (const Index column : {Index{0}, Index{1}})
        out.covariance.block(row * count + first, column * count + first, m, m) =
            band.covariance.block(row * m, column * m, m, m);
    first += m;
    for (Index i = 0; i < m; ++i) {
      signals::Mode mode;
      mode.pole.frequency_hz = band.frequencies_hz[i];
      mode.pole.damping = band.damping[i];
      mode.pole.frequency_sd = std::sqrt(band.covariance(i, i));
      mode.pole.damping_sd = std::sqrt(band.covariance(m + i, m + i));
      mode.pole.shape = band.shapes.col(i).cast<Complex>();
      mode.collinearity = 1.0;
      mode.shape_covariance = MatrixXd::Zero(2 * n, 2 * n);
      mode.shape_covariance.topLeftCorner(n, n) =
          band.shape_covariances[static_cast<std::size_t>(i)];
      out.modes.push_back(std::move(mode));
    }
    for (const std::string& why : band.not_established)
      out.remarks.unsettled.push_back(base::number(sorted[b].lowest_hz) + " to " +
                                      base::number(sorted[b].highest_hz) + " Hz: " + why);
  }
  signals::doubt_modes(out);
  return out;
}

}  // namespace wheeltap::identification
