// The answer of a report for every kind of finding.
#include "apps/text/answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/defects/support.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

Marginal row(double low, double middle, double high) {
  return {.mean = middle, .sd = 0.1, .q2_5 = low, .q50 = middle, .q97_5 = high};
}

struct MadeUp {
  DamageCase damage_case;
  DamageFindings findings;

  Marginal& location(std::size_t model, std::size_t n) {
    return findings.models[model].parameters[2 * n].estimate;
  }
};

DefectKind kind(const DefectType& type) {
  DefectKind out{.type = &type,
                 .name = std::string(type.noun),
                 .plural = std::string(type.noun) + "s",
                 .weights = {},
                 .location = inference::Uniform{0.0, 1.0},
                 .severity = inference::Prior(inference::Uniform{0.0, 0.9}),
                 .truth = {}};
  return out;
}

// 0, 1, 2 … damages with these probabilities, the first two near .095 and .425.
MadeUp damage_run(const std::vector<double>& probabilities) {
  MadeUp run;
  run.damage_case.beam.length = 1.0;
  run.damage_case.kinds = {kind(defects::kReduction)};
  run.findings.sampling.verdict.converged = true;
  const std::vector<std::pair<Marginal, Marginal>> places = {
      {row(0.082, 0.095, 0.108), row(0.15, 0.28, 0.44)},
      {row(0.41, 0.425, 0.44), row(0.55, 0.6, 0.64)}};
  for (std::size_t n = 0; n < probabilities.size(); ++n) {
    ModelFinding model{.name = std::to_string(n) + (n == 1 ? " damage" : " damages"),
                       .counts = {static_cast<int>(n)},
                       .standing = {.probability = probabilities[n]},
                       .parameters = {}};
    for (std::size_t i = 0; i < n; ++i) {
      const int component = static_cast<int>(i);
      model.parameters.push_back({{"location", "location", 0, component, 0}, places[i].first});
      model.parameters.push_back({{"reduction", "reduction", 0, component, 1}, places[i].second});
    }
    run.findings.models.push_back(std::move(model));
  }
  return run;
}

Answer answer(const MadeUp& run) {
  return apps::answer(run.damage_case, run.findings);
}

TEST(Answer, NoDamage) {
  const Answer a = answer(damage_run({0.93, 0.05, 0.02}));
  EXPECT_EQ(a.headline, "Most likely no damage (93 %).");
  EXPECT_THAT(a.detail, HasSubstr("Probability of at least one defect: 7 %."));
  EXPECT_THAT(a.detail, Not(HasSubstr("0.095")));
  EXPECT_THAT(a.caution, IsEmpty());
}

TEST(Answer, AProbabilityOfTheEvidenceIsCalledThat) {
  MadeUp run = damage_run({0.75, 0.25, 0.0});
  run.findings.models[0].standing.basis = inference::Basis::evidence;
  EXPECT_EQ(answer(run).headline, "Most likely no damage (75 %, by its evidence).");
}

TEST(Answer, OneDamageWithItsInterval) {
  const Answer a = answer(damage_run({0.0, 0.75, 0.25}));
  EXPECT_EQ(a.headline, "Most likely one damage (75 %).");
  EXPECT_EQ(a.detail,
            "Near 0.095 m (95 % interval 0.082 to 0.108 m), stiffness reduced by 28 % (15 to 44 "
            "%).");
}

TEST(Answer, NearCertaintyIsNotCalledLikely) {
  EXPECT_EQ(answer(damage_run({0.0, 0.98, 0.02})).headline, "One damage (98 %).");
}

TEST(Answer, SeveralDamages) {
  const Answer a = answer(damage_run({0.0, 0.1, 0.9}));
  EXPECT_EQ(a.headline, "Most likely two damages (90 %).");
  EXPECT_THAT(a.detail, StartsWith("(1) near 0.095 m"));
  EXPECT_THAT(a.detail, HasSubstr("; (2) near 0.425 m"));
}

