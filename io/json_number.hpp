// Numbers as JSON writes them.
#pragma once

#include <string>

namespace wheeltap::io {

/// The shortest text that reads back as x, as nlohmann-json dumps it: "0.3", "70000000000.0",
/// "null" for what is not finite. What is identified by such texts stays the same over versions.
[[nodiscard]] std::string json_number(double x);

}  // namespace wheeltap::io
