// The steps of the baseline's training that do not depend on how parameters are sampled: prepared
// rows, terms of the covariates, evidence, and the parameters of one draw.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "identification/monitoring/baseline_learning.hpp"
#include "identification/monitoring/marginal_likelihood.hpp"

namespace wheeltap::identification::monitoring::training {

/// Training rows, prepared for the sampling.
struct TrainingRows {
  std::vector<double> hours = {};
  std::vector<CovariateScaling::Scaled> scaled = {};
  Eigen::MatrixXd z = {};  ///< the values in `scaled` (covariates x rows)
  std::vector<FeatureRows> features = {};
  Eigen::VectorXd long_low = {}, long_high = {};  ///< range of the covariates with the long lag
  Eigen::MatrixXd sorted = {};        ///< sorted columns for quantiles (rows x covariates)
  std::vector<int> hinged = {};       ///< covariates that may have hinges
  std::vector<double> variance = {};  ///< one entry per feature
  /// Prior sd of the slopes of each feature, divided by its noise sd
  std::vector<double> slope_scale = {};
  std::vector<double> noise_scale = {};       ///< scale of the prior of σ² of each feature
  std::optional<EvidenceData> evidence = {};  ///< data of `features` with weights
  double slow_hours = kSlowHours;             ///< time constant of the slow drift
  bool lag = false;
  int most_hinges = 0;
  TrainingRows() = default;
  TrainingRows(const TrainingRows&) = delete;  // because `evidence` points to the rows
  TrainingRows& operator=(const TrainingRows&) = delete;
};

/// Positions in the sampled parameter vector. The vector contains, in this order: the lag (if any),
/// the rate of the fast drift, the slow ratio, the fast ratio of each feature, and one number per
/// hinge (covariate index plus a fraction for the knot).
struct Layout {
  bool lag;
  std::size_t features;
  double slow_hours = kSlowHours;
  [[nodiscard]] std::size_t rate() const { return lag ? 1 : 0; }
  [[nodiscard]] std::size_t slow() const { return rate() + 1; }
  [[nodiscard]] std::size_t fast(std::size_t j) const { return slow() + 1 + j; }
  [[nodiscard]] std::size_t hinge(std::size_t h) const { return slow() + 1 + features + h; }
};

/// Prepares the rows with robust weights, and writes the medians to `out.reference`.
[[nodiscard]] std::unique_ptr<TrainingRows> prepare(const Series& series,
                                                    const LearningOptions& options, Baseline& out);

/// Returns the lag, hinges and knots for the parameter vector x.
[[nodiscard]] CovariateTerms terms_of(const TrainingRows& of, const Layout& layout,
                                      std::span<const double> x);

/// phi of all rows, one column per row, without the terms for weather outside the training period.
/// Writes the range of the lagged covariates to `terms`.
[[nodiscard]] Eigen::MatrixXd term_table(const TrainingRows& of, CovariateTerms& terms);

[[nodiscard]] ProcessRatios ratios_of(const Layout& layout, std::span<const double> x,
                                      std::size_t feature);

/// The posteriors of the coefficients and noise variance of each feature, given the parameters x.
[[nodiscard]] std::vector<MarginalLikelihood> fits_of(const TrainingRows& of, const Layout& layout,
                                                      const Eigen::MatrixXd& table,
                                                      std::span<const double> x);

/// ln p(rows | x), summed over the features.
[[nodiscard]] double log_evidence(const TrainingRows& of, const Layout& layout,
                                  std::span<const double> x);

/// Correlation matrix of the drift, estimated from that of the one-step innovations. An innovation
/// contains only the change of the drift since the previous row. Each correlation is therefore
/// divided by the correlation that innovations of fully correlated drifts would have
/// (innovation_correlation).
[[nodiscard]] Eigen::MatrixXd drift_correlation(const TrainingRows& of,
                                                const Eigen::MatrixXd& table, const Layout& layout,
                                                std::span<const double> x);

/// Correlation of the innovations of two features with fully correlated fast drifts, in the steady
/// state of their separate filters, for rows `step` hours apart. The covariance of the two filters'
/// errors follows P' = (I - k_1 h')(A P A' + Q)(I - k_2 h')', with h = (1, 1).
[[nodiscard]] double innovation_correlation(const ProcessRatios& a, const ProcessRatios& b,
                                            double step);

/// Parameters of one draw, with noise variances drawn from their inverse gamma posteriors.
[[nodiscard]] BaselineParameters parameters_of(const TrainingRows& of, const Layout& layout,
                                               std::span<const double> x,
                                               const Eigen::VectorXd& reference,
                                               base::Random& random);

/// Runs the full filter from its prior through all training rows; returns the log evidence.
double run_through(const TrainingRows& of, const std::vector<Row>& rows, BaselineDraw& draw);

}  // namespace wheeltap::identification::monitoring::training
