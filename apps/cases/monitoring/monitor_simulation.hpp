// The simulated series of the starter case.
#pragma once

#include <cstdint>
#include <string>

namespace wheeltap::apps {

/// CSV of 120 days at 2 h, as the "truth" of the starter case describes it: three frequencies that
/// rise faster below 0 °C, and the air temperature. From hour 2400 on the second frequency is 1 %
/// lower.
[[nodiscard]] std::string simulated_series_csv(std::uint64_t seed);

}  // namespace wheeltap::apps
