#include "identification/structural/defects/defect_kind.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/support.hpp"
#include "tests/identification/cases.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

// A damage that reduces the stiffness of two adjacent elements by the same share.
const DefectType kTwin = {
    .name = "twin",
    .noun = "twin crack",
    .severity = "reduction",
    .severity_words = "stiffness lost",
    .effect_words = "stiffness lost",
    .percent = true,
    .lower = 0.0,
    .upper = 0.99,
    .bounds_words = "a reduction lies in [0, 0.99)",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place =
        [](const DefectKind&, double location, double severity, fem::Defects& out) {
          out.damages.push_back({std::max(location - 0.05, 0.0), severity});
          out.damages.push_back({location, severity});
        }};

TEST(DefectKind, EveryTypeIsFoundByItsName) {
  for (const DefectType* type : defect_types()) {
    EXPECT_EQ(find_defect_type(type->name), type);
    EXPECT_FALSE(type->severity.empty());
    EXPECT_NE(type->unit, nullptr);
    EXPECT_TRUE(type->place != nullptr || type->place_in_structure != nullptr);
    EXPECT_LT(type->lower, type->upper);
  }
  EXPECT_EQ(find_defect_type("twin"), nullptr);
}

TEST(DefectKind, ElementaryTypesPlaceOneDefect) {
  for (const DefectType* type : defect_types()) {
    if (!type->is_elementary) continue;
    fem::Defects placed;
    type->place(DefectKind{.type = type, .location = inference::Uniform{0.0, 1.0}}, 0.3, 0.2,
                placed);
    ASSERT_EQ(placed.damages.size() + placed.supports.size(), 1U) << type->name;
    EXPECT_EQ(placed.damages.empty() ? placed.supports[0].location : placed.damages[0].location,
              0.3);
  }
}

// A user-defined type works in a complete run without other changes.
TEST(DefectKind, FindsAUserDefinedTypeInABeam) {
  DamageCase damage_case = small_beam(1, {.damages = {{0.425, 0.5}, {0.475, 0.5}}});
  damage_case.kinds[0].type = &kTwin;
  damage_case.kinds[0].name = "twin crack";
  damage_case.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 0.9});
  const auto problem = make_damage_problem(damage_case, {});
  const auto likelihood = problem->problem.likelihood();
  const double at_truth = likelihood->log_likelihood(1, std::vector<double>{0.475, 0.5});
  EXPECT_GT(at_truth, likelihood->log_likelihood(1, std::vector<double>{0.675, 0.5}) + 2.0);
  for (const double r : likelihood->evaluation(1, std::vector<double>{0.675, 0.5}).residuals)
    EXPECT_TRUE(std::isfinite(r));
  std::vector<double> slope(2);
  EXPECT_FALSE(likelihood->gradient(1, std::vector<double>{0.475, 0.5}, slope))
      << "its derivatives are not those of one damage";

  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .warmup = 2000, .draws = 2000});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  EXPECT_EQ(found.models[1].name, "1 twin crack");
  EXPECT_NEAR(found.models[1].find(0, 0, 0)->q50, 0.475, 0.1);
  EXPECT_NEAR(found.models[1].find(0, 0, 1)->q50, 0.5, 0.2);
}

// A member that loses a share of its stiffness over half a metre and gains 100 kg of water for each
// tenth of it.
const DefectType kSoaked = {
    .name = "soaked",
    .noun = "soaked stretch",
    .several = "soaked stretches",
    .severity = "reduction",
    .severity_words = "stiffness lost",
    .effect_words = "stiffness lost",
    .percent = true,
    .lower = 0.0,
    .upper = 0.99,
    .bounds_words = "a reduction lies in [0, 0.99)",
    .unit = [](const DefectKind&) -> std::string_view { return ""; },
    .place_in_structure =
        [](const DefectKind&, const SiteLine::Spot& spot, double severity, StructureEffects& out) {
          out.defects.reductions.push_back(
              {spot.site, std::max(spot.s - 0.25, 0.0), spot.s + 0.25, severity});
          out.defects.masses.push_back({spot.site, spot.s, 1000.0 * severity});
        }};

