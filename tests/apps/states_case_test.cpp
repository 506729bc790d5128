// Cases with damage, unknown coefficients and several states.
#include "apps/cases/states_case.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/update_case.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using namespace identification;
using nlohmann::json;
using testing::HasSubstr;

/// Two storeys; the stiffness of the lower is unknown: 1400 N/m in truth, a quarter less in the
/// damaged state.
json two_storeys() {
  return json::parse(R"({"kind": "damage", "title": "Two storeys",
    "structure": {"chain": {"masses": [2, 1], "links": [
      {"name": "storey 1", "between": [0, 1], "stiffness": "k"},
      {"name": "storey 2", "between": [1, 2], "stiffness": 900}]}},
    "parameters": {"k": {"log_normal": [7.17, 0.3]}},
    "baseline": {"data": {"frequencies": [3.0880, 6.5110], "cov": 0.01}},
    "data": {"frequencies": [2.7566, 6.3163], "cov": 0.01},
    "damage": {"kind": "storey", "count": {"min": 0, "max": 1},
               "reduction": {"uniform": [0, 0.9]}}})");
}

json run(const Workspace& where, const json& c, const std::string& command, std::string& out) {
  const Outcome ran =
      wheeltap(where, command + " " + where.write_json("c.json", c).string() + " -o " +
                          (where / "out").string() + " --quiet --warmup 600 --draws 600");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  out = ran.out;
  return json::parse(read_all(where / "out/summary.json"));
}

TEST(StatesCase, UnknownStiffnessBesideDamage) {
  const Workspace where;
  std::string out;
  const json summary = run(where, two_storeys(), "damage", out);
  const json& k = summary["baseline"]["parameters"]["k"];
  EXPECT_NEAR(k["posterior"]["mean"].get<double>(), 1400.0, 150.0);
  EXPECT_GT(k["contraction"], 0.8);
  EXPECT_EQ(k["at_prior"], false);
  EXPECT_THAT(k["prior"].get<std::string>(), HasSubstr("log"));
  EXPECT_EQ(summary["baseline"]["states"][0]["name"], "healthy");
  EXPECT_EQ(summary["baseline"]["states"][1]["damaged"], true);
  EXPECT_LT(summary["baseline"]["check"]["largest_error"], 1e-6);
  EXPECT_GT(summary["models"][1]["probability"], 0.9);
  EXPECT_GT(summary["damage"]["inclusion_by_member"]["storey 1"], 0.5);
  ASSERT_EQ(summary["data"]["modes"].size(), 4U);
  EXPECT_EQ(summary["data"]["modes"][3]["state"], "damaged");
  EXPECT_EQ(summary["data"]["modes"][3]["mode_of_state"], 2);
  EXPECT_TRUE(summary["parameters"]["1 soft storey"].contains("k"));
  EXPECT_EQ(summary["unknowns"]["1 soft storey"][0]["prior"], "/parameters/k");
  EXPECT_THAT(out, HasSubstr("The intact structure"));
  EXPECT_THAT(out, HasSubstr("with full solutions at"));
  EXPECT_THAT(read_all(where / "out/report.html"), HasSubstr("baselineTable"));
}

// Independent stiffness errors of links: their scatter is inferred and reported.
TEST(StatesCase, HowFarTheModelIsOffIsInferred) {
  const Workspace where;
  json c = two_storeys();
  c["structure"]["chain"]["links"][0]["stiffness"] = 1300;
  c.erase("parameters");
  for (json* data : {&c["data"], &c["baseline"]["data"]})
    (*data)["discrepancy"] = {{"stiffness", {{"log_uniform", {0.01, 0.5}}}}};
  std::string out;
  const json summary = run(where, c, "damage", out);
  EXPECT_THAT(out, HasSubstr("Inferred standard deviation of the model error: stiffnesses of "));
  EXPECT_THAT(summary["baseline"]["model_error"].get<std::string>(), HasSubstr("members or links"));
  EXPECT_EQ(summary["unknowns"]["1 soft storey"][0]["prior"], "/data/discrepancy/stiffness");
  // Replicates include it: they scatter by more than the 1 % measurement error of the frequencies.
  const io::NetcdfReader file =
      io::NetcdfReader(read_all(where / "out/posterior.nc"), "posterior.nc", "a posterior");
  const auto replicates = file.read(*file.group("posterior_predictive"), "frequency");
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (std::size_t i = 1; i < replicates.values.size(); i += 4) {
    const double f = replicates.values[i];
    sum += f, squares += f * f, ++n;
  }
  EXPECT_GT(std::sqrt(squares / n - sum * sum / n / n), 0.02 * sum / n);
  // The first link is 8 % stiffer than in the model.
  const json& sd = summary["parameters"]["1 soft storey"]["stiffness_discrepancy"];
  EXPECT_GT(sd["q97.5"].get<double>(), 0.08);
}

