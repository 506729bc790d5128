// Numbers in JSON notation.
#pragma once

#include <string>

namespace wheeltap::io {

/// Converts x to the shortest string that converts back to x, in the format of nlohmann-json:
/// "0.3", "70000000000.0". The string is "null" if x is not finite. The format is fixed, so that
/// identifiers with numbers are equal in all versions of Wheeltap.
[[nodiscard]] std::string json_number(double x);

}  // namespace wheeltap::io
