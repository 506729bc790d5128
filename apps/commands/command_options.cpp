#include "apps/commands/command_options.hpp"
#include "apps/runs/case_run.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "apps/runs/run_cost.hpp"
#include "apps/whole_number.hpp"
#include "io/tables/array_columns.hpp"
#include "io/text/text_layout.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::apps {
namespace {

// Accepts numbers for which `allowed` is true. CLI::Range cannot be used, because it accepts nan.
CLI::Validator number(const char* words, const char* name, bool (*allowed)(double)) {
  return CLI::Validator(
      [=](const std::string& text) -> std::string {
        double x = 0.0;
        const char* last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data(), last, x);
        if (error == std::errc() && end == last && allowed(x)) return {};
        return text + ": must be " + words;
      },
      name);
}

}  // namespace

CLI::Validator whole(std::int64_t lowest, std::int64_t highest) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        if (const auto n = whole_number(text, lowest, highest)) {
          text = std::to_string(*n);
          return {};
        }
        return text + ": must be a whole number from " + std::to_string(lowest) + " to " +
               std::to_string(highest);
      },
      "INT in [" + std::to_string(lowest) + " - " + std::to_string(highest) + "]");
}

CLI::Validator positive() {
  return number("a positive number", "NUMBER > 0",
                [](double x) { return x > 0.0 && std::isfinite(x); });
}

CLI::Validator seconds() {
  return number("a number from 0 to 1e9", "NUMBER in [0 - 1e9]",
                [](double x) { return x >= 0.0 && x <= 1e9; });
}

Command sampled_command(Command command, bool may_reach_out, const char* resumed) {
  command.on_all_ranks = true;
  command.case_kind = command.name;
  command.add_options = [may_reach_out, resumed](CommandOptions& options) {
    options.add_run();
    if (may_reach_out) options.add_permissions();
    options.add_limits();
    options.add_dry_run();
    options.add_resume("continue an interrupted " + std::string(resumed) +
                       " from its checkpoint; print the results of a finished run again");
  };
  if (!command.run)
    command.run = [make = command.make_run](const Invocation& asked) {
      run_case(*make(case_to_sample(asked.common, asked.sampling), asked.common, asked.sampling));
    };
  return command;
}

