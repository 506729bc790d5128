// The server of the interactive application: HTTP on the loopback address of this machine.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/failure.hpp"

namespace wheeltap::apps {

/// A starter case.
struct StarterCase {
  std::string kind, structure;
};

/// The data and functions of the program that the server uses.
struct AppProgram {
  std::vector<std::string> kinds = {};  ///< kinds of cases
  std::vector<StarterCase> starters = {};
  /// Names of the commands that have checkpoints, --quick and --resume.
  std::vector<std::string> sampled = {};
  /// Returns the name of the command that runs a case with this text; empty if no command runs it.
  std::function<std::string(const std::string& text)> command = {};
  /// Checks `text`, the content of the case file `path`, with the checks that its command makes
  /// before a run. `allowed` returns true for input files that the case is permitted to use.
  /// Returns the first fault, if any.
  std::function<std::optional<CasePlace>(
      const std::filesystem::path& path, const std::string& text,
      const std::function<bool(const std::filesystem::path&)>& allowed)>
      check = {};
  /// Writes a starter case into a folder and returns the path of the case. Throws Failure.
  std::function<std::filesystem::path(const StarterCase& starter,
                                      const std::filesystem::path& folder)>
      start = {};
};

struct AppOptions {
  std::filesystem::path folder = ".";
  int port = 0;     ///< port of the server; 0: any free port
  int at_once = 1;  ///< largest number of simultaneous runs
  int threads = 1;  ///< threads per run
  /// Called with the URL when the server accepts connections
  std::function<void(const std::string& address)> ready = {};
  std::function<bool()> stop = {};  ///< returns true to stop; called a few times per second
};

/// Serves the application until stop() returns true. The URL contains a random token of 128 bits.
/// The server rejects requests without this token, with another origin or another host name, and
/// with methods other than GET and POST. Reports have a separate token, which gives access to
/// reports only. Throws Failure if the folder is missing or the port is not available.
void serve_application(const AppProgram& program, const AppOptions& options);

}  // namespace wheeltap::apps
