#include "fem/beam/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "beams.hpp"
#include "refusal.hpp"

namespace wheeltap::fem {
namespace {

TEST(Beam, ElementsCoverHalfOpenIntervals) {
  const Beam beam = slender_beam();
  EXPECT_EQ(beam.element_at(0.0), 0);
  EXPECT_EQ(beam.element_at(0.0099999), 0);
  EXPECT_EQ(beam.element_at(0.095), 9);
  EXPECT_EQ(beam.element_at(0.57), 57);
  EXPECT_EQ(beam.element_at(1.0), 99);
  EXPECT_DOUBLE_EQ(beam.element_midpoint(57), 0.575);
}

TEST(Beam, PlacesNextToANodeCountAsTheNode) {
  const Beam beam = slender_beam();
  for (int node = 0; node <= beam.elements; ++node) {
    const int element = std::min(node, beam.elements - 1);
    // node / 100.0 is not exact in binary, and neither is x / l.
    EXPECT_EQ(beam.element_at(node / 100.0), element);
    if (node == 0 || node == beam.elements) continue;
    EXPECT_EQ(beam.element_at(node / 100.0 - 0.9e-9), element);
    EXPECT_EQ(beam.element_at(node / 100.0 - 1.1e-9), element - 1);
  }
}

TEST(Beam, RejectsPlacesOutsideTheBeam) {
  const Beam beam = slender_beam();
  expect_refusal([&] { (void)beam.element_at(-1e-12); }, {"location", "[0, 1]"});
  expect_refusal([&] { (void)beam.element_at(1.5); }, {"1.5", "[0, 1]"});
  expect_refusal([&] { (void)beam.element_at(NAN); }, {"nan"});
}

TEST(Beam, FindsSupportsByName) {
  EXPECT_EQ(named_supports("free-free", 2.0).size(), 0U);
  EXPECT_EQ(named_supports("cantilever", 2.0).size(), 1U);
  EXPECT_TRUE(named_supports("cantilever", 2.0)[0].rotation);
  EXPECT_EQ(named_supports("clamped-pinned", 2.0)[1].at, 2.0);
  EXPECT_FALSE(named_supports("clamped-pinned", 2.0)[1].rotation);
  expect_refusal([] { (void)named_supports("hinged", 1.0); }, {"hinged", "clamped-pinned"});
}

TEST(Beam, DetectsMirrorSymmetry) {
  EXPECT_TRUE(is_mirror_symmetric(slender_beam("simply-supported")));
  EXPECT_TRUE(is_mirror_symmetric(slender_beam("clamped-clamped")));
  EXPECT_TRUE(is_mirror_symmetric(slender_beam("free-free")));
  EXPECT_FALSE(is_mirror_symmetric(slender_beam("cantilever")));
  EXPECT_FALSE(is_mirror_symmetric(slender_beam("clamped-pinned")));

  Beam beam = slender_beam();
  beam.supports.push_back({.at = 0.3, .stiffness = 1e4});
  EXPECT_FALSE(is_mirror_symmetric(beam));
  beam.supports.push_back({.at = 0.7, .stiffness = 1e4});
  EXPECT_TRUE(is_mirror_symmetric(beam));
  beam.supports.back().stiffness = 2e4;
  EXPECT_FALSE(is_mirror_symmetric(beam));
  // Two springs at one place are one spring of their total stiffness.
  beam.supports.push_back({.at = 0.3, .stiffness = 1e4});
  EXPECT_TRUE(is_mirror_symmetric(beam));
  beam.supports.pop_back();
  beam.supports.back() = {.at = 0.7, .deflection = false, .rotation = true, .stiffness = 1e4};
  EXPECT_FALSE(is_mirror_symmetric(beam));
  // A spring at a rigid support has no effect.
  beam = slender_beam("simply-supported");
  beam.supports.push_back({.at = beam.length, .stiffness = 1e4});
  EXPECT_TRUE(is_mirror_symmetric(beam));
}

TEST(Beam, RejectsInvalidDefinitions) {
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [](auto change, std::initializer_list<std::string> words) {
    Beam beam = slender_beam();
    change(beam);
    expect_refusal([&] { validate(beam); }, words);
  };
  EXPECT_NO_THROW(validate(slender_beam()));
  refuses([](Beam& b) { b.length = -1.0; }, {"beam.length", "-1", "positive"});
  refuses([&](Beam& b) { b.length = kNan; }, {"beam.length", "nan"});
  refuses([](Beam& b) { b.elements = 0; }, {"beam.elements", "0", "at least 1"});
  refuses([](Beam& b) { b.material.young = 0.0; }, {"young"});
  refuses([](Beam& b) { b.material.poisson = 0.5; }, {"poisson", "0.5", "below 0.5"});
  refuses([](Beam& b) { b.material.poisson = -1.0; }, {"poisson", "above -1"});
  refuses([](Beam& b) { b.material.density = -2700.0; }, {"density", "-2700"});
  refuses([](Beam& b) { b.section.area = 0.0; }, {"area"});
  refuses([](Beam& b) { b.section.second_moment = -1.0; }, {"second_moment"});
  refuses([](Beam& b) { b.section.shear_coefficient = 0.0; }, {"shear_coefficient"});
  refuses([](Beam& b) { b.supports[1].at = 1.2; }, {"beam.supports[1].at", "1.2", "[0, 1]"});
  refuses([](Beam& b) { b.supports[0].stiffness = -5.0; }, {"beam.supports[0].stiffness", "-5"});
  refuses([](Beam& b) { b.supports[0].deflection = false; }, {"beam.supports[0]", "must restrain"});
}

// Regression: no modes converged, and the program reported an internal error.
TEST(Beam, RejectsStiffnessesAndMassesBeyondFloatingPointRange) {
  Beam beam = slender_beam();
  beam.material.young = 1e300;
  expect_refusal([&] { validate(beam); }, {"bending stiffness", "1e-60 and 1e60", "units"});
  beam = slender_beam();
  beam.material.density = 1e-308;
  expect_refusal([&] { validate(beam); }, {"mass", "1e-60 and 1e60"});
  beam = slender_beam();
  beam.material.young = 1e30;  // unusual but valid
  EXPECT_NO_THROW(validate(beam));
}

}  // namespace
}  // namespace wheeltap::fem
