// mpirun -n N sharing_out: time for distributing work among ranks [µs], as wall time and as
// processor time of rank 0.
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>

#include "apps/runs/several_ranks.hpp"
#include "base/parallel.hpp"

int main() {
  using namespace wheeltap;
  using Clock = std::chrono::steady_clock;
  apps::JoinedRanks joined;
  const int ranks = base::ranks() == nullptr ? 1 : base::ranks()->size();
  std::printf("%d ranks, us per sharing out\n%8s %12s %12s %12s\n", ranks, "units", "bytes each",
              "clock", "processor");
  for (const int units : {1, 8, 64, 512}) {
    for (const std::size_t bytes :
         {std::size_t{100}, std::size_t{10'000}, std::size_t{1'000'000}}) {
      const int rounds = bytes * static_cast<std::size_t>(units) > 10'000'000 ? 10 : 100;
      const std::string outcome(bytes, 'x');
      std::size_t got = 0;
      const auto began = Clock::now();
      const std::clock_t spent = std::clock();
      for (int round = 0; round < rounds; ++round) {
        base::parallel_for(units, 1, [](int) {},
                           {.pack = [&](int) { return outcome; },
                            .unpack = [&](int, std::string_view b) { got += b.size(); }});
      }
      const std::chrono::duration<double, std::micro> took = Clock::now() - began;
      const double processor = 1e6 * static_cast<double>(std::clock() - spent) / CLOCKS_PER_SEC;
      std::printf("%8d %12zu %12.1f %12.1f\n", units, bytes, took.count() / rounds,
                  processor / rounds);
    }
  }
  joined.leave(0, {});
}
