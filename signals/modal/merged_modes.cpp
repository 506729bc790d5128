#include "signals/modal/merged_modes.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "signals/modal/average_linkage.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kNeverMerged = std::numeric_limits<double>::infinity();
constexpr double kNear = 0.02, kDeviations = 5.0, kThreshold = 0.15;
constexpr double kUnlike = 0.8, kInconsistent = 0.001;

std::vector<int> common_sensors(const std::vector<SetUpModes>& set_ups, int sensors) {
  std::vector<std::size_t> seen(index(sensors), 0);
  for (std::size_t s = 0; s < set_ups.size(); ++s) {
    std::set<int> own;
    for (const int k : set_ups[s].sensors) {
      if (k < 0 || k >= sensors)
        throw std::invalid_argument("sensor = " + std::to_string(k) + ": must be from 0 to " +
                                    std::to_string(sensors - 1));
      if (!own.insert(k).second)
        throw std::invalid_argument("set-up = " + std::to_string(s) + ": has sensor " +
                                    std::to_string(k) + " twice");
      ++seen[index(k)];
    }
  }
  std::vector<int> out;
  for (int k = 0; k < sensors; ++k)
    if (seen[index(k)] == set_ups.size()) out.push_back(k);
  return out;
}

std::vector<int> reference_channels(const SetUpModes& set_up, const std::vector<int>& references) {
  std::vector<int> out;
  for (const int k : references)
    out.push_back(static_cast<int>(std::ranges::find(set_up.sensors, k) - set_up.sensors.begin()));
  return out;
}

VectorXcd part(const VectorXcd& shape, const std::vector<int>& channels) {
  VectorXcd out(static_cast<Index>(channels.size()));
  for (std::size_t i = 0; i < channels.size(); ++i) out[static_cast<Index>(i)] = shape[channels[i]];
  return out;
}

/// The mean x̄, its weights (their sum is 1), and the variance τ² between set-ups.
struct Mean {
  double value = 0.0, sd = 0.0, between = 0.0, chi_square = 0.0;
  VectorXd weights;
};

Mean weighted_mean(const VectorXd& x, const VectorXd& stated) {
  // A variance of 0 is replaced by the variance of rounding errors.
  const VectorXd variance = stated.cwiseMax(1e-30 + 1e-24 * x.cwiseAbs2().maxCoeff());
  VectorXd w = variance.cwiseInverse();
  Mean out;
  out.value = w.dot(x) / w.sum();
  out.chi_square = w.dot((x.array() - out.value).square().matrix());
  const double freedom = static_cast<double>(x.size()) - 1.0;
  const double room = w.sum() - w.squaredNorm() / w.sum();
  if (freedom > 0.0) out.between = std::max(0.0, (out.chi_square - freedom) / room);
  w = (variance.array() + out.between).inverse();
  out.sd = std::sqrt(1.0 / w.sum());
  out.weights = w / w.sum();
  out.value = out.weights.dot(x);
  return out;
}

/// The shapes of one mode in all set-ups in which the mode was identified.
struct Pieces {
  struct Piece {
    std::vector<int> sensors;
    std::vector<int> references;  ///< channels
    VectorXcd shape;
    MatrixXd covariance;
    double weight = 1.0;  ///< u_s
  };
  std::vector<Piece> list;
  int sensors = 0;
  std::size_t base = 0;  ///< index of the part to which all others are scaled first
  Index top = -1;        ///< index of the entry that becomes 1

