// Validates texts from outside the program and prepares them for display.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// UTF-8 byte order mark that some editors write.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The index of the first byte that is not valid UTF-8 (Unicode 15, table 3-7: no overlong forms,
/// no surrogates), or that begins a character which is unsafe for a terminal: C0 and C1 control
/// characters, line and paragraph separators, and marks that reverse or isolate the writing
/// direction. `allowed` lists accepted control characters, e.g. "\n\t".
[[nodiscard]] std::optional<std::size_t> first_unprintable(std::string_view text,
                                                           std::string_view allowed = {});

/// The text with all such bytes and characters escaped ("\x1b", "\n", "\u{202e}"), as one line of
/// UTF-8 for display. Backslashes are not escaped, so the text cannot be read back.
[[nodiscard]] std::string printable(std::string_view text);

/// The text in UTF-8. A text that is not UTF-8 is read as Latin-1 (ISO 8859-1), which many loggers
/// and spreadsheets write.
[[nodiscard]] std::string in_utf8(std::string_view text);

}  // namespace wheeltap::io
