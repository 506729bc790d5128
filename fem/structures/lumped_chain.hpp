// Lumped-mass chains: masses and springs that move along one line, such as storeys.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Point masses with one degree of freedom each, and springs between two masses or to ground.
struct LumpedChain {
  struct Link {
    std::string name;
    std::array<int, 2> between;  ///< 0 is the ground, i the i-th mass
    double stiffness;            ///< [N/m], > 0
  };
  std::vector<double> masses;  ///< [kg], > 0
  std::vector<Link> links;
};

/// Throws InvalidStructure (a mass is a `masses` part, a link a `members` part).
void validate(const LumpedChain& chain);

/// Discretises the chain; strain i belongs to link i. Throws the exceptions of `validate`.
[[nodiscard]] Discretisation discretise(const LumpedChain& chain);

}  // namespace wheeltap::fem