  [[nodiscard]] VectorXcd glued() const {
    std::vector<VectorXcd> r;
    for (const Piece& p : list) r.push_back(part(p.shape, p.references));
    const auto factor = [](const VectorXcd& own, const VectorXcd& to) -> std::complex<double> {
      return own.dot(to) / own.squaredNorm();  // dot() of Eigen conjugates the first vector
    };
    VectorXcd mean = VectorXcd::Zero(r.front().size());
    double all = 0.0;
    for (std::size_t s = 0; s < list.size(); ++s) {
      mean += list[s].weight * factor(r[s], r[base]) * r[s];
      all += list[s].weight;
    }
    mean /= all;
    VectorXcd sum = VectorXcd::Zero(sensors);
    VectorXd weights = VectorXd::Zero(sensors);
    for (std::size_t s = 0; s < list.size(); ++s) {
      const Piece& p = list[s];
      const std::complex<double> a = factor(r[s], mean);
      for (std::size_t c = 0; c < p.sensors.size(); ++c) {
        sum[p.sensors[c]] += p.weight * a * p.shape[static_cast<Index>(c)];
        weights[p.sensors[c]] += p.weight;
      }
    }
    for (Index k = 0; k < sensors; ++k)
      sum[k] = weights[k] > 0.0 ? sum[k] / weights[k] : std::complex<double>(kNaN, kNaN);
    return sum;
  }
  [[nodiscard]] VectorXcd scaled() const {
    const VectorXcd whole = glued();
    return whole / whole[top];
  }
};

/// Relative variance of the references of a part: 1/u before scaling.
double relative_variance(const Pieces::Piece& p) {
  const auto n = static_cast<Index>(p.sensors.size());
  double variance = 0.0;
  for (const int c : p.references) variance += p.covariance(c, c) + p.covariance(n + c, n + c);
  return variance / part(p.shape, p.references).squaredNorm();
}

void glue(MergedMode& out, Pieces& pieces) {
  double best = kNeverMerged;
  for (std::size_t s = 0; s < pieces.list.size(); ++s) {
    // The variance is 0 if the only reference is the largest entry. The limit bounds the weight.
    const double variance = std::max(relative_variance(pieces.list[s]), 1e-8);
    pieces.list[s].weight = 1.0 / variance;
    if (variance < best) {
      best = variance;
      pieces.base = s;
    }
  }
  const VectorXcd whole = pieces.glued();
  double most = 0.0;
  for (Index k = 0; k < whole.size(); ++k)
    if (std::abs(whole[k]) > most) {
      most = std::abs(whole[k]);
      pieces.top = k;
    }
  out.shape = pieces.scaled();
  const Index n = pieces.sensors;
  out.shape_covariance = MatrixXd::Zero(2 * n, 2 * n);
  for (Pieces::Piece& p : pieces.list) {
    const auto own = static_cast<Index>(p.sensors.size());
    MatrixXd derivative(2 * n, 2 * own);
    for (Index j = 0; j < 2 * own; ++j) {
      const std::complex<double> held = p.shape[j % own];
      const double h = 1e-5;  // largest entry 1: differences are accurate to about 1e-10
      const std::complex<double> step =
          j < own ? std::complex<double>(h, 0.0) : std::complex(0.0, h);
      p.shape[j % own] = held + step;
      const VectorXcd up = pieces.scaled();
      p.shape[j % own] = held - step;
      const VectorXcd down = pieces.scaled();
      p.shape[j % own] = held;
      const VectorXcd slope = (up - down) / (2.0 * h);
      for (Index k = 0; k < n; ++k) {
        const bool told = std::isfinite(slope[k].real());
        derivative(k, j) = told ? slope[k].real() : 0.0;
        derivative(n + k, j) = told ? slope[k].imag() : 0.0;
      }
    }
    out.shape_covariance += derivative * p.covariance * derivative.transpose();
  }
}

double collinearity_of_known(const VectorXcd& shape) {
  std::vector<std::complex<double>> known;
  for (const std::complex<double>& x : shape)
    if (std::isfinite(x.real())) known.push_back(x);
  return phase_collinearity(
      Eigen::Map<const VectorXcd>(known.data(), static_cast<Index>(known.size())));
}

/// A mode of one set-up.
struct FoundMode {
  int set_up, place;
  const Mode* mode;
  VectorXcd at_references;
};

double distance_between(const FoundMode& a, const FoundMode& b) {
  const double fa = a.mode->pole.frequency_hz, fb = b.mode->pole.frequency_hz;
  const double apart = std::abs(fa - fb), larger = std::max(fa, fb);
  if (apart > std::max(kNear * larger, kDeviations * std::hypot(a.mode->pole.frequency_sd,
                                                                b.mode->pole.frequency_sd)))
    return kNeverMerged;
  return apart / larger + 1.0 - modal_assurance(a.at_references, b.at_references);
}

