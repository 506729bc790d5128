#include "identification/structural/damage/frequency_emulator.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "emulator/cubic_interpolant.hpp"
#include "emulator/gaussian_process.hpp"
#include "fem/sections/section.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/identification/cases.hpp"

namespace wheeltap::identification {
namespace {

using test::TemporaryDirectory;
using testing::HasSubstr;

// A simply supported beam with up to `most` damages, and a mirror-symmetric emulator.
DamageCase beam_case(int elements, int most, const EmulatorSpec& spec) {
  DamageCase out = small_beam(most);
  out.beam.elements = elements;
  out.beam.supports = fem::named_supports("simply-supported", 1.0);
  out.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 0.6});
  out.data = {};
  out.emulator = spec;
  out.emulator->symmetrise = true;
  return out;
}

EmulatorSpec grid(std::vector<int> sites, std::vector<double> reductions, int holdout = 1000) {
  EmulatorSpec spec;
  spec.sites = {std::move(sites)};
  spec.reductions = std::move(reductions);
  spec.holdout = holdout;
  return spec;
}

EmulatorSpec scattered(EmulatorSpec::Runs design, std::vector<int> runs, int holdout) {
  EmulatorSpec spec;
  spec.runs = design;
  spec.interpolant = &emulator::kGaussianProcess;
  spec.design_runs = std::move(runs);
  spec.holdout = holdout;
  return spec;
}

EmulatorSpec own_runs(const std::filesystem::path& file, const emulator::InterpolantType& type) {
  EmulatorSpec spec;
  spec.runs = EmulatorSpec::Runs::csv;
  spec.interpolant = &type;
  spec.csv = {file};
  return spec;
}

// Coarse: four sites of ten, up to two damages between 0.1 m and 0.9 m.
DamageCase emulated_case() {
  DamageCase out = beam_case(10, 2, grid({1, 3, 5, 8}, {0.0, 0.3, 0.6}, 50));
  out.kinds[0].location = inference::Uniform{0.1, 0.9};
  out.emulator->symmetrise = false;
  return out;
}

std::vector<double> fe(const DamageCase& c, const std::vector<fem::Damage>& damages) {
  return elastic_frequencies(c.beam, {.damages = damages, .supports = {}}, 4);
}

FrequencyEmulator trained(const DamageCase& c, int modes = 4) {
  const fem::Reanalysis reanalysis(c.beam, modes);
  return FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], modes, {});
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

TEST(FrequencyEmulator, IsEvaluatedAtElementMidpoints) {
  const DamageCase c = emulated_case();
  const FrequencyEmulator emulator = trained(c);
  std::vector<double> a(4), b(4);
  emulator.evaluate(std::vector<fem::Damage>{{0.401, 0.3}}, a);
  emulator.evaluate(std::vector<fem::Damage>{{0.499, 0.3}}, b);
  EXPECT_EQ(a, b) << "both are in one element";
  emulator.evaluate(std::vector<fem::Damage>{{0.501, 0.3}}, b);
  EXPECT_NE(a, b);
}

TEST(FrequencyEmulator, UsesFewerModesThanTheTable) {
  const FrequencyEmulator emulator = trained(emulated_case());
  std::vector<double> all(4), two(2);
  const std::vector<fem::Damage> damage = {{0.3, 0.2}};
  emulator.evaluate(damage, all);
  emulator.evaluate(damage, two);
  EXPECT_EQ(two, (std::vector<double>{all[0], all[1]}));
}

TEST(FrequencyEmulator, ReadsWhatItWrites) {
  const TemporaryDirectory where;
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
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", other, 2, 4), io::FileError);
}

