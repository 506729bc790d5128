// What to write in place of text that is not JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wheeltap::apps {

/// "; write …" for common mistakes at `at`, the 0-based byte at which a parser of JSON gave up:
/// units, decimal commas, comments, single quotes, missing and trailing commas. Empty where the
/// mistake is none of these.
[[nodiscard]] std::string syntax_remedy(std::string_view text, std::size_t at);

}  // namespace wheeltap::apps
