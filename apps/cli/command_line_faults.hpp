// Corrections of command lines that CLI11 rejects.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace wheeltap::apps {

/// The message on words that `command` of `app` does not accept, e.g. "damage has no option --quik;
/// did you mean --quick?". The message is empty if the command accepts all words.
[[nodiscard]] std::string unexpected_words(const CLI::App& app, const CLI::App& command);

/// The message about an unknown command, with a correction; `word` is the first word of the command
/// line.
[[nodiscard]] std::string unknown_command(const CLI::App& app, const std::string& word);

/// The message "--output is required: …" with the help of the option and an example.
[[nodiscard]] std::string output_is_missing(const CLI::App& command);

/// The first missing option or argument that `command` requires, with an example; empty if none is
/// missing.
[[nodiscard]] std::optional<std::string> missing_option(const CLI::App& command);

}  // namespace wheeltap::apps
