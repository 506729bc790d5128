#include "signals/units.hpp"

#include <gtest/gtest.h>

namespace wheeltap::signals {
namespace {

TEST(Units, FactorsToSi) {
  const auto expect = [](const char* text, Dimension dimension, double si) {
    const auto unit = find_unit(text);
    ASSERT_TRUE(unit) << text;
    EXPECT_EQ(unit->dimension, dimension) << text;
    EXPECT_DOUBLE_EQ(unit->si, si) << text;
  };
  for (const char* s : {"s", "S", "sec", "Sec", "SECONDS"}) expect(s, Dimension::time, 1.0);
  for (const char* us : {"us", "µs", "μs", "usec"}) expect(us, Dimension::time, 1e-6);
  expect("ms", Dimension::time, 1e-3);
  expect("min", Dimension::time, 60.0);
  expect("kN", Dimension::force, 1e3);
  expect("mN", Dimension::force, 1e-3);
  expect("MN", Dimension::force, 1e6);
  // NIST SP 811 (2008), appendix B.8.
  expect("lbf", Dimension::force, 4.4482216152605);
  expect("in", Dimension::length, 0.0254);
  expect("µm", Dimension::length, 1e-6);
  expect("mm/s", Dimension::velocity, 1e-3);
  expect("m s^-1", Dimension::velocity, 1.0);
  expect("g", Dimension::acceleration, 9.80665);
  expect("mm/s²", Dimension::acceleration, 1e-3);
  for (const char* a : {"m/s^2", "m/s2", "m/s²", "ms^-2", "m/s/s", "m s^-2", "m.s^-2", "m/s**2",
                        "m·s⁻²", "m / s^2"})
    expect(a, Dimension::acceleration, 1.0);
}

TEST(Units, UnknownUnitsReturnNothing) {
  for (const char* text : {"", "V", "Ms", "%", "1", "s^-2", "m/s^3", "mm s"})
    EXPECT_FALSE(find_unit(text)) << text;
}

TEST(Units, MessagesListThem) {
  EXPECT_EQ(known_units(Dimension::time), "s, ms, us, ns, min, h, d");
  EXPECT_EQ(name(Dimension::acceleration), "an acceleration");
}

}  // namespace
}  // namespace wheeltap::signals
