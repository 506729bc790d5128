// A series of features and covariates, one row a time.
#pragma once

#include <string>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

/// n rows of p features and c covariates. NaN marks a missing entry.
struct Series {
  std::vector<double> hours = {};  ///< n, strictly increasing
  Eigen::MatrixXd features = {};   ///< n x p: natural logarithms of positive features
  /// n x p: standard deviations of the logarithms, or empty where identification states none.
  Eigen::MatrixXd sds = {};
  Eigen::MatrixXd covariates = {};  ///< n x c
  std::vector<std::string> feature_names = {}, covariate_names = {};

  [[nodiscard]] int rows() const { return static_cast<int>(hours.size()); }
  [[nodiscard]] int feature_count() const { return static_cast<int>(features.cols()); }
  [[nodiscard]] int covariate_count() const { return static_cast<int>(covariates.cols()); }
  [[nodiscard]] Series first(int rows) const;
};

/// One row, as the filters take it.
struct Row {
  double hours = 0.0;
  Eigen::VectorXd features = {};  ///< p logarithms, NaN: missing
  /// p: noise variance of this row relative to a usual one; 1 where no sd is stated.
  Eigen::VectorXd relative_variance = {};
  Eigen::VectorXd covariates = {};  ///< c, NaN: missing
};

/// A fault of a series and its place.
struct SeriesFault {
  enum class Kind {
    time_repeated,
    time_decreasing,
    no_learning_rows,    ///< fewer than kFewestLearningRows before the end of learning
    feature_missing,     ///< `column`: fewer than kFewestLearningRows values in learning
    feature_constant,    ///< `column`: it does not vary in learning
    covariate_missing,   ///< `column`: no value in learning
    covariate_constant,  ///< `column`: it does not vary in learning
    sd_not_positive      ///< `column`
  };
  Kind kind;
  int row = -1;
  int column = -1;
};

inline constexpr int kFewestLearningRows = 20;

/// The faults of a series whose first `learning` rows are known to be healthy. A constant covariate
/// is a fault that a caller may take as a warning; the baseline leaves that covariate out.
[[nodiscard]] std::vector<SeriesFault> find_faults(const Series& series, int learning);

/// Row i; sds are relative to `usual_sds` (p), the medians in learning, or none.
[[nodiscard]] Row row_of(const Series& series, int i, const Eigen::VectorXd& usual_sds);

/// Median sd of each feature over the first `learning` rows; empty where none are stated.
[[nodiscard]] Eigen::VectorXd usual_sds(const Series& series, int learning);

}  // namespace wheeltap::identification::monitoring
