// Mode tracking: assignment of the identified modes of each record to tracked modes.
//
// For a tracked mode k, the predicted logarithm of its frequency is
//
//   m_kt = w_k(u_t) + a_kt,   a_kt a random walk (a local level),   w_k of the covariates, if any,
//
// The mode also has a reference shape and a probability D_k of being identified. An assignment σ
// maps each tracked mode to one identified mode or to none, without using an identified mode twice:
//
//   p(σ | record) ∝ Π_k [ D_k L_kσ(k)/λ  or  1 - D_k ],
//   L_kj = p(ln f_j | m_k) p(1 - MAC_kj).
//
// The density of spurious modes over ln f is λ. The density p(ln f) is Student's t about m_k with a
// share of a broad normal density, so that a mode shifted by several per cent by damage remains
// assigned. The density p(1 - MAC) is exponential, with a share of the uniform density that
// spurious modes have.
//
// The marginal probabilities of all pairs are exact sums over all assignments. A recursion over
// tracked modes and over sets of identified modes computes them (joint probabilistic data
// association; Fortmann, Bar-Shalom & Scheffe 1983).
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

struct IdentifiedMode {
  double frequency_hz = 0.0;
  double frequency_sd = 0.0;    ///< 0: unknown
  Eigen::VectorXcd shape = {};  ///< empty: unknown; NaN: entry not measured
  bool doubtful = false;
};

/// The modes of one record, in any order.
using IdentifiedRecord = std::vector<IdentifiedMode>;

/// MAC, |a^H b|²/(|a|² |b|²), over the entries measured in both shapes; 1 if a shape is empty.
[[nodiscard]] double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

struct TrackingOptions {
  double share = 0.5;      ///< least share of the training records that contain a tracked mode
  double broad_sd = 0.08;  ///< standard deviation of ln f in the broad normal density
  double broad_share = 0.05;
  double walk = 0.3;  ///< sd of the random-walk step of a_k, divided by TrackedMode::scatter
};

struct TrackedMode {
  double log_frequency = 0.0;  ///< median of ln f in the training records
  /// Sd of ln f about its prediction, without the sd of identification
  double scatter = 0.01;
  double discrepancy = 0.02;  ///< mean of 1 - MAC
  double detection = 0.9;     ///< D
  Eigen::VectorXcd shape = {};
};

/// The assignment of one record.
struct TrackedRecord {
  /// K: the most probable identified mode if its probability is at least one half, otherwise -1.
  std::vector<int> mode = {};
  Eigen::VectorXd probability = {};  ///< K: probability of this mode, or of "missing" for -1
  /// K x modes: marginal probabilities of all pairs. 1 minus the sum of a row is P("missing"); 1
  /// minus the sum of a column is P("spurious").
  Eigen::MatrixXd pairs = {};
};

class ModeTracker {
 public:
  /// Finds the modes to track and estimates their standard deviations, shapes and probabilities
  /// from `records` in order of time. `covariates`: n x c, or without columns. Throws
  /// std::invalid_argument if no mode is in the required share of the records.
  ModeTracker(const std::vector<IdentifiedRecord>& records, const Eigen::MatrixXd& covariates,
              const TrackingOptions& options = {});

  /// The tracked modes, ascending in frequency.
  [[nodiscard]] const std::vector<TrackedMode>& modes() const { return modes_; }

  /// Assigns all records in order of time, including the training records.
  [[nodiscard]] std::vector<TrackedRecord> track(const std::vector<IdentifiedRecord>& records,
                                                 const Eigen::MatrixXd& covariates) const;

 private:
  void find_modes(const std::vector<IdentifiedRecord>& records);
  void learn(const std::vector<IdentifiedRecord>& records, const Eigen::MatrixXd& covariates);
  /// w_k(u_t) of all rows, n x K, from a regression on the training records; zero without
  /// covariates.
  [[nodiscard]] Eigen::MatrixXd weather_effect(const Eigen::MatrixXd& covariates) const;

  TrackingOptions options_;
  std::vector<TrackedMode> modes_;
  double spurious_ = 1.0;                ///< λ, modes per unit of ln f
  Eigen::MatrixXd learned_covariates_;   ///< n x c
  Eigen::MatrixXd learned_frequencies_;  ///< n x K: ln f, NaN: missing
};

/// Marginal probabilities of pairs, K x M. `ratio`: L_kj/λ; `detection`: D, K.
[[nodiscard]] Eigen::MatrixXd pair_probabilities(const Eigen::MatrixXd& ratio,
                                                 const Eigen::VectorXd& detection);

}  // namespace wheeltap::identification::monitoring
