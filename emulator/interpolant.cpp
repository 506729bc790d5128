#include "emulator/interpolant.hpp"

#include <stdexcept>

namespace wheeltap::emulator {

void Interpolant::evaluate(std::span<const double> /*x*/, std::span<double> /*out*/,
                           std::span<double> /*variance*/) const {
  throw std::logic_error("this interpolant does not compute the variance of its error");
}

}  // namespace wheeltap::emulator