TEST(FrequencyEmulator, FingerprintDependsOnEveryPropertyOfTheBeam) {
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

TEST(FrequencyEmulator, NamesThePriorOutsideItsBox) {
  DamageCase c = emulated_case();
  const FrequencyEmulator emulator = trained(c);
  EXPECT_FALSE(emulator.reaches_outside(c.kinds[0]));
  c.kinds[0].location = inference::Uniform{0.1, 0.95};  // into element 10, beyond site 9
  ASSERT_TRUE(emulator.reaches_outside(c.kinds[0]));
  EXPECT_EQ(emulator.reaches_outside(c.kinds[0])->part, InvalidInput::Part::location);
  EXPECT_THAT(emulator.reaches_outside(c.kinds[0])->message, HasSubstr("0.15 to 0.85 m"));
  c.kinds[0].location = inference::Uniform{0.1, 0.9};
  c.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 0.7});
  ASSERT_TRUE(emulator.reaches_outside(c.kinds[0]));
  EXPECT_EQ(emulator.reaches_outside(c.kinds[0])->part, InvalidInput::Part::severity);
}

// A frequency is nearly linear in compliance, so with the same levels the error must decrease.
TEST(FrequencyEmulator, ComplianceAndAllSitesReduceTheError) {
  DamageCase c = emulated_case();
  c.beam.elements = 100;
  c.emulator->sites = {std::vector<int>(100)};
  std::iota(c.emulator->sites[0].begin(), c.emulator->sites[0].end(), 0);
  const fem::Reanalysis reanalysis(c.beam, 4);
  const auto linear = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  c.emulator->compliance = true;
  const auto compliance = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(compliance.holdout(1)[i].rmse, 0.5 * linear.holdout(1)[i].rmse);
    EXPECT_GT(compliance.holdout(1)[i].q2, 0.999);
  }
}

// For a symmetric beam, a place and its mirror image are equivalent; asymmetric sites break this.
TEST(FrequencyEmulator, PredictsMirrorImagesEqually) {
  DamageCase symmetrised = emulated_case();
  symmetrised.emulator->symmetrise = true;
  const FrequencyEmulator both = trained(symmetrised), one = trained(emulated_case());
  const std::vector<fem::Damage> here = {{0.25, 0.3}, {0.65, 0.5}},
                                 image = {{0.35, 0.5}, {0.75, 0.3}};
  std::vector<double> a(4), b(4), c(4), d(4);
  both.evaluate(here, a);
  both.evaluate(image, b);
  one.evaluate(here, c);
  one.evaluate(image, d);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(a[i], b[i], 1e-12 * a[i]);
    EXPECT_NEAR(a[i], 0.5 * (c[i] + d[i]), 1e-12 * a[i]);
    EXPECT_GT(std::abs(c[i] - d[i]), 1e-6 * c[i]);
  }
}

TEST(FrequencyEmulator, VarianceIsCalibratedOnFreshRuns) {
  DamageCase well_measured = emulated_case();
  well_measured.emulator->holdout = 2000;
  const FrequencyEmulator emulator = trained(well_measured);
  for (int count = 1; count <= 2; ++count) {
    for (const auto& z : emulator.error(count).standardised) {
      EXPECT_NEAR(z.rms, 1.0, 1e-6) << "the scale is fitted to this";
      EXPECT_LT(z.beyond_two, 0.12);
    }
  }
  std::vector<double> f(4), small(4), large(4);
  emulator.evaluate(std::vector<fem::Damage>{{0.33, 0.01}}, f, small);
  emulator.evaluate(std::vector<fem::Damage>{{0.33, 0.5}}, f, large);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(small[i], 0.02 * large[i]);
}

