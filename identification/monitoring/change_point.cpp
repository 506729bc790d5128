#include "identification/monitoring/change_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/constants.hpp"
#include "base/index.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double log_sum(double a, double b) {
  if (a < b) std::swap(a, b);
  return b == -kInfinity ? a : a + std::log1p(std::exp(b - a));
}

template <class Values>
double log_sum_exp(const Values& values) {
  const double top = values.maxCoeff();
  return top == -kInfinity ? top : top + std::log((values.array() - top).exp().sum());
}

/// ln of the prior probability of each hypothesis on δ, (1 + p) x kSizes.
MatrixXd log_prior_of_hypotheses(Index p) {
  const double all = p > 1 ? 0.5 : 1.0 - 0.5 / kSizes, each = (1.0 - all) / static_cast<double>(p);
  MatrixXd out(1 + p, kSizes);
  out.row(0).setConstant(std::log(all / kSizes));
  out.bottomRows(p).setConstant(std::log(each / kSizes));
  return out;
}

double profile_at(ShiftProfile profile, double hours) {
  if (profile == ShiftProfile::ramp) return std::min(1.0, hours / kRampHours);
  return profile == ShiftProfile::transient ? std::exp(-hours / kTransientHours) : 1.0;
}

/// Adds the log densities of a row to the weights of draws and hypotheses, normalises them and
/// redistributes the fixed share. Returns ln of the row's density given the onset.
double add_scores(CandidateOnset& c, const std::vector<MatrixXd>& log_density, double share) {
  double total = -kInfinity;
  for (std::size_t k = 0; k < c.draws.size(); ++k) {
    c.draws[k].log_weight += log_density[k];
    total = log_sum(total, log_sum_exp(c.draws[k].log_weight));
  }
  MatrixXd mean = MatrixXd::Zero(c.draws[0].log_weight.rows(), kSizes);
  for (ShiftPosterior& d : c.draws) {
    d.log_weight = (d.log_weight.array() - total).exp();
    mean += d.log_weight;
  }
  const auto m = static_cast<double>(c.draws.size());
  for (ShiftPosterior& d : c.draws)
    d.log_weight = ((1.0 - share) * d.log_weight.array() + (share / m) * mean.array()).log();
  return total;
}

// Fraction of weight that each row moves between the two filters of the model without a change.
constexpr double kFilterShare = 0.05;

