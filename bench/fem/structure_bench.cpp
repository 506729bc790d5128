// Compares reanalysis of two plane frames with three damages and eigensolves, within one run. With
// 300 degrees of freedom, reanalysis keeps all modes; the eigensolve is dense. With 20 000, it
// keeps 60 modes; the eigensolve is a sparse shift-invert solve for 60 modes.
//
// Counters for the second frame: `bound` is the largest error bound of the 20 frequencies, `error`
// the largest difference from full solutions; both are relative.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <random>

#include "base/eigen_solvers.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "frames.hpp"

namespace {

using namespace wheeltap::fem;
namespace bench = wheeltap::bench;

const Mesh& mesh() {
  static const Mesh kMesh(bench::frame(3, 1, 11, 12));  // 300 degrees of freedom
  return kMesh;
}

const Mesh& large_mesh() {
  static const Mesh kMesh(bench::frame(27, 10, 11, 12));
  return kMesh;
}

StructureChange three(const Mesh& mesh, std::mt19937_64& random, bool cracks) {
  std::uniform_int_distribution<int> pick(0, static_cast<int>(mesh.elements().size()) - 1);
  StructureChange change;
  std::vector<int> taken;
  while (taken.size() < 3) {
    const int e = pick(random);
    if (std::ranges::find(taken, e) != taken.end()) continue;
    taken.push_back(e);
    const auto& strains = mesh.elements()[static_cast<std::size_t>(e)].strains;
    for (const int row : strains) {
      if (row < 0) continue;
      if (cracks && row != strains[static_cast<std::size_t>(ElementStrain::bending_z)]) continue;
      change.softenings.push_back({{{row, 1.0}}, 0.6});
    }
  }
  return change;
}

void BM_Reanalysis(benchmark::State& state) {
  const auto d = std::make_shared<const Discretisation>(mesh().discretisation());
  const StructureReanalysis reanalysis(d, 20);
  auto workspace = reanalysis.make_workspace();
  std::mt19937_64 random(1);
  std::vector<StructureChange> changes;
  for (int i = 0; i < 64; ++i) changes.push_back(three(mesh(), random, state.range(0) != 0));
  std::vector<double> f(20);
  std::size_t next = 0;
  for (auto _ : state) {
    reanalysis.solve(changes[next++ % changes.size()], workspace, {.frequencies_hz = f});
    benchmark::DoNotOptimize(f.data());
  }
  state.counters["dofs"] = static_cast<double>(d->size());
}
BENCHMARK(BM_Reanalysis)->ArgName("cracks")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void BM_DenseEigensolve(benchmark::State& state) {
  const Eigen::MatrixXd k(mesh().discretisation().stiffness), m(mesh().discretisation().mass);
  for (auto _ : state) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        k, m,
        state.range(0) != 0 ? Eigen::ComputeEigenvectors | Eigen::Ax_lBx
                            : Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
    benchmark::DoNotOptimize(solver.eigenvalues().data());
  }
}
BENCHMARK(BM_DenseEigensolve)->ArgName("vectors")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// With `revisited`, all changes were solved before, as in a chain that repeats its changes.
void BM_FewModes(benchmark::State& state) {
  const auto d = std::make_shared<const Discretisation>(large_mesh().discretisation());
  const StructureReanalysis reanalysis(d, 20, 60);
  auto workspace = reanalysis.make_workspace();
  std::mt19937_64 random(1);
  std::vector<StructureChange> changes;
  for (int i = 0; i < 48; ++i) changes.push_back(three(large_mesh(), random, false));
  std::vector<double> f(20), bounds(20);
  std::size_t next = 0;
  double bound = 0.0, error = 0.0;
  const auto solve = [&](const StructureChange& change) {
    reanalysis.solve(change, workspace, {.frequencies_hz = f, .bounds_hz = bounds});
  };
  if (state.range(0) != 0)
    for (const StructureChange& change : changes) solve(change);
  for (auto _ : state) {
    solve(changes[next++ % changes.size()]);
    benchmark::DoNotOptimize(f.data());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    solve(changes[i]);
    const StructureModes full = structure_modes(changed(*d, changes[i]), 20);
    for (std::size_t k = 0; k < f.size(); ++k) {
      const double exact = full.frequencies_hz[static_cast<Eigen::Index>(k)];
      bound = std::max(bound, bounds[k] / exact);
      error = std::max(error, std::abs(f[k] / exact - 1.0));
    }
  }
  state.counters["dofs"] = static_cast<double>(d->size());
  state.counters["bound"] = bound;
  state.counters["error"] = error;
}
BENCHMARK(BM_FewModes)->ArgName("revisited")->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_FewModes)->ArgName("revisited")->Arg(0)->Iterations(48)->Unit(benchmark::kMicrosecond);

void BM_ShiftInvert(benchmark::State& state) {
  std::mt19937_64 random(1);
  const Discretisation d =
      changed(large_mesh().discretisation(), three(large_mesh(), random, false));
  for (auto _ : state) benchmark::DoNotOptimize(structure_modes(d, 60).eigenvalues.data());
}
BENCHMARK(BM_ShiftInvert)->Unit(benchmark::kMicrosecond);

}  // namespace
