#include "fem/sections/section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "refusal.hpp"

namespace wheeltap::fem {
namespace {

TEST(Section, RectangleAndCircle) {
  const Section r = section(Rectangle{.width = 0.025, .height = 0.006}, 0.3);
  EXPECT_NEAR(r.area, 1.5e-4, 1e-18);
  EXPECT_NEAR(r.second_moment, 4.5e-10, 1e-23);
  EXPECT_NEAR(r.shear_coefficient, 0.849673, 5e-7);
  const Section c = section(Circle{.diameter = 2.0}, 0.3);
  EXPECT_DOUBLE_EQ(c.area, std::numbers::pi);
  EXPECT_DOUBLE_EQ(c.second_moment, std::numbers::pi / 4.0);
  EXPECT_DOUBLE_EQ(c.shear_coefficient, 7.8 / 8.8);
}

TEST(Section, TubeLiesBetweenCircleAndThinRing) {
  // Thin ring: A = 2πrt, I = πr³t, κ = 2(1+ν)/(4+3ν) (Cowper 1966, thin-walled round tube).
  const double t = 1e-6;
  const Section thin = section(Tube{.outer_diameter = 2.0 + t, .thickness = t}, 0.3);
  EXPECT_NEAR(thin.area / (2.0 * std::numbers::pi * t), 1.0, 1e-9);
  EXPECT_NEAR(thin.second_moment / (std::numbers::pi * t), 1.0, 1e-9);
  EXPECT_NEAR(thin.shear_coefficient, 2.6 / 4.9, 1e-9);
  EXPECT_DOUBLE_EQ(cowper_tube(0.3, 0.0), cowper_circle(0.3));
}

TEST(Section, ThinWalledShapesByParts) {
  const double h = 0.2, b = 0.1, tf = 0.01, tw = 0.006;
  // Steiner's theorem, part by part.
  const double flanges = 2.0 * (b * tf * tf * tf / 12.0 + b * tf * 0.095 * 0.095);
  const double web = tw * 0.18 * 0.18 * 0.18 / 12.0;
  const Section i =
      section(ISection{.height = h, .width = b, .flange_thickness = tf, .web_thickness = tw}, 0.3);
  EXPECT_NEAR(i.area, 2.0 * b * tf + 0.18 * tw, 1e-15);
  EXPECT_NEAR(i.second_moment, flanges + web, 1e-15);
  const Section box =
      section(Box{.height = h, .width = b, .flange_thickness = tf, .web_thickness = tw}, 0.3);
  EXPECT_NEAR(box.area, 2.0 * b * tf + 2.0 * 0.18 * tw, 1e-15);
  EXPECT_NEAR(box.second_moment, flanges + 2.0 * web, 1e-15);
}

TEST(Section, CowperThinWalledLimits) {
  // Without flanges (m -> 0) a thin-walled shape is a thin rectangle.
  const Section web = section(
      ISection{.height = 1.0, .width = 0.0101, .flange_thickness = 1e-7, .web_thickness = 0.01},
      0.3);
  EXPECT_NEAR(web.shear_coefficient, cowper_rectangle(0.3), 1e-5);
  // A square thin-walled tube: m = 1, n = 1 gives 20 (1 + ν) / (48 + 39 ν) (Cowper 1966, table 1).
  const Section square = section(
      Box{.height = 1.001, .width = 1.001, .flange_thickness = 0.001, .web_thickness = 0.001}, 0.3);
  EXPECT_NEAR(square.shear_coefficient, 20.0 * 1.3 / (48.0 + 39.0 * 0.3), 1e-12);
  // The web carries the shear: κ A is close to the web's area.
  const Section beam = section(
      ISection{.height = 0.2, .width = 0.1, .flange_thickness = 0.008, .web_thickness = 0.006},
      0.3);
  EXPECT_NEAR(beam.shear_coefficient * beam.area / (0.2 * 0.006), 1.0, 0.1);
}

TEST(Section, TorsionOfRectangles) {
  // Timoshenko & Goodier, section 109: 0.1406 a⁴ of a square, 0.2287 of two to one, 1/3 of a strip.
  EXPECT_NEAR(rectangle_torsion_constant(1, 1), 0.1405770, 1e-7);
  EXPECT_NEAR(rectangle_torsion_constant(1, 2), 2 * 0.2286816, 1e-6);
  EXPECT_NEAR(rectangle_torsion_constant(2, 1), rectangle_torsion_constant(1, 2), 1e-16);
  EXPECT_NEAR(rectangle_torsion_constant(1000, 1),
              1000 / 3.0 - 64 / std::pow(std::numbers::pi, 5) * 31 / 32 * 1.0369277551433699, 1e-9);
}

TEST(Section, RefusesSizesThatDoNotFit) {
  expect_refusal([] { (void)section(Rectangle{.width = 0.0, .height = 1.0}, 0.3); },
                 {"width", "0"});
  expect_refusal([] { (void)section(Rectangle{.width = 1.0, .height = -1.0}, 0.3); },
                 {"height", "-1"});
  expect_refusal([] { (void)section(Circle{.diameter = 1.0}, 0.5); }, {"poisson", "below 0.5"});
  expect_refusal([] { (void)section(Tube{.outer_diameter = 1.0, .thickness = 0.5}, 0.3); },
                 {"thickness", "0.5"});
  expect_refusal(
      [] {
        (void)section(
            ISection{.height = 0.1, .width = 0.1, .flange_thickness = 0.05, .web_thickness = 0.01},
            0.3);
      },
      {"flange_thickness", "0.05"});
  expect_refusal(
      [] {
        (void)section(
            Box{.height = 0.1, .width = 0.1, .flange_thickness = 0.01, .web_thickness = 0.06}, 0.3);
      },
      {"web_thickness", "0.06"});
}

}  // namespace
}  // namespace wheeltap::fem