/// The candidates of one draw in one row. All candidates share the gain k_i of entry i, so that the
/// derivative of the innovation of entry j with respect to δ is
///
///   g_j = r e_j + F_j' h - Σ_{i<j} (k_i' h)_j g_i,
///
/// F_j: rows of F for feature j; i: entries before j. F changes after the row's last entry.
class DrawScores {
 public:
  DrawScores(const std::vector<CandidateOnset*>& all, std::size_t draw,
             const BaselineParameters& parameters, const VectorXd& h, double hours,
             std::int64_t row)
      : p_(parameters.features()),
        block_(parameters.block()),
        degrees_(parameters.degrees),
        h_(h),
        density_(parameters.degrees),
        hypotheses_(static_cast<std::size_t>((1 + p_) * kSizes)),
        sums_(all.size() * hypotheses_),
        gains_(p_ * block_, p_),
        along_(p_, p_),
        mass_(static_cast<Index>(all.size())),
        inflation_(static_cast<Index>(all.size())) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      CandidateOnset& c = *all[i];
      Candidate one{.shift = &c.draws[draw],
                    .profile = profile_at(c.profile, hours - c.hours),
                    .g = MatrixXd(p_, p_),
                    .spread = MatrixXd(p_, kSizes)};
      for (Index j = 0; j < p_; ++j)
        one.g.col(j).noalias() =
            one.shift->sensitivity.middleRows(j * block_, block_).transpose() * h;
      one.projected = one.g;
      const MatrixXd& log_weight = one.shift->log_weight;
      const double most = log_weight.maxCoeff(&one.favourite[0], &one.favourite[1]);
      mass_[static_cast<Index>(i)] = c.row == row ? -kInfinity : c.log_mass() + most;
      candidates_.push_back(std::move(one));
    }
  }

  /// Adds the densities of an entry of feature j; without a shift, its innovation is v with
  /// variance s. Returns the common noise inflation of the candidates: the mean over their most
  /// probable hypotheses, weighted by their mass.
  double score(Index j, double v, double s) {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      Candidate& c = candidates_[i];
      const ShiftPosterior& shift = *c.shift;
      auto g = c.g.col(entries_);
      g = c.projected.col(j);
      g[j] += c.profile;
      for (Index e = 0; e < entries_; ++e) g -= along_(e, j) * c.g.col(e);
      DensitySum::Terms* sum = &sums_[i * hypotheses_];
      for (Index size = 0; size < kSizes; ++size) {
        auto spread = c.spread.col(size);
        spread.noalias() = shift.covariance.middleCols(size * p_, p_) * g;
        add(i, 0, size, v - g.dot(shift.mean.col(size)), s + g.dot(spread), sum[size]);
        for (Index k = 0; k < p_; ++k)
          add(i, 1 + k, size, v - g[k] * shift.single_mean(k, size),
              s + g[k] * g[k] * shift.single_variance(k, size), sum[(1 + k) * kSizes + size]);
      }
    }
    if (degrees_ == kGaussian) return 1.0;
    const double top = mass_.maxCoeff();
    if (top == -kInfinity) return noise_inflation(v, s, degrees_);
    const VectorXd weight = (mass_.array() - top).exp();
    return weight.dot(inflation_) / weight.sum();
  }

  /// Updates the posterior of every δ by the entry that was scored last.
  void update(double v, double inflated, const VectorXd& gain) {
    for (Candidate& c : candidates_) {
      ShiftPosterior& shift = *c.shift;
      const auto g = c.g.col(entries_);
      for (Index size = 0; size < kSizes; ++size) {
        const auto spread = c.spread.col(size);
        const double total = inflated + g.dot(spread);
        shift.mean.col(size) += spread * ((v - g.dot(shift.mean.col(size))) / total);
        shift.covariance.middleCols(size * p_, p_).noalias() -=
            (spread / total) * spread.transpose();
        for (Index k = 0; k < p_; ++k) {
          double& variance = shift.single_variance(k, size);
          const double kg = variance * g[k], st = inflated + g[k] * kg;
          shift.single_mean(k, size) += kg * (v - g[k] * shift.single_mean(k, size)) / st;
          variance -= kg * kg / st;
        }
      }
    }
    gains_.col(entries_) = gain;
    for (Index j = 0; j < p_; ++j) along_(entries_, j) = gain.segment(j * block_, block_).dot(h_);
    ++entries_;
  }

  void finish() {
    for (Candidate& c : candidates_)
      c.shift->sensitivity.noalias() -=
          gains_.leftCols(entries_) * c.g.leftCols(entries_).transpose();
  }

  /// ln of the row's density under each hypothesis of candidate i.
  void write(std::size_t i, MatrixXd& log_density) const {
    for (Index h = 0; h <= p_; ++h)
      for (Index size = 0; size < kSizes; ++size)
        log_density(h, size) =
            density_.value(sums_[i * hypotheses_ + static_cast<std::size_t>(h * kSizes + size)]);
  }

 private:
  struct Candidate {
    ShiftPosterior* shift = nullptr;
    double profile = 1.0;
    MatrixXd g = {};          // p x entries
    MatrixXd projected = {};  // column j: F_j' h
    MatrixXd spread = {};     // covariance of δ times g, one column per size
    std::array<Index, 2> favourite = {};
  };

  void add(std::size_t i, Index hypothesis, Index size, double v, double s,
           DensitySum::Terms& sum) {
    density_.add(sum, v, s);
    if (hypothesis != candidates_[i].favourite[0] || size != candidates_[i].favourite[1]) return;
    inflation_[static_cast<Index>(i)] = noise_inflation(v, s, degrees_);
    mass_[static_cast<Index>(i)] += log_innovation_density(v, s, degrees_);
  }

  Index p_, block_;
  double degrees_;
  const VectorXd& h_;
  DensitySum density_;
  std::size_t hypotheses_;
  std::vector<DensitySum::Terms> sums_;
  std::vector<Candidate> candidates_;
  MatrixXd gains_, along_;  // states x entries; entries x features: k' h
  VectorXd mass_, inflation_;
  Index entries_ = 0;
};

}  // namespace

/// Log densities of a row under each candidate, draw and hypothesis.
struct ChangePoint::RowScores {
  std::vector<std::vector<MatrixXd>> log_density;  ///< per candidate and draw: (1 + p) x kSizes
  VectorXd unshifted;                              ///< per draw: candidates' filter without a shift
};

