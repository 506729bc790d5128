#include "identification/monitoring/mode_tracking.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "identification/monitoring/baseline_filter.hpp"
#include "identification/monitoring/residual_scatter.hpp"
#include "identification/monitoring/weather_regression.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDegreesOfTracking = 4.0;
constexpr double kLeastScatter = 5e-4, kLeastDiscrepancy = 5e-3;
constexpr double kDoubtfulFactor = 0.2;  // reduces L: doubtful modes are more often spurious
constexpr double kUnlikeShapes = 0.1;    // share of the uniform density of 1 - MAC
constexpr std::size_t kMostModes = 60;   // per record: bits of a set

/// Current level of a tracked mode, and the variance of the level.
struct Level {
  double mean = 0.0, variance = 0.0;
};

double pair_density(const TrackedMode& tracked, double predicted, double variance,
                    const IdentifiedMode& mode, const TrackingOptions& options) {
  const double sd = mode.frequency_sd / mode.frequency_hz;
  const double s = variance + tracked.scatter * tracked.scatter + sd * sd;
  const double v = std::log(mode.frequency_hz) - predicted;
  const double broad = s + options.broad_sd * options.broad_sd;
  const double frequency =
      (1.0 - options.broad_share) * std::exp(log_innovation_density(v, s, kDegreesOfTracking)) +
      options.broad_share * std::exp(log_innovation_density(v, broad, kGaussian));
  if (tracked.shape.size() == 0 || mode.shape.size() == 0)
    return frequency * (mode.doubtful ? kDoubtfulFactor : 1.0);
  const double unlike = 1.0 - modal_assurance(tracked.shape, mode.shape);
  const double e = tracked.discrepancy;
  const double shape =
      (1.0 - kUnlikeShapes) * std::exp(-unlike / e) / (e * -std::expm1(-1.0 / e)) + kUnlikeShapes;
  return frequency * shape * (mode.doubtful ? kDoubtfulFactor : 1.0);
}

/// The ratios L_kj/λ of all pairs of a record.
MatrixXd ratios_of_record(const std::vector<TrackedMode>& modes, const std::vector<Level>& levels,
                          const VectorXd& weather, double spurious, const IdentifiedRecord& record,
                          const TrackingOptions& options) {
  MatrixXd out(static_cast<Index>(modes.size()), static_cast<Index>(record.size()));
  for (Index k = 0; k < out.rows(); ++k)
    for (Index j = 0; j < out.cols(); ++j)
      out(k, j) = pair_density(modes[index(k)], weather[k] + levels[index(k)].mean,
                               levels[index(k)].variance, record[index(j)], options) /
                  spurious;
  return out;
}

VectorXd detections(const std::vector<TrackedMode>& modes) {
  VectorXd out(static_cast<Index>(modes.size()));
  for (Index k = 0; k < out.size(); ++k) out[k] = modes[index(k)].detection;
  return out;
}

TrackedRecord tracked_record(const MatrixXd& pairs) {
  TrackedRecord out{.probability = VectorXd(pairs.rows()), .pairs = pairs};
  for (Index k = 0; k < pairs.rows(); ++k) {
    Index best = 0;
    const double most = pairs.cols() > 0 ? pairs.row(k).maxCoeff(&best) : 0.0;
    const double missing = 1.0 - pairs.row(k).sum();
    out.mode.push_back(most >= 0.5 ? static_cast<int>(best) : -1);
    out.probability[k] = most >= 0.5 ? most : std::clamp(missing, 0.0, 1.0);
  }
  return out;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// ln f of the assigned modes, n x K; NaN: missing.
MatrixXd assigned_frequencies(const std::vector<IdentifiedRecord>& records,
                              const std::vector<TrackedRecord>& tracked, Index modes) {
  MatrixXd out = MatrixXd::Constant(static_cast<Index>(records.size()), modes, kNaN);
  for (std::size_t t = 0; t < records.size(); ++t)
    for (Index k = 0; k < modes; ++k)
      if (const int j = tracked[t].mode[index(k)]; j >= 0)
        out(static_cast<Index>(t), k) = std::log(records[t][index(j)].frequency_hz);
  return out;
}

Series series_of(const MatrixXd& frequencies, const MatrixXd& covariates) {
  Series out{.features = frequencies, .covariates = covariates};
  for (Index t = 0; t < frequencies.rows(); ++t) out.hours.push_back(static_cast<double>(t));
  return out;
}

void check_sizes(const std::vector<IdentifiedRecord>& records) {
  for (const IdentifiedRecord& record : records)
    if (record.size() > kMostModes)
      throw std::invalid_argument("a record has more than " + std::to_string(kMostModes) +
                                  " modes: identify a narrower band");
}

}  // namespace

