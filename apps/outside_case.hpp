// "predictor" in a case, where it is a model of someone else's: a server's, or a program's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/case_file.hpp"
#include "apps/commands.hpp"
#include "apps/summary.hpp"
#include "identification/outside_emulator.hpp"
#include "identification/remembered_model.hpp"

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

/// What a run keeps of the model's answers, in its folder.
inline constexpr const char* kModelRuns = "model-runs.journal";

/// The model with these outputs, asked for its sizes where it can be, and what it has said before:
/// in the user's file, or, with --resume, in the run's. Its inputs are the unknowns in their own
/// order. Throws Failure (64 where a program may not be run: --allow-commands, or a host may not be
/// reached: --allow-hosts; this machine always may), io::FileError and
/// OutsideModelError.
[[nodiscard]] std::shared_ptr<identification::RememberedModel> open_outside(
    const CaseFile& file, const OutsideSpec& spec, int outputs, const CommonOptions& common);

/// The model in a few words.
[[nodiscard]] std::string in_words(const OutsideSpec& spec);
/// What of it a summary tells: whose it is, how often it was asked, how wrong its emulator is.
[[nodiscard]] Report outside_report(const OutsideSpec& spec,
                                    const identification::OutsideModel& model,
                                    const identification::OutsideEmulator* emulator = nullptr);

}  // namespace wheeltap::apps