/// The values of one mode in all set-ups in which the mode was identified.
struct Sightings {
  VectorXd f, zeta, f_variance, zeta_variance;
  Pieces pieces;
  int doubted = 0;
};

/// The smallest MAC between two parts, at most 1.
double least_reference_mac(const Pieces& pieces) {
  double least = 1.0;
  for (std::size_t a = 0; a < pieces.list.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      least =
          std::min(least, modal_assurance(part(pieces.list[a].shape, pieces.list[a].references),
                                          part(pieces.list[b].shape, pieces.list[b].references)));
  return least;
}

class ModeMerger {
 public:
  ModeMerger(const std::vector<SetUpModes>& set_ups, int sensors, std::vector<int> references)
      : set_ups_(set_ups), sensors_(sensors), out_{.references = std::move(references)} {
    for (const SetUpModes& s : set_ups_) {
      channels_.push_back(reference_channels(s, out_.references));
      int& least = out_.covariance_samples;
      if (s.covariance_samples > 0 && (least == 0 || s.covariance_samples < least))
        least = s.covariance_samples;
    }
  }

  MergedModes merge() {
    match();
    count_ = static_cast<Index>(out_.modes.size());
    for (const SetUpModes& s : set_ups_)
      weights_.emplace_back(MatrixXd::Zero(2 * count_, 2 * static_cast<Index>(s.modes.size())));
    between_ = VectorXd::Zero(2 * count_);
    for (std::size_t m = 0; m < out_.modes.size(); ++m) {
      MergedMode& mode = out_.modes[m];
      Sightings seen = sightings(mode);
      average(static_cast<Index>(m), seen);
      mode.reference_mac = least_reference_mac(seen.pieces);
      glue(mode, seen.pieces);
      mode.collinearity = collinearity_of_known(mode.shape);
      doubt(mode, seen.doubted);
    }
    sort_by_frequency();
    return std::move(out_);
  }

 private:
  /// Matches the modes of the set-ups. The merged modes contain only indices so far.
  void match() {
    std::vector<FoundMode> found;
    std::vector<int> groups;
    for (std::size_t s = 0; s < set_ups_.size(); ++s) {
      for (std::size_t m = 0; m < set_ups_[s].modes.size(); ++m) {
        const Mode& mode = set_ups_[s].modes[m];
        found.push_back(
            {static_cast<int>(s), static_cast<int>(m), &mode, part(mode.pole.shape, channels_[s])});
        groups.push_back(static_cast<int>(s));
      }
    }
    const auto distance = [&](int i, int j) {
      return distance_between(found[index(i)], found[index(j)]);
    };
    for (const std::vector<int>& cluster : average_linkage(groups, distance, kThreshold)) {
      MergedMode mode{.places = std::vector<int>(set_ups_.size(), -1)};
      for (const int i : cluster)
        mode.places[index(found[index(i)].set_up)] = found[index(i)].place;
      out_.modes.push_back(std::move(mode));
    }
  }

  [[nodiscard]] Sightings sightings(const MergedMode& mode) const {
    const auto members = static_cast<Index>(mode.found());
    Sightings seen{.f = VectorXd(members),
                   .zeta = VectorXd(members),
                   .f_variance = VectorXd(members),
                   .zeta_variance = VectorXd(members),
                   .pieces = {}};
    seen.pieces.sensors = sensors_;
    Index i = 0;
    for (std::size_t s = 0; s < set_ups_.size(); ++s) {
      if (mode.places[s] < 0) continue;
      const Mode& one = set_ups_[s].modes[index(mode.places[s])];
      seen.f[i] = one.pole.frequency_hz;
      seen.zeta[i] = one.pole.damping;
      seen.f_variance[i] = std::pow(one.pole.frequency_sd, 2);
      seen.zeta_variance[i] = std::pow(one.pole.damping_sd, 2);
      seen.doubted += one.doubts.empty() ? 0 : 1;
      seen.pieces.list.push_back({.sensors = set_ups_[s].sensors,
                                  .references = channels_[s],
                                  .shape = one.pole.shape,
                                  .covariance = one.shape_covariance});
      ++i;
    }
    return seen;
  }

  void average(Index row, const Sightings& seen) {
    MergedMode& mode = out_.modes[static_cast<std::size_t>(row)];
    const Mean frequency = weighted_mean(seen.f, seen.f_variance),
               damping = weighted_mean(seen.zeta, seen.zeta_variance);
    mode.frequency_hz = frequency.value;
    mode.frequency_sd = frequency.sd;
    mode.between_hz = std::sqrt(frequency.between);
    mode.damping = damping.value;
    mode.damping_sd = damping.sd;
    const Index members = seen.f.size();
    if (members > 1)
      mode.consistency_p = boost::math::gamma_q(0.5 * (static_cast<double>(members) - 1.0),
                                                0.5 * frequency.chi_square);
    Index i = 0;
    for (std::size_t s = 0; s < set_ups_.size(); ++s) {
      if (mode.places[s] < 0) continue;
      const auto own = static_cast<Index>(set_ups_[s].modes.size());
      weights_[s](row, mode.places[s]) = frequency.weights[i];
      weights_[s](count_ + row, own + mode.places[s]) = damping.weights[i];
      ++i;
    }
    between_[row] = frequency.between * frequency.weights.squaredNorm();
    between_[count_ + row] = damping.between * damping.weights.squaredNorm();
  }

  void doubt(MergedMode& mode, int doubted) const {
    if (2 * mode.found() < static_cast<int>(set_ups_.size()))
      mode.doubts.push_back(MergeDoubt::few_set_ups);
    if (2 * doubted > mode.found()) mode.doubts.push_back(MergeDoubt::doubted);
    if (mode.consistency_p < kInconsistent) mode.doubts.push_back(MergeDoubt::inconsistent);
    if (mode.reference_mac < kUnlike) mode.doubts.push_back(MergeDoubt::unlike);
  }

  /// Computes the modes and the rows of their covariance.
  void sort_by_frequency() {
    std::vector<std::size_t> order(out_.modes.size());
    for (std::size_t m = 0; m < order.size(); ++m) order[m] = m;
    std::ranges::sort(order, {}, [&](std::size_t m) { return out_.modes[m].frequency_hz; });
    MatrixXd covariance = between_.asDiagonal();
    for (std::size_t s = 0; s < set_ups_.size(); ++s)
      covariance += weights_[s] * set_ups_[s].covariance * weights_[s].transpose();
    out_.covariance.resize(2 * count_, 2 * count_);
    const auto from = [&](Index k) {
      return k < count_ ? static_cast<Index>(order[static_cast<std::size_t>(k)])
                        : count_ + static_cast<Index>(order[static_cast<std::size_t>(k - count_)]);
    };
    for (Index i = 0; i < 2 * count_; ++i)
      for (Index j = 0; j < 2 * count_; ++j) out_.covariance(i, j) = covariance(from(i), from(j));
    std::vector<MergedMode> sorted;
    for (const std::size_t m : order) sorted.push_back(std::move(out_.modes[m]));
    out_.modes = std::move(sorted);
  }

  const std::vector<SetUpModes>& set_ups_;
  int sensors_;
  MergedModes out_;
  std::vector<std::vector<int>> channels_;  ///< channels of the references, by set-up
  Index count_ = 0;                         ///< number of merged modes
  /// Derivatives of merged values with respect to frequencies and damping ratios of set-ups.
  std::vector<MatrixXd> weights_;
  VectorXd between_;  ///< additional variance τ² of the merged values
};

}  // namespace

int MergedMode::found() const {
  return static_cast<int>(std::ranges::count_if(places, [](int p) { return p >= 0; }));
}

MergedModes merge_modes(const std::vector<SetUpModes>& set_ups, int sensors) {
  if (set_ups.empty()) throw std::invalid_argument("set-ups = 0: must be at least 1");
  std::vector<int> references = common_sensors(set_ups, sensors);
  if (references.empty())
    throw std::invalid_argument(
        "set-ups: have no sensor in common, so that their shapes cannot be scaled to each other");
  return ModeMerger(set_ups, sensors, std::move(references)).merge();
}

}  // namespace wheeltap::signals
