#include "signals/modal/modal_identification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/parallel.hpp"
#include "signals/modal/merged_subspace.hpp"
#include "signals/refuse.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kBlocks = 50, kFewBlocks = 20, kFewestBlocks = 8;
constexpr long kLagsPerBlock = 5;
constexpr int kFewestLags = 4;
constexpr int kRoom = 2;        // smallest ratio of columns to order, for regressions on references
constexpr double kRows = 1.2;   // ratio of rows and columns of H to the minimum for the order
constexpr int kMostRows = 900;  // largest number of rows of H
constexpr double kKept = 0.4;   // decimate() keeps frequencies up to this share of the new rate
constexpr double kTone = 1.3;   // for a tone, the amplitude kurtosis is lower
constexpr double kToneDamping = 0.002;
constexpr double kAlike = 1.0 - 1e-9;

/// Rejects proportional channels; identical channels would create a mode of their difference.
void refuse_copies(const MatrixXd& y) {
  const MatrixXd centred = y.colwise() - y.rowwise().mean();
  const MatrixXd product = centred * centred.transpose();
  for (Index a = 0; a < y.rows(); ++a)
    for (Index b = 0; b < a; ++b)
      if (std::abs(product(a, b)) > kAlike * std::sqrt(product(a, a) * product(b, b)) &&
          product(a, a) > 0.0 && product(b, b) > 0.0)
        throw ChannelError(
            a, "equals channel " + std::to_string(b) + " except for its scale: omit one of the two",
            b);
}

MatrixXd decimated(const Eigen::Ref<const MatrixXd>& records, int factor, int threads) {
  if (factor == 1) return records;
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(records.rows()));
  base::parallel_for(static_cast<int>(records.rows()), threads, [&](int c) {
    std::vector<double> x(static_cast<std::size_t>(records.cols()));
    Eigen::Map<Eigen::RowVectorXd>(x.data(), records.cols()) = records.row(c);
    detrend(x, 1);  // decimate() continues the record by reflection at its ends
    rows[static_cast<std::size_t>(c)] = decimate(x, factor);
  });
  MatrixXd out(records.rows(), static_cast<Index>(rows.front().size()));
  for (Index c = 0; c < out.rows(); ++c)
    out.row(c) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(c)].data(), out.cols());
  return out;
}

struct Shape {
  int rows = 0, columns = 0, order = 0;  // p, q, largest order
  [[nodiscard]] int lags() const { return rows + columns; }
};

/// Chooses p and q for a model order and a time span [samples], limited by the record.
Shape shape_of(int order, double span, int channels, int references, long samples, int lags) {
  Shape out{.order = order};
  out.rows = static_cast<int>(std::ceil(kRows * order / channels));
  out.columns = static_cast<int>(std::ceil(kRows * order / references));
  const int least = lags > 0 ? lags : static_cast<int>(std::ceil(span));
  if (out.lags() < least) {
    const int more = least - out.lags();
    // Divides the lags into p and q so that H is nearly square.
    for (int i = 0; i < more; ++i)
      ++(out.rows * channels <= out.columns * references ? out.rows : out.columns);
  }
  const int most_lags = static_cast<int>(std::min<long>(
      samples / (kFewestBlocks * kLagsPerBlock),
      static_cast<long>(kMostRows) / channels + static_cast<long>(kMostRows) / references));
  if (most_lags < kFewestLags)
    refuse("samples", static_cast<double>(samples),
           "must be at least " + std::to_string(kFewestBlocks * kLagsPerBlock * kFewestLags) +
               " after decimation to the band, for at least two blocks");
  const int limit = lags > 0 ? std::min(lags, most_lags) : most_lags;
  while (out.lags() > std::max(limit, 2))
    --(out.rows * channels >= out.columns * references && out.rows > 1 ? out.rows : out.columns);
  if (out.rows < 1 || out.columns < 1)
    refuse("samples", static_cast<double>(samples), "too few for any lag");
  out.order = std::min(out.order, std::min(out.rows * channels, out.columns * references) / 2 * 2);
  return out;
}

int blocks_of(int requested, long samples, int lags) {
  if (requested > 0) return requested;
  return static_cast<int>(
      std::clamp<long>((samples - lags) / (kLagsPerBlock * lags), kFewestBlocks, kBlocks));
}

