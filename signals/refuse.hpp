// Errors about bad settings and bad channels.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "base/number.hpp"

namespace wheeltap::signals {

/// Throws std::invalid_argument: "segment = 4: must be at least 8 samples".
[[noreturn]] inline void refuse(const std::string& name, auto value, const std::string& bound) {
  throw std::invalid_argument(name + " = " + base::number(static_cast<double>(value)) + ": " +
                              bound);
}

/// The error for a channel that a computation cannot use (channel numbers start at 0): "channel =
/// 3: does not move".
struct ChannelError : std::invalid_argument {
  ChannelError(long number, std::string why, std::optional<long> copied = {})
      : std::invalid_argument("channel = " + std::to_string(number) + ": " + why),
        channel(number),
        reason(std::move(why)),
        original(copied) {}
  long channel;
  std::string reason;
  std::optional<long> original;  ///< the channel that it is proportional to, if that is the reason
};

}  // namespace wheeltap::signals
