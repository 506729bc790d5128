// `wheeltap sid` and `wheeltap simulate` on the command line.
#include <gmock/gmock.h>

#include "sid_cases.hpp"

namespace wheeltap::apps::sid_command_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShort = " --quiet --chains 2 --warmup 3000 --draws 1000 ";

TEST(SidCommand, WritesWhatTheContractPromises) {
  const Workspace where;
  const auto c = where.write_json("case.json", small_sid_case());
  const auto out = where / "out";
  const Outcome run = wheeltap(where, "sid " + c.string() + " -o " + out.string() + kShort);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Which model?"));
  const json s = json::parse(read_all(out / "summary.json"));
  EXPECT_EQ(s["wheeltap"]["command"], "sid");
  ASSERT_EQ(s["models"].size(), 2U);
  EXPECT_EQ(s["models"][1]["name"], "duffing");
  EXPECT_GT(s["models"][1]["mcse"].get<double>(), 0.0);
  for (const char* key : {"visited", "entered", "log_evidence", "log_evidence_se", "basis"}) {
    EXPECT_TRUE(s["models"][1].contains(key)) << key;
  }
  const json& d = s["diagnostics"];
  EXPECT_EQ(d["converged"].get<bool>(), d["not_established"].empty());
  EXPECT_TRUE(d.contains("resolution"));
  EXPECT_TRUE(d["ladder"].contains("barrier"));
  const json& k = s["parameters"]["duffing"]["k"];
  EXPECT_LT(k["q2.5"].get<double>(), k["q97.5"].get<double>());
  const json& fit = s["fit_at_mean"]["duffing"][0];
  EXPECT_NEAR(fit["rmse"].get<double>(), 0.05, 0.0125);  // sd of an sd: 5 % of it; five of them
  EXPECT_NEAR(fit["r2"].get<double>(), 1.0 - std::pow(fit["nrmse"].get<double>(), 2), 1e-9);
  EXPECT_TRUE(fit["whiteness"].contains("p_value"));
  // 97 % of 200 samples, five standard deviations of a binomial below.
  EXPECT_GT(s["predictive"]["channels"][0]["coverage"].get<double>(), 0.91);
  EXPECT_TRUE(std::filesystem::exists(out / "posterior.nc"));
}

// Fault: the probability of a single model was "> 99.9 % ± 0.03 %", a priori > 99.9 %.
TEST(SidCommand, OneModelIsComparedWithNothing) {
  const Workspace where;
  json c = small_sid_case();
  c["models"].erase(0);
  const auto out = where / "out";
  const Outcome run =
      wheeltap(where, "sid " + where.write_json("case.json", c).string() + " -o " + out.string() +
                          " --quiet --chains 2 --warmup 1000 --draws 500");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("Which model?")));
  EXPECT_THAT(run.out, Not(HasSubstr("> 99.9 %")));
  EXPECT_THAT(run.out, HasSubstr("\nduffing\n"));
}

// With a noise of 1e-5 of the response, the default Runge-Kutta steps are too long.
TEST(SidCommand, RepeatsARunWhoseStepsWereTooLong) {
  const Workspace where;
  json c = small_sid_case();
  c["truth"]["noise"] = 2e-6;
  for (json& model : c["models"]) model["noise"] = 2e-6;
  c["parameters"]["k"] = {{"normal", {50.0, 0.01}}};
  c["parameters"]["k3"] = {{"normal", {1000.0, 0.5}}};
  const auto run = [&](const std::string& name) {
    const auto out = where / name;
    const Outcome done = wheeltap(where, "sid " + where.write_json(name + ".json", c).string() +
                                             " -o " + out.string() + kShort);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return json::parse(read_all(out / "summary.json"));
  };
  const json s = run("automatic");
  EXPECT_LT(s["integration"]["error_of_steps"]["duffing"].get<double>(), 0.3);
  EXPECT_THAT(s["diagnostics"]["notes"].dump(), HasSubstr("repeated with Taylor series"));
  EXPECT_THAT(s["diagnostics"]["warnings"].dump(), Not(HasSubstr("a quarter of the time step")));
  c["integration"] = {{"method", "runge-kutta"}};
  const json fixed = run("fixed");
  EXPECT_GT(fixed["integration"]["error_of_steps"]["duffing"].get<double>(), 0.3);
  EXPECT_THAT(fixed["diagnostics"]["warnings"].dump(), HasSubstr("a quarter of the time step"));
  EXPECT_GT(s["best_draw"]["duffing"]["k3"].get<double>(), 0.0);
}

