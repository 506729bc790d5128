// Covariances of several set-ups as those of one that has all sensors: merging before
// identification.
//
// Set-ups s share reference sensors, but not the excitation: their block Hankel matrices
//   H_s = (O_ref; O_s) Z_s   (rows of the references; of the moved sensors)
// have the observability matrix of one structure, and Z_s of their own (PreGER: Döhler, Reynders,
// Magalhães, Mevel, De Roeck & Cunha 2011, Identification of bridge modal parameters; Mevel,
// Basseville, Benveniste & Goursat 2002, Mech. Syst. Signal Process. 16:319). With
// (H_1,ref H_2,ref …) = U S Vᵀ cut to rank n and B = U_n fixed,
//   Z_s = Bᵀ H_s,ref,   O_ref = (Σ H_s,ref Z_sᵀ) (Σ Z_s Z_sᵀ)⁻¹,   O_s = H_s,mov Z_sᵀ (Z_s Z_sᵀ)⁻¹,
// and H = (O_ref; O_1; …) (Z_1 Z_2 …)/√N stands for the Hankel matrix of one set-up with all
// sensors; of its columns those of V_n are all it has. Set-ups are independent: each block of each
// moves H by the derivative of that with B held, which is a choice of basis.
#pragma once

#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

/// One set-up's covariances, with references in one order in all of them.
struct SetUpCovariances {
  OutputCovariances covariances;
  std::vector<int> sensors = {};  ///< of all, by channel
};

/// `sensors`: how many there are in all. A sensor that several set-ups have without being a
/// reference is taken from the first of them. `columns` is q; `rank` n. Throws
/// std::invalid_argument for a rank beyond what the references' rows and columns hold.
[[nodiscard]] HankelFactor merge_covariances(const std::vector<SetUpCovariances>& set_ups,
                                             int sensors, int columns, int rank);

}  // namespace wheeltap::signals
