// Options that several commands share: help texts and allowed values.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "apps/commands/command.hpp"

namespace wheeltap::io {
struct ArrayLayout;
struct TextLayout;
}  // namespace wheeltap::io

namespace wheeltap::apps {

/// Validator of whole numbers in [lowest, highest]. The validator parses the text of the option by
/// whole_number() and replaces this text by plain digits, so that CLI11 reads the same number.
[[nodiscard]] CLI::Validator whole(std::int64_t lowest, std::int64_t highest);

/// Validator of finite numbers above 0.
[[nodiscard]] CLI::Validator positive();

/// Validator of numbers from 0 to 1e9.
[[nodiscard]] CLI::Validator seconds();

/// Adds options for the layout of a text file, a workbook or a file of arrays. The options have the
/// same names as the keys of a record in a case.
void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays);

inline constexpr std::int64_t kMany = 1'000'000'000;
inline constexpr const char* kResults =
    "folder of the results: summary.json, posterior.nc and report.html";
inline constexpr const char* kSummary = "print summary.json instead of text";

/// Adds options to one command. The values of the options are stored in the Invocation.
class CommandOptions {
 public:
  CommandOptions(CLI::App& app, Invocation& invocation) : app_(app), invocation_(invocation) {}

  /// The CLI11 command, to add options that no other command has.
  [[nodiscard]] CLI::App& app() { return app_; }
  [[nodiscard]] Invocation& invocation() { return invocation_; }

  /// Adds the common options of damage, sid and update: case, results and sampling.
  void add_run();
  /// Adds the argument CASE and the option --set.
  void add_case();
  /// Adds --output and --quiet. `type` is the name of the value in the help: FOLDER, FILE.nc.
  void add_output(const char* type, const char* what);
  void add_quiet();
  void add_json(const char* what);
  void add_seed(const char* what);
  /// Adds --threads and --simd.
  void add_threads();
  /// Adds --chains, --warmup, --draws, --search, --checkpoint, --prior-only, --quick and
  /// --evidence.
  void add_sampling();
  /// Adds --allow-commands and --allow-hosts.
  void add_permissions();
  /// Adds --max-memory, --max-hours and --max-disk.
  void add_limits();
  /// Adds --dry-run, which makes --output optional.
  void add_dry_run();
  void add_resume(const std::string& what);

 private:
  CLI::App& app_;
  Invocation& invocation_;
};

/// Completes a sampling command from its name, summary and make_run. The command runs cases of the
/// kind with the same name and has the options of a sampling run. `may_reach_out` adds the options
/// that permit running programs and connecting to hosts. `resumed` is the end of the help text of
/// --resume.
[[nodiscard]] Command sampled_command(Command command, bool may_reach_out,
                                      const char* resumed = "run");

}  // namespace wheeltap::apps
