// An external model as the "predictor" of a case: a server or a program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/emulation/outside_emulator.hpp"

namespace wheeltap::apps {

/// Timeout and number of retries of a prediction.
struct Patience {
  double timeout_seconds = 3600.0;  ///< longest time of one prediction
  int retries = 0;
};

/// A model on a UM-Bridge server.
struct UmbridgeSpec {
  std::string url;     ///< http://host:port, path optional
  std::string host{};  ///< host of `url`
  std::string model;   ///< name of the model; empty: the only model, or "forward"
  Json config = Json::object();
  Patience patience = {.retries = 4};
};

/// A program that Wheeltap runs once per prediction.
struct CommandSpec {
  std::vector<std::string> words;  ///< program and arguments, with {in}, {out} and {case}
  /// True if the program's files contain plain numbers instead of JSON
  bool numbers = false;
  std::filesystem::path folder;  ///< folder of the case
  InputFiles files{};            ///< fingerprints of the program and of arguments that are paths
  Patience patience = {.retries = 1};
};

struct OutsideSpec {
  std::optional<UmbridgeSpec> umbridge = {};
  std::optional<CommandSpec> command = {};  ///< exactly one of `command` and `umbridge` is set
  std::vector<int> order = {};              ///< input i is the unknown with index order[i]
  std::vector<std::string> names = {};      ///< names of the inputs
  std::optional<identification::OutsideEmulatorSpec> emulator = {};
  std::filesystem::path memory =
      /// File, named in the case, that stores predictions. If `memory` is empty, predictions are
      /// stored in the folder of the run.
      {};
};

/// True if /predictor is an external model.
[[nodiscard]] bool has_outside_model(const CaseFile& file);
/// Parses /predictor of a case with the given unknowns. Throws Failure.
[[nodiscard]] OutsideSpec parse_outside(const CaseFile& file,
                                        const std::vector<std::string>& unknowns);

/// A short name of the external model, for messages.
[[nodiscard]] std::string in_words(const OutsideSpec& spec);
}  // namespace wheeltap::apps
