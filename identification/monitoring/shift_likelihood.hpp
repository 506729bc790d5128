// The likelihood of a shift δ of all features, from the candidate onsets.
//
// A candidate holds the posterior p(δ | rows) = N(m, C) for the hypothesis "all features shift"
// with the prior N(0, P). The likelihood of any other hypothesis about δ is
//
//   L(δ) = p(rows | δ) / p(rows | no change) ∝ Σ_k w_k N(δ; m_k, C_k) / N(δ; 0, P)
//        = Σ_k exp(log_weight_k - ½ (δ - mean_k)ᵀ precision_k (δ - mean_k)),
//   precision = C⁻¹ - P⁻¹,   precision · mean = C⁻¹ m.
//
// The sums are over onsets, profiles and parameter draws, with posterior weights. The
// likelihood is exact for Gaussian noise. Components with negligible weights are omitted.
#pragma once

#include <vector>

#include "identification/monitoring/change_point.hpp"

namespace wheeltap::identification::monitoring {

struct ShiftLikelihood {
  struct Component {
    double log_weight = 0.0;
    Eigen::VectorXd mean = {};       ///< p
    Eigen::MatrixXd precision = {};  ///< p x p, positive semidefinite
  };
  std::vector<Component> components = {};  ///< sorted, largest weight first
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ShiftLikelihood::Component>
void carry(Parcel& parcel, Of& c) {
  parcel(c.log_weight, c.mean, c.precision);
}

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, ShiftLikelihood>
void carry(Parcel& parcel, Of& l) {
  parcel(l.components);
}

struct LikelihoodLimits {
  int components = 24;       ///< largest number of components
  double negligible = 1e-4;  ///< a component below this fraction of the largest weight is omitted
};

/// Computes the likelihood of the shift at the time `hours`: of a ramp, the share that is reached.
/// `residual_sd` is Baseline::residual_sd (p entries).
[[nodiscard]] ShiftLikelihood shift_likelihood(const std::vector<CandidateOnset>& candidates,
                                               double hours, const Eigen::VectorXd& residual_sd,
                                               const LikelihoodLimits& limits = {});

/// ln L(δ), up to a constant that does not depend on δ.
[[nodiscard]] double log_likelihood(const ShiftLikelihood& likelihood,
                                    const Eigen::VectorXd& shift);

}  // namespace wheeltap::identification::monitoring