ChangePoint::ChangePoint(const Baseline& baseline, const ChangePointOptions& options)
    : scaling_(baseline.scaling),
      residual_sd_(baseline.residual_sd),
      options_(options),
      draws_(baseline.draws),
      last_hours_(baseline.last_hours),
      last_ramp_hours_(baseline.last_hours) {
  for (const BaselineDraw& draw : draws_) changed_.push_back(draw.filter);
  const auto m = static_cast<Index>(draws_.size());
  log_weight_ = VectorXd::Constant(m, -std::log(static_cast<double>(m)));
  shared_ = VectorXd::Constant(m, 0.5);
}

CandidateOnset ChangePoint::born(const Row& row, ShiftProfile profile) const {
  const auto p = static_cast<Index>(residual_sd_.size());
  CandidateOnset out{.row = rows_, .hours = row.hours, .profile = profile};
  const MatrixXd prior = log_prior_of_hypotheses(p);
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    ShiftPosterior shift{.sensitivity = MatrixXd::Zero(draws_[m].filter.x.size(), p),
                         .mean = MatrixXd::Zero(p, kSizes),
                         .covariance = MatrixXd::Zero(p, p * kSizes),
                         .single_mean = MatrixXd::Zero(p, kSizes),
                         .single_variance = MatrixXd(p, kSizes),
                         .log_weight = prior.array() + log_weight_[static_cast<Index>(m)]};
    for (Index s = 0; s < kSizes; ++s) {
      shift.single_variance.col(s) = (kShiftSizes[s] * residual_sd_).array().square();
      shift.covariance.middleCols(s * p, p).diagonal() = shift.single_variance.col(s);
    }
    out.draws.push_back(std::move(shift));
  }
  return out;
}

void ChangePoint::bear_candidates(const Row& row, double hours) {
  const double log_born = std::log(-std::expm1(-options_.hazard_per_hour * hours)) + log_no_change_;
  log_no_change_ -= options_.hazard_per_hour * hours;
  const auto bear = [&](ShiftProfile profile, double log_share, double rows) {
    candidates_.push_back(born(row, profile));
    candidates_.back().log_wealth = log_share + std::log(rows);
    candidates_.back().log_prior = log_share + log_born + std::log(rows);
  };
  bear(ShiftProfile::step, std::log1p(-options_.ramp_share), 1.0);
  // A candidate ramp represents all rows since the previous candidate ramp.
  if (options_.ramp_share > 0.0 && (rows_ + 1) % options_.ramp_every == 0)
    bear(ShiftProfile::ramp, std::log(options_.ramp_share), options_.ramp_every);
  if (options_.transients_per_hour > 0.0) {
    const double ends = options_.transient_ends_per_hour * hours;
    for (CandidateOnset& c : transients_) {
      if (ends > 0.0) log_quiet_ = log_sum(log_quiet_, c.log_mass() + std::log(-std::expm1(-ends)));
      c.log_prior -= ends;
    }
    transients_.push_back(born(row, ShiftProfile::transient));
    transients_.back().log_prior =
        log_quiet_ + std::log(-std::expm1(-options_.transients_per_hour * hours));
    log_quiet_ -= options_.transients_per_hour * hours;
  }
}

std::vector<CandidateOnset*> ChangePoint::all_candidates() {
  std::vector<CandidateOnset*> out;
  for (CandidateOnset& c : candidates_) out.push_back(&c);
  for (CandidateOnset& c : transients_) out.push_back(&c);
  return out;
}

VectorXd ChangePoint::score_healthy(const Row& row, double hours,
                                    const std::vector<Weather>& weather, PredictedRow& out) {
  const auto p = static_cast<Index>(residual_sd_.size());
  out = {.mean = VectorXd::Zero(p), .sd = VectorXd::Zero(p), .weather = VectorXd::Zero(p)};
  VectorXd squares = VectorXd::Zero(p), log_density(log_weight_.size());
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    BaselineDraw& draw = draws_[m];
    const double weight = std::exp(log_weight_[static_cast<Index>(m)]);
    const Index block = draw.parameters.block();
    for (Index j = 0; j < p; ++j)
      out.weather[j] +=
          weight *
          draw.filter.x.segment(j * block + 1, block - 3).dot(weather[m].h.segment(1, block - 3));
    const RowPrediction predicted =
        filter_row(draw.parameters, weather[m], row, hours, draw.filter);
    log_density[static_cast<Index>(m)] = predicted.log_density;
    out.mean += weight * predicted.mean;
    squares.array() += weight * (predicted.mean.array().square() + predicted.sd.array().square());
  }
  out.sd = (squares.array() - out.mean.array().square()).max(0.0).sqrt();
  return log_density;
}

