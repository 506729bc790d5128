// The list of force laws. To add a force law, write one file in laws/ and add two lines here: the
// include and the name in `LawList`. Add a test of the force law to tests/dynamics/laws_test.cpp.
//
// A force law T(e, ė) is a struct with
//   kInfo                    name in a case file; coefficients with units, roles and bounds
//   tension(c, e, ė)         tension [N] for coefficients c[i], for any vector type V
//   slopes(c, e_max)         largest slopes, for the choice of the time step
// and, if they apply,
//   feasible(c)              true if coefficients within their bounds are feasible together
//   kPower                   the power 2 or 3 of the extension: T = c[0] e² or T = c[0] e³
//   threshold(c)             spring beyond a threshold: T_open = c[0] max(0, e - threshold)
//   friction(c)              dry friction: the force at which the link slips
//   kCreep                   dry friction: index of the creep speed. A constant 0 gives the exact
//                            (non-smooth) law; any other creep speed gives a regularised law
//
// A force law with an internal state ζ sets `kInfo.memory` and has tension(c, e, ė, ζ) and
// memory_rate(c, e, ė, ζ) = ζ̇. A force law sets `kInfo.paced` if its damping rate or the rate of
// its internal state grows with the speed |ė|. Every force law with memory is an example.
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