TEST(FrequencyEmulator, AnovaPredictsAnyCountFromTwoTables) {
  const TemporaryDirectory where;
  std::vector<int> every(20);
  std::iota(every.begin(), every.end(), 0);
  EmulatorSpec spec = grid(every, {0.0, 0.2, 0.4, 0.6}, 300);
  spec.interpolant = &emulator::kMonotoneCubic;
  spec.compliance = true;
  spec.anova = emulator::Additive::inverse_square;
  const DamageCase c = beam_case(20, 4, spec);
  const fem::Reanalysis reanalysis(c.beam, 4);
  const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  EXPECT_EQ(made.max_count(), 4);
  EXPECT_EQ(made.runs(3), 80 + 6400);
  EXPECT_EQ(made.trained_runs(), 80 + 6400);
  EXPECT_THAT(made.describe(3), HasSubstr("ANOVA in the inverse-square"));
  for (int count = 1; count <= 4; ++count) {
    for (const auto& error : made.holdout(count)) EXPECT_GT(error.q2, 0.998) << count;
  }
  made.save(where / "t.nc", {});
  const auto read = FrequencyEmulator::load(where / "t.nc", c.beam, 4, 4);
  const std::vector<fem::Damage> damages = {{0.11, 0.2}, {0.43, 0.1}, {0.77, 0.5}, {0.93, 0.33}};
  std::vector<double> a(4), b(4), u(4), v(4);
  made.evaluate(damages, a, u);
  read.evaluate(damages, b, v);
  EXPECT_EQ(a, b);
  EXPECT_EQ(u, v);
  const auto exact = fe(c, damages);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[i], exact[i], 1e-3 * exact[i]);
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", c.beam, 5, 4), std::invalid_argument);
}

TEST(FrequencyEmulator, RefinesUntilItIsAccurate) {
  for (const double accuracy : {1e-2, 1e-4}) {
    EmulatorSpec spec = grid({0, 9, 19}, {0.0, 0.6});
    spec.interpolant = &emulator::kCubic;
    spec.compliance = true;
    spec.accuracy = accuracy;
    const DamageCase c = beam_case(20, 1, spec);
    const fem::Reanalysis reanalysis(c.beam, 4);
    const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
    const auto intact = reanalysis.intact_frequencies_hz();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT(made.holdout(1)[i].rmse, accuracy * intact[i]);
      EXPECT_LT(made.holdout(1)[i].max_error, 2.0 * accuracy * intact[i]);
    }
    EXPECT_EQ(made.runs(1) > 40, accuracy < 1e-3) << "only as many runs as necessary";
  }
}

class ScatteredEmulator : public testing::TestWithParam<std::string> {};

TEST_P(ScatteredEmulator, IsTrainedStoredAndReadBack) {
  const TemporaryDirectory where;
  EmulatorSpec spec = scattered(EmulatorSpec::Runs::latin_hypercube, {60, 150}, 100);
  spec.compliance = true;
  spec.interpolant = find_interpolant_type(GetParam());
  const DamageCase c = beam_case(20, 2, spec);
#ifndef WHEELTAP_WITH_CGAL
  if (GetParam() == "delaunay") GTEST_SKIP() << "built without CGAL";
#endif
  const fem::Reanalysis reanalysis(c.beam, 4);
  const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  EXPECT_FALSE(made.reaches_outside(c.kinds[0]));
  made.save(where / "t.nc", {});
  const auto read = FrequencyEmulator::load(where / "t.nc", c.beam, 2, 4);
  // The priors' corners are inside, for both orders of the damages.
  for (const auto& damages : std::vector<std::vector<fem::Damage>>{
           {{0.0, 0.0}, {1.0, 0.6}}, {{0.0, 0.6}, {0.0, 0.0}}, {{0.31, 0.2}, {0.8, 0.4}}}) {
    std::vector<double> a(4), b(4), u(4), v(4);
    made.evaluate(damages, a, u);
    read.evaluate(damages, b, v);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(a[i], b[i], 1e-9 * a[i]);
      EXPECT_GE(u[i], 0.0);
      EXPECT_NEAR(u[i], v[i], 1e-6 * u[i] + 1e-12);
    }
  }
  for (const auto& error : made.holdout(1)) EXPECT_GT(error.q2, 0.6);
  EXPECT_EQ(made.error(1).leave_one_out.size(), GetParam() == "delaunay" ? 0U : 4U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ScatteredEmulator, testing::Values("gaussian-process", "delaunay"),
                         [](const auto& test) {
                           return test.param == "delaunay" ? "Delaunay" : "GaussianProcess";
                         });