double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  if (a.size() == 0 || b.size() == 0) return 1.0;
  if (a.size() != b.size()) throw std::invalid_argument("shapes of different sizes");
  std::complex<double> cross = 0.0;
  double aa = 0.0, bb = 0.0;
  for (Index i = 0; i < a.size(); ++i) {
    if (!std::isfinite(std::abs(a[i])) || !std::isfinite(std::abs(b[i]))) continue;
    cross += std::conj(a[i]) * b[i];
    aa += std::norm(a[i]);
    bb += std::norm(b[i]);
  }
  return aa > 0.0 && bb > 0.0 ? std::min(1.0, std::norm(cross) / (aa * bb)) : 1.0;
}

MatrixXd pair_probabilities(const MatrixXd& ratio, const VectorXd& detection) {
  using Weights = std::map<std::uint64_t, double>;
  constexpr double kNegligible = 1e-14;  // weight relative to the largest weight
  const Index tracked = ratio.rows(), modes = ratio.cols();
  const auto bit = [](Index j) { return std::uint64_t{1} << static_cast<unsigned>(j); };
  const auto prune = [](Weights& w) {
    double most = 0.0;
    for (const auto& [taken, weight] : w) most = std::max(most, weight);
    std::erase_if(w, [&](const auto& one) { return one.second < kNegligible * most; });
    for (auto& [taken, weight] : w) weight /= most;
  };
  // Forward: weight of each set of identified modes that the first k tracked modes occupy.
  std::vector<Weights> forward = {{{0, 1.0}}};
  for (Index k = 0; k < tracked; ++k) {
    Weights next;
    for (const auto& [taken, weight] : forward.back()) {
      next[taken] += weight * (1.0 - detection[k]);
      for (Index j = 0; j < modes; ++j)
        if ((taken & bit(j)) == 0) next[taken | bit(j)] += weight * detection[k] * ratio(k, j);
    }
    prune(next);
    forward.push_back(std::move(next));
  }
  // Backward: total weight of all assignments of the remaining tracked modes, for each set.
  MatrixXd out = MatrixXd::Zero(tracked, modes);
  Weights backward;
  for (const auto& [taken, weight] : forward.back()) backward[taken] = 1.0;
  for (Index k = tracked - 1; k >= 0; --k) {
    Weights before;
    double total = 0.0;
    for (const auto& [taken, weight] : forward[index(k)]) {
      const auto after = [&](std::uint64_t set) {
        const auto found = backward.find(set);
        return found == backward.end() ? 0.0 : found->second;
      };
      const double missing = (1.0 - detection[k]) * after(taken);
      double sum = missing;
      for (Index j = 0; j < modes; ++j) {
        if ((taken & bit(j)) != 0) continue;
        const double pair = detection[k] * ratio(k, j) * after(taken | bit(j));
        out(k, j) += weight * pair;
        sum += pair;
      }
      before[taken] = sum;
      total += weight * sum;
    }
    out.row(k) /= total;
    double most = 0.0;
    for (const auto& [taken, value] : before) most = std::max(most, value);
    for (auto& [taken, value] : before) value /= most;
    backward = std::move(before);
  }
  return out;
}

