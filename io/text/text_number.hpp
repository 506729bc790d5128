// Conversion of printed numbers, and recognition of cells that mean "no value".
#pragma once

#include <optional>
#include <string_view>

namespace wheeltap::io {

/// The printed precision of numbers: the largest number of digits after the decimal point, and the
/// largest number of significant digits. Both values are -1 if no number has been read.
struct PrintedDigits {
  int decimals = -1;
  int digits = -1;
};

/// Converts the whole string to the nearest double, as std::from_chars does. Returns std::nullopt
/// for an empty string, a string that is not a number, and a number beyond the range of doubles.
/// `decimal` is '.' or ','. The exponent may have the Fortran form ("1.5D-3").
[[nodiscard]] std::optional<double> parse_number(std::string_view text, char decimal = '.');

/// Converts a number with thousands separators: "1.234,5", "1'234.5", "1 234 567". A single comma
/// or point between two groups of digits ("1,234") could be the decimal mark. `proven` is true if
/// other numbers of the text show that the character separates thousands.
[[nodiscard]] std::optional<double> parse_grouped_number(std::string_view text, char decimal,
                                                         bool proven = false);

/// True for a string with which loggers and spreadsheets mark a missing value: empty, NA, N/A,
/// NULL, #N/A, 1.#QNAN, "-", "---", … ("nan" and "inf" are numbers).
[[nodiscard]] bool is_missing_value(std::string_view text);

/// True for a missing value (is_missing_value) and for words with which loggers mark a missing
/// value: "overload", "error", "no data". Use this function only for columns of numbers; in other
/// cells, these words may be names.
[[nodiscard]] bool is_missing_word(std::string_view text);

/// Reads the decimal number at the start of [p, end). Increases `digits` if the number has more
/// printed digits. Returns the end of the number. Returns null if the string does not begin with a
/// number, or if the number is nan, inf or beyond the range of doubles.
[[nodiscard]] const char* read_number(const char* p, const char* end, double& value,
                                      PrintedDigits& digits, char decimal = '.');

}  // namespace wheeltap::io
