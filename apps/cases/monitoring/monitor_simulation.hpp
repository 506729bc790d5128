// A simulated series, for the starter case.
#pragma once

#include <cstdint>
#include <string>

namespace wheeltap::apps {

/// CSV of 120 days at 2 h: hour, three frequencies, air temperature. Below 0 °C the frequencies
/// rise faster; 5 % of the entries are missing, 1 % are outliers. From day 100 on the second
/// frequency is 1 % lower.
[[nodiscard]] std::string simulated_series_csv(std::uint64_t seed);

}  // namespace wheeltap::apps