double ChangePoint::weigh_draws(const VectorXd& own, const VectorXd& shared) {
  // ln weights of both filters (without a change; shared by the candidates), per draw.
  const VectorXd with_own = log_weight_.array() + (1.0 - shared_.array()).log() + own.array();
  const VectorXd with_shared = log_weight_.array() + shared_.array().log() + shared.array();
  const double total = log_sum(log_sum_exp(with_own), log_sum_exp(with_shared));
  const VectorXd a = (with_own.array() - total).exp(), b = (with_shared.array() - total).exp();
  const double share = options_.fixed_share;
  shared_ = (1.0 - kFilterShare) * b.array() / (a + b).array().max(1e-300) + 0.5 * kFilterShare;
  log_weight_ =
      ((1.0 - share) * (a + b).array() + share / static_cast<double>(draws_.size())).log();
  return total;
}

void ChangePoint::score_draw(std::size_t m, const Row& row, const Weather& weather,
                             RowScores& scores) {
  const BaselineParameters& parameters = draws_[m].parameters;
  BaselineFilter& filter = changed_[m];
  const auto p = static_cast<Index>(residual_sd_.size());
  const std::vector<CandidateOnset*> all = all_candidates();
  DrawScores candidates(all, m, parameters, weather.h, row.hours, rows_);
  VectorXd covariance, gain(filter.x.size());
  for (Index j = 0; j < p; ++j) {
    if (!std::isfinite(row.features[j])) continue;
    const int feature = static_cast<int>(j);
    filter.observe(feature, weather.h, covariance);
    const double noise = noise_variance(parameters, weather, row, filter, feature);
    const double s = filter.variance(feature, weather.h, covariance) + noise;
    const double v = row.features[j] - filter.mean(feature, weather.h);
    scores.unshifted[static_cast<Index>(m)] += log_innovation_density(v, s, parameters.degrees);
    const double inflated = s + noise * (candidates.score(j, v, s) - 1.0);
    gain = covariance / inflated;
    filter.update(covariance, v, inflated);
    candidates.update(v, inflated, gain);
  }
  candidates.finish();
  for (std::size_t i = 0; i < all.size(); ++i) candidates.write(i, scores.log_density[i][m]);
}

double ChangePoint::weigh_healthy(const RowScores& scores, double log_baseline) {
  double total = log_quiet_ + log_baseline;
  log_quiet_ = total;
  for (std::size_t i = 0; i < transients_.size(); ++i) {
    CandidateOnset& c = transients_[i];
    c.log_ratio += add_scores(c, scores.log_density[candidates_.size() + i], options_.fixed_share);
    total = log_sum(total, c.log_mass());
  }
  log_quiet_ -= total;
  for (CandidateOnset& c : transients_) c.log_ratio -= total;
  return total;
}

void ChangePoint::weigh_candidates(const RowScores& scores, double log_healthy) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    CandidateOnset& c = candidates_[i];
    const double gain = add_scores(c, scores.log_density[i], options_.fixed_share) - log_healthy;
    c.log_ratio += gain;
    c.log_wealth += gain;
  }
}

void ChangePoint::merge(std::vector<CandidateOnset>& list, std::size_t from, std::size_t into) {
  CandidateOnset &a = list[from], &b = list[into];
  if (a.profile != ShiftProfile::transient)
    moved_ += std::exp(a.log_mass() - log_sum(log_no_change_, a.log_mass()));
  b.log_prior = log_sum(b.log_mass(), a.log_mass()) - b.log_ratio;
  b.log_wealth = log_sum(b.log_wealth, a.log_wealth);
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(from));
}

void ChangePoint::retire_transients(double hours) {
  constexpr double kDecayed = 5.0;  // in time constants
  std::erase_if(transients_, [&](const CandidateOnset& c) {
    if (hours - c.hours < kDecayed * kTransientHours) return false;
    log_quiet_ = log_sum(log_quiet_, c.log_mass());
    return true;
  });
}

void ChangePoint::merge_old() {
  if (options_.young == 0) return;
  for (const ShiftProfile profile : {ShiftProfile::step, ShiftProfile::ramp})
    while (merge_one(candidates_, profile)) continue;
  while (merge_one(transients_, ShiftProfile::transient)) continue;
}