TEST(Answer, UndecidedCountNamesAllThatCount) {
  const Answer a = answer(damage_run({0.02, 0.52, 0.46}));
  EXPECT_EQ(a.headline, "Undecided: the data allow one damage (52 %) or two damages (46 %).");
  EXPECT_THAT(a.detail, StartsWith("If one damage: "));
}

TEST(Answer, MirrorImagesAreBothNamed) {
  MadeUp run = damage_run({0.0, 0.75, 0.25});
  run.findings.symmetry = SymmetryFinding{.center = 0.5, .emulated = false, .chains = {}};
  EXPECT_THAT(answer(run).detail, HasSubstr("or at its mirror image 0.905 m"));
  EXPECT_THAT(answer(run).detail, HasSubstr("cannot distinguish a location from its mirror image"));
}

TEST(Answer, MidspanIsItsOwnMirrorImage) {
  MadeUp run = damage_run({0.0, 0.9, 0.1});
  run.findings.symmetry = SymmetryFinding{.center = 0.5, .emulated = false, .chains = {}};
  run.location(1, 0) = row(0.49, 0.499, 0.5);
  EXPECT_THAT(answer(run).detail, Not(HasSubstr("mirror image 0.5")));
}

TEST(Answer, WideLocationIsNotCalledLocated) {
  MadeUp run = damage_run({0.0, 0.9, 0.1});
  run.location(1, 0) = row(0.1, 0.4, 0.8);
  EXPECT_THAT(answer(run).detail, StartsWith("Not located: anywhere from 0.100 to 0.800 m"));
}

TEST(Answer, NotConvergedComesFirst) {
  MadeUp run = damage_run({0.0, 0.75, 0.25});
  run.findings.sampling.verdict.converged = false;
  const Answer a = answer(run);
  EXPECT_THAT(a.caution, HasSubstr("do not trust these numbers yet"));
  EXPECT_EQ(a.headline, "So far: Most likely one damage (75 %).");
}

// Fault: a friction damper fitted with R² -0.28 was "viscous (> 99.9 %)".
TEST(Answer, MisfitComesBeforeTheWinner) {
  Findings findings;
  findings.sampling.verdict.converged = true;
  for (const char* name : {"viscous", "linear"}) {
    findings.models.push_back({.name = name});
    findings.models.back().standing.probability = findings.models.size() == 1 ? 1.0 : 0.0;
  }
  findings.fit_verdict.why = {misfit::Unexplained{"force", -0.28}};
  Answer a = apps::answer(findings);
  EXPECT_EQ(a.headline,
            "None of these models explains the record (R² -0.28 for \"force\"). Best model: "
            "“viscous” (> 99.9 %).");
  EXPECT_TRUE(a.misfit);
  findings.sampling.verdict.converged = false;  // was "…: So far: …"
  EXPECT_THAT(apps::answer(findings).headline,
              HasSubstr(". Best model so far: “viscous” (> 99.9 %)."));
  findings.sampling.verdict.converged = true;
  findings.models.pop_back();
  a = apps::answer(findings);
  EXPECT_EQ(a.headline, "“viscous” does not explain the record (R² -0.28 for \"force\").");
  findings.fit_verdict.why.clear();
  EXPECT_FALSE(apps::answer(findings).misfit);
}

// Fault: a beam of 600 (mm) was "undecided, 65.1 %"; noise of 20 % (for 0.2 %) was not reported.
TEST(Answer, FrequenciesThatNothingExplainsComeFirst) {
  MadeUp run = damage_run({0.349, 0.651});
  run.findings.fit_verdict.why = {misfit::BeyondNoise{0.0, {1, 2}, false}};
  EXPECT_THAT(answer(run).headline,
              StartsWith("No number of damages that the case allows explains the frequencies "
                         "(predictive p < 1e-15). Best model: One damage (65.1 %)."));
  // Chains that disagree may have missed the damages.
  run.findings.fit_verdict.why = {misfit::BeyondNoise{0.0, {1, 2}, false, false}};
  EXPECT_THAT(answer(run).headline,
              StartsWith("The draws so far do not explain the frequencies (predictive p < 1e-15), "
                         "and the Markov chains disagree. Best model: One damage (65.1 %)."));
  run.findings.fit_verdict.why = {misfit::WithinNoise{0.99999998, 0.2}};
  EXPECT_THAT(answer(run).headline, StartsWith("The frequencies fit more closely than the stated "
                                               "noise of 20 % allows (predictive p > 0.9999)."));
}

