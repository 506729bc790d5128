// Errors for invalid settings and unusable channels.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "base/number.hpp"

namespace wheeltap::signals {

/// Throws std::invalid_argument for a setting with an invalid value: "segment = 4: must be at least
/// 8 samples".
[[noreturn]] inline void refuse(const std::string& name, auto value, const std::string& bound) {
  throw std::invalid_argument(name + " = " + base::number(static_cast<double>(value)) + ": " +
                              bound);
}

/// The error for a channel that a computation cannot use: "channel = 3: is constant". Channel
/// numbers start at 0.
struct ChannelError : std::invalid_argument {
  ChannelError(long number, std::string why, std::optional<long> copied = {})
      : std::invalid_argument("channel = " + std::to_string(number) + ": " + why),
        channel(number),
        reason(std::move(why)),
        original(copied) {}
  long channel;
  std::string reason;
  std::optional<long> original;  ///< the channel to which this channel is proportional, if that is
                                 ///< the reason
};

}  // namespace wheeltap::signals