TEST(FrequencyEmulator, TrainsOnTheUsersRuns) {
  const TemporaryDirectory where;
  const DamageCase plain = beam_case(20, 1, {});
  std::string full = "location[1] [m],reduction[1],f1 [Hz],f2 [Hz],f3 [Hz]\n", loose = full;
  const auto add = [&](std::string& csv, double x, double r) {
    char line[200];
    const auto f = fe(plain, {{x, r}});
    std::snprintf(line, sizeof line, "%.4f,%.4f,%.10g,%.10g,%.10g\n", x, r, f[0], f[1], f[2]);
    csv += line;
  };
  for (int e = 0; e < 20; ++e) {
    for (const double r : {0.0, 0.2, 0.4, 0.6}) {
      add(full, 0.025 + 0.05 * e, r);
      add(loose, 0.025 + 0.05 * e, r == 0.0 || r == 0.6 ? r : r + 0.004 * e);
    }
  }
  test::put_bytes(where / "full.csv", full);
  test::put_bytes(where / "loose.csv", loose);
  EmulatorSpec cubic = own_runs(where / "full.csv", emulator::kCubic);
  cubic.compliance = true;
  for (const auto& [spec, exactness] : std::vector<std::pair<EmulatorSpec, double>>{
           {cubic, 3e-4}, {own_runs(where / "loose.csv", emulator::kGaussianProcess), 2e-3}}) {
    const DamageCase c = beam_case(20, 1, spec);
    const fem::Reanalysis reanalysis(c.beam, 3);
    const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 3, {});
    EXPECT_EQ(made.trained_runs(), 0);
    std::vector<double> f(3);
    made.evaluate(std::vector<fem::Damage>{{0.31, 0.33}}, f);
    const auto exact = fe(c, {{0.31, 0.33}});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(f[i], exact[i], exactness * exact[i]);
    EXPECT_THROW((void)FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {}),
                 std::invalid_argument)
        << "the file has three modes";
  }
  const DamageCase c = beam_case(20, 1, own_runs(where / "loose.csv", emulator::kMultilinear));
  const fem::Reanalysis reanalysis(c.beam, 3);
  EXPECT_THROW((void)FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 3, {}),
               io::FileError)
      << "not a grid";
  test::put_bytes(where / "twice.csv", loose + "0.0251,0.0,1,2,3\n");
  const DamageCase twice =
      beam_case(20, 1, own_runs(where / "twice.csv", emulator::kGaussianProcess));
  EXPECT_THROW((void)FrequencyEmulator::train(reanalysis, *twice.emulator, c.kinds[0], 3, {}),
               io::FileError)
      << "the same element and reduction twice";
}

TEST(FrequencyEmulator, PartsCombineToTheWholeTable) {
  for (const EmulatorSpec& spec : {grid({0, 6, 19}, {0.0, 0.3, 0.6}, 20),
                                   scattered(EmulatorSpec::Runs::sobol, {20, 30}, 20)}) {
    const DamageCase c = beam_case(20, 2, spec);
    const fem::Reanalysis reanalysis(c.beam, 4);
    const auto whole = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
    std::vector<emulator::TableFile> parts;
    for (const int part : {2, 0, 1}) {
      parts.push_back(run_part(reanalysis, *c.emulator, c.kinds[0], 4, part, 3, {}));
    }
    const auto merged = emulator::merge(parts);
    const auto joined =
        FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {.runs = &merged});
    EXPECT_EQ(joined.trained_runs(), 0);
    std::vector<double> a(4), b(4), u(4), v(4);
    const std::vector<fem::Damage> damages = {{0.23, 0.11}, {0.77, 0.51}};
    whole.evaluate(damages, a, u);
    joined.evaluate(damages, b, v);
    EXPECT_EQ(a, b);
    EXPECT_EQ(u, v);
    parts.pop_back();
    const auto lacking = emulator::merge(parts);
    EXPECT_THROW(
        (void)FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {.runs = &lacking}),
        std::invalid_argument);
  }
}

}  // namespace
}  // namespace wheeltap::identification
