// Lumped-mass chains: masses and springs that move along one line, for example the storeys of a
// building.
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
    std::array<int, 2> between;  ///< ends of the link: 0 is the ground, i the i-th mass
    double stiffness;            ///< [N/m], > 0
  };
  std::vector<double> masses;  ///< [kg], > 0
  std::vector<Link> links;
};

/// Checks a chain. Throws InvalidStructure, with the part `masses` for an invalid mass and
/// `members` for an invalid link.
void validate(const LumpedChain& chain);

/// Discretises the chain; strain i belongs to link i. Throws the exceptions of `validate`.
[[nodiscard]] Discretisation discretise(const LumpedChain& chain);

}  // namespace wheeltap::fem
