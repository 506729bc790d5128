// Numbers in JSON notation.
#pragma once

#include <string>

namespace wheeltap::io {

/// The shortest text that reads back as x, in the format of nlohmann-json: "0.3", "70000000000.0",
/// "null" if not finite. Identifiers that contain such numbers are therefore the same in all
/// versions.
[[nodiscard]] std::string json_number(double x);

}  // namespace wheeltap::io