// The same for a frame, compared with the directly changed frame.
TEST(DefectKind, FindsAUserDefinedTypeInAFrame) {
  const fem::Structure frame = modal::portal(8);
  const fem::Mesh mesh(frame);
  DamageCase damage_case;
  damage_case.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = frame});
  SiteLine line = SiteLine::of_members(mesh, {0, 1, 2});
  const double truth = line.x_of(1, 1.3);
  DefectKind kind{.type = &kSoaked,
                  .name = "soaked stretch",
                  .plural = "soaked stretches",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.9}),
                  .truth = {{.location = truth, .severity = 0.4}}};
  kind.line = std::move(line);
  damage_case.kinds = {kind};
  damage_case.simulation = Simulation{.modes = 4, .cv = 0.002, .seed = 1};
  damage_case.data = simulate(damage_case, 1);

  const auto problem = make_damage_problem(damage_case, {});
  const auto likelihood = problem->problem.likelihood();
  const inference::Evaluation at_truth = likelihood->evaluation(1, std::vector{truth, 0.4});
  const fem::Discretisation changed = fem::changed(
      mesh.discretisation(),
      fem::change_of(mesh, {.reductions = {{1, 1.05, 1.55, 0.4}}, .masses = {{1, 1.3, 400.0}}}));
  const fem::StructureModes modes = fem::structure_modes(changed, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double f = modes.frequencies_hz[static_cast<Eigen::Index>(i)];
    EXPECT_NEAR(at_truth.prediction[i], f, 1e-6 * f) << i;
  }
  EXPECT_GT(at_truth.log_likelihood, likelihood->log_likelihood(0, {}) + 2.0);

  const auto posterior =
      inference::reversible_jump(problem->problem, {.seed = 1, .warmup = 1000, .draws = 1000});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  EXPECT_EQ(found.models[1].name, "1 soaked stretch");
  EXPECT_GT(found.models[1].probability(), 0.9);
}

TEST(DefectKind, RejectsInvalidCasesNamingThePart) {
  const auto refusal = [](DamageCase damage_case) -> std::pair<InvalidInput::Part, std::string> {
    try {
      (void)make_damage_problem(std::move(damage_case), {});
    } catch (const InvalidInput& error) {
      return {error.part(), error.what()};
    }
    return {InvalidInput::Part::model, "accepted"};
  };
  DamageCase outside = small_beam(1);
  outside.kinds[0].location = inference::Uniform{0.0, 1.5};
  EXPECT_EQ(refusal(outside).first, InvalidInput::Part::location);
  EXPECT_EQ(refusal(outside).second, "locations lie on the beam, in [0, 1] m");
  DamageCase rigid = small_beam(1);
  rigid.kinds[0].severity = DefectKind::Rigid{};
  EXPECT_EQ(refusal(rigid).first, InvalidInput::Part::severity);
  DamageCase no_sd = small_beam(1);
  no_sd.data.sd_hz.clear();
  EXPECT_EQ(refusal(no_sd).first, InvalidInput::Part::data);
  DamageCase certain = small_beam(1);
  certain.data.sd_hz[2] = 0.0;
  EXPECT_EQ(refusal(certain).second, "mode 3: a standard deviation of 0 Hz, must be positive");
  DamageCase broken = small_beam(1);
  broken.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 1.5});
  EXPECT_EQ(refusal(broken).first, InvalidInput::Part::severity);
  DamageCase negative = small_beam(1);
  negative.kinds[0].weights = {1.5, -0.5};
  EXPECT_EQ(refusal(negative).second, "a weight of -0.5: must be >= 0");
  DamageCase nothing = small_beam(1);
  nothing.kinds.clear();
  EXPECT_EQ(refusal(nothing).second, "has no kind of defect: needs at least one");
}

}  // namespace
}  // namespace wheeltap::identification
