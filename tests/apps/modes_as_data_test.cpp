// A modes.json as data: from accelerations to damage and parameters.
#include "apps/cases/records/modes_as_data.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/update_case.hpp"
#include "program.hpp"

namespace wheeltap::apps::modes_as_data_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Three storeys; the lowest has the stiffness k.
json record_of(double k, int seed) {
  json c = json::parse(R"({"kind": "sid", "title": "chain",
    "record": {"sample_rate": 50, "channels": []},
    "parameters": {"k": {"uniform": [1000, 20000]}},
    "models": [{"name": "m", "masses": [10, 10, 10], "noise": 0.01, "links": [
      {"between": [0, 1], "stiffness": "k", "damping": 8},
      {"between": [1, 2], "stiffness": 9000, "damping": 8},
      {"between": [2, 3], "stiffness": 9000, "damping": 8}]}],
    "truth": {"model": "m", "noise": 0.01, "samples": 30000, "sample_rate": 50, "excitation": []}})");
  for (int mass = 1; mass <= 3; ++mass) {
    const std::string n = std::to_string(mass);
    c["record"]["channels"].push_back({{"column", "f" + n}, {"role", "force"}, {"mass", mass}});
    c["truth"]["excitation"].push_back({{"mass", mass}, {"kind", "white"}, {"variance", 100}});
  }
  for (int mass = 1; mass <= 3; ++mass)
    c["record"]["channels"].push_back({{"column", "a" + std::to_string(mass)},
                                       {"role", "response"},
                                       {"mass", mass},
                                       {"quantity", "acceleration"}});
  c["truth"]["parameters"] = {{"k", k}};
  c["truth"]["seed"] = seed;
  return c;
}

/// Accelerations, then their modes: modal/modes.json.
void measure(const Workspace& where, double k, int seed) {
  const std::string sid = where.write_json("sid.json", record_of(k, seed)).string();
  ASSERT_EQ(wheeltap(where, "simulate " + sid + " -o " + (where / "a.csv").string()).exit_code, 0);
  const json modal = json::parse(R"({"kind": "modal", "band": [0.5, 20],
    "record": {"file": "a.csv", "sample_rate": 50, "channels": [
      {"column": "a1", "role": "response", "node": "1", "direction": "x"},
      {"column": "a2", "role": "response", "node": "mass 2", "direction": "x"},
      {"column": "a3", "role": "response", "node": 3}]}})");
  const Outcome ran = wheeltap(where, "modal " + where.write_json("modal.json", modal).string() +
                                          " -o " + (where / "modal").string());
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
}

json chain() {
  return json::parse(R"({"chain": {"masses": [10, 10, 10], "links": [
    {"name": "storey 1", "between": [0, 1], "stiffness": 9000},
    {"name": "storey 2", "between": [1, 2], "stiffness": 9000},
    {"name": "storey 3", "between": [2, 3], "stiffness": 9000}]}})");
}

json damage_case() {
  return {{"kind", "damage"},
          {"structure", chain()},
          {"data", {{"from", "modal/modes.json"}}},
          {"damage", json::parse(R"({"kind": "storey", "count": {"min": 0, "max": 1},
                                     "reduction": {"uniform": [0, 0.9]}})")}};
}

TEST(ModesAsData, FromAccelerationsToDamage) {
  const Workspace where;
  measure(where, 0.7 * 9000, 4);
  const Outcome ran =
      wheeltap(where, "damage " + where.write_json("damage.json", damage_case()).string() + " -o " +
                          (where / "out").string() + " --quiet --warmup 500 --draws 500");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("from modal/modes.json: 3 of 3 modes, with shapes at 3 sensors"));
  EXPECT_THAT(ran.out, HasSubstr("damping is not used"));
  const json summary = json::parse(read_all(where / "out/summary.json"));
  EXPECT_GT(summary["models"][1]["probability"], 0.99);
  EXPECT_GT(summary["damage"]["inclusion_by_member"]["storey 1"], 0.99);
  const json& r = summary["parameters"]["1 soft storey"]["reduction[1]"];
  EXPECT_LT(r["q2.5"], 0.3);
  EXPECT_GT(r["q97.5"], 0.3);
  EXPECT_LT(r["sd"], 0.02);
  EXPECT_GT(summary["data"]["posterior_predictive_p"], 0.01);
}

/// The data of an update case with the file, without a run.
identification::ModalData parsed(const Workspace& where, const json& data) {
  json c = {{"kind", "update"},
            {"structure", chain()},
            {"parameters", {{"k", {{"log_normal", {9.1, 0.3}}}}}},
            {"data", data}};
  c["structure"]["chain"]["links"][0]["stiffness"] = "k";
  return parse_update_case(read_case(where.write_json("update.json", c))).update.data;
}