// A softening spring this strong diverges for all values of its prior.
TEST(SidCommand, NamesTheOnlyModelIfItsPriorMakesItImpossible) {
  const Workspace where;
  json c = small_sid_case();
  const auto good = where.write_json("good.json", c);
  const auto record = where / "record.csv";
  ASSERT_EQ(wheeltap(where, "simulate " + good.string() + " -o " + record.string()).exit_code, 0);
  c.erase("truth");
  c["record"]["file"] = record.string();
  c["parameters"]["k3"] = {{"uniform", {-2e9, -1e9}}};
  c["models"].erase(0);
  const auto out = where / "out";
  const Outcome run = wheeltap(
      where, "sid " + where.write_json("c.json", c).string() + " -o " + out.string() + kShort);
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("'duffing'"));
  EXPECT_THAT(run.err, HasSubstr("k3 ~ uniform"));
  EXPECT_TRUE(!std::filesystem::exists(out) || std::filesystem::is_empty(out));
}

// Interval of a further window for each parameter: for a correct model it is wider than that of the
// run, since a window is a quarter of the record, and is centred near the run's value.
TEST(SidCommand, TellsWhatHoldsBetweenWindows) {
  const Workspace where;
  json c = small_sid_case();
  c["windows"] = 4;
  c["truth"]["samples"] = 800;
  const auto out = where / "out";
  const Outcome run = wheeltap(
      where, "sid " + where.write_json("case.json", c).string() + " -o " + out.string() + kShort);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("a further window (95 %)"));
  const json s = json::parse(read_all(out / "summary.json"));
  const json& k = s["parameters"]["duffing"]["k"];
  const json& w = k["between_windows"];
  for (const char* key : {"mean", "sd", "q2.5", "q5", "q50", "q95", "q97.5"}) {
    EXPECT_TRUE(w[key].is_number()) << key;
    EXPECT_TRUE(w["whole"][key].is_number()) << key;
  }
  EXPECT_EQ(w["windows"]["value"].size(), 4U);
  EXPECT_EQ(w["use"], "run");
  EXPECT_GT(w["sd"].get<double>(), 1.5 * k["sd"].get<double>());
  EXPECT_LT(w["whole"]["q2.5"].get<double>(), k["mean"].get<double>());
  EXPECT_GT(w["whole"]["q97.5"].get<double>(), k["mean"].get<double>());
  EXPECT_GT(w["scatter"]["p_value"].get<double>(), 1e-3);
  EXPECT_THAT(read_all(out / "report.html"), HasSubstr("between_windows"));
}

// The information of two records on k adds up (precisions add if k is the only unknown; with k3
// there is more), and each record is a window for the other.
TEST(SidCommand, TakesSeveralRecordsTogether) {
  const Workspace where;
  json one = small_sid_case(), two = small_sid_case();
  two["records"] = {two["record"], two["record"]};
  two.erase("record");
  const auto run = [&](const json& c, const std::string& name) {
    const auto out = where / name;
    const Outcome done = wheeltap(where, "sid " + where.write_json(name + ".json", c).string() +
                                             " -o " + out.string() + kShort);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return json::parse(read_all(out / "summary.json"));
  };
  json other = one;
  other["truth"]["seed"] = one["truth"]["seed"].get<int>() + 1;
  const json first = run(one, "one"), second = run(other, "other"), both = run(two, "two");
  const auto sd = [](const json& s) { return s["parameters"]["duffing"]["k"]["sd"].get<double>(); };
  const double together = 1.0 / std::hypot(1.0 / sd(first), 1.0 / sd(second));
  EXPECT_LT(sd(both), 1.2 * together);
  EXPECT_GT(sd(both), 0.6 * together);
  ASSERT_EQ(both["further_records"].size(), 1U);
  EXPECT_NEAR(both["further_records"][0]["fit_at_best_draw"]["duffing"][0]["rmse"].get<double>(),
              0.05, 0.0125);
  EXPECT_EQ(both["parameters"]["duffing"]["k"]["between_windows"]["windows"]["value"].size(), 2U);
}

