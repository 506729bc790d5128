#include "apps/cases/monitoring/monitor_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "base/random.hpp"

namespace wheeltap::apps {

std::string simulated_series_csv(std::uint64_t seed) {
  constexpr std::array kFrequencies{3.98, 5.17, 9.9}, kSlope{-0.0004, -0.0006, -0.0005};
  constexpr int kRows = 120 * 12, kDamaged = 100 * 12;
  base::Random random(seed, 0, 0, base::Purpose::simulation);
  std::string out = "hour,f1 [Hz],f2 [Hz],f3 [Hz],air [degC]\n";
  double front = 0.0, drift = 0.0;
  for (int t = 0; t < kRows; ++t) {
    const double hour = 2.0 * t, day = hour / 24.0;
    front = 0.97 * front + 1.0 * random.normal();
    drift = 0.98 * drift + 0.2 * random.normal();
    const double air =
        4.0 + 5.0 * std::cos(kTwoPi * day / 60.0) + 3.0 * std::sin(kTwoPi * (day - 0.4)) + front;
    out += base::number(hour);
    for (std::size_t j = 0; j < kFrequencies.size(); ++j) {
      const double sd = random.uniform() < 0.01 ? 0.03 : 0.003;
      const double change = kSlope[j] * air + 5.0 * kSlope[j] * std::min(0.0, air) +
                            0.0008 * drift + sd * random.normal() +
                            (t >= kDamaged && j == 1 ? -0.01 : 0.0);
      out += ",";
      if (random.uniform() >= 0.05) out += base::fixed(kFrequencies[j] * std::exp(change), 4);
    }
    out += "," + base::fixed(air, 2) + "\n";
  }
  return out;
}

}  // namespace wheeltap::apps