TEST(Answer, AParameterThatRepeatsItsPriorIsMarked) {
  Findings findings;
  findings.sampling.verdict.converged = true;
  findings.models = {{.name = "linear", .standing = {.probability = 1.0}}};
  findings.models[0].parameters = {
      {.unknown = {"k", "k"}, .estimate = row(1.0, 2.0, 3.0), .prior_overlap = 0.95}};
  EXPECT_THAT(apps::answer(findings).detail, HasSubstr("k = 2 (1 to 3, nearly its prior)"));
}

TEST(Answer, SupportsHaveTheirOwnWords) {
  MadeUp run = damage_run({0.0, 1.0});
  run.damage_case.kinds = {kind(defects::kSupport)};
  run.damage_case.kinds[0].severity = DefectKind::Rigid{};
  run.findings.models[1].parameters = {
      {{"location", "location[1]", 0, 0, 0}, row(0.07, 0.079, 0.087)}};
  const Answer a = answer(run);
  EXPECT_EQ(a.headline, "One support (> 99.9 %).");
  EXPECT_EQ(a.detail, "Near 0.079 m (95 % interval 0.070 to 0.087 m).");
}

TEST(Answer, TwoKindsInOneModel) {
  MadeUp run = damage_run({0.1, 0.9});
  run.damage_case.kinds = {kind(defects::kReduction), kind(defects::kSupport)};
  run.findings.models[0].counts = {0, 0};
  run.findings.models[1].counts = {2, 1};
  run.findings.models[1].parameters.clear();
  EXPECT_EQ(answer(run).headline, "Most likely two damages and one support (90 %).");
}

// A kind with any name keeps its severity. Fault: a bearing beside cracks had the reduction of the
// crack.
TEST(Answer, AKindCalledAnythingHasItsOwnSeverity) {
  MadeUp run = damage_run({0.1, 0.9});
  run.damage_case.kinds = {kind(defects::kReduction), kind(defects::kSupport)};
  run.damage_case.kinds[0].name = "crack";
  run.damage_case.kinds[1].name = "bearing";
  run.findings.models[1].counts = {1, 1};
  run.findings.models[1].parameters = {
      {{"location", "crack location[1]", 0, 0, 0}, row(0.082, 0.095, 0.108)},
      {{"reduction", "reduction[1]", 0, 0, 1}, row(0.15, 0.28, 0.44)},
      {{"location", "bearing location[1]", 1, 0, 0}, row(0.41, 0.425, 0.44)},
      {{"stiffness", "stiffness[1]", 1, 0, 1}, row(900, 1000, 1100)}};
  EXPECT_THAT(answer(run).detail,
              HasSubstr("(1) crack near 0.095 m (95 % interval 0.082 to 0.108 m), "
                        "stiffness reduced by 28 %"));
  EXPECT_THAT(answer(run).detail,
              HasSubstr("(2) bearing near 0.425 m (95 % interval 0.410 to 0.440 "
                        "m), stiffness 1000 N/m (900 to 1100)."));
}

