#include "identification/emulation/interpolants.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/identification/cases.hpp"

namespace wheeltap::identification {
namespace {

using emulator::InterpolantType;
using emulator::RowMatrix;
using testing::HasSubstr;

// The responses of the nearest run, with every range mapped to [0, 1].
class NearestRun final : public emulator::Interpolant {
 public:
  explicit NearestRun(const emulator::Table& table)
      : design_(table.design()), values_(table.values) {}
  void evaluate(std::span<const double> x, std::span<double> out) const override {
    emulator::require_inside(design_.factors, x);
    double least = std::numeric_limits<double>::infinity();
    Eigen::Index nearest = 0;
    for (Eigen::Index run = 0; run < design_.runs(); ++run) {
      double distance = 0.0;
      for (std::size_t j = 0; j < x.size(); ++j) {
        const emulator::Factor& f = design_.factors[j];
        distance += std::pow((x[j] - design_.point(run)[j]) / (f.high() - f.low()), 2);
      }
      if (distance < least) {
        least = distance;
        nearest = run;
      }
    }
    std::ranges::copy(values_.row(nearest), out.begin());
  }
  [[nodiscard]] bool contains(std::span<const double> x) const override {
    return emulator::contains(design_.factors, x);
  }

 private:
  emulator::Design design_;
  RowMatrix values_;
};

constexpr InterpolantType nearest_run(InterpolantType::Runs runs) {
  return {.name = "nearest-run",
          .words = "nearest run",
          .runs = runs,
          .train = [](emulator::Table& table, const emulator::TrainingOptions&)
              -> std::unique_ptr<const emulator::Interpolant> {
            return std::make_unique<NearestRun>(table);
          }};
}
constexpr InterpolantType kOnGrids = nearest_run(InterpolantType::Runs::grid);
constexpr InterpolantType kScattered = nearest_run(InterpolantType::Runs::scattered);

DamageCase emulated_beam(const EmulatorSpec& spec) {
  DamageCase out = small_beam(1, {.damages = {{0.325, 0.6}}, .supports = {}});
  out.emulator = spec;
  return out;
}

EmulatorSpec every_tenth_of_a_reduction() {
  EmulatorSpec spec;
  spec.interpolant = &kOnGrids;
  spec.sites.emplace_back();
  for (int site = 0; site < 20; ++site) spec.sites[0].push_back(site);
  for (int level = 0; level <= 9; ++level) spec.reductions.push_back(0.1 * level);
  spec.reductions.back() = 0.9;
  spec.holdout = 50;
  return spec;
}

TEST(Interpolants, EveryTypeIsFoundByItsNameAndTrained) {
  std::set<std::string_view> names;
  for (const InterpolantType* type : interpolant_types()) {
    EXPECT_EQ(find_interpolant_type(type->name), type);
    EXPECT_TRUE(names.insert(type->name).second) << type->name << " occurs twice";
    EXPECT_FALSE(type->words.empty());
    EXPECT_GE(type->most_factors, 2U) << "a damage has two";
    ASSERT_NE(type->train, nullptr);
#ifndef WHEELTAP_WITH_CGAL
    if (type->name == "delaunay") continue;
#endif
    const bool grid = type->runs == InterpolantType::Runs::grid;
    emulator::Table table;
    table.factors = {{"x", "m", {0.0, 0.3, 0.7, 1.0}}, {"r", "", {0.0, 0.2, 0.6}}};
    table.response_name = "frequency";
    emulator::Design design =
        grid ? emulator::full_factorial(table.factors)
             : emulator::with_corners(emulator::latin_hypercube(table.factors, 12, 1));
    table.values = RowMatrix(design.runs(), 2);
    for (Eigen::Index i = 0; i < design.runs(); ++i) {
      const auto x = design.point(i);
      table.values.row(i) << 1.0 + x[0] - x[1], std::sin(x[0]) * x[1];
    }
    if (!grid) table.points = design.points;
    const auto made = type->train(table, {.waves = {true, false}});
    double out[2], variance[2];
    for (Eigen::Index i = 0; i < design.runs(); ++i) {
      made->evaluate(design.point(i), out);
      EXPECT_NEAR(out[0], table.values(i, 0), 1e-6) << type->name;
      EXPECT_NEAR(out[1], table.values(i, 1), 1e-6) << type->name;
    }
    const std::vector<double> inside = {0.5, 0.3}, outside = {0.5, 0.7};
    EXPECT_TRUE(made->contains(inside));
    EXPECT_FALSE(made->contains(outside));
    EXPECT_THROW(made->evaluate(outside, out), std::out_of_range);
    if (type->has_variance) {
      made->evaluate(inside, out, variance);
      EXPECT_GE(variance[0], 0.0);
      EXPECT_EQ(made->leave_one_out().mean.rows(), design.runs());
    } else {
      EXPECT_THROW(made->evaluate(inside, out, variance), std::logic_error);
      EXPECT_EQ(made->leave_one_out().mean.rows(), 0);
    }
  }
  EXPECT_EQ(find_interpolant_type("nearest-run"), nullptr);
  EXPECT_EQ(interpolant_names(InterpolantType::Runs::grid),
            "\"multilinear\", \"cubic\" and \"monotone-cubic\"");
}

// A user-defined type works in training, a file and a complete run without other changes.
TEST(Interpolants, AUserDefinedTypePredictsABeam) {
  const DamageCase damage_case = emulated_beam(every_tenth_of_a_reduction());
  const auto problem = make_damage_problem(damage_case, {});
  const FrequencyEmulator& made = *problem->emulator;
  EXPECT_EQ(made.describe(1), "nearest run in r, 20 sites x 10 levels");
  EXPECT_FALSE(made.is_slow());
  EXPECT_TRUE(made.error(1).leave_one_out.empty());
  EXPECT_GT(made.error(1).holdout[0].rmse, 0.0);

  const test::TemporaryDirectory where;
  made.save(where / "t.nc", {});
  const InterpolantType* const mine[] = {&kOnGrids};
  const auto read = FrequencyEmulator::load(where / "t.nc", damage_case.beam, 1, 4, mine);
  std::vector<double> a(4), b(4), u(4), v(4);
  const std::vector<fem::Damage> damage = {{0.41, 0.33}};
  made.evaluate(damage, a, u);
  read.evaluate(damage, b, v);
  EXPECT_EQ(a, b);
  EXPECT_EQ(u, v);
  try {
    (void)FrequencyEmulator::load(where / "t.nc", damage_case.beam, 1, 4);
    ADD_FAILURE() << "the program's list does not have this interpolant";
  } catch (const io::FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("interpolation \"nearest-run\" is unknown"));
  }

  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .warmup = 2000, .draws = 2000});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  EXPECT_NEAR(found.models[1].find(0, 0, 0)->q50, 0.325, 0.1);
  EXPECT_NEAR(found.models[1].find(0, 0, 1)->q50, 0.6, 0.2);
}

TEST(Interpolants, AUserDefinedTypeWorksForScatteredRunsAndGrids) {
  EmulatorSpec spec;
  spec.interpolant = &kScattered;
  spec.runs = EmulatorSpec::Runs::sobol;
  spec.design_runs = {200};
  spec.holdout = 50;
  const DamageCase loose = emulated_beam(spec);
  const fem::Reanalysis reanalysis(loose.beam, 4);
  const auto made = FrequencyEmulator::train(reanalysis, *loose.emulator, loose.kinds[0], 4, {});
  EXPECT_EQ(made.describe(1), "nearest run in r");

  EmulatorSpec grid = every_tenth_of_a_reduction();
  grid.accuracy = 0.05;
  const auto refined = FrequencyEmulator::train(reanalysis, grid, loose.kinds[0], 4, {});
  EXPECT_GT(refined.runs(1), 200) << "steps need many levels";
}

}  // namespace
}  // namespace wheeltap::identification
