// What texts from outside may hold, and how they are shown.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// What editors of some systems put before a text in UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The byte at which `text` stops being UTF-8 (Unicode 15, table 3-7: no overlong forms, no
/// surrogates) or holds what no terminal should be sent: control characters, C0 and C1 alike, line
/// and paragraph separators, and the marks that reverse or isolate the direction of writing.
/// `allowed` are control characters that are fine here, e.g. "\n\t".
[[nodiscard]] std::optional<std::size_t> first_unprintable(std::string_view text,
                                                           std::string_view allowed = {});

/// The text with all of those escaped, "\x1b", "\n", "\u{202e}", so that it is one line of UTF-8
/// that shows as it is. Backslashes stay as they are: it is for eyes, not for reading back.
[[nodiscard]] std::string printable(std::string_view text);

/// The text, in UTF-8: what is none is taken for Latin-1 (ISO 8859-1), the alphabet of loggers and
/// spreadsheets that write "Weg [µm]" in one byte a character.
[[nodiscard]] std::string in_utf8(std::string_view text);

}  // namespace wheeltap::io