/// True if p may be the same mode as `other`: the shapes are the same, and the distance is below
/// three standard deviations, or below the half-power widths if p is less certain.
bool is_twin(const Pole& p, const Pole& other) {
  const double apart = std::abs(other.frequency_hz - p.frequency_hz);
  const double width =
      std::abs(p.damping) * p.frequency_hz + std::abs(other.damping) * other.frequency_hz;
  const bool alike = apart < 3.0 * std::hypot(p.frequency_sd, other.frequency_sd) ||
                     (apart < width && p.frequency_sd > other.frequency_sd);
  return alike && modal_assurance(p.shape, other.shape) > 0.9;
}

/// True if the filter of the band may distort the mode. The Bayesian method uses no filter.
bool at_the_edge(const ModalResult& result, double frequency_hz) {
  if (result.method == ModalMethod::bayesian) return false;
  const double width = result.highest_hz - result.lowest_hz;
  return std::ranges::any_of(std::array{result.lowest_hz, result.highest_hz}, [&](double end) {
    return std::abs(frequency_hz - end) < 0.05 * std::min(end, width);
  });
}

/// Largest amplitude kurtosis over the records, each for the channel with the largest motion in the
/// mode. A tone must thus appear in all records. Records that are too short give 2.
double largest_kurtosis(const std::vector<MatrixXd>& records,
                        const std::vector<std::vector<int>>& sensors, const Pole& pole,
                        double sample_rate_hz) {
  double out = 0.0;
  for (std::size_t s = 0; s < records.size(); ++s) {
    const MatrixXd& y = records[s];
    Eigen::VectorXd share(y.rows());
    for (Index c = 0; c < y.rows(); ++c)
      share[c] = std::abs(pole.shape[sensors[s][static_cast<std::size_t>(c)]]) /
                 (y.row(c).norm() + 1e-300);
    Index strongest = 0;
    share.maxCoeff(&strongest);
    out = std::max(
        out, amplitude_kurtosis(y.row(strongest).transpose(), pole.frequency_hz, sample_rate_hz));
  }
  return out;
}

/// Describes the modes of the diagram with their uncertainty. `records` has the record of each
/// set-up, and `sensors` the sensors of its channels.
void describe(ModalResult& out, const StochasticSubspace& subspace,
              const std::vector<MatrixXd>& records, const std::vector<std::vector<int>>& sensors) {
  std::map<int, std::vector<std::size_t>> by_order;
  for (std::size_t m = 0; m < out.diagram.modes.size(); ++m)
    by_order[out.diagram.poles[static_cast<std::size_t>(out.diagram.modes[m].chosen)].order]
        .push_back(m);
  const auto count = static_cast<Index>(out.diagram.modes.size());
  out.modes.resize(out.diagram.modes.size());
  MatrixXd moves(2 * count, 0);
  for (const auto& [order, which] : by_order) {
    std::vector<int> places;
    for (const std::size_t m : which)
      places.push_back(
          out.diagram.poles[static_cast<std::size_t>(out.diagram.modes[m].chosen)].place);
    const MovedPoles moved = subspace.moved_poles(order, places);
    if (moves.cols() == 0) moves.resize(2 * count, moved.frequency_moves.cols());
    for (std::size_t i = 0; i < which.size(); ++i) {
      const std::size_t m = which[i];
      const ModeCluster& cluster = out.diagram.modes[m];
      const Pole& pole = moved.poles[i];
      out.modes[m] = {
          .pole = pole,
          .collinearity = phase_collinearity(pole.shape),
          .phase_deviation = mean_phase_deviation(pole.shape),
          .present = static_cast<int>(cluster.members.size()),
          .orders = cluster.orders,
          .amplitude_kurtosis = largest_kurtosis(records, sensors, pole, out.sample_rate_hz),
          .shape_covariance = moved.shape_moves[i] * moved.shape_moves[i].transpose()};
      moves.row(static_cast<Index>(m)) = moved.frequency_moves.row(static_cast<Index>(i));
      moves.row(count + static_cast<Index>(m)) = moved.damping_moves.row(static_cast<Index>(i));
    }
  }
  out.covariance = moves * moves.transpose();
}

}  // namespace

