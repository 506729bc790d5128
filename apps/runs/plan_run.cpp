#include "apps/runs/plan_run.hpp"

#include <chrono>
#include <cmath>

#include "apps/explained.hpp"
#include "apps/report/plan_page.hpp"
#include "apps/results/planning/plan_summary.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "base/parallel.hpp"
#include "io/atomic_file.hpp"

namespace wheeltap::apps {

void PlanRun::keep(const std::filesystem::path& folder) const {
  io::finish_commit(folder);
  const std::string text = damage_case.dump(2) + "\n";
  Report kept = summary;
  kept["files"]["damage.json"] = seal(text);
  io::AtomicFile recommended(folder / "damage.json"), report(folder / "report.html"),
      whole(folder / "summary.json");
  recommended.write(text);
  report.write(plan_page(kept));
  whole.write(kept.dump(1) + "\n");
  io::AtomicFile* const files[] = {&recommended, &report, &whole};
  io::commit_together(files);
}

void check_plan_case(const PlanCaseFile& parsed, int scenarios) {
  using namespace identification::planning;
  constexpr double kLargestCov = 0.2, kFewestAlarms = 5.0;
  const CaseFile& file = parsed.parsed.file;
  const PlanCheck check = explained(parsed, [&] { return check_plan(parsed.plan); });
  if (check.largest_cov > kLargestCov)
    file.refuse(Pointer("/plan") / (file.json.at("plan").contains("cov") ? "cov" : "seconds"),
                "gives a standard deviation of " + percent(check.largest_cov) +
                    " for a frequency: must give at most " + percent(kLargestCov) +
                    "; plan a longer record");
  // Expected number of false alarms in the simulated tests of the intact model.
  const double alarms_a_test = parsed.plan.false_alarm / check.models;
  if (alarms_a_test * kMostVariationTests < kFewestAlarms)
    file.refuse(Pointer("/plan/false_alarm"),
                "must be at least " +
                    base::significant(kFewestAlarms * check.models / kMostVariationTests, 3) +
                    ": a plan compares designs with at most " + base::grouped(kMostVariationTests) +
                    " simulated tests");
  if (alarms_a_test * variation_tests(scenarios) < kFewestAlarms)
    file.refuse(Pointer("/plan/false_alarm"),
                "is too small for " + base::grouped(scenarios) +
                    " simulated tests: use --scenarios " +
                    std::to_string(std::lround(
                        std::ceil(10.0 * kFewestAlarms * check.models / parsed.plan.false_alarm))) +
                    " or more, or a larger probability");
}

PlanRun run_plan(const PlanCaseFile& parsed, const CommonOptions& common,
                 const PlanRunOptions& how) {
  using namespace identification::planning;
  const auto begun = std::chrono::steady_clock::now();
  const PlanOptions options{.scenarios = how.scenarios,
                            .seed = common.seed.value_or(1),
                            .threads = base::thread_count(common.threads),
                            .progress = how.progress};
  PlanRun out;
  explained(parsed, [&] {
    const PlanModel model(parsed.plan, options);
    const PlanFindings findings = make_plan(parsed.plan, model, options);
    EngineCheck check;
    if (how.checks > 0)
      check = check_by_engine(parsed.plan, model, findings.designs.front(), how.checks,
                              {.seed = options.seed, .threads = options.threads, .quick = true},
                              [&](double fraction) {
                                if (how.progress)
                                  how.progress("check by the full engine", fraction);
                              });
    out.summary = plan_summary(parsed, findings, check,
                               {.seed = options.seed, .command_line = common.command_line});
    out.damage_case = recommended_case(parsed, findings);
    return true;
  });
  out.summary["cost"] = {
      {"wall_seconds",
       std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count()}};
  return out;
}

}  // namespace wheeltap::apps
