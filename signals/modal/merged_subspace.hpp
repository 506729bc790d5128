// Merging of the covariances of several set-ups before identification: the result corresponds to
// the covariances of one set-up with all sensors.
//
// The set-ups s have common reference sensors, but different excitations. The block Hankel matrices
// of the set-ups,
//   H_s = (O_ref; O_s) Z_s   (rows of the references; rows of the moved sensors)
// contain rows of one observability matrix, that of the structure. The factors Z_s differ (PreGER:
// Döhler, Reynders, Magalhães, Mevel, De Roeck & Cunha 2011, Identification of bridge modal
// parameters; Mevel, Basseville, Benveniste & Goursat 2002, Mech. Syst. Signal Process. 16:319).
// With (H_1,ref H_2,ref …) = U S Vᵀ truncated to rank n and B = U_n fixed,
//   Z_s = Bᵀ H_s,ref,   O_ref = (Σ H_s,ref Z_sᵀ) (Σ Z_s Z_sᵀ)⁻¹,   O_s = H_s,mov Z_sᵀ (Z_s Z_sᵀ)⁻¹,
// and H = (O_ref; O_1; …) (Z_1 Z_2 …)/√N is the Hankel matrix of one set-up with all sensors,
// reduced to the column space V_n. The set-ups are statistically independent. The change of H due
// to each data block follows from the derivative of H for constant B. B may be held constant,
// because B only selects a basis.
#pragma once

#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

/// The covariances of one set-up. All set-ups must have the references in the same order.
struct SetUpCovariances {
  OutputCovariances covariances;
  std::vector<int> sensors = {};  ///< sensor of each channel, among all sensors
};

/// Merges the covariances of several set-ups. `sensors` is the number of sensors of all set-ups
/// together. If a sensor that is not a reference occurs in several set-ups, the function uses the
/// data of the first of these set-ups. `columns` is the number q of block columns of the Hankel
/// matrix, and `rank` is n. Throws std::invalid_argument if n exceeds the number of rows or columns
/// of H_s,ref.
[[nodiscard]] HankelFactor merge_covariances(const std::vector<SetUpCovariances>& set_ups,
                                             int sensors, int columns, int rank);

}  // namespace wheeltap::signals
