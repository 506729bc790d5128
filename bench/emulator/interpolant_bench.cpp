// Cost of one evaluation of each emulator at random points: 20 responses.
#include <benchmark/benchmark.h>

#include "emulator/cubic_interpolant.hpp"
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

/// Times f.evaluate at 1024 points in turn.
template <class Emulator>
void time_evaluations(benchmark::State& state, const Emulator& f, const RowMatrix& points) {
  std::vector<double> out(kResponses);
  const auto d = static_cast<std::size_t>(points.cols());
  Eigen::Index i = 0;
  for (auto _ : state) {
    f.evaluate(std::span(points.row(i).data(), d), out);
    benchmark::DoNotOptimize(out.data());
    i = (i + 1) % points.rows();
  }
}

RowMatrix random_values(const std::vector<Factor>& factors) {
  return RowMatrix::Random(full_factorial(factors).runs(), kResponses);
}

void multilinear(benchmark::State& state) {
  const auto factors = source_like(static_cast<int>(state.range(0)));
  time_evaluations(state, MultilinearInterpolant(factors, random_values(factors)),
                   random_design(factors, 1024, 1).points);
}
BENCHMARK(multilinear)->DenseRange(1, 6)->ArgName("factors");

void monotone_cubic(benchmark::State& state) {
  const auto factors = source_like(static_cast<int>(state.range(0)));
  time_evaluations(state,
                   CubicInterpolant(factors, random_values(factors),
                                    std::vector(factors.size(), AxisRule::monotone_cubic)),
                   random_design(factors, 1024, 1).points);
}
BENCHMARK(monotone_cubic)->DenseRange(1, 4)->ArgName("factors");

/// Locations on levels (every element a site), reductions anywhere.
void monotone_cubic_at_sites(benchmark::State& state) {
  const auto factors = source_like(4);
  RowMatrix points = random_design(factors, 1024, 1).points;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (Eigen::Index j : {0, 2})
      points(i, j) = factors[0].levels[static_cast<std::size_t>(points(i, j) * 10)];
  time_evaluations(state,
                   CubicInterpolant(factors, random_values(factors),
                                    std::vector(factors.size(), AxisRule::monotone_cubic)),
                   points);
}
BENCHMARK(monotone_cubic_at_sites);

}  // namespace

BENCHMARK_MAIN();
