#include <array>

#include "identification/sid/residuals/residual_model.hpp"

namespace wheeltap::identification {

std::span<const ResidualKind* const> residual_kinds() {
  static constexpr std::array kKinds = {&kAutoregressive};
  return kKinds;
}

}  // namespace wheeltap::identification
