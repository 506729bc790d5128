// Printed numbers, and cells that mean "no value".
#pragma once

#include <optional>
#include <string_view>

namespace wheeltap::io {

/// The printed precision of numbers: the largest numbers of digits after the point and of
/// significant digits. Negative if there is no number.
struct PrintedDigits {
  int decimals = -1;
  int digits = -1;
};

/// Converts the whole text to the nearest double, as std::from_chars does. Returns std::nullopt for
/// an empty text, a text that is not a number, and a number beyond the range of doubles. `decimal`
/// is '.' or ','. Accepts Fortran exponents ("1.5D-3").
[[nodiscard]] std::optional<double> parse_number(std::string_view text, char decimal = '.');

/// A number with thousands separators: "1.234,5", "1'234.5", "1 234 567". A single comma or point
/// between two groups ("1,234") could be the decimal mark. `grouped` is true if other numbers of
/// the text show that it separates thousands.
[[nodiscard]] std::optional<double> parse_grouped_number(std::string_view text, char decimal,
                                                         bool proven = false);

/// True for a text with which loggers and spreadsheets mark "no value": empty, NA, N/A, NULL, #N/A,
/// 1.#QNAN, "-", "---", … ("nan" and "inf" are numbers).
[[nodiscard]] bool is_missing_value(std::string_view text);

/// True for a missing value (is_missing_value) and for words with which loggers mark it:
/// "overload", "error", "no data". Use this function only for columns of numbers; elsewhere such
/// words may be names.
[[nodiscard]] bool is_missing_word(std::string_view text);

/// Reads the decimal number at the start of [p, end) and its printed precision. Returns the end of
/// the number; null if there is no number, or if it is nan, inf or beyond the range of doubles.
[[nodiscard]] const char* read_number(const char* p, const char* end, double& value,
                                      PrintedDigits& digits, char decimal = '.');

}  // namespace wheeltap::io
