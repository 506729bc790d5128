// Numbers that a case's author wrote as text: "0.1%", "0.9 m", "210 GPa", "6,3".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::apps {

struct WrittenNumber {
  double value;      ///< in SI units
  std::string unit;  ///< the SI unit; empty where the text has none, or is a percentage
};

/// The number that all of `text` states: digits with a decimal point or a decimal comma, and
/// perhaps a unit or a percent sign. None where it states no number, or one in an unknown unit.
[[nodiscard]] std::optional<WrittenNumber> written_number(std::string_view text);

/// `value` as a case may hold it, 15 digits: "0.001", "210e9", "-2.5e-7".
[[nodiscard]] std::string pasted(double value);

/// "write 210e9 (Pa)" where `text` states a number, else empty.
[[nodiscard]] std::string number_to_write(std::string_view text);

}  // namespace wheeltap::apps
