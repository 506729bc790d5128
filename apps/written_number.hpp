// Numbers written as text in a case: "0.1%", "0.9 m", "210 GPa", "6,3".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wheeltap::apps {

struct WrittenNumber {
  double value;      ///< the number in SI units
  std::string unit;  ///< SI unit of the number; empty for a percentage or a number without unit
};

/// Parses all of `text`: digits with a decimal point or comma, and optionally a unit or a percent
/// sign. The result is empty for any other text or an unknown unit.
[[nodiscard]] std::optional<WrittenNumber> written_number(std::string_view text);

/// `value` as JSON for a case, with up to 15 digits: "0.001", "210e9", "-2.5e-7".
[[nodiscard]] std::string pasted(double value);

/// Advice "write 210e9 (Pa)" if `text` contains a number with a unit; otherwise empty.
[[nodiscard]] std::string number_to_write(std::string_view text);

}  // namespace wheeltap::apps
