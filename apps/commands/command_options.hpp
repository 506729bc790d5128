// The options that several commands have, in the same words, and what values they take.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "apps/commands/command.hpp"

namespace wheeltap::io {
struct ArrayLayout;
struct TextLayout;
}  // namespace wheeltap::io

namespace wheeltap::apps {

/// Whole numbers in [lowest, highest], by the one reader of them; what stands for the option is the
/// number's plain form, so that nothing reads it otherwise.
[[nodiscard]] CLI::Validator whole(std::int64_t lowest, std::int64_t highest);

/// Finite numbers above 0.
[[nodiscard]] CLI::Validator positive();

/// Numbers from 0 to 1e9.
[[nodiscard]] CLI::Validator seconds();

/// Adds options for how a text, a workbook or a file of arrays is laid out, named as the keys of a
/// case's record are.
void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays);

inline constexpr std::int64_t kMany = 1'000'000'000;
inline constexpr const char* kResults =
    "the folder for the results: summary.json, posterior.nc and report.html";
inline constexpr const char* kSummary = "print summary.json in place of the text";

/// Adds options to one command; they are read into the Invocation.
class CommandOptions {
 public:
  CommandOptions(CLI::App& app, Invocation& invocation) : app_(app), invocation_(invocation) {}

  /// For options that no other command has.
  [[nodiscard]] CLI::App& app() { return app_; }
  [[nodiscard]] Invocation& invocation() { return invocation_; }

  /// What damage, sid and update have in common: a case, its results, and how it is sampled.
  void add_run();
  /// CASE and --set.
  void add_case();
  /// --output and --quiet; `type` is what the help calls the value: FOLDER, FILE.nc.
  void add_output(const char* type, const char* what);
  void add_quiet();
  void add_json(const char* what);
  void add_seed(const char* what);
  /// --threads and --simd.
  void add_threads();
  /// --chains, --warmup, --draws, --search, --checkpoint, --prior-only, --quick and --evidence.
  void add_sampling();
  /// --allow-commands and --allow-hosts.
  void add_permissions();
  /// --max-memory, --max-hours and --max-disk.
  void add_limits();
  /// --dry-run, which needs no --output.
  void add_dry_run();
  void add_resume(const std::string& what);

 private:
  CLI::App& app_;
  Invocation& invocation_;
};

/// `command`, which has a name, a summary and make_run, as the command that runs cases of the kind
/// of its name, with the options of such a run. `may_reach_out` adds the permissions to run
/// programs and to reach hosts; `resumed` is what --resume continues.
[[nodiscard]] Command sampled_command(Command command, bool may_reach_out,
                                      const char* resumed = "run");

}  // namespace wheeltap::apps
