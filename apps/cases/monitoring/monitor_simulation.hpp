// The simulated series of the starter case.
#pragma once

#include <cstdint>
#include <string>

namespace wheeltap::apps {

/// CSV of 120 days with a time step of 2 h, simulated from the "truth" of the starter case: the air
/// temperature, and three frequencies with a steeper slope below 0 °C. From hour 2400 on, the
/// second frequency is 1.5 % lower.
[[nodiscard]] std::string simulated_series_csv(std::uint64_t seed);

}  // namespace wheeltap::apps