// A chain without the truth's cubic spring: terminal, summary and warnings state which interval to
// use. A quick run skips windows.
TEST(SidCommand, SaysWhichIntervalToUseWhereATermIsMissing) {
  const Workspace where;
  json c = small_sid_case();
  c["truth"]["samples"] = 2000;
  c["truth"]["noise"] = 0.005;
  const auto csv = where / "record.csv";
  const Outcome made = wheeltap(
      where, "simulate " + where.write_json("truth.json", c).string() + " -o " + csv.string());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  c.erase("truth");
  c["record"]["file"] = csv.string();
  c["record"]["sample_rate"] = 100;
  c["windows"] = 5;
  c["models"].erase(1);
  c["models"][0]["noise"] = "sigma";
  c["parameters"].erase("k3");
  c["parameters"]["sigma"] = {{"log_uniform", {1e-4, 1.0}}};
  const auto run = [&](const std::string& options) {
    const auto out = where / "out";
    const Outcome done = wheeltap(where, "sid " + where.write_json("case.json", c).string() +
                                             " -o " + out.string() + options);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return std::pair(done.out, json::parse(read_all(out / "summary.json")));
  };
  const auto [text, s] = run(kShort);
  EXPECT_EQ(s["parameters"]["linear"]["k"]["between_windows"]["use"], "windows");
  EXPECT_THAT(s["diagnostics"]["warnings"].dump(), HasSubstr("between the 5 windows"));
  EXPECT_THAT(text, HasSubstr("between the 5 windows"));
  const auto [quick, look] = run(" --quiet --quick");
  EXPECT_FALSE(look["parameters"]["linear"]["k"].contains("between_windows"));
}

TEST(SidCommand, ChoosesTheOrderOfResiduals) {
  const Workspace where;
  json c = small_sid_case();
  c["residuals"] = {{"ar", "auto"}};
  const auto out = where / "out";
  const Outcome run = wheeltap(
      where, "sid " + where.write_json("case.json", c).string() + " -o " + out.string() + kShort);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json s = json::parse(read_all(out / "summary.json"));
  EXPECT_EQ(s["residuals"]["ar"]["duffing"], 0);  // the truth: white
  EXPECT_GT(s["residuals"]["ar"]["linear"], 0);   // its misfit is smooth
  EXPECT_THAT(run.out, HasSubstr("Residuals: white, chosen by BIC"));
  EXPECT_THAT(s["diagnostics"]["notes"].dump(), HasSubstr("chosen by BIC"));
}

TEST(SidCommand, SweepsWriteOneTable) {
  const Workspace where;
  json c = small_sid_case();
  c["sweep"] = {{"path", "/truth/parameters/k3"}, {"values", {100, 2000}}};
  const auto file = where.write_json("case.json", c);
  const auto out = where / "out";
  const Outcome run = wheeltap(where, "sid " + file.string() + " -o " + out.string() + kShort);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string table = read_all(out / "sweep.csv");
  EXPECT_EQ(std::ranges::count(table, '\n'), 4);  // a comment, the header, two rows
  EXPECT_THAT(table, HasSubstr("ln B(duffing:linear)"));
  EXPECT_THAT(table, HasSubstr("P(linear),mcse,basis,"));
  c["sweep"]["path"] = "/truth/parametres/k3";
  const auto wrong = where.write_json("case.json", c);
  EXPECT_EQ(wheeltap(where, "sid " + wrong.string() + " -o " + out.string()).exit_code, 65);
}

