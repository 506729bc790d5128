// The list of force laws. To add a law, write one file in laws/ and add two lines here, the include
// and the name in `LawList`; add its test to tests/dynamics/laws_test.cpp.
//
// A law T(e, ė) is a struct with
//   kInfo                    its name in a case file and its coefficients with units and bounds,
//   tension(c, e, ė)         the tension [N] for coefficients c[i], for any vector type V,
//   slopes(c, e_max)         its largest slopes, for the choice of the time step,
// and, if applicable,
//   feasible(c)              whether coefficients, each within its bounds, are consistent,
//   kPower                   for a power of the extension: T = c[0] e², c[0] e³,
//   threshold(c)             for a spring beyond a threshold: T_open = c[0] max(0, e - threshold),
//   friction(c), kCreep      for dry friction: the slip force, and the index of the coefficient
//   whose
//                            constant value 0 selects exact instead of regularised friction.
// A law with `kInfo.memory` has tension(c, e, ė, ζ) and memory_rate(c, e, ė, ζ) = ζ̇ for its
// internal state. A law whose rates grow with |ė|, such as every law with memory, has
// `kInfo.paced`.
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