void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays) {
  const std::string rest = " of delimited text (default: detected)";
  command
      ->add_option_function<std::string>(
          "--decimal", [&layout](const std::string& text) { layout.decimal = text.at(0); },
          "decimal mark (. or ,)" + rest)
      ->check(CLI::IsMember({".", ","}));
  command->add_option_function<std::string>(
      "--separator",
      [&layout](const std::string& text) {
        layout.separator = io::parse_separator(text);
        if (!layout.separator)
          throw CLI::ValidationError("--separator", text + ": must be ',', ';', tab, '|' or blank");
      },
      "column separator (the character, or comma, semicolon, tab, bar or blank)" + rest);
  const auto add_line = [&](const std::string& names, std::optional<int>& into,
                            const std::string& what) {
    command
        ->add_option_function<int>(
            names, [&into](const int& line) { into = line; }, what)
        ->transform(whole(0, 1'000'000'000));
  };
  add_line("--skip", layout.skip, "number of lines to skip at the top" + rest);
  add_line("--header", layout.header,
           "number of the line with the column names in delimited text, counted from 1; 0 if no "
           "line has names (default: detected)");
  add_line("--units-row", layout.units_row,
           "number of the line with the column units in delimited text, counted from 1; 0 if no "
           "line has units (default: detected)");
  command->add_option_function<std::string>(
      "--time-format",
      [&layout](const std::string& text) {
        layout.time_format = text;
        if (!io::parse_time_format(text))
          throw CLI::ValidationError(
              "--time-format",
              text + ": must be day-first, month-first or a pattern like '%d.%m.%Y %H:%M:%S'");
      },
      "format of the time stamps of delimited text: day-first, month-first or a pattern like "
      "'%d.%m.%Y %H:%M:%S'");
  command->add_option("--sheet", layout.sheet,
                      "name of the sheet of an Excel workbook (default: the first visible sheet)");
  command->add_option_function<bool>(
      "--rows-are-channels", [&arrays](const bool& rows) { arrays.rows_are_channels = rows; },
      "true if each row of a matrix in a MATLAB, NumPy, NetCDF or HDF5 file is a channel, false if "
      "each column is a channel (default: time is along the longest dimension)");
}

void CommandOptions::add_run() {
  add_case();
  add_output("FOLDER", kResults);
  add_json(kSummary);
  add_seed("seed of the random numbers of the Markov chains (default 1)");
  add_threads();
  add_sampling();
}

void CommandOptions::add_case() {
  app_.add_option("CASE", invocation_.common.case_path, "path of the case file (JSON)")->required();
  app_.add_option(
          "--set", invocation_.common.overrides,
          "key and new value of an entry of the case, as path.to.key=VALUE; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
}

void CommandOptions::add_output(const char* type, const char* what) {
  app_.add_option("-o,--output", invocation_.common.output, std::string("required: ") + what)
      ->required()
      ->type_name(type);
  add_quiet();
}

void CommandOptions::add_json(const char* what) {
  app_.add_flag("--json", invocation_.as_json, what);
}

void CommandOptions::add_seed(const char* what) {
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
  app_.add_option("--seed", invocation_.common.seed, what)->transform(whole(0, kLargestSeed));
}

void CommandOptions::add_threads() {
  app_.add_option("--simd", invocation_.simd,
                  "SIMD instruction set: baseline, avx2 or avx512 (default: the best set that the "
                  "processor supports)")
      ->check(CLI::IsMember({"baseline", "avx2", "avx512"}));
  app_.add_option("--threads", invocation_.common.threads,
                  "number of threads (default: the number of processors, or 1 per rank with MPI); "
                  "results do not depend on this number")
      ->envname(kThreadsVariable)
      ->transform(whole(1, 4096));
}

void CommandOptions::add_sampling() {
  app_.add_option("--chains", invocation_.sampling.chains,
                  "number of independent Markov chains (default 4)")
      ->transform(whole(1, 1000));
  app_.add_option("--warmup", invocation_.sampling.warmup,
                  "number of warm-up iterations per Markov chain (default: chosen automatically)")
      ->transform(whole(1, kMany));
  app_.add_option(
          "--draws", invocation_.sampling.draws,
          "number of draws per Markov chain after warm-up (default: as many as convergence needs)")
      ->transform(whole(100, kMany));
  app_.add_option(
          "--search", invocation_.sampling.searches,
          "number of local searches for posterior modes in each model; each starts at a draw of "
          "the prior (default: chosen automatically)")
      ->transform(whole(0, kMany));
  app_.add_option(
          "--checkpoint", invocation_.common.checkpoint_seconds,
          "time in seconds between two checkpoints for --resume (default 60; 0: no checkpoints)")
      ->check(seconds());
  CLI::Option* prior_only = app_.add_flag(
      "--prior-only", invocation_.sampling.prior_only,
      "ignore the data, as a check of the sampler: the posterior must equal the prior");
  app_.add_flag(
          "--quick", invocation_.sampling.quick,
          "quick run with a fixed, small amount of work: searches for posterior modes and short "
          "chains, so that probabilities are approximate; "
          "--dry-run estimates the run time")
      ->excludes(prior_only);
  app_.add_flag("--evidence{tmcmc+bridge}", invocation_.sampling.evidence,
                "check the probabilities: also compute the evidence of each model by other methods "
                "(--evidence=METHODS: tmcmc, bridge, laplace, joined by +; default tmcmc+bridge)")
      ->excludes(prior_only);
}

void CommandOptions::add_permissions() {
  app_.add_flag("--allow-commands", invocation_.common.allow_commands,
                "allow the case to run programs (\"predictor\": {\"command\": ...})");
  app_.add_option("--allow-hosts", invocation_.common.allow_hosts,
                  "host to which the case may connect; may be repeated (\"predictor\": "
                  "{\"umbridge\": ...}); this machine is always allowed")
      ->type_name("NAME")
      ->take_all()
      ->allow_extra_args(false);
}

void CommandOptions::add_limits() {
  app_.add_option("--max-memory", invocation_.common.max_memory_gb,
                  "upper limit of the estimated memory of a run in GB (default 4)")
      ->check(positive());
  app_.add_option("--max-hours", invocation_.common.max_hours,
                  "upper limit of the estimated run time in hours (default 100)")
      ->check(positive());
  app_.add_option(
          "--max-disk", invocation_.common.max_disk_gb,
          "upper limit of the estimated size of the results in GB (default: the free space of the "
          "disk that stores the results)")
      ->check(positive());
}

void CommandOptions::add_dry_run() {
  app_.add_flag_callback(
      "--dry-run", [&common = invocation_.common] { common.dry_run = print_estimate; },
      "print the estimated run time and memory without a run; --output is then optional");
  app_.get_option("--output")->required(false);  // only a run requires it
}

void CommandOptions::add_quiet() {
  app_.add_flag("--quiet", invocation_.common.quiet, "print no progress on standard error");
}

void CommandOptions::add_resume(const std::string& what) {
  app_.add_flag("--resume", invocation_.common.resume, what);
}

}  // namespace wheeltap::apps
