#include "fem/sections/section_shapes.hpp"

#include <gtest/gtest.h>

namespace wheeltap::fem {
namespace {

TEST(SectionShapes, OutlinesHaveTheAreaAndTheDepthOfTheFormulas) {
  for (const SectionShape& shape : section_shapes()) {
    std::vector<double> sizes = {0.2, 0.01};  // a tube's
    if (shape.sizes.size() == 4) sizes = {0.2, 0.1, 0.008, 0.006};
    sizes.resize(shape.sizes.size());
    const Region region = shape.outline(sizes);
    double area = signed_area(region.outer), low = 0.0, high = 0.0;
    for (const Ring& hole : region.holes) area -= signed_area(hole);
    for (const auto& corner : region.outer) {
      low = std::min(low, corner.y());
      high = std::max(high, corner.y());
    }
    EXPECT_NEAR(area / shape.plane(sizes, 0.3).area, 1.0, 1e-12) << shape.name;
    EXPECT_NEAR((high - low) / shape.depth(sizes), 1.0, 1e-3) << shape.name;
    EXPECT_EQ(find_section_shape(shape.name), &shape);
  }
  EXPECT_EQ(find_section_shape("polygon"), nullptr);
}

}  // namespace
}  // namespace wheeltap::fem