void doubt_modes(ModalResult& out) {
  for (Mode& mode : out.modes) {
    const Pole& p = mode.pole;
    const auto add = [&](ModeDoubt d) { mode.doubts.push_back(d); };
    if (2 * mode.present < mode.orders) add(ModeDoubt::few_orders);
    const bool spectral =
        out.method == ModalMethod::decomposition || out.method == ModalMethod::enhanced;
    // A peak of a spectrum has no damping ratio, or a ratio that the window changes.
    const bool tone = (spectral && mode.amplitude_kurtosis < kTone) ||
                      (out.method == ModalMethod::subspace &&
                       p.damping < std::max(kToneDamping, 2.0 * p.damping_sd) &&
                       p.damping < 2.5 * kToneDamping && mode.amplitude_kurtosis < kTone);
    if (tone) add(ModeDoubt::tone);
    if (p.damping_sd > 0.5 * std::abs(p.damping)) add(ModeDoubt::damping_unknown);
    if (mode.collinearity < kCollinear) add(ModeDoubt::complex_shape);
    for (const Mode& other : out.modes)
      if (&other != &mode && is_twin(p, other.pole)) add(ModeDoubt::twin);
    if (at_the_edge(out, p.frequency_hz)) add(ModeDoubt::at_the_edge);
    if (out.block_seconds > 0.0 && p.damping > 0.0 &&
        out.block_seconds * p.damping * 2.0 * std::numbers::pi * p.frequency_hz < 1.0)
      ++out.remarks.longer_decays;
  }
}

double amplitude_kurtosis(const Eigen::Ref<const Eigen::VectorXd>& x, double frequency_hz,
                          double sample_rate_hz, double cycles) {
  const auto window =
      static_cast<Index>(std::ceil(cycles * sample_rate_hz / std::max(frequency_hz, 1e-300)));
  if (window < 4 || x.size() < 4 * window) return 2.0;  // undetermined
  double second = 0.0, fourth = 0.0;
  Index count = 0;
  for (Index from = 0; from + window <= x.size(); from += window, ++count) {
    std::complex<double> z = 0.0;
    for (Index i = 0; i < window; ++i) {
      const double hann = 1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                         static_cast<double>(window));
      z += hann * x[from + i] *
           std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * static_cast<double>(from + i) /
                               sample_rate_hz);
    }
    second += std::norm(z);
    fourth += std::norm(z) * std::norm(z);
  }
  return second > 0.0 ? fourth * static_cast<double>(count) / (second * second) : 2.0;
}

MatrixXd records_of_band(const Eigen::Ref<const MatrixXd>& records, double sample_rate_hz,
                         int threads, ModalResult& out) {
  if (!(sample_rate_hz > 0.0)) refuse("sample rate", sample_rate_hz, "must be positive");
  const double most = 0.45 * sample_rate_hz;
  if (!(out.highest_hz > 0.0)) out.highest_hz = most;
  if (!(out.lowest_hz >= 0.0 && out.lowest_hz < out.highest_hz))
    refuse("lowest frequency", out.lowest_hz, "must be at least 0 and below the highest");
  if (out.lowest_hz >= 0.5 * sample_rate_hz)
    refuse("lowest frequency", out.lowest_hz, "must be below half the sampling rate");
  if (out.highest_hz > most) {
    out.remarks.band_cut = out.highest_hz >= 0.5 * sample_rate_hz;
    out.highest_hz = std::min(out.highest_hz, 0.5 * sample_rate_hz);
  }
  out.decimated = std::max(1, static_cast<int>(kKept * sample_rate_hz / out.highest_hz));
  out.sample_rate_hz = sample_rate_hz / out.decimated;
  MatrixXd y = decimated(records, out.decimated, threads);
  refuse_copies(y);
  return y;
}

namespace {

/// Numbers that determine model orders and lags: channels per block row and block column of H.
struct Counted {
  int rows = 0, references = 0;
  int requested = 0;  ///< largest model order for the size of H
  int order = 0;      ///< requested largest order
};

/// Identifies the modes with lags over a period of the band's lower end, then, if it is shorter, of
/// the lowest mode. `subspace_of(shape)` sets lags, blocks and block length.
template <class Make>
void identify_by_lags(ModalResult& out, const ModalOptions& options, const Counted& counted,
                      const std::vector<MatrixXd>& records,
                      const std::vector<std::vector<int>>& sensors, const Make& subspace_of) {
  long samples = records.front().cols();
  for (const MatrixXd& y : records) samples = std::min<long>(samples, y.cols());
  double slowest = std::max(out.lowest_hz, 0.01 * out.sample_rate_hz);
  std::optional<StochasticSubspace> last;
  for (int round = 0; round < 2; ++round) {
    const Shape shape = shape_of(counted.requested, out.sample_rate_hz / slowest, counted.rows,
                                 counted.references, samples, options.lags);
    if (shape.order < 2) refuse("samples", static_cast<double>(samples), "too few for a model");
    if (round == 1 && shape.lags() >= out.lags) break;  // unchanged
    out.lags = shape.lags();
    out.largest_order = shape.order;
    out.remarks.order_cut = shape.order < counted.requested ? counted.order : 0;
    out.blocks = blocks_of(options.blocks, samples, out.lags);
    const StochasticSubspace& subspace = last.emplace(subspace_of(shape));
    out.remarks.short_blocks = out.blocks < kFewBlocks ||
                               out.block_seconds * out.sample_rate_hz < kLagsPerBlock * out.lags;
    out.singular_values = subspace.singular_values();
    out.diagram = stabilise(
        subspace,
        {.lowest_hz = out.lowest_hz, .highest_hz = out.highest_hz, .threads = options.threads});
    describe(out, subspace, records, sensors);
    if (out.modes.empty() || options.lags > 0) break;
    slowest = out.modes.front().pole.frequency_hz;
  }
  if (!options.poles.empty()) {
    choose_poles(out.diagram, options.poles);
    describe(out, *last, records, sensors);
    out.chosen_by_hand = true;
  }
  doubt_modes(out);
}

}  // namespace

