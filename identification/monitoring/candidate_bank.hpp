// The posteriors of the shift δ for all candidate onsets (change_point.hpp), stored in SIMD layout.
//
// The gain k_i of entry i of a row is common to all candidates, so that the innovation of entry j
// changes with δ by
//
//   g_j = r e_j + F_j' h - Σ_{i<j} (k_i' h)_j g_i,
//
// F_j: rows of feature j in F, the sensitivity of the state to δ; r: time profile of the
// shift; e_j: unit vector; i: entries before j. F is updated after the row's last entry.
#pragma once

#include <concepts>
#include <span>
#include <type_traits>
#include <vector>

#include "base/eigen.hpp"
#include "identification/monitoring/kernels/candidate_kernel.hpp"

namespace wheeltap::identification::monitoring {

using detail::kSizes;

/// Posterior of δ under one candidate and one parameter draw.
struct ShiftPosterior {
  Eigen::MatrixXd sensitivity;                   ///< F: states x p
  Eigen::MatrixXd mean;                          ///< p x kSizes, all features shift
  Eigen::MatrixXd covariance;                    ///< p x (p kSizes)
  Eigen::MatrixXd single_mean, single_variance;  ///< p x kSizes: feature j alone shifts
  /// (1 + p) x kSizes: ln of the joint posterior of draw and hypothesis, given the onset; row 0:
  /// all features shift; row 1 + j: feature j alone.
  Eigen::MatrixXd log_weight;
};

class CandidateBank {
 public:
  CandidateBank() = default;
  /// `blocks`: BaselineParameters::block() of each draw; `prior_variance`: of δ, p x kSizes.
  CandidateBank(const std::vector<int>& blocks, const Eigen::MatrixXd& prior_variance);

  /// Adds a candidate without rows. `weight`: (1 + p) x kSizes, prior probabilities of the
  /// hypotheses; `draws`: probability of each draw. Returns the candidate's slot.
  int add(const Eigen::MatrixXd& weight, const Eigen::VectorXd& draws);
  void release(int slot);
  [[nodiscard]] ShiftPosterior posterior(int slot, int draw) const;
  /// Number of slots, used and free.
  [[nodiscard]] int slots() const { return static_cast<int>(used_.size()); }

  // Calls for one row: for each draw, begin, then score and update for each present entry, then
  // finish. After all draws, weigh.

  struct RowStart {
    const Eigen::VectorXd& h;          ///< observation vector of every feature
    double fast, slow;                 ///< decays of both drifts since the previous row
    double degrees;                    ///< of Student's t; kGaussian
    const std::vector<char>& present;  ///< p
    std::span<const double> profile;   ///< r(t - τ) of each slot
    std::span<const double> log_mass;  ///< ln of the mass of each slot; kExcluded: not counted
  };
  void begin(int draw, const RowStart& row);
  /// Adds the densities of an entry of feature j. Without a shift, its innovation is v with
  /// variance s. Returns the common noise inflation: the mean inflation of the candidates'
  /// most probable hypotheses, weighted by the candidates' masses. Returns 0 if no candidate
  /// counts.
  double score(int j, double v, double s);
  /// Conditions every δ on the entry that was scored last; `gain`: gain of the state.
  void update(double inflated, const Eigen::VectorXd& gain);
  void finish();
  /// Adds the row's densities to the weights of draws and hypotheses. `unshifted`: per draw, ln of
  /// the density of the row without a shift. `share`: part of the weight that is redistributed
  /// evenly between draws. Returns ln of the row's density under each slot's candidate.
  [[nodiscard]] std::vector<double> weigh(const Eigen::VectorXd& unshifted, double share);

 private:
  [[nodiscard]] detail::CandidateTiles tiles(int draw);
  [[nodiscard]] detail::CandidateLayout layout(int draw) const {
    return {.features = static_cast<int>(prior_variance_.rows()),
            .block = blocks_[static_cast<std::size_t>(draw)]};
  }
  /// Index of row `row` in the tile of a slot.
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

  // Values that belong to the current row:
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
