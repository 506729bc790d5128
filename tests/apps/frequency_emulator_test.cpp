#include "apps/frequency_emulator.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using testing::HasSubstr;

DamageCase emulated_case() {
  Json json = small_case();
  json["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  json["predictor"] =
      Json::parse(R"({"sites": [2, 4, 6, 9], "multipliers": [0.4, 0.7, 1.0], "holdout": 50})");
  const Workspace where;
  return parse_damage_case(read_case(where.write_json("c.json", json)));
}

FrequencyEmulator trained(const DamageCase& c, int modes = 4) {
  const fem::Reanalysis reanalysis(c.beam, modes);
  return FrequencyEmulator::train(reanalysis, *c.emulator, 2, modes, {});
}

TEST(FrequencyEmulator, IsTheFiniteElementSolutionAtItsNodes) {
  const DamageCase c = emulated_case();
  const FrequencyEmulator emulator = trained(c);
  EXPECT_EQ(emulator.runs(1), 12);
  EXPECT_EQ(emulator.runs(2), 144);
  const std::vector<fem::Damage> damages = {{c.beam.element_midpoint(3), 0.3},
                                            {c.beam.element_midpoint(8), 0.6}};
  const auto exact = elastic_frequencies(c.beam, {.damages = damages, .supports = {}}, 4);
  std::vector<double> out(4);
  emulator.evaluate(damages, out);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(out[i], exact[i], 1e-6 * exact[i]);
}

TEST(FrequencyEmulator, IsAskedAtElementMidpoints) {
  const DamageCase c = emulated_case();
  const FrequencyEmulator emulator = trained(c);
  std::vector<double> a(4), b(4);
  emulator.evaluate(std::vector<fem::Damage>{{0.401, 0.3}}, a);
  emulator.evaluate(std::vector<fem::Damage>{{0.499, 0.3}}, b);
  EXPECT_EQ(a, b) << "both lie in one element";
  emulator.evaluate(std::vector<fem::Damage>{{0.501, 0.3}}, b);
  EXPECT_NE(a, b);
}

TEST(FrequencyEmulator, FewerModesThanTheTableHas) {
  const FrequencyEmulator emulator = trained(emulated_case());
  std::vector<double> all(4), two(2);
  const std::vector<fem::Damage> damage = {{0.3, 0.2}};
  emulator.evaluate(damage, all);
  emulator.evaluate(damage, two);
  EXPECT_EQ(two, (std::vector<double>{all[0], all[1]}));
}

TEST(FrequencyEmulator, ReadsWhatItWrites) {
  const Workspace where;
  const DamageCase c = emulated_case();
  const FrequencyEmulator written = trained(c);
  written.save(where / "t.nc", {{"command", "test"}});
  const FrequencyEmulator read = FrequencyEmulator::load(where / "t.nc", c.beam, 2, 4);
  std::vector<double> a(4), b(4);
  const std::vector<fem::Damage> damages = {{0.23, 0.11}, {0.77, 0.51}};
  written.evaluate(damages, a);
  read.evaluate(damages, b);
  EXPECT_EQ(a, b);
  EXPECT_EQ(read.holdout(2)[3].rmse, written.holdout(2)[3].rmse);
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", c.beam, 3, 4), std::invalid_argument);
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", c.beam, 2, 5), std::invalid_argument);
  fem::Beam other = c.beam;
  other.material.young *= 1.001;
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", other, 2, 4), emulator::FileError);
}

TEST(FrequencyEmulator, FingerprintSeesEveryPropertyOfTheBeam) {
  const fem::Beam beam = emulated_case().beam;
  std::vector<fem::Beam> others(8, beam);
  others[0].length *= 1.01;
  others[1].elements += 1;
  others[2].supports[0].rotation = true;
  others[3].material.young *= 1.01;
  others[4].material.density *= 1.01;
  others[5].section.second_moment *= 1.01;
  others[6].section.shear_coefficient *= 1.01;
  others[7].supports[1].stiffness = 1e6;
  for (const fem::Beam& other : others) EXPECT_NE(beam_fingerprint(other), beam_fingerprint(beam));
}

TEST(FrequencyEmulator, NamesThePriorThatReachesOutsideItsBox) {
  DamageCase c = emulated_case();
  const FrequencyEmulator emulator = trained(c);
  EXPECT_FALSE(emulator.reaches_outside(c.kinds[0]));
  c.kinds[0].location = inference::Uniform{0.1, 0.95};  // into element 10, beyond site 9
  ASSERT_TRUE(emulator.reaches_outside(c.kinds[0]));
  EXPECT_EQ(emulator.reaches_outside(c.kinds[0])->prior, "location");
  EXPECT_THAT(emulator.reaches_outside(c.kinds[0])->message, HasSubstr("0.15 to 0.85 m"));
  c.kinds[0].location = inference::Uniform{0.1, 0.9};
  c.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 0.7});
  ASSERT_TRUE(emulator.reaches_outside(c.kinds[0]));
  EXPECT_EQ(emulator.reaches_outside(c.kinds[0])->prior, "reduction");
}

// A frequency is nearly linear in compliance: with the same levels the error must fall.
TEST(FrequencyEmulator, ComplianceAndEverySiteLeaveLittleError) {
  DamageCase c = emulated_case();
  c.beam.elements = 100;
  c.emulator->sites = {std::vector<int>(100)};
  std::iota(c.emulator->sites[0].begin(), c.emulator->sites[0].end(), 0);
  const fem::Reanalysis reanalysis(c.beam, 4);
  const auto linear = FrequencyEmulator::train(reanalysis, *c.emulator, 1, 4, {});
  c.emulator->compliance = true;
  const auto compliance = FrequencyEmulator::train(reanalysis, *c.emulator, 1, 4, {});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(compliance.holdout(1)[i].rmse, 0.5 * linear.holdout(1)[i].rmse);
    EXPECT_GT(compliance.holdout(1)[i].q2, 0.999);
  }
}

}  // namespace
}  // namespace wheeltap::apps