TEST(Answer, EquationOfMotion) {
  Findings found;
  found.sampling.verdict.converged = true;
  found.models.push_back({.name = "linear", .standing = {.probability = 0.18}});
  found.models.push_back({.name = "duffing", .standing = {.probability = 0.82}});
  found.models[1].parameters = {{{"k", "k"}, row(47.6, 51.4, 55.2)}};
  found.models[1].parameters[0].unknown.unit = "N/m";
  const Answer a = apps::answer(found);
  EXPECT_EQ(a.headline, "Most likely “duffing” (82 %).");
  EXPECT_EQ(a.detail, "With 95 % intervals: k = 51.4 N/m (47.6 to 55.2).");
}

TEST(Answer, SweepSaysWhereTheChoiceChanges) {
  const auto at = [](const char* value, double p, bool converged) {
    SweepRow row{.value = value, .models = {}, .converged = converged};
    row.models.push_back({.name = "linear", .standing = {.probability = 1.0 - p}});
    row.models.push_back({.name = "duffing", .standing = {.probability = p}});
    return row;
  };
  const Answer a =
      apps::answer("/record/samples/1",
                   {at("100.0", 0.3, true), at("200.0", 0.4, true), at("300.0", 0.8, false)});
  EXPECT_EQ(a.headline,
            "Most probable over /record/samples/1: “linear” from 100.0 to 200.0 and “duffing” at "
            "300.0.");
  EXPECT_THAT(a.caution, StartsWith("1 of 3 runs have not converged"));
}

// A summary of an older version has no answer: models in the order of their probability.
TEST(Answer, OfAnOlderSummaryNamesTheModels) {
  const Report older = {{"wheeltap", {{"command", "damage"}, {"case", Report::object()}}},
                        {"models",
                         {{{"name", "1 damage"}, {"probability", 0.3}},
                          {{"name", "2 damages"}, {"probability", 0.7}}}},
                        {"parameters", Report::object()},
                        {"diagnostics", {{"converged", true}}}};
  EXPECT_EQ(read_answer(older).headline, "Most likely 2 damages (70 %).");
  const Report kept = {{"answer", json(Answer{"c", "h", "d"})}};
  EXPECT_EQ(read_answer(kept).detail, "d");
}

TermFinding term(const std::string& name, double inclusion, int a = 0, int b = 1) {
  return {.label = name, .name = name, .a = a, .b = b, .inclusion = inclusion};
}

TEST(Answer, OfADiscoverySaysWhichTermsALinkHas) {
  SidFindings run;
  run.models.resize(8);
  run.models[0].name = "linear";
  run.models[0].standing.probability = 1.0;
  run.sampling.verdict.converged = true;
  run.discovery.terms = {term("quadratic", 0.98), term("cubic", 0.9999), term("coulomb", 0.03),
                         term("bouc_wen", 0.4)};
  run.discovery.terms[1].parameters = {
      {.unknown = {.name = "cubic", .label = "cubic", .unit = "N/m^3"},
       .estimate = row(990.0, 1000.0, 1012.0)}};
  const Answer a = apps::answer(run);
  EXPECT_EQ(a.headline,
            "The link 0-1 has cubic (> 99.9 %) and quadratic (98 %) as terms; undecided: bouc wen "
            "(40 %); no evidence for coulomb (3 %).");
  EXPECT_EQ(a.detail, "With 95 % intervals: cubic = 1000 N/m^3 (990 to 1012).");
  run.discovery.terms = {term("cubic", 0.01), term("cubic", 0.95, 1, 2)};
  run.sampling.verdict.converged = false;
  EXPECT_EQ(apps::answer(run).headline,
            "So far: The link 0-1 needs none of the terms; no evidence for cubic (1 %). The link "
            "1-2 has cubic (95 %) as a term.");
  EXPECT_FALSE(apps::answer(run).caution.empty());
  run.sampling.verdict.converged = true;
  run.fit_verdict.why = {misfit::Unexplained{"force", -0.28}};
  EXPECT_EQ(
      apps::answer(run).headline.find("No subset of these terms explains the record (R² -0.28"),
      0U);
  EXPECT_TRUE(apps::answer(run).misfit);
}

}  // namespace
}  // namespace wheeltap::apps