ModeTracker::ModeTracker(const std::vector<IdentifiedRecord>& records, const MatrixXd& covariates,
                         const TrackingOptions& options)
    : options_(options) {
  check_sizes(records);
  find_modes(records);
  if (modes_.empty())
    throw std::invalid_argument("no mode is in " +
                                std::to_string(static_cast<int>(100.0 * options.share)) +
                                " % of the training records");
  // The first pass has no effect of the weather yet; the later passes include it.
  for (int pass = 0; pass < 3; ++pass) learn(records, covariates);
}

void ModeTracker::find_modes(const std::vector<IdentifiedRecord>& records) {
  struct Found {
    std::size_t record;
    const IdentifiedMode* mode;
    bool free = true;
  };
  constexpr std::size_t kMostRecords = 200;
  const std::size_t n = std::min(records.size(), kMostRecords);
  std::vector<Found> found;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t t = i * records.size() / n;
    for (const IdentifiedMode& mode : records[t]) found.push_back({t, &mode});
  }
  const auto distance = [](const IdentifiedMode& a, const IdentifiedMode& b) {
    const bool shapes = a.shape.size() > 0 && b.shape.size() > 0;
    const double f = std::log(a.frequency_hz / b.frequency_hz) / (shapes ? 0.05 : 0.025);
    const double unlike = (1.0 - modal_assurance(a.shape, b.shape)) / 0.15;
    return std::hypot(f, unlike);
  };
  // Repeatedly takes the mode for which most records have a similar mode.
  for (;;) {
    std::vector<std::size_t> best;
    std::size_t support = 0, centre = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i].free) continue;
      std::vector<std::size_t> near;
      std::size_t with = 0;
      for (std::size_t k = 0, last = records.size(); k < found.size(); ++k) {
        if (!found[k].free || distance(*found[i].mode, *found[k].mode) > 1.0) continue;
        near.push_back(k);
        with += found[k].record != last ? 1 : 0;
        last = found[k].record;
      }
      if (with <= support) continue;
      support = with;
      centre = i;
      best = std::move(near);
    }
    if (static_cast<double>(support) < options_.share * static_cast<double>(n) || support == 0)
      break;
    std::vector<double> logs;
    for (const std::size_t k : best) {
      logs.push_back(std::log(found[k].mode->frequency_hz));
      found[k].free = false;
    }
    modes_.push_back({.log_frequency = median_of(logs), .shape = found[centre].mode->shape});
  }
  std::ranges::sort(modes_, {}, &TrackedMode::log_frequency);
}

MatrixXd ModeTracker::weather_effect(const MatrixXd& covariates) const {
  MatrixXd out = MatrixXd::Zero(covariates.rows(), static_cast<Index>(modes_.size()));
  if (learned_frequencies_.size() == 0 || covariates.cols() == 0) return out;
  const HingeRegression regression(series_of(learned_frequencies_, learned_covariates_));
  const VectorXd zero = VectorXd::Zero(out.cols());
  for (Index t = 0; t < out.rows(); ++t) {
    const Row row{.features = zero, .covariates = covariates.row(t).transpose()};
    out.row(t) = -regression.residuals(row).transpose();
  }
  for (Index k = 0; k < out.cols(); ++k) out.col(k).array() -= modes_[index(k)].log_frequency;
  return out;
}