// Without a healthy measurement a damaged storey and a low stiffness are indistinguishable.
TEST(StatesCase, WhatCannotBeToldApartIsSaid) {
  const Workspace where;
  json c = two_storeys();
  c.erase("baseline");
  c["data"]["cov"] = 0.002;
  c["damage"]["on"] = {"storey 1"};
  c["damage"]["count"] = {{"min", 1}, {"max", 1}};
  c["parameters"]["k"] = {{"log_normal", {7.17, 1.0}}};
  std::string out;
  const json summary = run(where, c, "damage", out);
  ASSERT_FALSE(summary["baseline"]["hides_damage"].empty());
  EXPECT_EQ(summary["baseline"]["hides_damage"][0]["parameter"], "k");
  EXPECT_THAT(summary["diagnostics"]["warnings"].dump(),
              HasSubstr("are not identifiable separately (correlation"));
}

TEST(StatesCase, TheDryRunSaysWhatALikelihoodCosts) {
  const Workspace where;
  const Outcome ran = wheeltap(
      where, "damage " + where.write_json("c.json", two_storeys()).string() + " --dry-run");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr(" ms each"));
}

// Unknown E of a beam: scaling healthy and damaged frequencies by the same factor changes neither
// the damage nor its mirror image.
TEST(StatesCase, ABeamOfUnknownE) {
  const Workspace where;
  json c = small_case();
  const auto intact = parse_damage_case(read_case(where.write_json("b.json", c))).damage.beam;
  auto healthy = elastic_frequencies(intact, {}, 5);
  auto damaged = elastic_frequencies(intact, {.damages = {{0.33, 0.4}}}, 5);
  for (auto* list : {&healthy, &damaged})
    for (double& f : *list) f *= std::sqrt(1.1);
  c["beam"]["material"]["young"] = "E";
  c["parameters"]["E"] = {{"log_normal", {std::log(70e9), 0.1}}};
  c["baseline"]["data"] = {{"frequencies", healthy}, {"cov", 0.001}};
  c["data"] = {{"frequencies", damaged}, {"cov", 0.001}};
  c["damage"]["count"] = {{"min", 0}, {"max", 1}};
  std::string out;
  const json summary = run(where, c, "damage", out);
  EXPECT_NEAR(summary["baseline"]["parameters"]["E"]["posterior"]["mean"].get<double>() / 77e9, 1.0,
              0.005);
  EXPECT_GT(summary["models"][1]["probability"], 0.99);
  EXPECT_TRUE(summary["damage"].contains("folded"));
  const json& r = summary["parameters"]["1 damage"]["reduction[1]"];
  EXPECT_LT(r["q2.5"], 0.4);
  EXPECT_GT(r["q97.5"], 0.4);
  // An unknown spring at one end breaks the symmetry.
  c["beam"]["supports"] = json::parse(R"([{"at": 0, "fix": ["deflection"]},
    {"at": 1.0, "fix": ["deflection"]}, {"at": 1.0, "fix": ["rotation"], "stiffness": "s"}])");
  c["parameters"]["s"] = {{"log_uniform", {0.1, 100}}};
  const DamageCase sprung = parse_damage_case(read_case(where.write_json("s.json", c))).damage;
  EXPECT_TRUE(sprung.states()->tells_sides());
  const auto at = [&](double s) {
    const AnyStructure any = sprung.states()->model->at(std::vector<double>{70e9, s});
    return std::get<fem::Structure>(any).supports[2].stiffness[5];
  };
  EXPECT_EQ(at(3.0), 3.0);
}

