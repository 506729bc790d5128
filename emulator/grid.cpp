#include "emulator/grid.hpp"

#include <stdexcept>
#include <string>

namespace wheeltap::emulator {

std::vector<GridAxis> grid_axes(const std::vector<Factor>& factors, const RowMatrix& values) {
  check_factors(factors);
  if (values.cols() < 1) throw std::invalid_argument("a table needs responses");
  std::vector<GridAxis> axes(factors.size());
  std::ptrdiff_t stride = values.cols();
  for (std::size_t j = factors.size(); j-- > 0;) {
    axes[j] = {.scale = factors[j].scale, .coordinates = {}, .stride = stride};
    stride *= static_cast<std::ptrdiff_t>(factors[j].levels.size());
    for (double level : factors[j].levels)
      axes[j].coordinates.push_back(to_scale(factors[j].scale, level));
  }
  if (stride != values.size())
    throw std::invalid_argument("a table has " + std::to_string(values.rows()) +
                                " rows for a grid of " + std::to_string(stride / values.cols()) +
                                " nodes");
  if (!values.allFinite()) throw std::invalid_argument("a value of a table is not finite");
  return axes;
}

}  // namespace wheeltap::emulator
