// Run time and memory of the identification of modes with their covariance: modal_bench [THREADS].
// The structure is a chain of masses under white forces with one sensor per mass; the largest model
// order is 80.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "../../tests/signals/random_vibration.hpp"
#include "signals/modal/modal_identification.hpp"

int main(int count, char** arguments) {
  using namespace wheeltap::signals;
  const int threads = count > 1 ? std::atoi(arguments[1]) : 2;
  std::printf("%9s %10s %6s %6s %6s %6s %10s %10s %9s\n", "channels", "samples", "lags", "blocks",
              "order", "modes", "clock [s]", "CPU [s]", "MB");
  for (const auto& [channels, samples] :
       {std::pair{8, 61440L}, std::pair{20, 100'000L}, std::pair{20, 1'000'000L}}) {
    VibratingStructure structure = chain(channels, 1.0, 400.0);
    structure.step = 0.04;
    const Eigen::MatrixXd y = structure.accelerations(samples, 0.05, 1);
    const auto began = std::chrono::steady_clock::now();
    const std::clock_t spent = std::clock();
    const ModalResult found = identify_modes(y, {.sample_rate_hz = 1.0 / structure.step,
                                                 .lowest_hz = 0.2,
                                                 .largest_order = 80,
                                                 .threads = threads});
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    std::printf("%9d %10ld %6d %6d %6d %6zu %10.2f %10.2f %9.0f\n", channels, samples, found.lags,
                found.blocks, found.largest_order, found.modes.size(), took.count(),
                static_cast<double>(std::clock() - spent) / CLOCKS_PER_SEC,
                static_cast<double>(used.ru_maxrss) / 1024.0);
  }
}
