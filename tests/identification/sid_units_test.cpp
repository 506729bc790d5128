// Units of parameters from their uses and from the channels' units.
#include "identification/sid/sid_units.hpp"

#include <gtest/gtest.h>

#include "dynamics/laws.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;
using Role = SidChannel::Role;

/// One mass with friction, a stop and hysteresis; one parameter per coefficient. The channels'
/// headers have these units.
SidCase rig(const std::string& force, const std::string& displacement) {
  SidCase c;
  const auto p = [&](const char* name) { return c.parameter(name, inference::Uniform{0.0, 1.0}); };
  SidModel model{.name = "rig"};
  model.chain.masses = {p("m")};
  dynamics::Link link{.a = 0, .b = 1};
  link.stiffness = p("k"), link.damping = p("c");
  link.laws = {dynamics::make_law<dynamics::laws::Coulomb>({p("F"), p("creep")}),
               dynamics::make_law<dynamics::laws::Contact>({p("kc"), p("gap")}),
               dynamics::make_law<dynamics::laws::BoucWen>({p("kh"), p("yield"), p("n")}),
               dynamics::make_law<dynamics::laws::Cubic>({p("k3")}),
               dynamics::make_law<dynamics::laws::QuadraticDamping>({p("c2")})};
  model.chain.links = {link};
  model.noise = {p("sigma")};
  model.residuals = {kAutoregressive.make(1), {{p("ar[1]")}}};
  model.initial.displacement = {p("y0")}, model.initial.velocity = {p("v0")};
  c.models = {model};
  SidChannel driver{.column = "x", .role = Role::force, .mass = 1};
  SidChannel response{.column = "y", .role = Role::response, .mass = 1};
  driver.take_unit(force), response.take_unit(displacement);
  response.signal.offset = p("zero"), driver.signal.offset = p("preload");
  c.channels = {driver, response};
  return c;
}

using Units = std::map<std::string, std::string>;

// Regression (issue 14, finding 7): k, c and k3 had no units.
TEST(SidUnits, FollowFromTheUse) {
  for (const char* displacement : {"m", "mm", ""}) {
    EXPECT_EQ(parameter_units(rig("kN", displacement)), (Units{{"m", "kg"},
                                                               {"k", "N/m"},
                                                               {"c", "N s/m"},
                                                               {"F", "N"},
                                                               {"creep", "m/s"},
                                                               {"kc", "N/m"},
                                                               {"gap", "m"},
                                                               {"kh", "N/m"},
                                                               {"yield", "m"},
                                                               {"n", "1"},
                                                               {"k3", "N/m^3"},
                                                               {"c2", "N s^2/m^2"},
                                                               {"sigma", "m"},
                                                               {"ar[1]", "1"},
                                                               {"y0", "m"},
                                                               {"v0", "m/s"},
                                                               {"zero", "m"},
                                                               {"preload", "N"}}))
        << displacement;
  }
}

// Regression (issue 14, finding 7): volts were labelled m and N.
TEST(SidUnits, VoltsStayVolts) {
  const Units units = parameter_units(rig("V", "V"));
  EXPECT_EQ(units.at("m"), "V s^2/V");
  EXPECT_EQ(units.at("k"), "V/V");
  EXPECT_EQ(units.at("k3"), "V/V^3");
  EXPECT_EQ(units.at("F"), "V");
  EXPECT_EQ(units.at("sigma"), "V");
  EXPECT_EQ(units.at("v0"), "V/s");
  EXPECT_EQ(parameter_units(rig("N", "counts")).at("k"), "N/counts");
  EXPECT_EQ(parameter_units(rig("N", "mV/V")).at("k3"), "N/(mV/V)^3");
  SidCase scaled = rig("N", "V");
  scaled.channels[1].scale_given = true;
  EXPECT_EQ(parameter_units(scaled).at("k"), "N/m");
}

TEST(SidUnits, AreEmptyIfUsesOrChannelsDisagree) {
  SidCase shared = rig("N", "m");
  shared.models[0].chain.links[0].damping = shared.models[0].chain.links[0].stiffness;
  EXPECT_EQ(parameter_units(shared).at("k"), "");
  EXPECT_EQ(parameter_units(shared).at("F"), "N");
  SidCase mixed = rig("N", "V");
  SidChannel other{.column = "z", .role = Role::response, .mass = 1};
  other.take_unit("m");
  mixed.channels.push_back(other);
  mixed.models[0].noise.push_back(mixed.models[0].noise[0]);
  EXPECT_FALSE(unit_system(mixed).has_value());
  const Units units = parameter_units(mixed);
  EXPECT_EQ(units.at("k"), "");
  EXPECT_EQ(units.at("sigma"), "");
  EXPECT_EQ(units.at("zero"), "V");
  // A velocity in V determines no unit of length.
  SidCase velocity = rig("N", "V");
  velocity.channels[1].quantity = dynamics::Quantity::velocity;
  EXPECT_EQ(parameter_units(velocity).at("k"), "");
  EXPECT_EQ(parameter_units(velocity).at("sigma"), "V");
}

// Only a base drives the chain: forces follow from the masses in kg.
TEST(SidUnits, AChainOnAMovingBaseIsInSi) {
  SidCase c = rig("N", "m");
  c.channels[0].role = Role::base_acceleration;
  c.channels[0].unit = "g";
  EXPECT_EQ(parameter_units(c).at("k"), "N/m");
  EXPECT_EQ(parameter_units(c).at("m"), "kg");
}

}  // namespace
}  // namespace wheeltap::identification
