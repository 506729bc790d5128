// Printed numbers, and cells that mean "no value".
#pragma once

#include <optional>
#include <string_view>

namespace wheeltap::io {

/// The printed precision of numbers: the largest numbers of digits after the point and of
/// significant digits. Negative without any number.
struct PrintedDigits {
  int decimals = -1;
  int digits = -1;
};

/// The number that the whole text represents, as the nearest double, like std::from_chars.
/// std::nullopt for an empty text and beyond the range of doubles. `decimal` is '.' or ','. Accepts
/// Fortran exponents ("1.5D-3").
[[nodiscard]] std::optional<double> parse_number(std::string_view text, char decimal = '.');

/// A number with thousands separators: "1.234,5", "1'234.5", "1 234 567". A single comma or point
/// between two groups ("1,234") could be the decimal mark; `grouped` says that other numbers prove
/// it to be a thousands separator.
[[nodiscard]] std::optional<double> parse_grouped_number(std::string_view text, char decimal,
                                                         bool proven = false);

/// True for a text with which loggers and spreadsheets mark "no value": empty, NA, N/A, NULL, #N/A,
/// 1.#QNAN, "-", "---", … ("nan" and "inf" are numbers).
[[nodiscard]] bool is_missing_value(std::string_view text);

/// The same, or a logger's word for a missing value: "overload", "error", "no data". Use it only in
/// columns of numbers, because such words may be names.
[[nodiscard]] bool is_missing_word(std::string_view text);

/// Reads the decimal number at the start of [p, end) and its printed precision. Returns the end of
/// the number; null if there is none, or it is nan, inf or beyond the range.
[[nodiscard]] const char* read_number(const char* p, const char* end, double& value,
                                      PrintedDigits& digits, char decimal = '.');

}  // namespace wheeltap::io