/// The parsed states of the case.
ObservedStates states_of(const Workspace& where, const json& c) {
  return *parse_damage_case(read_case(where.write_json("c.json", c))).damage.states();
}

TEST(StatesCase, StatesInheritWhatTheyDoNotSay) {
  const Workspace where;
  json c = two_storeys();
  c["baseline"]["data"] = json::parse(R"({"cov": 0.01, "states": [
    {"name": "empty", "frequencies": [3.0, 6.4]},
    {"frequencies": [2.5, 6.0], "sd": [0.02, 0.03], "masses": [{"node": 2, "mass": 0.5}]}]})");
  const ObservedStates states = states_of(where, c);
  ASSERT_EQ(states.list.size(), 3U);
  EXPECT_EQ(states.list[0].name, "empty");
  EXPECT_EQ(states.list[1].name, "healthy 2");
  EXPECT_NEAR(states.list[0].data.covariance(0, 0), 9e-4, 1e-12);
  EXPECT_NEAR(states.list[1].data.covariance(1, 1), 9e-4, 1e-12);
  ASSERT_EQ(states.list[1].masses.size(), 1U);
  EXPECT_EQ(states.list[1].masses[0].motion.dofs, std::vector<int>{1});
  EXPECT_TRUE(states.list[2].damaged);
  EXPECT_FALSE(states.list[1].damaged);
}

// An update with a regression on temperature and known coefficients in the states.
TEST(StatesCase, AnUpdateOfSeveralStates) {
  const Workspace where;
  json c = json::parse(R"({"kind": "update", "title": "Storeys",
    "structure": {"chain": {"masses": [2, 1, "water"], "links": [
      {"between": [0, 1], "stiffness": "k"}, {"between": [1, 2], "stiffness": 900},
      {"between": [2, 3], "stiffness": 700}]}},
    "parameters": {"k": {"log_normal": [7.17, 0.3]}},
    "temperature": {"stiffness_per_kelvin": {"normal": [0, 1e-3]}, "reference": 10},
    "data": {"cov": 0.0005, "states": []}})");
  // Truth: k 1400, stiffness decreases by 4e-4 per kelvin.
  const auto frequencies = [&](double water, double temperature) {
    json truth = json::parse(R"({"kind": "update", "parameters": {},
      "structure": {"chain": {"masses": [2, 1, 1], "links": [
        {"between": [0, 1], "stiffness": 1400}, {"between": [1, 2], "stiffness": 900},
        {"between": [2, 3], "stiffness": 700}]}}})");
    truth["structure"]["chain"]["masses"][2] = water;
    truth["kind"] = "damage";
    truth.erase("parameters");
    const Outcome ran =
        wheeltap(where, "modes --json --modes 3 " + where.write_json("t.json", truth).string());
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    auto f = json::parse(ran.out)["frequencies_hz"].get<std::vector<double>>();
    for (double& x : f) x *= std::sqrt(1.0 - 4e-4 * (temperature - 10.0));
    return f;
  };
  for (const auto& [water, temperature] :
       std::vector<std::pair<double, double>>{{0.5, -15}, {1.0, 10}, {1.5, 30}, {0.8, 25}})
    c["data"]["states"].push_back({{"known", {{"water", water}}},
                                   {"temperature", temperature},
                                   {"frequencies", frequencies(water, temperature)}});
  const auto held_out = frequencies(1.2, 0);
  c["data"]["states"].push_back({{"name", "full"},
                                 {"known", {{"water", 1.2}}},
                                 {"temperature", 0},
                                 {"predict", {held_out[0], held_out[1]}}});
  std::string out;
  const json summary = run(where, c, "update", out);
  const json& estimates = summary["parameters"]["the structure"];
  EXPECT_NEAR(estimates["k"]["mean"].get<double>(), 1400.0, 5.0);
  EXPECT_NEAR(estimates["stiffness_per_kelvin"]["mean"].get<double>(), -4e-4, 4e-5);
  ASSERT_EQ(summary["predictions"].size(), 2U);
  EXPECT_EQ(summary["predictions"][0]["state"], "full");
  EXPECT_EQ(summary["predictions"][0]["inside"], true);
  EXPECT_NEAR(summary["predictions"][1]["frequency_hz"]["q50"].get<double>() / held_out[1], 1.0,
              1e-3);
}

