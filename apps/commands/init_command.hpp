// `wheeltap init`: a starter case and a description of every key.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace wheeltap::apps {

/// Every key that a case of a kind may have, from the schema of the kind. The result is a Markdown
/// table; a row has the path of a key, whether the key is required, and its meaning. "[]" in a path
/// stands for each element of a list. Throws Failure (64) for a kind without a schema.
[[nodiscard]] std::string describe_keys(const std::string& kind);

/// Writes KIND.json, KIND.md and data files into `folder` and returns their paths, KIND.json first.
/// Throws the same exceptions as run_init.
std::vector<std::filesystem::path> write_starter(const std::string& kind,
                                                 const std::string& structure,
                                                 const std::filesystem::path& folder);

/// Kind and structure of every starter case.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> starter_cases();

/// Writes a starter case KIND.json, its description KIND.md and data files into `folder`, and
/// prints the next steps. `structure` is "beam", or another structure for which the kind has a
/// starter case. Throws Failure: 64 for a kind or a structure without a starter case; 73 if one of
/// the files already exists (then no file is written) or cannot be written.
void run_init(const std::string& kind, const std::string& structure,
              const std::filesystem::path& folder);

}  // namespace wheeltap::apps
