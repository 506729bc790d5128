// The list of force laws. To add a law, write one file in laws/ and add two lines here, the include
// and the name in `LawList`; add its test to tests/dynamics/laws_test.cpp.
//
// A law T(e, ė) is a struct with
//   kInfo                    its name in a case file and its coefficients with units, roles and
//                            bounds,
//   tension(c, e, ė)         the tension [N] for coefficients c[i], over any vector type V,
//   slopes(c, e_max)         its steepest slopes, for the choice of the step,
// and, where they apply,
//   feasible(c)              whether coefficients, each within its bounds, make sense together,
//   kPower                   of a power of the extension: T = c[0] e², c[0] e³,
//   threshold(c)             of a spring beyond a threshold: T_open = c[0] max(0, e - threshold),
//   friction(c), kCreep      of dry friction: the force at which it slips, and which coefficient,
//   if
//                            it is the constant 0, says that it is exact and not regularised.
// One with `kInfo.memory` has tension(c, e, ė, ζ) and memory_rate(c, e, ė, ζ) = ζ̇ for its own
// state; one whose rates grow with |ė|, as all with memory, is `kInfo.paced`.
#pragma once

#include <type_traits>

#include "dynamics/law.hpp"
#include "dynamics/laws/bilinear.hpp"
#include "dynamics/laws/bouc_wen.hpp"
#include "dynamics/laws/contact.hpp"
#include "dynamics/laws/coulomb.hpp"
#include "dynamics/laws/cubic.hpp"
#include "dynamics/laws/quadratic.hpp"
#include "dynamics/laws/quadratic_damping.hpp"
#include "dynamics/laws/quintic.hpp"

namespace wheeltap::dynamics {

using LawList = TypeList<laws::Quadratic, laws::Cubic, laws::Bilinear, laws::Contact,
                         laws::QuadraticDamping, laws::Coulomb, laws::BoucWen, laws::Quintic>;

}  // namespace wheeltap::dynamics
