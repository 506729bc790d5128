// Numbers in JSON notation.
#pragma once

#include <string>

namespace wheeltap::io {

/// Converts x to the shortest string that converts back to x, in the format of nlohmann-json:
/// "0.3", "70000000000.0". The string is "null" if x is not finite. Because the format is fixed,
/// identifiers that contain numbers are the same in all versions of Wheeltap.
[[nodiscard]] std::string json_number(double x);

}  // namespace wheeltap::io