bool ChangePoint::merge_one(std::vector<CandidateOnset>& list, ShiftProfile profile) {
  constexpr int kLastOctave = 7;  // contains all older candidates
  const bool is_ramp = profile == ShiftProfile::ramp;
  std::map<int, std::vector<std::size_t>> octaves;
  const double unit = options_.young * (is_ramp ? 4.0 : 1.0);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].profile != profile) continue;
    const auto age = static_cast<double>(rows_ - list[i].row);
    if (age >= unit)
      octaves[std::min(kLastOctave, static_cast<int>(std::log2(age / unit)))].push_back(i);
  }
  for (const auto& [octave, members] : octaves) {
    if (static_cast<int>(members.size()) <= (is_ramp ? 2 : options_.kept_per_octave)) continue;
    // Merge the candidate with the smallest mass into its nearer neighbour.
    std::size_t lightest = 0;
    for (std::size_t k = 1; k < members.size(); ++k)
      if (list[members[k]].log_mass() < list[members[lightest]].log_mass()) lightest = k;
    std::size_t into = lightest == 0 ? 1 : lightest - 1;
    if (lightest > 0 && lightest + 1 < members.size()) {
      const auto gap = [&, members = members](std::size_t k) {
        return std::abs(list[members[k]].row - list[members[lightest]].row);
      };
      if (gap(lightest + 1) < gap(lightest - 1)) into = lightest + 1;
    }
    merge(list, members[lightest], members[into]);
    return true;
  }
  return false;
}

PredictedRow ChangePoint::add(const Row& row) {
  const double hours = row.hours - last_hours_;
  const CovariateScaling::Scaled scaled = scaling_(row.covariates);
  bear_candidates(row, hours);
  std::vector<Weather> weather;
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    weather.push_back(next_weather(scaled, hours, draws_[m]));
    const BaselineParameters& b = draws_[m].parameters;
    changed_[m].predict(b, hours);
    const double fast = std::exp(-b.fast_rate * hours), slow = std::exp(-hours / kSlowHours);
    for (CandidateOnset* c : all_candidates())
      for (Index j = 1; j <= residual_sd_.size(); ++j) {
        c->draws[m].sensitivity.row(j * b.block() - 2) *= fast;
        c->draws[m].sensitivity.row(j * b.block() - 1) *= slow;
      }
  }
  PredictedRow out;
  const VectorXd own = score_healthy(row, hours, weather, out);
  if (row.features.array().isFinite().any()) {
    RowScores scores;
    const MatrixXd none(residual_sd_.size() + 1, kSizes);
    scores.log_density.assign(candidates_.size() + transients_.size(),
                              std::vector<MatrixXd>(draws_.size(), none));
    scores.unshifted = VectorXd::Zero(log_weight_.size());
    for (std::size_t m = 0; m < draws_.size(); ++m) score_draw(m, row, weather[m], scores);
    weigh_candidates(scores, weigh_healthy(scores, weigh_draws(own, scores.unshifted)));
  }
  ++rows_;
  retire_transients(row.hours);
  merge_old();
  last_hours_ = row.hours;
  return out;
}

double ChangePoint::log_statistic() const {
  double sum = -kInfinity;
  for (const CandidateOnset& c : candidates_) sum = log_sum(sum, c.log_wealth);
  return sum;
}

double ChangePoint::probability_changed() const {
  double sum = -kInfinity;
  for (const CandidateOnset& c : candidates_) sum = log_sum(sum, c.log_mass());
  return std::exp(sum - log_sum(sum, log_no_change_));
}

VectorXd ChangePoint::draw_probabilities() const {
  const double changed = probability_changed();
  double all = -kInfinity;
  for (const CandidateOnset& c : candidates_) all = log_sum(all, c.log_mass());
  VectorXd out = (1.0 - changed) * log_weight_.array().exp();
  for (const CandidateOnset& c : candidates_)
    for (Index m = 0; m < out.size(); ++m)
      out[m] += changed * std::exp(c.log_mass() - all + log_sum_exp(c.draws[index(m)].log_weight));
  return out / out.sum();
}