ModesFile three() {
  ModesFile out{.sensors = {{.name = "a", .node = "1", .direction = "x"},
                            {.name = "b", .node = "2", .direction = "-x"},
                            {.name = "c", .node = "mass 3"}},
                .frequencies_hz = Eigen::Vector3d(2.1, 6.0, 8.6),
                .damping = Eigen::Vector3d(0.01, 0.01, 0.01)};
  out.covariance = Eigen::MatrixXd::Identity(6, 6) * 1e-4;
  out.covariance(0, 2) = out.covariance(2, 0) = 5e-5;
  out.shapes.resize(3, 3);
  out.shapes << 0.4, 1.0, -0.8, -0.8, -0.4, 1.0, 1.0, -0.8, -0.4;
  out.shape_covariance.assign(3, Eigen::MatrixXd::Identity(6, 6) * 1e-4);
  out.doubtful = {false, true, false};
  return out;
}

TEST(ModesAsData, TakesFrequenciesShapesAndTheirCovariances) {
  const Workspace where;
  where.write("m.json", modes_json(three()).dump());
  const auto doubtless = parsed(where, {{"from", "m.json"}});
  EXPECT_EQ(doubtless.modes(), 3);
  EXPECT_EQ(doubtless.frequencies_hz[0], 2.1);
  EXPECT_TRUE(doubtless.is_gap(1));
  EXPECT_EQ(doubtless.frequencies_hz[2], 8.6);
  EXPECT_EQ(doubtless.covariance(0, 2), 5e-5);
  EXPECT_THAT(doubtless.origin, HasSubstr("without the doubtful 2"));
  ASSERT_EQ(doubtless.shapes.cols(), 3);
  EXPECT_EQ(doubtless.sensors[1].motion.coefficients, std::vector<double>{-1.0});
  EXPECT_EQ(doubtless.sensors[2].motion.dofs, std::vector<int>{2});
  EXPECT_EQ(parsed(where, {{"from", "m.json"}, {"modes", 2}}).frequencies_hz,
            (std::vector<double>{2.1, 6.0}));
  const auto listed = parsed(where, {{"from", "m.json"}, {"modes", {3, 2}}});
  EXPECT_TRUE(listed.is_gap(0));
  EXPECT_EQ(listed.frequencies_hz[1], 6.0);
  EXPECT_EQ(listed.frequencies_hz[2], 8.6);
  // Sensors of the case, one of them left out.
  const json placed = {{"from", "m.json"}, {"sensors", {{{"mass", 3}}, nullptr, {{"mass", 1}}}}};
  const auto two = parsed(where, placed);
  ASSERT_EQ(two.shapes.cols(), 2);
  EXPECT_EQ(two.sensors[0].motion.dofs, std::vector<int>{2});
  EXPECT_NEAR(two.shapes(0, 1) / two.shapes(0, 0), 1.0 / 0.4, 1e-12);
  const json one = {{"from", "m.json"}, {"sensors", {{{"mass", 3}}, nullptr, nullptr}}};
  EXPECT_FALSE(parsed(where, one).has_shapes());
}

// One of the merged set-ups lacks a mode: its sensors have no entries in that shape.
TEST(ModesAsData, GapsOfShapesAreNotMeasured) {
  const Workspace where;
  ModesFile modes = three();
  const double none = std::nan("");
  modes.shapes(1, 0) = {none, none};
  modes.shapes(0, 2) = modes.shapes(1, 2) = {none, none};
  where.write("m.json", modes_json(modes).dump());
  const auto data = parsed(where, {{"from", "m.json"}});
  ASSERT_EQ(data.shapes.rows(), 3);
  EXPECT_FALSE(std::isnan(data.shapes(0, 0)));
  EXPECT_TRUE(std::isnan(data.shapes(0, 1)));
  EXPECT_FALSE(std::isnan(data.shapes(0, 2)));
  // A single entry cannot define a shape.
  for (Eigen::Index s = 0; s < 3; ++s) EXPECT_TRUE(std::isnan(data.shapes(2, s))) << s;
  EXPECT_EQ(data.shape_covariances.size(), 3U);
}

/// Five equal storeys of 1 kg and 16 N/m, measured by one channel; `exact` frequencies.
ModesFile one_channel() {
  ModesFile out{.sensors = {{.name = "L2", .node = "2", .direction = "x"}},
                .frequencies_hz = Eigen::VectorXd(5),
                .damping = Eigen::VectorXd::Constant(5, 0.01)};
  for (int j = 0; j < 5; ++j)
    out.frequencies_hz[j] = 8.0 / (2.0 * M_PI) * std::sin((2 * j + 1) * M_PI / 22.0);
  out.covariance = Eigen::MatrixXd::Identity(10, 10) * 1e-6;
  out.shapes = Eigen::MatrixXcd::Ones(1, 5);
  out.shape_covariance.assign(5, Eigen::MatrixXd::Identity(2, 2) * 1e-6);
  out.doubtful = {false, true, false, false, false};
  return out;
}