// Fault: the message on a known mass of -2.5 named a prior that is not in the case.
TEST(StatesCase, KnownValuesOutOfRangeAreErrorsOfTheirState) {
  const Workspace where;
  json c = json::parse(R"({"kind": "update",
    "structure": {"chain": {"masses": ["m"], "links": [{"between": [0, 1], "stiffness": "k"}]}},
    "parameters": {"k": {"log_normal": [7.17, 0.3]}},
    "data": {"cov": 0.01, "states": [{"known": {"m": 2}, "frequencies": [4]},
                                     {"known": {"m": -2.5}, "frequencies": [5]}]}})");
  const auto said = [&](double mass) -> std::string {
    c["data"]["states"][1]["known"]["m"] = mass;
    try {
      static_cast<void>(parse_update_case(read_case(where.write_json("c.json", c))));
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::bad_input);
      return failure.what();
    }
    return "";
  };
  for (const double mass : {-2.5, 0.0})
    EXPECT_THAT(said(mass), HasSubstr("/data/states/1/known/m: " + json(mass).dump() +
                                      ": must be positive: it is the value of "
                                      "/structure/chain/masses/0"));
  EXPECT_EQ(said(1.5), "");
}

// Parameters may set node positions.
TEST(StatesCase, PlacesOfNodes) {
  const Workspace where;
  const json c = json::parse(R"({"kind": "update",
    "parameters": {"E": {"log_normal": [26, 0.1]}},
    "structure": {"materials": {"m": {"young": "E", "poisson": 0.3, "density": 7800}},
      "sections": {"s": {"shape": "rectangle", "width": 0.05, "height": 0.006}},
      "nodes": {"clamp": [0, 0], "roller": ["place", 0], "tip": [0.5, 0]},
      "members": [{"nodes": ["clamp", "roller"], "elements": 4, "material": "m", "section": "s"},
        {"nodes": ["roller", "tip"], "elements": 4, "material": "m", "section": "s"}],
      "supports": [{"node": "clamp", "fix": ["x", "y", "rotation"]},
                   {"node": "roller", "fix": ["y"]}]},
    "data": {"cov": 0.01, "states": [{"known": {"place": 0.1}, "frequencies": [20]},
                                     {"known": {"place": 0.2}, "frequencies": [30]}]}})");
  const auto states = *parse_update_case(read_case(where.write_json("c.json", c))).update.states;
  const AnyStructure any =
      states.model->at(states.values(std::vector<double>{2e11}, states.list[1]));
  const auto& s = std::get<fem::Structure>(any);
  EXPECT_EQ(fem::member_frame(s, 0).length, 0.2);
  EXPECT_NEAR(s.members[1].pieces[0].to, 0.3, 1e-12);
  EXPECT_NO_THROW((void)fem::Mesh(s).discretisation());
}

