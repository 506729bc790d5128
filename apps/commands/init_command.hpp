// `wheeltap init`: a case to start from, with every key explained beside it.
#pragma once

#include <filesystem>
#include <string>

namespace wheeltap::apps {

/// Every key that a case of a kind may have, from its schema: a Markdown table of path, whether it
/// must be there, and what is allowed. "[]" in a path stands for each element of a list. Throws
/// Failure (64) for a kind without a schema.
[[nodiscard]] std::string describe_keys(const std::string& kind);

/// Writes KIND.json, KIND.md and the data they need into `folder`, and prints what to do next.
/// `structure` is "beam", or what else the kind has a starter for. Throws Failure: 64 for a kind
/// (or a structure) that has no starter case, 73 where one of the files exists already (none is
/// written then) or cannot be written.
void run_init(const std::string& kind, const std::string& structure,
              const std::filesystem::path& folder);

}  // namespace wheeltap::apps