json five_storeys(const json& data) {
  json c = {{"kind", "update"}, {"data", data}, {"parameters", json::object()}};
  for (int i = 1; i <= 5; ++i) {
    const std::string k = "k" + std::to_string(i);
    c["structure"]["chain"]["masses"].push_back(1);
    c["structure"]["chain"]["links"].push_back({{"between", {i - 1, i}}, {"stiffness", k}});
    c["parameters"][k] = {{"log_normal", {std::log(16.0), 0.6}}};
  }
  return c;
}

// One channel has no shapes: an unused mode leaves a gap, and the others keep their numbers.
TEST(ModesAsData, DoubtfulModesOfOneChannelLeaveAGap) {
  const Workspace where;
  where.write("m.json", modes_json(one_channel()).dump());
  const json doubtful = {{"from", "m.json"}},
             listed = {{"from", "m.json"}, {"modes", {1, 3, 4, 5}}};
  for (const json& data : {doubtful, listed}) {
    const std::string file = where.write_json("update.json", five_storeys(data)).string();
    const auto taken = parse_update_case(read_case(file)).update.data;
    ASSERT_EQ(taken.modes(), 5) << data;
    EXPECT_TRUE(taken.is_gap(1));
    EXPECT_FALSE(taken.has_shapes());
    EXPECT_THAT(taken.origin, HasSubstr("modes 1, 3, 4 and 5 keep their numbers"));
  }
  const std::string file = where.write_json("update.json", five_storeys(doubtful)).string();
  const Outcome ran =
      wheeltap(where, "update " + file + " -o " + (where / "out").string() + " --quiet --quick");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json summary = json::parse(read_all(where / "out/summary.json"));
  for (const auto& [name, k] : summary["parameters"]["the structure"].items()) {
    EXPECT_LT(k["q2.5"], 16.0) << name;
    EXPECT_GT(k["q97.5"], 16.0) << name;
  }
  EXPECT_EQ(summary["data"]["modes"][2]["computed_mode"], 3);
  EXPECT_EQ(summary["data"]["numbering"]["modes"], json({1, 3, 4, 5}));
  EXPECT_GT(summary["data"]["numbering"]["probability"], 0.5);
}

// The modes of a file shortened by hand keep their numbers; a case may give others.
TEST(ModesAsData, ModesAreTakenByTheirNumbers) {
  const Workspace where;
  json file = json::parse(modes_json(one_channel()).dump());
  file["numbers"] = {2, 3, 4, 6, 7};
  where.write("m.json", file.dump());
  const auto frequencies = [&](const json& data) { return parsed(where, data).frequencies_hz; };
  const double f = one_channel().frequencies_hz[0];
  auto found = frequencies({{"from", "m.json"}, {"modes", {2}}});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(std::isnan(found[0]));
  EXPECT_EQ(found[1], f);
  found = frequencies({{"from", "m.json"}, {"modes", {2}}, {"model_modes", {1}}});
  EXPECT_EQ(found, std::vector<double>{f});
}

TEST(ModesAsData, CovariancesOfFewBlocksAreRaised) {
  const Workspace where;
  ModesFile modes = three();
  modes.blocks = 50;
  where.write("m.json", modes_json(modes).dump());
  const auto raised = parsed(where, {{"from", "m.json"}, {"modes", 3}});
  EXPECT_NEAR(raised.covariance(0, 0), 1e-4 * 49.0 / 45.0 * (1.0 + 2.0 * 45.0 / (46.0 * 43.0)),
              1e-12);
  modes.blocks = 6;
  where.write("m.json", modes_json(modes).dump());
  const auto diagonal = parsed(where, {{"from", "m.json"}, {"modes", 3}});
  EXPECT_EQ(diagonal.covariance(0, 2), 0.0);
  EXPECT_THAT(diagonal.origin, HasSubstr("without correlations"));
}

