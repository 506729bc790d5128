// Run time of a design: 20 frequencies of the beam of Tiboaca 2016 (100 elements) by exact
// reanalysis, and by the full eigensolutions that the reanalysis replaces.
#include <benchmark/benchmark.h>

#include <chrono>
#include <random>
#include <vector>

#include "base/eigen_solvers.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/sections/section.hpp"

namespace {

using namespace wheeltap::fem;

constexpr int kModes = 20;

Beam source_beam() {
  return {.length = 1.0,
          .elements = 100,
          .supports = named_supports("simply-supported", 1.0),
          .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
          .section = section(Rectangle{.width = 0.025, .height = 0.006}, 0.3)};
}

std::vector<std::vector<Damage>> random_designs(std::size_t damages) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::vector<Damage>> designs(512);
  for (auto& design : designs)
    for (std::size_t i = 0; i < damages; ++i)
      design.push_back({.location = uniform(generator), .reduction = 0.9 * uniform(generator)});
  return designs;
}

void reanalysis_damages(benchmark::State& state) {
  const Reanalysis reanalysis(source_beam(), kModes);
  auto workspace = reanalysis.make_workspace();
  const auto designs = random_designs(static_cast<std::size_t>(state.range(0)));
  std::vector<double> f(kModes);
  std::size_t i = 0;
  for (auto _ : state) {
    reanalysis.frequencies_hz(designs[i++ % designs.size()], {}, workspace, f);
    benchmark::DoNotOptimize(f.data());
  }
}
BENCHMARK(reanalysis_damages)->DenseRange(1, 6)->Unit(benchmark::kMicrosecond);

void reanalysis_rigid_supports(benchmark::State& state) {
  const Reanalysis reanalysis(source_beam(), kModes);
  auto workspace = reanalysis.make_workspace();
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::vector<SpringSupport>> designs(512);
  for (auto& design : designs)
    for (long i = 0; i < state.range(0); ++i) design.push_back({.location = uniform(generator)});
  std::vector<double> f(kModes);
  std::size_t i = 0;
  for (auto _ : state) {
    reanalysis.frequencies_hz({}, designs[i++ % designs.size()], workspace, f);
    benchmark::DoNotOptimize(f.data());
  }
}
BENCHMARK(reanalysis_rigid_supports)->DenseRange(1, 2)->Unit(benchmark::kMicrosecond);

void reanalysis_gradients(benchmark::State& state) {
  const Reanalysis reanalysis(source_beam(), kModes);
  auto workspace = reanalysis.make_workspace();
  const auto damages = static_cast<std::size_t>(state.range(0));
  const auto designs = random_designs(damages);
  std::vector<double> f(kModes), gradients(kModes * damages);
  std::size_t i = 0;
  for (auto _ : state) {
    reanalysis.solve(designs[i++ % designs.size()], {}, workspace,
                     {.frequencies_hz = f,
                      .damage_gradients_hz = gradients,
                      .element_gradients_hz = {},
                      .shapes = {},
                      .points = {}});
    benchmark::DoNotOptimize(gradients.data());
  }
}
BENCHMARK(reanalysis_gradients)->Arg(1)->Arg(2)->Arg(5)->Unit(benchmark::kMicrosecond);

void reanalysis_element_gradients_and_shapes(benchmark::State& state) {
  const Reanalysis reanalysis(source_beam(), kModes);
  auto workspace = reanalysis.make_workspace();
  const auto designs = random_designs(2);
  std::vector<Reanalysis::Point> points;
  for (int p = 1; p < 10; ++p) points.push_back({.at = 0.1 * p});
  std::vector<double> f(kModes), gradients(kModes * 100), shapes(kModes * points.size());
  std::size_t i = 0;
  for (auto _ : state) {
    reanalysis.solve(designs[i++ % designs.size()], {}, workspace,
                     {.frequencies_hz = f,
                      .damage_gradients_hz = {},
                      .element_gradients_hz = gradients,
                      .shapes = shapes,
                      .points = points});
    benchmark::DoNotOptimize(gradients.data());
  }
}
BENCHMARK(reanalysis_element_gradients_and_shapes)->Unit(benchmark::kMicrosecond);

