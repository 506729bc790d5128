#include "identification/frequency_emulator.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using testing::HasSubstr;

DamageCase emulated_case(const std::string& more = R"({"symmetrise": false})") {
  Json json = small_case();
  json["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  json["predictor"] =
      Json::parse(R"({"sites": [2, 4, 6, 9], "multipliers": [0.4, 0.7, 1.0], "holdout": 50})");
  json["predictor"].update(Json::parse(more));
  const Workspace where;
  return parse_damage_case(read_case(where.write_json("c.json", json))).damage;
}

// Up to `max_count` damages anywhere on 20 elements.
DamageCase case_of(const std::string& predictor, int max_count, const Workspace& where) {
  Json json = small_case();
  json["beam"]["elements"] = 20;
  json["damage"]["count"]["max"] = max_count;
  json["predictor"] = Json::parse(predictor);
  return parse_damage_case(read_case(where.write_json("c.json", json))).damage;
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
  EXPECT_THROW((void)FrequencyEmulator::load(where / "t.nc", other, 2, 4), io::FileError);
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
  const auto linear = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  c.emulator->compliance = true;
  const auto compliance = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(compliance.holdout(1)[i].rmse, 0.5 * linear.holdout(1)[i].rmse);
    EXPECT_GT(compliance.holdout(1)[i].q2, 0.999);
  }
}

// A symmetric beam cannot tell a place from its mirror image; sites that are not symmetric would.
TEST(FrequencyEmulator, AnswersForMirrorImagesAlike) {
  const FrequencyEmulator both = trained(emulated_case("{}")), one = trained(emulated_case());
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
  EXPECT_FALSE(emulated_case(R"({"emulator_error": false})").emulator->symmetrise)
      << "trusted blindly, as it is";
}

TEST(FrequencyEmulator, VarianceIsHonestOnFreshRuns) {
  const FrequencyEmulator emulator = trained(emulated_case(R"({"holdout": 2000})"));
  for (int count = 1; count <= 2; ++count) {
    for (const auto& z : emulator.error(count).standardised) {
      EXPECT_NEAR(z.rms, 1.0, 1e-6) << "what the scale is fitted to";
      EXPECT_LT(z.beyond_two, 0.12);
    }
  }
  std::vector<double> f(4), small(4), large(4);
  emulator.evaluate(std::vector<fem::Damage>{{0.33, 0.01}}, f, small);
  emulator.evaluate(std::vector<fem::Damage>{{0.33, 0.5}}, f, large);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(small[i], 0.02 * large[i]);
}

TEST(FrequencyEmulator, AnovaServesAnyCountFromTwoTables) {
  const Workspace where;
  const DamageCase c = case_of(R"({"sites": "every-element", "multipliers": [0.4, 0.6, 0.8, 1.0],
    "interpolation": "monotone-cubic", "coordinate": "compliance", "expansion": "anova",
    "holdout": 300})",
                               4, where);
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

TEST(FrequencyEmulator, GrowsUntilItIsAccurate) {
  const Workspace where;
  for (const double accuracy : {1e-2, 1e-4}) {
    const DamageCase c = case_of(R"({"sites": [1, 10, 20], "multipliers": [0.4, 1.0], "coordinate":
      "compliance", "interpolation": "cubic", "accuracy": )" +
                                     std::to_string(accuracy) + "}",
                                 1, where);
    const fem::Reanalysis reanalysis(c.beam, 4);
    const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
    const auto intact = reanalysis.intact_frequencies_hz();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT(made.holdout(1)[i].rmse, accuracy * intact[i]);
      EXPECT_LT(made.holdout(1)[i].max_error, 2.0 * accuracy * intact[i]);
    }
    EXPECT_EQ(made.runs(1) > 40, accuracy < 1e-3) << "and no more runs than that takes";
  }
}

class ScatteredEmulator : public testing::TestWithParam<std::string> {};