TEST(StatesCase, Refusals) {
  const Workspace where;
  const auto refused = [&](const json& c, const std::string& words) {
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
    EXPECT_EQ(outcome.exit_code, 65) << words << ": " << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  json c = two_storeys();
  c["parameters"]["unused"] = {{"uniform", {0, 1}}};
  refused(c, "/parameters/unused");
  c = two_storeys();
  c["baseline"]["data"].erase("cov");
  refused(c, "/baseline/data/cov");
  c = two_storeys();
  c["baseline"]["data"]["frequencies"] = {3.0, 6.4, 9.0};
  refused(c, "healthy: 3 modes");
  c = two_storeys();
  c["baseline"]["data"]["cov"] = {{"log_uniform", {1e-3, 0.1}}};
  refused(c, "/data/cov");
  c = two_storeys();
  c["data"]["states"] = json::parse(R"([{"states": [{"frequencies": [2.7]}]}])");
  refused(c, "/data/states/0/states");
  c = two_storeys();
  c["data"]["known"] = {{"k", 1400}};
  refused(c, "/data/known/k");
  c = two_storeys();
  c["data"]["temperature"] = 20;
  refused(c, "/temperature: ");
  c["temperature"] = {{"stiffness_per_kelvin", {{"normal", {0, 1e-3}}}}};
  refused(c, "/baseline/data/temperature");
  c = two_storeys();
  c["temperature"] = {{"stiffness_per_kelvin", {{"normal", {0, 1e-3}}}}};
  refused(c, "/temperature");
  c = two_storeys();
  c["data"]["masses"] = json::parse(R"([{"node": 3, "mass": 1}])");
  refused(c, "/data/masses/0/node");
  c["data"]["masses"] = json::parse(R"([{"node": 2, "mass": 0}])");
  refused(c, "/data/masses/0/mass");
  c = two_storeys();
  c["data"]["discrepancy"] = {{"cov", 0.01}};
  c["baseline"]["data"]["discrepancy"] = {{"cov", 0.02}};
  refused(c, "/data/discrepancy/cov");
  c = two_storeys();
  c["data"]["discrepancy"] = {{"cov", 0.01}, {"mixing", 0.5}};
  c["baseline"]["data"]["discrepancy"] = {{"cov", 0.01}, {"mixing", 0.7}};
  refused(c, "/data/discrepancy/mixing");
  c["data"]["discrepancy"].erase("cov");
  refused(c, "/data/discrepancy/mixing");
  // The first state states no model error; the others state different ones.
  c = two_storeys();
  c["data"]["states"] = json::parse(R"([{"discrepancy": {"cov": 0.01}, "frequencies": [2.7]},
    {"discrepancy": {"cov": 0.05}, "frequencies": [2.7]}])");
  c["data"].erase("frequencies");
  refused(c, "/discrepancy/cov: 0.05: must be the same in every state");
  c = two_storeys();
  c["data"]["discrepancy"] = {{"cov", 0.01}, {"mixing", 0.5}, {"stiffness", 0.05}};
  refused(c, "/data/discrepancy/mixing: 0.5: is not allowed with \"stiffness\"");
  c["data"]["discrepancy"] = {{"stiffness", 0.05}};
  c["baseline"]["data"]["discrepancy"] = {{"stiffness", 0.06}};
  refused(c, "/data/discrepancy/stiffness");
  c["data"]["discrepancy"] = {{"stiffness", 2}};
  refused(c, "/data/discrepancy/stiffness");
  c = json::parse(R"({"kind": "damage",
    "structure": {"materials": {"m": {"young": 2e11, "poisson": 0.3, "density": 7800}},
      "sections": {"s": {"shape": "rectangle", "width": 0.05, "height": 0.006}},
      "nodes": {"a": [0, 0], "b": [1, 0]},
      "members": [{"nodes": ["a", "b"], "elements": 8, "material": "m", "section": "s", "axial_force": 50}],
      "supports": [{"node": "a", "fix": ["x", "y", "rotation"]}]},
    "data": {"frequencies": [5, 31], "cov": 0.01, "discrepancy": {"stiffness": 0.05}},
    "damage": {"kind": "reduction", "count": {"min": 0, "max": 1, "prior": "uniform"},
               "reduction": {"uniform": [0, 0.9]}}})");
  refused(c, "/data/discrepancy/stiffness: 0.05: is not allowed with axial forces");
  c["data"].erase("discrepancy");
  c["data"]["temperature"] = 20;
  c["temperature"] = {{"stiffness_per_kelvin", {{"normal", {0, 1e-3}}}}, {"reference", 10}};
  refused(c, "is not allowed with axial forces");
  c = two_storeys();
  c["structure"]["chain"]["links"][0]["stiffness"] = 1400;
  c.erase("parameters");
  c["baseline"]["data"]["covariance"] = {{1e-4, 0}, {0, 1e-4}};
  c["baseline"]["data"].erase("cov");
  refused(c, "/baseline/data");
}

}  // namespace
}  // namespace wheeltap::apps
