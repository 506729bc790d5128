// Corrections of text that is not JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wheeltap::apps {

/// Correction "; write …" of a common mistake at `at`, the 0-based byte at which the JSON parser
/// stopped. Common mistakes are units, decimal commas, comments, single quotes, missing and
/// trailing commas. The result is empty for other mistakes.
[[nodiscard]] std::string syntax_remedy(std::string_view text, std::size_t at);

}  // namespace wheeltap::apps
