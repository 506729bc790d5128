// A time series of features and covariates, with one row per time.
#pragma once

#include <string>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

/// n rows of p features and c covariates. NaN marks a missing entry.
struct Series {
  std::vector<double> hours = {};  ///< n, strictly increasing
  Eigen::MatrixXd features = {};   ///< natural logarithms of positive features (n x p)
  /// Standard deviations of the logarithms (n x p); empty if no sds are known.
  Eigen::MatrixXd sds = {};
  Eigen::MatrixXd covariates = {};  ///< n x c
  std::vector<std::string> feature_names = {}, covariate_names = {};

  [[nodiscard]] int rows() const { return static_cast<int>(hours.size()); }
  [[nodiscard]] int feature_count() const { return static_cast<int>(features.cols()); }
  [[nodiscard]] int covariate_count() const { return static_cast<int>(covariates.cols()); }
  [[nodiscard]] Series first(int rows) const;
};

inline constexpr double kLargestRelativeVariance = 1e8;

/// One row of a series, as input of the filters.
struct Row {
  double hours = 0.0;
  Eigen::VectorXd features = {};  ///< p logarithms; NaN: missing
  /// Noise variances of this row divided by the usual noise variances (p entries); 1 if no sd is
  /// stated. Limited to kLargestRelativeVariance, because a very large sd is a code for an unknown
  /// sd.
  Eigen::VectorXd relative_variance = {};
  Eigen::VectorXd covariates = {};  ///< values of the c covariates; NaN: missing
};

/// A fault of a series and its location.
struct SeriesFault {
  enum class Kind {
    time_repeated,
    time_decreasing,
    no_learning_rows,    ///< fewer than kFewestLearningRows rows in the training period
    feature_missing,     ///< `column`: fewer than kFewestLearningRows values in the training period
    feature_constant,    ///< `column`: constant in the training period
    covariate_missing,   ///< `column`: no value in the training period
    covariate_constant,  ///< `column`: constant in the training period
    sd_not_positive      ///< `column`
  };
  Kind kind;
  int row = -1;
  int column = -1;
};

inline constexpr int kFewestLearningRows = 20;

/// The faults of a series whose first `learning` rows are known to be healthy. A caller may treat a
/// constant covariate as a warning only, because the baseline does not use it.
[[nodiscard]] std::vector<SeriesFault> find_faults(const Series& series, int learning);

/// Returns row i, with the noise variances divided by the squares of the medians `usual_sds`. If
/// `usual_sds` is empty, all relative variances are 1.
[[nodiscard]] Row row_of(const Series& series, int i, const Eigen::VectorXd& usual_sds);

/// Median time step between consecutive rows.
[[nodiscard]] double median_step(const std::vector<double>& hours);

/// Median sd of each feature over the first `learning` rows; empty if the series states no sds.
[[nodiscard]] Eigen::VectorXd usual_sds(const Series& series, int learning);

}  // namespace wheeltap::identification::monitoring
