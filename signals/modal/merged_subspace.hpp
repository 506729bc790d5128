// Merges the covariances of several set-ups into those of one set-up with all sensors, before
// identification.
//
// Set-ups s share reference sensors, but not the excitation. Their block Hankel matrices
//   H_s = (O_ref; O_s) Z_s   (rows of the references; of the moved sensors)
// have the observability matrix of one structure and different Z_s (PreGER: Döhler, Reynders,
// Magalhães, Mevel, De Roeck & Cunha 2011, Identification of bridge modal parameters; Mevel,
// Basseville, Benveniste & Goursat 2002, Mech. Syst. Signal Process. 16:319). With (H_1,ref H_2,ref
// …) = U S Vᵀ truncated to rank n and B = U_n fixed,
//   Z_s = Bᵀ H_s,ref,   O_ref = (Σ H_s,ref Z_sᵀ) (Σ Z_s Z_sᵀ)⁻¹,   O_s = H_s,mov Z_sᵀ (Z_s Z_sᵀ)⁻¹,
// and H = (O_ref; O_1; …) (Z_1 Z_2 …)/√N is the Hankel matrix of one set-up with all sensors,
// reduced to the column space V_n. Set-ups are independent. The effect of each data block on H
// follows from the derivative for constant B, since B only selects a basis.
#pragma once

#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

/// The covariances of one set-up; all set-ups have the references in the same order.
struct SetUpCovariances {
  OutputCovariances covariances;
  std::vector<int> sensors = {};  ///< sensor of each channel, among all sensors
};

/// `sensors`: total number of sensors. If a sensor that is not a reference occurs in several
/// set-ups, the first set-up is used. `columns` is q; `rank` n. Throws std::invalid_argument for a
/// rank above the rows or columns of the references.
[[nodiscard]] HankelFactor merge_covariances(const std::vector<SetUpCovariances>& set_ups,
                                             int sensors, int columns, int rank);

}  // namespace wheeltap::signals
