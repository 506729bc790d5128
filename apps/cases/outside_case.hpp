// "predictor" in a case, where it is a model of someone else's: a server's, or a program's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "identification/emulation/outside_emulator.hpp"

namespace wheeltap::apps {

/// How long to wait for an answer, and how often to ask again.
struct Patience {
  double timeout_seconds = 3600.0;  ///< for one answer
  int retries = 0;
};

/// A model that a UM-Bridge server offers.
struct UmbridgeSpec {
  std::string url;     ///< http://host:port, with a path or without
  std::string host{};  ///< of it
  std::string model;   ///< empty: the only one, or "forward"
  Json config = Json::object();
  Patience patience = {.retries = 4};
};

/// A program that is run once an answer.
struct CommandSpec {
  std::vector<std::string> words;  ///< program and arguments; {in}, {out} and {case} stand in them
  bool numbers = false;            ///< plain numbers in its files, not JSON
  std::filesystem::path folder;    ///< of the case
  InputFiles files{};              ///< the program and what its command names with a folder
  Patience patience = {.retries = 1};
};

struct OutsideSpec {
  std::optional<UmbridgeSpec> umbridge = {};
  std::optional<CommandSpec> command = {};  ///< one of the two
  std::vector<int> order = {};              ///< input i is unknown order[i]
  std::vector<std::string> names = {};      ///< of the inputs
  std::optional<identification::OutsideEmulatorSpec> emulator = {};
  std::filesystem::path memory =
      {};  ///< a file of the user's for its answers; empty: the run's own
};

/// Whether /predictor is such a model.
[[nodiscard]] bool has_outside_model(const CaseFile& file);
/// Reads /predictor of a case with these unknowns. Throws Failure.
[[nodiscard]] OutsideSpec parse_outside(const CaseFile& file,
                                        const std::vector<std::string>& unknowns);

/// The model in a few words.
[[nodiscard]] std::string in_words(const OutsideSpec& spec);
}  // namespace wheeltap::apps
