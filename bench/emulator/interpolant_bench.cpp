// Cost of one evaluation of each emulator at random points: 20 responses.
#include <benchmark/benchmark.h>

#include "emulator/multilinear_interpolant.hpp"

namespace {

using namespace wheeltap::emulator;

constexpr Eigen::Index kResponses = 20;

/// d factors on a grid of ten locations by four reductions, as the source's tables are.
std::vector<Factor> source_like(int d) {
  std::vector<Factor> factors;
  for (int j = 0; j < d; ++j) {
    Factor factor{.name = std::to_string(j), .unit = "", .levels = {}};
    const int levels = j % 2 ? 4 : 10;
    for (int i = 0; i < levels; ++i) factor.levels.push_back(0.1 * i);
    factors.push_back(factor);
  }
  return factors;
}

void multilinear(benchmark::State& state) {
  const auto factors = source_like(static_cast<int>(state.range(0)));
  const MultilinearInterpolant f(factors,
                                 RowMatrix::Random(full_factorial(factors).runs(), kResponses));
  const Design points = random_design(factors, 1024, 1);
  std::vector<double> out(kResponses);
  Eigen::Index i = 0;
  for (auto _ : state) {
    f.evaluate(points.point(i), out);
    benchmark::DoNotOptimize(out.data());
    i = (i + 1) % points.runs();
  }
}
BENCHMARK(multilinear)->DenseRange(1, 6)->ArgName("factors");

}  // namespace

BENCHMARK_MAIN();