TEST(ModesAsData, DirectionsByAngles) {
  const Workspace where;
  ModesFile modes = three();
  modes.sensors = {{.node = "B", .azimuth = 60.0},
                   {.node = "C", .direction = "-y"},
                   {.node = "C", .azimuth = 0.0, .elevation = 0.5}};
  where.write("m.json", modes_json(modes).dump());
  const json c = json::parse(R"({"kind": "update", "parameters": {"E": {"log_normal": [26, 0.1]}},
    "structure": {"materials": {"m": {"young": "E", "poisson": 0.3, "density": 7850}},
      "sections": {"s": {"shape": "rectangle", "width": 0.05, "height": 0.01}},
      "nodes": {"A": [0, 0], "B": [0, 1], "C": [1, 1], "D": [1, 0]},
      "members": [{"nodes": ["A", "B"], "elements": 4, "material": "m", "section": "s"},
        {"nodes": ["B", "C"], "elements": 4, "material": "m", "section": "s"},
        {"nodes": ["C", "D"], "elements": 4, "material": "m", "section": "s"}],
      "supports": [{"node": "A", "fix": ["x", "y", "rotation"]},
                   {"node": "D", "fix": ["x", "y", "rotation"]}]},
    "data": {"from": "m.json"}})");
  const auto data = parse_update_case(read_case(where.write_json("u.json", c))).update.data;
  ASSERT_EQ(data.sensors[0].motion.coefficients.size(), 2U);
  EXPECT_NEAR(data.sensors[0].motion.coefficients[0], 0.5, 1e-12);
  EXPECT_NEAR(data.sensors[0].motion.coefficients[1], std::sqrt(0.75), 1e-12);
  EXPECT_EQ(data.sensors[1].motion.coefficients, std::vector<double>{-1.0});
  EXPECT_EQ(data.sensors[2].motion.dofs.size(), 1U);
}

TEST(ModesAsData, Refusals) {
  const Workspace where;
  const auto refused = [&](const json& data, const std::string& words, int exit = 65) {
    json c = damage_case();
    c["data"] = data;
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
    EXPECT_EQ(outcome.exit_code, exit) << words << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  where.write("m.json", modes_json(three()).dump());
  const json from = {{"from", "m.json"}};
  const auto with = [&](const char* key, const json& value) {
    json data = from;
    data[key] = value;
    return data;
  };
  refused({{"from", "none.json"}}, "none.json", 66);
  refused(with("frequencies", {2.1}), "/data/frequencies");
  refused(with("cov", 0.01), "/data/cov");
  refused(with("modes", 4), "/data/modes");
  refused(with("modes", {1, 4}), "/data/modes/1");
  refused(with("modes", {1, 1}), "/data/modes/1");
  refused(with("model_modes", {1}),
          "/data/model_modes: [1]: must have one number for each of the 2");
  refused(with("model_modes", {2, 1}), "/data/model_modes/1: 1: must increase");
  refused(with("sensors", {{{"mass", 1}}}), "/data/sensors");
  refused({{"frequencies", {2.1}}, {"cov", 0.01}, {"modes", {1}}}, "/data/modes");
  where.write("m.json", "{\"frequencies_hz\": [1, ");
  refused(from, "m.json:1:");
  ModesFile modes = three();
  modes.sensors[1].node = "7";
  where.write("m.json", modes_json(modes).dump());
  refused(from, "m.json: /sensors/1/node");
  modes = three();
  modes.sensors[2].direction = "y";
  where.write("m.json", modes_json(modes).dump());
  refused(from, "m.json: /sensors/2/direction");
  modes = three();
  modes.covariance(0, 2) = modes.covariance(2, 0) = 2e-4;
  where.write("m.json", modes_json(modes).dump());
  refused(with("modes", 3), "m.json: /covariance");
  modes = three();
  modes.shape_covariance[2].setZero();
  where.write("m.json", modes_json(modes).dump());
  refused(from, "m.json: /shape_covariance/2");
  modes = three();
  modes.doubtful.assign(3, true);
  where.write("m.json", modes_json(modes).dump());
  refused(from, "/data/from");
}

// Before: "m.json: no such file", also from `wheeltap modes`, which needs only the structure.
TEST(ModesAsData, AMissingFileIsNamedWithItsKeyAndItsCommand) {
  const Workspace where;
  json c = small_case();
  c["data"] = {{"from", "m.json"}, {"sensors", {{{"at", 0.2}}, {{"at", 0.5}}}}};
  const std::string path = where.write_json("c.json", c).string();
  const Outcome outcome = wheeltap(where, "damage " + path + " --dry-run");
  EXPECT_EQ(outcome.exit_code, 66);
  EXPECT_THAT(outcome.err, HasSubstr("c.json: /data/from: "));
  EXPECT_THAT(outcome.err, HasSubstr("m.json: no such file: write it with wheeltap modal"));
  const Outcome modes = wheeltap(where, "modes " + path);
  EXPECT_EQ(modes.exit_code, 0) << modes.err;
}

// For a beam, the case gives the sensor positions.
TEST(ModesAsData, OnABeam) {
  const Workspace where;
  where.write("m.json", modes_json(three()).dump());
  json c = small_case();
  c["data"] = {{"from", "m.json"}};
  const auto run = [&] {
    return wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
  };
  Outcome outcome = run();
  EXPECT_EQ(outcome.exit_code, 65);
  EXPECT_THAT(outcome.err, HasSubstr("/data/sensors: is missing"));
  c["data"]["sensors"] = {{{"at", 0.2}}, {{"at", 0.5}}, nullptr};
  outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace
}  // namespace wheeltap::apps::modes_as_data_test