std::vector<TrackedRecord> ModeTracker::track(const std::vector<IdentifiedRecord>& records,
                                              const MatrixXd& covariates) const {
  check_sizes(records);
  const MatrixXd weather = weather_effect(covariates);
  const VectorXd detection = detections(modes_);
  std::vector<Level> levels;
  for (const TrackedMode& mode : modes_)
    levels.push_back({mode.log_frequency, mode.scatter * mode.scatter});
  std::vector<TrackedRecord> out;
  for (std::size_t t = 0; t < records.size(); ++t) {
    const VectorXd effect = weather.row(static_cast<Index>(t)).transpose();
    for (std::size_t k = 0; k < levels.size(); ++k)
      levels[k].variance += std::pow(options_.walk * modes_[k].scatter, 2);
    out.push_back(tracked_record(pair_probabilities(
        ratios_of_record(modes_, levels, effect, spurious_, records[t], options_), detection)));
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const int j = out.back().mode[k];
      if (j < 0) continue;
      const IdentifiedMode& mode = records[t][index(j)];
      const double sd = mode.frequency_sd / mode.frequency_hz;
      const double noise = modes_[k].scatter * modes_[k].scatter + sd * sd;
      // An uncertain assignment moves the level less.
      const double gain = out.back().probability[static_cast<Index>(k)] * levels[k].variance /
                          (levels[k].variance + noise);
      levels[k].mean +=
          gain * (std::log(mode.frequency_hz) - effect[static_cast<Index>(k)] - levels[k].mean);
      levels[k].variance *= 1.0 - gain;
    }
  }
  return out;
}

void ModeTracker::learn(const std::vector<IdentifiedRecord>& records, const MatrixXd& covariates) {
  const std::vector<TrackedRecord> tracked = track(records, covariates);
  const auto count = static_cast<Index>(modes_.size());
  const MatrixXd frequencies = assigned_frequencies(records, tracked, count);
  const MatrixXd effect = weather_effect(covariates);
  double spurious = 0.0, low = kInfinity, high = -kInfinity;
  for (std::size_t t = 0; t < records.size(); ++t) {
    spurious += static_cast<double>(records[t].size()) - tracked[t].pairs.sum();
    for (const IdentifiedMode& mode : records[t]) {
      low = std::min(low, std::log(mode.frequency_hz));
      high = std::max(high, std::log(mode.frequency_hz));
    }
  }
  const auto n = static_cast<double>(records.size());
  spurious_ = std::max(0.05, spurious / n) / std::max(0.1, high - low);
  for (Index k = 0; k < count; ++k) {
    TrackedMode& mode = modes_[index(k)];
    std::vector<double> levels, steps, unlike;
    double detected = 0.0, weight = 0.0;
    Eigen::VectorXcd shape = Eigen::VectorXcd::Zero(mode.shape.size());
    for (std::size_t t = 0; t < records.size(); ++t) {
      detected += tracked[t].pairs.row(k).sum();
      const int j = tracked[t].mode[index(k)];
      if (j < 0) continue;
      levels.push_back(frequencies(static_cast<Index>(t), k));
      steps.push_back(levels.back() - effect(static_cast<Index>(t), k));
      const Eigen::VectorXcd& other = records[t][index(j)].shape;
      if (shape.size() == 0 || other.size() == 0 || !other.allFinite()) continue;
      unlike.push_back(1.0 - modal_assurance(mode.shape, other));
      // The phase of a shape is arbitrary: rotate each shape to the phase of the reference.
      const std::complex<double> cross = other.dot(mode.shape);
      if (std::abs(cross) == 0.0) continue;
      shape += other / other.norm() * (cross / std::abs(cross));
      weight += 1.0;
    }
    mode.detection = std::clamp(detected / n, 0.05, 0.98);
    if (levels.size() < 3) continue;
    mode.log_frequency = median_of(levels);
    mode.scatter = std::max(
        kLeastScatter,
        robust_scatter(Eigen::Map<const VectorXd>(steps.data(), static_cast<Index>(steps.size())))
            .sd[0]);
    if (weight > 0.0) {
      double sum = 0.0;
      for (const double d : unlike) sum += d;
      mode.discrepancy =
          std::max(kLeastDiscrepancy, 2.0 * sum / static_cast<double>(unlike.size()));
      mode.shape = shape / shape.norm();
    }
  }
  learned_frequencies_ = frequencies;
  learned_covariates_ = covariates;
}

}  // namespace wheeltap::identification::monitoring
