#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "apps/runs/sid/sid_sweep.hpp"

namespace wheeltap::apps {
namespace {

/// Runs a case with a sweep once per value of the sweep; sweep.csv replaces posterior.nc.
void run_sid(const CommonOptions& common, const SamplingOptions& options) {
  CaseFile file = case_to_sample(common, options);
  if (file.json.contains("sweep"))
    return sweep_sid(std::move(file), common, options, *make_log(common.quiet));
  run_case(*make_sid_run(std::move(file), common, options));
}

}  // namespace

Command sid_command() {
  return sampled_command(
      {.name = "sid",
       .summary = "identify the equation of motion of a structure from records",
       .make_run = make_sid_run,
       .run = [](const Invocation& asked) { run_sid(asked.common, asked.sampling); }},
      false, "run or sweep");
}

}  // namespace wheeltap::apps
