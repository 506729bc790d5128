// Options that several commands share: texts and allowed values.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "apps/commands/command.hpp"

namespace wheeltap::io {
struct ArrayLayout;
struct TextLayout;
}  // namespace wheeltap::io

namespace wheeltap::apps {

/// Accepts whole numbers in [lowest, highest], parsed by whole_number(). Replaces the option's text
/// by the plain digits, so that CLI11 reads the same number.
[[nodiscard]] CLI::Validator whole(std::int64_t lowest, std::int64_t highest);

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator positive();

/// Accepts numbers from 0 to 1e9.
[[nodiscard]] CLI::Validator seconds();

/// Adds options for the layout of a text, a workbook or a file of arrays, named like the keys of a
/// case's record.
void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays);

inline constexpr std::int64_t kMany = 1'000'000'000;
inline constexpr const char* kResults =
    "folder of the results: summary.json, posterior.nc and report.html";
inline constexpr const char* kSummary = "print summary.json instead of text";

/// Adds options to one command; their values are stored in the Invocation.
class CommandOptions {
 public:
  CommandOptions(CLI::App& app, Invocation& invocation) : app_(app), invocation_(invocation) {}

  /// The CLI11 command, for options that no other command has.
  [[nodiscard]] CLI::App& app() { return app_; }
  [[nodiscard]] Invocation& invocation() { return invocation_; }

  /// The common options of damage, sid and update: case, results and sampling.
  void add_run();
  /// CASE and --set.
  void add_case();
  /// --output and --quiet; `type` is the name of the value in the help: FOLDER, FILE.nc.
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
  /// --dry-run, which makes --output optional.
  void add_dry_run();
  void add_resume(const std::string& what);

 private:
  CLI::App& app_;
  Invocation& invocation_;
};

/// Completes a sampling command from its name, summary and make_run. The result runs cases of the
/// kind with this name and has the options of such a run. `may_reach_out` adds the options that
/// permit running programs and connecting to hosts. `resumed` completes the help of --resume.
[[nodiscard]] Command sampled_command(Command command, bool may_reach_out,
                                      const char* resumed = "run");

}  // namespace wheeltap::apps
