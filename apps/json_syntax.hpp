// Advice for text that is not valid JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wheeltap::apps {

/// Advice "; write …" for a common mistake. `at` is the index of the byte (from 0) at which the
/// JSON parser stopped. Common mistakes are units, decimal commas, comments, single quotes, missing
/// and trailing commas. The result is empty for other mistakes.
[[nodiscard]] std::string syntax_remedy(std::string_view text, std::size_t at);

}  // namespace wheeltap::apps
