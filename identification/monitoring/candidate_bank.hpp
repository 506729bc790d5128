// The posteriors of the shift δ for all candidate onsets (change_point.hpp), stored in SIMD layout.
//
// The gain k_i of entry i of a row is common to all candidates. The change of the innovation of
// entry j per unit of δ is therefore
//
//   g_j = r e_j + F_j' h - Σ_{i<j} (k_i' h)_j g_i,
//
// F_j: rows of feature j in F, the sensitivity of the state to δ; r: time profile of the shift;
// e_j: unit vector; i: entries before j. F is updated after the last entry of a row.
#pragma once

#include <concepts>
#include <span>
#include <type_traits>
#include <vector>

#include "base/eigen.hpp"
#include "identification/monitoring/kernels/candidate_kernel.hpp"

namespace wheeltap::identification::monitoring {

using detail::kSizes;

/// Posterior of the shift δ, given one candidate onset and one parameter draw.
struct ShiftPosterior {
  Eigen::MatrixXd sensitivity;                   ///< F: states x p
  Eigen::MatrixXd mean;                          ///< if all features shift (p x kSizes)
  Eigen::MatrixXd covariance;                    ///< p x (p kSizes)
  Eigen::MatrixXd single_mean, single_variance;  ///< if feature j alone shifts (p x kSizes)
  /// ln of the joint posterior of draw and hypothesis, given the onset: (1 + p) x kSizes; row 0:
  /// all features shift; row 1 + j: feature j alone.
  Eigen::MatrixXd log_weight;
};

class CandidateBank {
 public:
  CandidateBank() = default;
  /// `blocks` holds BaselineParameters::block() of each draw, and `prior_variance` the prior
  /// variances of δ (p x kSizes).
  CandidateBank(const std::vector<int>& blocks, const Eigen::MatrixXd& prior_variance);

  /// Adds a candidate that has no rows yet, and returns its slot. `weight` holds the prior
  /// probabilities of the hypotheses, (1 + p) x kSizes, and `draws` the prior probabilities of the
  /// draws.
  int add(const Eigen::MatrixXd& weight, const Eigen::VectorXd& draws);
  void release(int slot);
  [[nodiscard]] ShiftPosterior posterior(int slot, int draw) const;
  /// Total number of slots, used and free.
  [[nodiscard]] int slots() const { return static_cast<int>(used_.size()); }

  // Order of the calls for one row: for each draw, call begin, then call score and update for each
  // present entry, then call finish. After all draws, call weigh.

  struct RowStart {
    const Eigen::VectorXd& h;          ///< observation vector of every feature
    double fast, slow;                 ///< decays of both drifts since the previous row
    double degrees;                    ///< degrees of freedom of Student's t, or kGaussian
    const std::vector<char>& present;  ///< p
    std::span<const double> profile;   ///< r(t - τ) of each slot
    std::span<const double> log_mass;  ///< ln of each slot's posterior mass; kExcluded: not used
  };
  void begin(int draw, const RowStart& row);
  /// Adds the densities of an entry of feature j, whose innovation without a shift is v with
  /// variance s. Returns the common noise inflation: the mean inflation of the candidates' most
  /// probable hypotheses, weighted by the candidates' masses. Returns 0 if all candidates are
  /// excluded.
  double score(int j, double v, double s);
  /// Conditions every δ on the entry of the last call of `score`; `gain` is the Kalman gain of the
  /// state.
  void update(double inflated, const Eigen::VectorXd& gain);
  void finish();
  /// Multiplies the weights of draws and hypotheses by the row's densities. `unshifted` has, per
  /// draw, ln of the row's density without a shift; the fraction `share` of the weight is
  /// redistributed evenly between the draws. Returns, for each slot, ln of the density of the row
  /// under the candidate in this slot.
  [[nodiscard]] std::vector<double> weigh(const Eigen::VectorXd& unshifted, double share);

 private:
  [[nodiscard]] detail::CandidateTiles tiles(int draw);
  [[nodiscard]] detail::CandidateLayout layout(int draw) const {
    return {.features = static_cast<int>(prior_variance_.rows()),
            .block = blocks_[static_cast<std::size_t>(draw)]};
  }
  /// Position of row `row` in the tile of a slot.
  [[nodiscard]] static std::size_t place(int slot, int rows, int row) {
    return (static_cast<std::size_t>(slot / detail::kTile) * static_cast<std::size_t>(rows) +
            static_cast<std::size_t>(row)) *
               detail::kTile +
           static_cast<std::size_t>(slot % detail::kTile);
  }
  void clear(int slot);

  std::vector<int> blocks_;
  Eigen::MatrixXd prior_variance_;
  std::vector<char> used_;
  std::vector<std::vector<double>> state_;  ///< per draw: tiles

  // Values of the current row:
  std::vector<std::vector<double>> scratch_;
  int draw_ = 0, entries_ = 0, feature_ = 0;
  double degrees_ = 0.0, v_ = 0.0, s_ = 0.0;
  Eigen::VectorXd h_;
  std::vector<double> gains_, along_, inverse_prior_;

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, CandidateBank>
  friend void carry(Parcel& parcel, Of& bank) {
    parcel(bank.blocks_, bank.prior_variance_, bank.used_, bank.state_);
  }
};

}  // namespace wheeltap::identification::monitoring