ChangeEstimate ChangePoint::estimate() const {
  const Index p = residual_sd_.size();
  ChangeEstimate out{.probability = probability_changed(),
                     .shift = VectorXd::Zero(p),
                     .shift_sd = VectorXd::Zero(p),
                     .shifted_probability = VectorXd::Zero(p)};
  if (candidates_.empty()) return out;
  double sum = -kInfinity;
  for (const CandidateOnset& c : candidates_) sum = log_sum(sum, c.log_mass());
  std::vector<std::pair<double, double>> onsets;
  VectorXd squares = VectorXd::Zero(p);
  for (const CandidateOnset& c : candidates_) {
    const double mass = std::exp(c.log_mass() - sum);
    onsets.emplace_back(c.hours, mass);
    if (c.profile == ShiftProfile::ramp) out.ramp_probability += mass;
    for (const ShiftPosterior& d : c.draws)
      for (Index size = 0; size < kSizes; ++size) {
        const double all = mass * std::exp(d.log_weight(0, size));
        const auto cov = d.covariance.middleCols(size * p, p);
        out.shift += all * d.mean.col(size);
        squares.array() += all * (d.mean.col(size).array().square() + cov.diagonal().array());
        out.shifted_probability.array() += all;
        for (Index j = 0; j < p; ++j) {
          const double alone = mass * std::exp(d.log_weight(1 + j, size));
          const double mean = d.single_mean(j, size);
          out.shift[j] += alone * mean;
          squares[j] += alone * (mean * mean + d.single_variance(j, size));
          out.shifted_probability[j] += alone;
        }
      }
  }
  out.shift_sd = (squares.array() - out.shift.array().square()).max(0.0).sqrt();
  std::ranges::sort(onsets);
  double below = 0.0;
  out.onset_low = out.onset_median = out.onset_high = onsets.back().first;
  bool low = false, median = false;
  for (const auto& [hours, mass] : onsets) {
    below += mass;
    if (!low && below >= 0.025) out.onset_low = hours, low = true;
    if (!median && below >= 0.5) out.onset_median = hours, median = true;
    if (below >= 0.975) {
      out.onset_high = hours;
      break;
    }
  }
  return out;
}

MatrixXd ChangePoint::covariate_slopes(int covariates) const {
  const Index p = residual_sd_.size();
  MatrixXd out = MatrixXd::Zero(p, covariates);
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    const BaselineDraw& draw = draws_[m];
    if (draw.lagged.size() == 0) continue;
    const double weight = std::exp(log_weight_[static_cast<Index>(m)]);
    const Index block = draw.parameters.block();
    const MatrixXd slopes = term_slopes(draw.parameters.terms, draw.lagged);
    for (Index j = 0; j < p; ++j)
      for (int i = 0; i < scaling_.count(); ++i)
        out(j, scaling_.used()[index(i)]) +=
            weight * draw.filter.x.segment(j * block, slopes.rows()).dot(slopes.col(i)) /
            scaling_.sd(i);
  }
  return out;
}

void ChangePoint::accept_change() {
  const auto best = std::ranges::max_element(candidates_, {},
                                             [](const CandidateOnset& c) { return c.log_mass(); });
  if (best == candidates_.end()) return;
  const Index p = residual_sd_.size();
  VectorXd log_weight(log_weight_.size());
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    const ShiftPosterior& d = best->draws[m];
    log_weight[static_cast<Index>(m)] = log_sum_exp(d.log_weight);
    Index h = 0, size = 0;
    d.log_weight.maxCoeff(&h, &size);
    VectorXd mean = VectorXd::Zero(p);
    MatrixXd covariance = MatrixXd::Zero(p, p);
    if (h == 0) {
      mean = d.mean.col(size);
      covariance = d.covariance.middleCols(size * p, p);
    } else {
      mean[h - 1] = d.single_mean(h - 1, size);
      covariance(h - 1, h - 1) = d.single_variance(h - 1, size);
    }
    // State and intercept are functions of the shift δ: x + (F + E) δ.
    MatrixXd entry = d.sensitivity;
    for (Index j = 0; j < p; ++j) entry(j * draws_[m].parameters.block(), j) += 1.0;
    BaselineFilter& filter = changed_[m];
    filter.x += entry * mean;
    filter.p += entry * covariance * entry.transpose();
    filter.p = 0.5 * (filter.p + filter.p.transpose()).eval();
    draws_[m].filter = filter;
  }
  log_weight_ = log_weight.array() - log_sum_exp(log_weight);
  shared_.setConstant(0.5);
  candidates_.clear();
  transients_.clear();
  log_quiet_ = 0.0;
  log_no_change_ = 0.0;
}

}  // namespace wheeltap::identification::monitoring
