// Validation of strings from outside the program, and their preparation for display.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// UTF-8 byte order mark. Some editors write this mark at the beginning of a file.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Returns the index of the first byte that is not valid UTF-8 (Unicode 15, table 3-7: no overlong
/// forms, no surrogates), or that begins a character unsafe for a terminal. Unsafe characters are
/// C0 and C1 control characters, line and paragraph separators, and marks that reverse or isolate
/// the writing direction. `allowed` lists accepted control characters, e.g. "\n\t".
[[nodiscard]] std::optional<std::size_t> first_unprintable(std::string_view text,
                                                           std::string_view allowed = {});

/// Returns the string as one line of UTF-8 for display. Invalid bytes and unsafe characters (see
/// `first_unprintable`) are escaped: "\x1b", "\n", "\u{202e}". Backslashes are not escaped, so the
/// original string cannot be restored from the result.
[[nodiscard]] std::string printable(std::string_view text);

/// Converts a string to UTF-8. A string that is not UTF-8 is read as Latin-1 (ISO 8859-1), the
/// encoding that many loggers and spreadsheets write.
[[nodiscard]] std::string in_utf8(std::string_view text);

}  // namespace wheeltap::io
