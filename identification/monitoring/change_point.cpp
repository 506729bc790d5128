#include "identification/monitoring/change_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "inference/statistics/standard_normal.hpp"

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

/// p(δ's hypothesis), (1 + p) x kSizes.
MatrixXd prior_of_hypotheses(Index p) {
  const double all = p > 1 ? 0.5 : 1.0 - 0.5 / kSizes, each = (1.0 - all) / static_cast<double>(p);
  MatrixXd out(1 + p, kSizes);
  out.row(0).setConstant(all / kSizes);
  out.bottomRows(p).setConstant(each / kSizes);
  return out;
}

// Fraction of weight that each row moves between the two filters of the model without a change.
constexpr double kFilterShare = 0.05;

/// A longer time between two scored rows, in usual steps, is a gap.
constexpr double kGap = 1.5;

/// Appends (hours, mass) of an onset. The mass of merged onsets has their mean and variance and a
/// normal distribution, in equally probable parts, between the earliest and the latest of them.
void spread_onsets(const CandidateOnset& c, double mass,
                   std::vector<std::pair<double, double>>& out) {
  constexpr int kParts = 20;
  for (int part = 0; part < kParts; ++part) {
    const double z = inference::normal_quantile((part + 0.5) / kParts);
    out.emplace_back(std::clamp(c.mean_hours + std::sqrt(c.variance_hours) * z, c.first_hours,
                                std::max(c.first_hours, c.last_hours)),
                     mass / kParts);
  }
}

}  // namespace

double profile_at(ShiftProfile profile, double hours) {
  if (profile == ShiftProfile::ramp) return std::min(1.0, hours / kRampHours);
  return profile == ShiftProfile::transient ? std::exp(-hours / kTransientHours) : 1.0;
}

ChangePoint::ChangePoint(const Baseline& baseline, const ChangePointOptions& options)
    : scaling_(baseline.scaling),
      residual_sd_(baseline.residual_sd),
      options_(options),
      draws_(baseline.draws),
      rows_per_hour_(baseline.rows_per_hour),
      last_hours_(baseline.last_hours),
      last_ramp_hours_(baseline.last_hours),
      last_scored_hours_(baseline.last_hours) {
  std::vector<int> blocks;
  for (const BaselineDraw& draw : draws_) {
    changed_.push_back(draw.filter);
    blocks.push_back(draw.parameters.block());
  }
  MatrixXd variance(residual_sd_.size(), kSizes);
  for (Index s = 0; s < kSizes; ++s)
    variance.col(s) = (kShiftSizes[s] * residual_sd_).array().square();
  bank_ = CandidateBank(blocks, variance);
  const auto m = static_cast<Index>(draws_.size());
  log_weight_ = VectorXd::Constant(m, -std::log(static_cast<double>(m)));
  shared_ = VectorXd::Constant(m, 0.5);
}

CandidateOnset ChangePoint::born(const Row& row, ShiftProfile profile) {
  const VectorXd draws = log_weight_.array().exp();
  return {.row = rows_,
          .hours = row.hours,
          .first_hours = row.hours,
          .last_hours = row.hours,
          .mean_hours = row.hours,
          .profile = profile,
          .slot = bank_.add(prior_of_hypotheses(residual_sd_.size()), draws)};
}

std::vector<CandidateOnset> ChangePoint::candidates() const {
  std::vector<CandidateOnset> out = candidates_;
  for (CandidateOnset& c : out)
    for (std::size_t m = 0; m < draws_.size(); ++m)
      c.draws.push_back(bank_.posterior(c.slot, static_cast<int>(m)));
  return out;
}