/// The table of Tiboaca 2016 for two damages: 10 × 10 sites × 4 × 4 multipliers.
void two_site_table_of_1600_designs(benchmark::State& state) {
  const Reanalysis reanalysis(source_beam(), kModes);
  auto workspace = reanalysis.make_workspace();
  const Beam& beam = reanalysis.beam();
  std::vector<double> f(kModes);
  for (auto _ : state)
    for (int first = 4; first < 100; first += 10)
      for (int second = 5; second < 100; second += 10)
        for (const double r1 : {0.0, 0.2, 0.4, 0.6})
          for (const double r2 : {0.0, 0.2, 0.4, 0.6}) {
            const Damage damages[] = {{beam.element_midpoint(first), r1},
                                      {beam.element_midpoint(second), r2}};
            reanalysis.frequencies_hz(damages, {}, workspace, f);
            benchmark::DoNotOptimize(f.data());
          }
}
BENCHMARK(two_site_table_of_1600_designs)->Unit(benchmark::kMillisecond);

void full_solution(benchmark::State& state, bool dense) {
  const Beam beam = source_beam();
  const auto designs = random_designs(2);
  std::size_t i = 0;
  for (auto _ : state) {
    const Defects defects{.damages = designs[i++ % designs.size()], .supports = {}};
    benchmark::DoNotOptimize(
        modal_analysis(beam, defects, {.modes = kModes, .dense = dense}).frequencies_hz.data());
  }
}
BENCHMARK_CAPTURE(full_solution, sparse, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(full_solution, dense, true)->Unit(benchmark::kMicrosecond);

/// Solves K φ = λ M φ with all vectors, like a simple program.
void plain_dense_eigensolve(benchmark::State& state) {
  const Assembly<double> a = assemble<double>(source_beam(), {});
  const Eigen::MatrixXd k(a.stiffness), m(a.mass);
  for (auto _ : state) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
    benchmark::DoNotOptimize(solver.eigenvalues().data());
  }
}
BENCHMARK(plain_dense_eigensolve)->Unit(benchmark::kMicrosecond);

/// Computes 20 frequencies of a damaged beam by reanalysis, and by a dense eigensolve of the same
/// problem, in turns within one run. Other load of the machine thus hardly changes the ratio of the
/// times.
void reanalysis_against_dense_eigensolve(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  const Beam beam = source_beam();
  const Reanalysis reanalysis(beam, kModes);
  auto workspace = reanalysis.make_workspace();
  const auto designs = random_designs(static_cast<std::size_t>(state.range(0)));
  const Defects defects{.damages = designs[0], .supports = {}};
  const Assembly<double> a = assemble<double>(beam, defects);
  const Eigen::MatrixXd k(a.stiffness), m(a.mass);
  std::vector<double> f(kModes);
  std::chrono::duration<double> fast{}, dense{};
  for (auto _ : state) {
    const auto start = Clock::now();
    for (const auto& design : designs) {
      reanalysis.frequencies_hz(design, {}, workspace, f);
      benchmark::DoNotOptimize(f.data());
    }
    const auto middle = Clock::now();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
    benchmark::DoNotOptimize(solver.eigenvalues().data());
    fast += middle - start;
    dense += Clock::now() - middle;
  }
  const double runs = static_cast<double>(state.iterations());
  const double each = fast.count() / runs / static_cast<double>(designs.size());
  state.counters["reanalysis_us"] = 1e6 * each;
  state.counters["dense_us"] = 1e6 * dense.count() / runs;
  state.counters["times_faster"] = dense.count() / runs / each;
}
BENCHMARK(reanalysis_against_dense_eigensolve)
    ->Arg(2)
    ->Arg(5)
    ->Unit(benchmark::kMillisecond)
    ->MinTime(2.0);

void preparing_the_reanalysis(benchmark::State& state) {
  Beam beam = source_beam();
  beam.elements = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const Reanalysis reanalysis(beam, kModes);
    benchmark::DoNotOptimize(&reanalysis);
  }
}
BENCHMARK(preparing_the_reanalysis)->Arg(100)->Arg(400)->Unit(benchmark::kMillisecond);

}  // namespace
