// Printed numbers, and cells of a table that hold none.
#pragma once

#include <optional>
#include <string_view>

namespace wheeltap::io {

/// How finely numbers are printed: the most digits after the point and the most significant digits.
/// Negative where nothing was printed.
struct PrintedDigits {
  int decimals = -1;
  int digits = -1;
};

/// The number that this text is, all of it; empty text is none. The nearest double, as
/// std::from_chars has it; text beyond the range of doubles is none. `decimal` is '.' or ','.
/// Fortran's exponents ("1.5D-3") are read as well.
[[nodiscard]] std::optional<double> parse_number(std::string_view text, char decimal = '.');

/// A number with separators of thousands: "1.234,5", "1'234.5", "1 234 567". A comma or a point
/// between two groups only ("1,234") could be the decimal mark: it is one of thousands where that
/// is proven by other numbers.
[[nodiscard]] std::optional<double> parse_grouped_number(std::string_view text, char decimal,
                                                         bool proven = false);

/// A text by which loggers and spreadsheets say "no value": empty, NA, N/A, NULL, #N/A, 1.#QNAN,
/// "-", "---", … ("nan" and "inf" are numbers).
[[nodiscard]] bool is_missing_value(std::string_view text);

/// The same, or a word by which a logger says that it has none: "overload", "error", "no data". In
/// a column of numbers only: such words may be names.
[[nodiscard]] bool is_missing_word(std::string_view text);

/// Reads the decimal number at the start of [p, end) and how finely it is printed. Returns one past
/// it; null where there is none, or it is not a plain one (nan, inf, beyond the range).
[[nodiscard]] const char* read_number(const char* p, const char* end, double& value,
                                      PrintedDigits& digits, char decimal = '.');

}  // namespace wheeltap::io