void ChangePoint::bear_candidates(const Row& row, double hours) {
  const double log_born = std::log(-std::expm1(-options_.hazard_per_hour * hours)) + log_no_change_;
  log_no_change_ -= options_.hazard_per_hour * hours;
  // The threshold is a number of rows at the usual step. Rows at shorter steps count for less.
  const auto bear = [&](ShiftProfile profile, double log_share, double rows,
                        double more_log_prior) {
    candidates_.push_back(born(row, profile));
    candidates_.back().log_wealth = log_share + std::log(rows);
    candidates_.back().log_prior = log_share + log_born + more_log_prior;
  };
  const auto begins_at = [&](double first) {
    CandidateOnset& c = candidates_.back();
    c.first_hours = first;
    c.mean_hours = 0.5 * (first + c.last_hours);
    c.variance_hours = (c.last_hours - first) * (c.last_hours - first) / 12.0;
  };
  bear(ShiftProfile::step, std::log1p(-options_.ramp_share), std::min(1.0, hours * rows_per_hour_),
       0.0);
  // After a gap, the change may have occurred at any time in the gap.
  if (hours * rows_per_hour_ > kGap) begins_at(last_scored_hours_);
  // A candidate ramp stands for all rows since the last one.
  if (options_.ramp_share > 0.0 && rows_ - last_ramp_row_ >= options_.ramp_every) {
    const double rows = options_.ramp_every, since = row.hours - last_ramp_hours_;
    bear(ShiftProfile::ramp, std::log(options_.ramp_share), std::min(rows, since * rows_per_hour_),
         std::log(since / hours));
    if (hours * rows_per_hour_ > kGap) begins_at(last_ramp_hours_);
    last_ramp_hours_ = row.hours;
    last_ramp_row_ = rows_;
  }
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

double ChangePoint::score_draw(std::size_t m, const Row& row, const Weather& weather,
                               const CandidateBank::RowStart& start) {
  const BaselineParameters& parameters = draws_[m].parameters;
  BaselineFilter& filter = changed_[m];
  const auto p = static_cast<Index>(residual_sd_.size());
  bank_.begin(static_cast<int>(m), start);
  VectorXd covariance;
  double unshifted = 0.0;
  bool any = false;
  for (Index j = 0; j < p; ++j) {
    if (!std::isfinite(row.features[j])) continue;
    any = true;
    const int feature = static_cast<int>(j);
    filter.observe(feature, weather.h, covariance);
    const double noise = noise_variance(parameters, weather, row, filter, feature);
    const double s = filter.variance(feature, weather.h, covariance) + noise;
    const double v = row.features[j] - filter.mean(feature, weather.h);
    unshifted += log_innovation_density(v, s, parameters.degrees);
    double inflation = bank_.score(feature, v, s);
    if (inflation == 0.0) inflation = noise_inflation(v, s, parameters.degrees);
    const double inflated = s + noise * (inflation - 1.0);
    filter.update(covariance, v, inflated);
    bank_.update(inflated, covariance / inflated);
  }
  if (any) bank_.finish();
  return unshifted;
}

double ChangePoint::weigh_healthy(const std::vector<double>& log_density, double log_baseline) {
  double total = log_quiet_ + log_baseline;
  log_quiet_ = total;
  for (CandidateOnset& c : transients_) {
    c.log_ratio += log_density[index(c.slot)];
    total = log_sum(total, c.log_mass());
  }
  log_quiet_ -= total;
  for (CandidateOnset& c : transients_) c.log_ratio -= total;
  return total;
}

void ChangePoint::weigh_candidates(const std::vector<double>& log_density, double log_healthy) {
  for (CandidateOnset& c : candidates_) {
    const double gain = log_density[index(c.slot)] - log_healthy;
    c.log_ratio += gain;
    c.log_wealth += gain;
  }
}

void ChangePoint::merge(std::vector<CandidateOnset>& list, std::size_t from, std::size_t into) {
  CandidateOnset &a = list[from], &b = list[into];
  if (a.profile != ShiftProfile::transient)
    moved_ += std::exp(a.log_mass() - log_sum(log_no_change_, a.log_mass()));
  const double share = 1.0 / (1.0 + std::exp(b.log_mass() - a.log_mass()));  // of a
  const double apart = a.mean_hours - b.mean_hours;
  b.mean_hours += share * apart;
  b.variance_hours +=
      share * (a.variance_hours - b.variance_hours) + share * (1.0 - share) * apart * apart;
  b.log_prior = log_sum(b.log_mass(), a.log_mass()) - b.log_ratio;
  b.log_wealth = log_sum(b.log_wealth, a.log_wealth);
  b.first_hours = std::min(b.first_hours, a.first_hours);
  b.last_hours = std::max(b.last_hours, a.last_hours);
  bank_.release(a.slot);
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(from));
}

