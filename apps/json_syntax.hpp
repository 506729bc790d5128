// Corrections of text that is not JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wheeltap::apps {

/// "; write …" for common mistakes at `at`, the 0-based byte where the JSON parser stopped: units,
/// decimal commas, comments, single quotes, missing and trailing commas. Empty for other mistakes.
[[nodiscard]] std::string syntax_remedy(std::string_view text, std::size_t at);

}  // namespace wheeltap::apps