TEST(SidCommand, RejectsASweepThatLeadsNowhere) {
  const Workspace where;
  for (const char* path :
       {"/models/99999999999999999999", "/models/2", "/models/-", "/models/01", "/models/x",
        "models", "/models/~2", "/truth/parameters/k/0", "", "/sweep", "/sweep/values/0"}) {
    json c = small_sid_case();
    c["sweep"] = {{"path", path}, {"values", {100, 2000}}};
    const Outcome run =
        wheeltap(where, "sid " + where.write_json("case.json", c).string() + " --dry-run");
    EXPECT_EQ(run.exit_code, 65) << path << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("/sweep/path")) << path;
  }
}

/// A case with a record file simulated with this stiffness; the case file is always the same.
std::string written_case(const Workspace& where, double stiffness, const json& sweep = {}) {
  json c = small_sid_case();
  c["truth"]["parameters"]["k"] = stiffness;
  const auto truth = where.write_json("truth.json", c);
  EXPECT_EQ(wheeltap(where, "simulate " + truth.string() + " -o " +
                                (where / "record.csv").string() + " --quiet")
                .exit_code,
            0);
  c.erase("truth");
  c["record"]["file"] = "record.csv";
  if (!sweep.is_null()) c["sweep"] = sweep;
  return where.write_json("case.json", c).string();
}

double stiffness_of(const json& run) {
  return run["parameters"]["duffing"]["k"]["mean"].get<double>();
}

TEST(SidCommand, ResumeBelongsToTheContentOfTheRecord) {
  const Workspace where;
  const auto out = where / "out";
  const auto run = [&](double stiffness) {
    const Outcome ran = wheeltap(where, "sid " + written_case(where, stiffness) + " -o " +
                                            out.string() + kShort + " --resume");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(out / "summary.json"));
  };
  const json first = run(40.0), again = run(40.0), other = run(60.0);
  EXPECT_EQ(first, again);
  EXPECT_GT(stiffness_of(other), stiffness_of(first) + 5.0);
  EXPECT_EQ(first["wheeltap"]["case"], other["wheeltap"]["case"]);
  EXPECT_NE(first["wheeltap"]["inputs"]["record.csv"]["checksum"],
            other["wheeltap"]["inputs"]["record.csv"]["checksum"]);
}

TEST(SidCommand, ResumeOfASweepBelongsToTheContentOfTheRecord) {
  const Workspace where;
  const auto out = where / "out";
  const json sweep = {{"path", "/record/samples/1"}, {"values", {150, 200}}};
  const auto run = [&](double stiffness) {
    std::string c = written_case(where, stiffness, sweep);
    json with_samples = json::parse(read_all(c));
    with_samples["record"]["samples"] = {0, 200};
    c = where.write_json("case.json", with_samples);
    const Outcome ran = wheeltap(where, "sid " + c + " -o " + out.string() + kShort + " --resume");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(out / "summary.json"))["sweep"]["rows"];
  };
  const json first = run(40.0), again = run(40.0), other = run(60.0);
  EXPECT_EQ(first, again);
  for (const std::size_t row : {0U, 1U})
    EXPECT_GT(stiffness_of(other[row]), stiffness_of(first[row]) + 5.0);
}

TEST(SidCommand, SimulatesWithUnitsInTheHeader) {
  const Workspace where;
  const auto c = where.write_json("case.json", small_sid_case());
  const auto out = where / "record.csv";
  ASSERT_EQ(wheeltap(where, "simulate " + c.string() + " -o " + out.string()).exit_code, 0);
  EXPECT_THAT(read_all(out), HasSubstr("time [s],force [N],displacement [m]\n"));
}

}  // namespace
}  // namespace wheeltap::apps::sid_command_test
