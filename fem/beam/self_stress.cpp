#include "fem/beam/self_stress.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "fem/beam/assembly.hpp"

namespace wheeltap::fem {
namespace {

using Extended = long double;
using Vector = Eigen::Matrix<Extended, Eigen::Dynamic, 1>;

/// Effect of a unit reaction at one restrained motion, on the beam clamped at its right end.
struct Reaction {
  Vector stresses;         // elements, then springs
  Extended force, moment;  // residual at the right end, in units of the shear and bending stresses
  Extended size;           // magnitude of all contributions to force and moment
};

}  // namespace

Eigen::MatrixXd self_stresses(const Beam& beam) {
  const TimoshenkoElement<Extended> element(beam);
  struct Hold {
    MotionRow<Extended> row;
    Extended stiffness;  // infinite for a rigid restraint
  };
  std::vector<Hold> holds;
  Eigen::Index springs = 0;
  for (const Support& s : beam.supports)
    for (const bool rotation : {false, true})
      if (rotation ? s.rotation : s.deflection) {
        holds.push_back({motion_row(beam, element, s.at, rotation),
                         s.stiffness ? static_cast<Extended>(*s.stiffness)
                                     : std::numeric_limits<Extended>::infinity()});
        springs += s.stiffness.has_value();
      }

  const Eigen::Index elements = beam.elements;
  const Extended bending = element.bending()[3], shear = element.shear()[0],
                 turn = element.shear()[1];
  std::vector<Reaction> reactions;
  Eigen::Index spring = 0;
  for (const Hold& hold : holds) {
    Reaction r{
        .stresses = Vector::Zero(2 * elements + springs), .force = 0, .moment = 0, .size = 0};
    Vector load = Vector::Zero(2 * beam.nodes());
    for (int i = 0; i < 4; ++i)
      if (hold.row.coefficients[i] != 0) load[hold.row.first_dof + i] = hold.row.coefficients[i];
    // Solves Bᵀ t + load = 0 by nodes; b = bending (0, -1, 0, 1), a = (shear, turn, -shear, turn).
    Extended shear_before = 0, bending_before = 0;
    for (Eigen::Index node = 0; node <= elements; ++node) {
      const Extended here = shear_before - load[2 * node] / shear;
      if (node == elements) {
        r.force = here;
        r.moment = bending_before + (turn * shear_before + load[2 * node + 1]) / bending;
        break;
      }
      bending_before += (turn * (here + shear_before) + load[2 * node + 1]) / bending;
      r.stresses[2 * node] = bending_before;
      r.stresses[2 * node + 1] = here;
      shear_before = here;
    }
    if (std::isfinite(hold.stiffness))
      r.stresses[2 * elements + spring++] = 1 / std::sqrt(hold.stiffness);
    r.size = r.stresses.norm() + std::abs(r.force) + std::abs(r.moment);
    reactions.push_back(std::move(r));
  }
  constexpr Extended kDependent = 1e-10L;  // limit of rounding errors, relative to `size`

  // Combines reactions to states in equilibrium: force and moment eliminate one reaction each.
  for (Extended Reaction::*const left : {&Reaction::force, &Reaction::moment}) {
    std::size_t pivot = reactions.size();
    Extended largest = kDependent;
    for (std::size_t i = 0; i < reactions.size(); ++i) {
      const Extended share = std::abs(reactions[i].*left) / reactions[i].size;
      if (share > largest) largest = share, pivot = i;
    }
    if (pivot == reactions.size()) continue;
    const Reaction taken = reactions[pivot];
    reactions.erase(reactions.begin() + static_cast<std::ptrdiff_t>(pivot));
    for (Reaction& r : reactions) {
      const Extended share = r.*left / taken.*left;
      r.stresses -= share * taken.stresses;
      r.force -= share * taken.force;
      r.moment -= share * taken.moment;
      r.size += std::abs(share) * taken.size;
      r.*left = 0;
    }
  }

  // Orthonormalises twice. A column that depends on the others (a motion restrained twice) carries
  // no stress.
  std::vector<Vector> basis;
  for (Reaction& r : reactions) {
    for (int pass = 0; pass < 2; ++pass)
      for (const Vector& q : basis) r.stresses -= q.dot(r.stresses) * q;
    const Extended left = r.stresses.norm();
    if (left > kDependent * r.size) basis.push_back(r.stresses / left);
  }
  Eigen::MatrixXd result(2 * elements, static_cast<Eigen::Index>(basis.size()));
  for (Eigen::Index k = 0; k < result.cols(); ++k)
    for (Eigen::Index i = 0; i < result.rows(); ++i)
      result(i, k) = static_cast<double>(basis[static_cast<std::size_t>(k)][i]);
  return result;
}

}  // namespace wheeltap::fem