ModalResult identify_modes(const Eigen::Ref<const MatrixXd>& records, const ModalOptions& options) {
  ModalResult out{.lowest_hz = options.lowest_hz, .highest_hz = options.highest_hz};
  const MatrixXd y = records_of_band(records, options.sample_rate_hz, options.threads, out);
  const auto channels = static_cast<int>(y.rows());
  const int references =
      options.references.empty() ? channels : static_cast<int>(options.references.size());
  const int requested =
      options.largest_order > 0 ? options.largest_order / 2 * 2 : std::clamp(10 * channels, 20, 80);
  std::vector<int> all(static_cast<std::size_t>(channels));
  std::iota(all.begin(), all.end(), 0);
  identify_by_lags(out, options, {channels, references, requested, requested}, {y}, {all},
                   [&](const Shape& shape) {
                     const OutputCovariances covariances =
                         output_covariances(y, {.lags = out.lags,
                                                .blocks = out.blocks,
                                                .references = options.references,
                                                .threads = options.threads});
                     out.references = covariances.references;
                     out.block_seconds =
                         static_cast<double>(covariances.samples) / out.sample_rate_hz;
                     return StochasticSubspace(covariances, {.step = 1.0 / out.sample_rate_hz,
                                                             .columns = shape.columns,
                                                             .largest_order = shape.order,
                                                             .threads = options.threads});
                   });
  return out;
}

ModalResult identify_set_ups(const std::vector<MatrixXd>& records,
                             const std::vector<std::vector<int>>& sensors,
                             const std::vector<std::vector<int>>& references, int count,
                             const ModalOptions& options) {
  if (records.empty() || sensors.size() != records.size() || references.size() != records.size())
    refuse("set-ups", static_cast<double>(records.size()),
           "must be at least one, each with its sensors and references");
  ModalResult out;
  std::vector<MatrixXd> y;
  for (const MatrixXd& record : records) {
    ModalResult band{.lowest_hz = options.lowest_hz, .highest_hz = options.highest_hz};
    y.push_back(records_of_band(record, options.sample_rate_hz, options.threads, band));
    out = std::move(band);
  }
  out.set_ups = static_cast<int>(records.size());
  const auto common = static_cast<int>(references.front().size());
  const int requested =
      options.largest_order > 0 ? options.largest_order / 2 * 2 : std::clamp(10 * common, 20, 80);
  // The references alone must give enough rows and columns for the order. Moved sensors are
  // regressed on them; with only as many columns as the order, noise would be fitted.
  identify_by_lags(
      out, options, {common, common, kRoom * requested, requested}, y, sensors,
      [&](const Shape& shape) {
        std::vector<SetUpCovariances> set_ups;
        for (std::size_t s = 0; s < y.size(); ++s) {
          set_ups.push_back({.covariances = output_covariances(y[s], {.lags = out.lags,
                                                                      .blocks = out.blocks,
                                                                      .references = references[s],
                                                                      .threads = options.threads}),
                             .sensors = sensors[s]});
          const double seconds =
              static_cast<double>(set_ups.back().covariances.samples) / out.sample_rate_hz;
          out.block_seconds = s == 0 ? seconds : std::min(out.block_seconds, seconds);
        }
        out.references.clear();
        for (const int c : references.front())
          out.references.push_back(sensors.front()[static_cast<std::size_t>(c)]);
        out.largest_order = shape.order / kRoom / 2 * 2;
        return StochasticSubspace(
            merge_covariances(set_ups, count, shape.columns, out.largest_order),
            {.step = 1.0 / out.sample_rate_hz,
             .largest_order = out.largest_order,
             .threads = options.threads});
      });
  return out;
}

}  // namespace wheeltap::signals
