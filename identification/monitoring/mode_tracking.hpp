// Mode tracking: assignment of the identified modes of each record to tracked modes.
//
// The predicted logarithm of the frequency of tracked mode k in row t is
//
//   m_kt = w_k(u_t) + a_kt, a_kt: random walk (local level), w_k: effect of covariates,
//
// The mode also has a reference shape and a probability D_k of being identified. An assignment σ
// maps each tracked mode to a different identified mode, or to none:
//
//   p(σ | record) ∝ Π_k [ D_k L_kσ(k)/λ  or  1 - D_k ],
//   L_kj = p(ln f_j | m_k) p(1 - MAC_kj).
//
// The density of spurious modes over ln f is λ. The density p(ln f) is a mixture of Student's t
// about m_k and a broad normal density. A mode therefore remains assigned after damage has shifted
// its frequency by several per cent. The density p(1 - MAC) is exponential, mixed with the uniform
// density of spurious modes.
//
// The marginal probabilities of all pairs (tracked mode, identified mode) are exact sums over
// assignments. A recursion over tracked modes and over sets of identified modes computes these sums
// (joint probabilistic data association; Fortmann, Bar-Shalom & Scheffe 1983).
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

struct IdentifiedMode {
  double frequency_hz = 0.0;
  double frequency_sd = 0.0;    ///< 0 if unknown
  Eigen::VectorXcd shape = {};  ///< empty if unknown; NaN for an entry that was not measured
  bool doubtful = false;
};

/// The modes of one record, in any order.
using IdentifiedRecord = std::vector<IdentifiedMode>;

/// MAC |a^H b|²/(|a|² |b|²) over the entries measured in both shapes; 1 if a shape is empty.
[[nodiscard]] double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

struct TrackingOptions {
  double share = 0.5;      ///< smallest fraction of training records with a tracked mode
  double broad_sd = 0.08;  ///< standard deviation of ln f in the broad normal density
  double broad_share = 0.05;
  double walk = 0.3;  ///< sd of the random-walk step of a_k, divided by TrackedMode::scatter
};

struct TrackedMode {
  double log_frequency = 0.0;  ///< median of ln f in the training records
  /// Standard deviation of ln f about its prediction, without the contribution of the
  /// identification error
  double scatter = 0.01;
  double discrepancy = 0.02;  ///< mean of 1 - MAC in training
  double detection = 0.9;     ///< D
  Eigen::VectorXcd shape = {};
};

/// The assignment of one record's identified modes to tracked modes.
struct TrackedRecord {
  /// The most probable identified mode for each of K tracked modes; -1: probability below one half.
  std::vector<int> mode = {};
  Eigen::VectorXd probability = {};  ///< probability of each entry of `mode` (-1: of no match)
  /// Marginal probabilities of all pairs (K x modes). P(missing) is 1 minus the sum of a row;
  /// P(spurious) is 1 minus the sum of a column.
  Eigen::MatrixXd pairs = {};
};

class ModeTracker {
 public:
  /// Finds the modes to track and estimates their scatter, shapes and detection probabilities D
  /// from `records` in order of time. `covariates` is n x c; c may be 0. Throws
  /// std::invalid_argument if no mode is in the required fraction of records.
  ModeTracker(const std::vector<IdentifiedRecord>& records, const Eigen::MatrixXd& covariates,
              const TrackingOptions& options = {});

  /// The tracked modes, in ascending order of frequency.
  [[nodiscard]] const std::vector<TrackedMode>& modes() const { return modes_; }

  /// Assigns the modes of all records, including the training records, to the tracked modes. The
  /// records are processed in order of time. Throws std::invalid_argument for a record with more
  /// than 60 modes.
  [[nodiscard]] std::vector<TrackedRecord> track(const std::vector<IdentifiedRecord>& records,
                                                 const Eigen::MatrixXd& covariates) const;

 private:
  void find_modes(const std::vector<IdentifiedRecord>& records);
  void learn(const std::vector<IdentifiedRecord>& records, const Eigen::MatrixXd& covariates);
  /// Effects w_k(u_t) of the covariates in all rows, n x K, from a regression over the training
  /// records; zero without covariates.
  [[nodiscard]] Eigen::MatrixXd weather_effect(const Eigen::MatrixXd& covariates) const;

  TrackingOptions options_;
  std::vector<TrackedMode> modes_;
  double spurious_ = 1.0;                ///< λ: spurious modes per unit of ln f
  Eigen::MatrixXd learned_covariates_;   ///< n x c
  Eigen::MatrixXd learned_frequencies_;  ///< ln f (n x K); NaN: missing
};

/// Marginal probabilities of pairs, K x M. `ratio` is L_kj/λ; `detection` has the K entries D_k.
[[nodiscard]] Eigen::MatrixXd pair_probabilities(const Eigen::MatrixXd& ratio,
                                                 const Eigen::VectorXd& detection);

}  // namespace wheeltap::identification::monitoring
