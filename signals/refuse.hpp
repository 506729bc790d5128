// Error message for an invalid setting.
#pragma once

#include <stdexcept>
#include <string>

#include "base/number.hpp"

namespace wheeltap::signals {

/// Throws std::invalid_argument: "segment = 4: must be at least 8 samples".
[[noreturn]] inline void refuse(const std::string& name, auto value, const std::string& bound) {
  throw std::invalid_argument(name + " = " + base::number(static_cast<double>(value)) + ": " +
                              bound);
}

}  // namespace wheeltap::signals