void ChangePoint::retire_transients(double hours) {
  constexpr double kDecayed = 5.0;  // in time constants
  std::erase_if(transients_, [&](const CandidateOnset& c) {
    if (hours - c.hours < kDecayed * kTransientHours) return false;
    log_quiet_ = log_sum(log_quiet_, c.log_mass());
    bank_.release(c.slot);
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
  std::array<std::vector<std::size_t>, kLastOctave + 1> octaves;
  const double unit = options_.young * (is_ramp ? 4.0 : 1.0);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].profile != profile) continue;
    const auto age = static_cast<double>(rows_ - list[i].row);
    if (age >= unit)
      octaves[index(std::min(kLastOctave, static_cast<int>(std::log2(age / unit))))].push_back(i);
  }
  for (const std::vector<std::size_t>& members : octaves) {
    if (static_cast<int>(members.size()) <= (is_ramp ? 2 : options_.kept_per_octave)) continue;
    // Merge the candidate with the smallest mass into its nearer neighbour.
    std::size_t lightest = 0;
    for (std::size_t k = 1; k < members.size(); ++k)
      if (list[members[k]].log_mass() < list[members[lightest]].log_mass()) lightest = k;
    std::size_t into = lightest == 0 ? 1 : lightest - 1;
    if (lightest > 0 && lightest + 1 < members.size()) {
      const auto gap = [&](std::size_t k) {
        return std::abs(list[members[k]].row - list[members[lightest]].row);
      };
      if (gap(lightest + 1) < gap(lightest - 1)) into = lightest + 1;
    }
    merge(list, members[lightest], members[into]);
    return true;
  }
  return false;
}

bool ChangePoint::knows_weather() const {
  double known = 0.0;
  for (std::size_t m = 0; m < draws_.size(); ++m)
    if (is_weather_known(draws_[m], residual_sd_))
      known += std::exp(log_weight_[static_cast<Index>(m)]);
  return known >= 0.5;
}

