// What to type in place of a command line that CLI11 rejects.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace wheeltap::apps {

/// "damage has no option --quik; did you mean --quick?" for words that `command` of `app` does not
/// take; empty where there are none.
[[nodiscard]] std::string unexpected_words(const CLI::App& app, const CLI::App& command);

/// Why `word`, the first of the command line, is no command of `app`, and what to type.
[[nodiscard]] std::string unknown_command(const CLI::App& app, const std::string& word);

/// "--output is required: …", with its own help and an example.
[[nodiscard]] std::string output_is_missing(const CLI::App& command);

/// What is missing of what `command` must have, and an example; none where nothing is.
[[nodiscard]] std::optional<std::string> missing_option(const CLI::App& command);

}  // namespace wheeltap::apps
