// Reanalysis of a plane frame of 300 degrees of freedom with three damages, beside its dense
// eigensolve; ratios are of one run.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <algorithm>
#include <memory>
#include <random>

#include "fem/structures/mesh.hpp"
#include "fem/structures/structure_modes.hpp"
#include "fem/structures/structure_reanalysis.hpp"

namespace {

using namespace wheeltap::fem;

/// Three storeys of one bay on clamped feet, 11 elements a member: 300 degrees of freedom.
Structure frame() {
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const MemberSection section{.area = 6e-3, .second_moment_y = 2e-5, .shear_coefficient_z = 0.5};
  Structure s{.dimension = 2, .nodes = {}, .members = {}};
  for (int storey = 0; storey <= 3; ++storey)
    for (int side = 0; side < 2; ++side)
      s.nodes.push_back({"n", {5.0 * side + 0.1 * storey, 3.0 * storey, 0.0}});
  const auto add = [&](int a, int b, int elements) {
    const auto line = difference(s.nodes[static_cast<std::size_t>(b)].at,
                                 s.nodes[static_cast<std::size_t>(a)].at);
    s.members.push_back({.name = "m",
                         .nodes = {a, b},
                         .elements = elements,
                         .pieces = {{.to = norm(line), .material = material, .section = section}}});
  };
  for (int storey = 0; storey < 3; ++storey) {
    add(2 * storey, 2 * storey + 2, 11);
    add(2 * storey + 1, 2 * storey + 3, 11);
    add(2 * storey + 2, 2 * storey + 3, 12);
  }
  for (const int foot : {0, 1})
    s.supports.push_back({.node = foot, .fix = {true, true, true, true, true, true}});
  return s;
}

const Mesh& mesh() {
  static const Mesh kMesh(frame());
  return kMesh;
}

StructureChange three(std::mt19937_64& random, bool cracks) {
  std::uniform_int_distribution<int> pick(0, static_cast<int>(mesh().elements().size()) - 1);
  StructureChange change;
  std::vector<int> taken;
  while (taken.size() < 3) {
    const int e = pick(random);
    if (std::ranges::find(taken, e) != taken.end()) continue;
    taken.push_back(e);
    const auto& strains = mesh().elements()[static_cast<std::size_t>(e)].strains;
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
  for (int i = 0; i < 64; ++i) changes.push_back(three(random, state.range(0) != 0));
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

}  // namespace