PredictedRow ChangePoint::add(const Row& measured) {
  const double hours = measured.hours - last_hours_;
  const CovariateScaling::Scaled scaled = scaling_(measured.covariates, last_covariates_);
  std::vector<Weather> weather;
  for (BaselineDraw& draw : draws_) weather.push_back(next_weather(scaled, hours, draw));
  Row row = measured;
  const bool is_scored = knows_weather() && measured.features.array().isFinite().any();
  if (!is_scored) row.features.setConstant(kNaN);
  // A row without data says nothing about a change: its onsets belong to the next scored row.
  if (is_scored) {
    bear_candidates(measured, measured.hours - last_scored_hours_);
    last_scored_hours_ = measured.hours;
  }
  PredictedRow out;
  const VectorXd own = score_healthy(row, hours, weather, out);
  out.is_scored = is_scored;

  std::vector<char> present;
  for (const double y : row.features) present.push_back(std::isfinite(y) ? 1 : 0);
  const auto slots = index(bank_.slots());
  std::vector<double> profile(slots, 0.0), log_mass(slots, detail::kExcluded);
  for (const std::vector<CandidateOnset>* list : {&candidates_, &transients_})
    for (const CandidateOnset& c : *list) {
      profile[index(c.slot)] = profile_at(c.profile, row.hours - c.hours);
      if (c.row != rows_) log_mass[index(c.slot)] = c.log_mass();
    }
  VectorXd unshifted(log_weight_.size());
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    const BaselineParameters& b = draws_[m].parameters;
    changed_[m].predict(b, hours);
    const CandidateBank::RowStart start{.h = weather[m].h,
                                        .fast = std::exp(-b.fast_rate * hours),
                                        .slow = std::exp(-hours / b.slow_hours),
                                        .degrees = b.degrees,
                                        .present = present,
                                        .profile = profile,
                                        .log_mass = log_mass};
    unshifted[static_cast<Index>(m)] = score_draw(m, row, weather[m], start);
  }
  if (row.features.array().isFinite().any()) {
    const std::vector<double> log_density = bank_.weigh(unshifted, options_.fixed_share);
    weigh_candidates(log_density, weigh_healthy(log_density, weigh_draws(own, unshifted)));
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
  for (const CandidateOnset& c : candidates())
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
  for (const CandidateOnset& c : candidates()) {
    const double mass = std::exp(c.log_mass() - sum);
    spread_onsets(c, mass, onsets);
    if (c.profile == ShiftProfile::ramp) out.ramp_probability += mass;
    const double share = profile_at(c.profile, last_hours_ - c.hours), share2 = share * share;
    for (const ShiftPosterior& d : c.draws)
      for (Index size = 0; size < kSizes; ++size) {
        const double all = mass * std::exp(d.log_weight(0, size));
        const auto cov = d.covariance.middleCols(size * p, p);
        out.shift += all * share * d.mean.col(size);
        squares.array() +=
            all * share2 * (d.mean.col(size).array().square() + cov.diagonal().array());
        out.shifted_probability.array() += all;
        for (Index j = 0; j < p; ++j) {
          const double alone = mass * std::exp(d.log_weight(1 + j, size));
          const double mean = d.single_mean(j, size);
          out.shift[j] += alone * share * mean;
          squares[j] += alone * share2 * (mean * mean + d.single_variance(j, size));
          out.shifted_probability[j] += alone;
        }
      }
  }
  // The shares of the candidates sum to 1 up to rounding.
  out.shifted_probability = out.shifted_probability.cwiseMin(1.0);
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
  if (candidates_.empty()) return;
  constexpr double kNegligible = 1e-9;
  const Index p = residual_sd_.size();
  double all = log_no_change_;
  for (const CandidateOnset& c : candidates_) all = log_sum(all, c.log_mass());
  VectorXd log_weight(log_weight_.size());
  for (std::size_t m = 0; m < draws_.size(); ++m) {
    BaselineFilter& filter = changed_[m];
    const Index states = filter.x.size();
    // Moments of the state's displacement (F + r E) δ over all hypotheses; zero without a change.
    double sum = std::exp(log_no_change_ - all + log_weight_[static_cast<Index>(m)]);
    VectorXd mean = VectorXd::Zero(states);
    MatrixXd square = MatrixXd::Zero(states, states);
    for (const CandidateOnset& c : candidates_) {
      const double mass = std::exp(c.log_mass() - all);
      if (mass < kNegligible) continue;
      const ShiftPosterior d = bank_.posterior(c.slot, static_cast<int>(m));
      const double profile = profile_at(c.profile, last_hours_ - c.hours);
      MatrixXd entry = d.sensitivity;
      for (Index j = 0; j < p; ++j) entry(j * draws_[m].parameters.block(), j) += profile;
      VectorXd shift = VectorXd::Zero(p);
      MatrixXd shift_square = MatrixXd::Zero(p, p);
      for (Index size = 0; size < kSizes; ++size) {
        const double joint = mass * std::exp(d.log_weight(0, size));
        sum += joint;
        shift += joint * d.mean.col(size);
        shift_square += joint * (d.covariance.middleCols(size * p, p) +
                                 d.mean.col(size) * d.mean.col(size).transpose());
        for (Index j = 0; j < p; ++j) {
          const double alone = mass * std::exp(d.log_weight(1 + j, size));
          const double value = d.single_mean(j, size);
          sum += alone;
          shift[j] += alone * value;
          shift_square(j, j) += alone * (value * value + d.single_variance(j, size));
        }
      }
      mean += entry * shift;
      square += entry * shift_square * entry.transpose();
    }
    log_weight[static_cast<Index>(m)] = std::log(sum);
    mean /= sum;
    filter.x += mean;
    filter.p += square / sum - mean * mean.transpose();
    filter.p = 0.5 * (filter.p + filter.p.transpose()).eval();
    draws_[m].filter = filter;
  }
  log_weight_ = log_weight.array() - log_sum_exp(log_weight);
  shared_.setConstant(0.5);
  for (const std::vector<CandidateOnset>* list : {&candidates_, &transients_})
    for (const CandidateOnset& c : *list) bank_.release(c.slot);
  candidates_.clear();
  transients_.clear();
  last_ramp_hours_ = last_hours_;
  last_ramp_row_ = rows_ - 1;
  log_quiet_ = 0.0;
  log_no_change_ = 0.0;
}

}  // namespace wheeltap::identification::monitoring