TEST_P(ScatteredEmulator, IsTrainedStoredAndReadBack) {
  const Workspace where;
  const DamageCase c = case_of(R"({"design": {"kind": "latin-hypercube", "runs": [60, 150]},
    "coordinate": "compliance", "holdout": 100, "interpolation": ")" +
                                   GetParam() + "\"}",
                               2, where);
#ifndef WHEELTAP_WITH_CGAL
  if (GetParam() == "delaunay") GTEST_SKIP() << "built without CGAL";
#endif
  const fem::Reanalysis reanalysis(c.beam, 4);
  const auto made = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
  EXPECT_FALSE(made.reaches_outside(c.kinds[0]));
  made.save(where / "t.nc", {});
  const auto read = FrequencyEmulator::load(where / "t.nc", c.beam, 2, 4);
  // The priors' corners are inside, in whatever order the damages come to the ends.
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

TEST(FrequencyEmulator, LearnsFromTheUsersOwnRuns) {
  const Workspace where;
  const DamageCase plain = case_of(R"({"sites": [1, 20], "multipliers": [0.4, 1]})", 1, where);
  std::string grid = "location[1] [m],reduction[1],f1 [Hz],f2 [Hz],f3 [Hz]\n", scattered = grid;
  const auto add = [&](std::string& csv, double x, double r) {
    char line[200];
    const auto f = fe(plain, {{x, r}});
    std::snprintf(line, sizeof line, "%.4f,%.4f,%.10g,%.10g,%.10g\n", x, r, f[0], f[1], f[2]);
    csv += line;
  };
  for (int e = 0; e < 20; ++e) {
    for (const double r : {0.0, 0.2, 0.4, 0.6}) {
      add(grid, 0.025 + 0.05 * e, r);
      add(scattered, 0.025 + 0.05 * e, r == 0.0 || r == 0.6 ? r : r + 0.004 * e);
    }
  }
  where.write("grid.csv", grid);
  where.write("scattered.csv", scattered);
  for (const auto& [predictor, exactness] : std::vector<std::pair<std::string, double>>{
           {R"({"runs_csv": "grid.csv", "interpolation": "cubic", "coordinate": "compliance"})",
            3e-4},
           {R"({"runs_csv": ["scattered.csv"], "interpolation": "gaussian-process"})", 2e-3}}) {
    const DamageCase c = case_of(predictor, 1, where);
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
  const DamageCase c = case_of(R"({"runs_csv": "scattered.csv"})", 1, where);
  const fem::Reanalysis reanalysis(c.beam, 3);
  EXPECT_THROW((void)FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 3, {}),
               io::FileError)
      << "no grid";
  where.write("twice.csv", scattered + "0.0251,0.0,1,2,3\n");
  const DamageCase twice =
      case_of(R"({"runs_csv": "twice.csv", "interpolation": "gaussian-process"})", 1, where);
  EXPECT_THROW((void)FrequencyEmulator::train(reanalysis, *twice.emulator, c.kinds[0], 3, {}),
               io::FileError)
      << "one element, one reduction, twice";
}

TEST(FrequencyEmulator, PartsMakeTheWhole) {
  const Workspace where;
  for (const char* predictor :
       {R"({"sites": [1, 7, 20], "multipliers": [0.4, 0.7, 1.0], "holdout": 20})",
        R"({"design": {"kind": "sobol", "runs": [20, 30]}, "holdout": 20})"}) {
    const DamageCase c = case_of(predictor, 2, where);
    const fem::Reanalysis reanalysis(c.beam, 4);
    const auto whole = FrequencyEmulator::train(reanalysis, *c.emulator, c.kinds[0], 4, {});
    std::vector<emulator::TableFile> parts;
    for (const int part : {2, 0, 1}) {
      parts.push_back(
          FrequencyEmulator::run_part(reanalysis, *c.emulator, c.kinds[0], 4, part, 3, {}));
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
}  // namespace wheeltap::apps
