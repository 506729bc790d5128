// Run time of one evaluation of each emulator at random points, with 20 responses.
#include <benchmark/benchmark.h>

#include <cmath>

#include "emulator/anova.hpp"
#include "emulator/cubic_interpolant.hpp"
#include "emulator/gaussian_process.hpp"
#include "emulator/multilinear_interpolant.hpp"
#ifdef WHEELTAP_WITH_CGAL
#include "emulator/delaunay_interpolant.hpp"
#endif

namespace {

using namespace wheeltap::emulator;

constexpr Eigen::Index kResponses = 20;

/// d factors on a grid of ten locations by four reductions, as in the tables of Tiboaca 2016.
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

/// Locations at levels, as if every element were a site; reductions between levels.
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

void anova(benchmark::State& state) {
  const auto one = source_like(2), two = source_like(4);
  const MultilinearInterpolant single(one, random_values(one).cwiseAbs());
  const MultilinearInterpolant pair(two, random_values(two).cwiseAbs());
  const AnovaEmulator f(
      std::vector<double>(kResponses, 1.0), 2,
      [&](std::span<const double> x, std::span<double> y) { single.evaluate(x, y); },
      [&](std::span<const double> x, std::span<double> y) { pair.evaluate(x, y); },
      Additive::square);
  const RowMatrix block = random_design(one, 1024, 1).points;
  const Eigen::Index count = state.range(0);
  RowMatrix points(1024, 2 * count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index row = 0; row < 1024; ++row)
      points.row(row).segment(2 * i, 2) = block.row((row + 100 * i) % 1024);
  time_evaluations(state, f, points);
}
BENCHMARK(anova)->DenseRange(1, 5)->ArgName("components");

/// A smooth function of four factors. The measured times do not depend on this function.
RowMatrix smooth(const RowMatrix& points) {
  RowMatrix y(points.rows(), kResponses);
  for (Eigen::Index i = 0; i < y.rows(); ++i)
    for (Eigen::Index k = 0; k < kResponses; ++k)
      y(i, k) = std::sin((0.5 + 0.1 * static_cast<double>(k)) * points.row(i).sum());
  return y;
}

void gaussian_process_fit(benchmark::State& state) {
  const Design design = latin_hypercube(source_like(4), state.range(0), 1);
  const RowMatrix y = smooth(design.points).leftCols(1);
  for (auto _ : state) {
    const GaussianProcess f(design.factors, design.points, y);
    benchmark::DoNotOptimize(&f);
  }
}
BENCHMARK(gaussian_process_fit)
    ->Arg(100)
    ->Arg(200)
    ->Arg(400)
    ->ArgName("runs")
    ->Unit(benchmark::kMillisecond);

void gaussian_process(benchmark::State& state, bool shared, bool variance) {
  const Design design = latin_hypercube(source_like(4), state.range(0), 1);
  const GaussianProcess f(design.factors, design.points, smooth(design.points),
                          {.shared_lengths = shared, .most_fitted_runs = 50, .most_iterations = 3});
  const RowMatrix points = random_design(design.factors, 256, 2).points;
  std::vector<double> mean(kResponses), var(kResponses);
  Eigen::Index i = 0;
  for (auto _ : state) {
    const std::span<const double> x(points.row(i).data(), 4);
    if (variance)
      f.evaluate(x, mean, var);
    else
      f.evaluate(x, mean);
    benchmark::DoNotOptimize(mean.data());
    i = (i + 1) % points.rows();
  }
}
BENCHMARK_CAPTURE(gaussian_process, mean, false, false)->Arg(200)->Arg(400)->ArgName("runs");
BENCHMARK_CAPTURE(gaussian_process, mean_shared, true, false)->Arg(200)->Arg(400)->ArgName("runs");
BENCHMARK_CAPTURE(gaussian_process, variance, false, true)->Arg(200)->Arg(400)->ArgName("runs");
BENCHMARK_CAPTURE(gaussian_process, variance_shared, true, true)
    ->Arg(200)
    ->Arg(400)
    ->ArgName("runs");

#ifdef WHEELTAP_WITH_CGAL
Design scattered(int d) {
  return with_corners(latin_hypercube(source_like(d), 500, 1));
}

void delaunay_build(benchmark::State& state) {
  const Design design = scattered(static_cast<int>(state.range(0)));
  const RowMatrix y = smooth(design.points);
  std::size_t simplices = 0;
  for (auto _ : state)
    simplices = DelaunayInterpolant(design.factors, design.points, y).simplices();
  state.counters["simplices"] = static_cast<double>(simplices);
}
BENCHMARK(delaunay_build)->DenseRange(2, 5)->ArgName("factors")->Unit(benchmark::kMillisecond);

void delaunay(benchmark::State& state) {
  const Design design = scattered(static_cast<int>(state.range(0)));
  time_evaluations(state, DelaunayInterpolant(design.factors, design.points, smooth(design.points)),
                   random_design(design.factors, 1024, 2).points);
}
BENCHMARK(delaunay)->DenseRange(2, 5)->ArgName("factors");
#endif

}  // namespace

BENCHMARK_MAIN();
