// Run time of a pass of expectation-maximisation over the samples of a mixture, for each
// instruction set of this processor. If likelihoods are cheap, such passes take most of the warm-up
// time.
//
// `component_s` is a rate: evaluations per second of the density and the moments of one component
// at one sample.
// All instruction sets give bitwise equal results, so only the ratio of their rates within one run
// matters. Registers of twice the width can at most double the rate.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "inference/mixtures/packed_mixture.hpp"

namespace wheeltap::inference::packed {
namespace {

constexpr int kComponents = 64;
constexpr std::size_t kSamples = 4000;

// Components with overlapping samples, like the components of a curved ridge.
std::vector<NormalMixture::Component> overlapping(int d, base::Random& random) {
  std::vector<NormalMixture::Component> out;
  for (int k = 0; k < kComponents; ++k) {
    out.push_back({1.0 / kComponents,
                   Eigen::VectorXd::NullaryExpr(d, [&] { return 2.0 * random.normal(); }),
                   Eigen::MatrixXd::Identity(d, d)});
  }
  return out;
}

void pass(benchmark::State& state, const Routines* routines, int dimension) {
  base::Random random(7, 0, 0, base::Purpose::test);
  const auto d = static_cast<std::size_t>(dimension);
  const auto components = overlapping(dimension, random);
  const std::vector<double> packed = pack(components, kInfinity);
  const std::size_t groups = groups_of(components.size()), stride = group_stride(d);
  std::vector<double> means(groups * kLanes * d);
  for (std::size_t k = 0; k < components.size(); ++k)
    for (std::size_t i = 0; i < d; ++i)
      means[((k / kLanes) * d + i) * kLanes + k % kLanes] =
          components[k].mean[static_cast<Eigen::Index>(i)];
  std::vector<double> z(kSamples * d), weight(kSamples, 1.0);
  for (double& x : z) x = 2.0 * random.normal();
  for (auto _ : state) {
    std::vector<double> moments(groups * (stride + kLanes), 0.0);
    benchmark::DoNotOptimize(routines->em_pass(packed.data(), means.data(), groups, stride,
                                               {kSamples, d, z.data(), weight.data()},
                                               moments.data()));
  }
  state.counters["component_s"] = benchmark::Counter(static_cast<double>(kSamples) * kComponents,
                                                     benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace
}  // namespace wheeltap::inference::packed

int main(int argc, char** argv) {
  using namespace wheeltap;
  benchmark::Initialize(&argc, argv);
  const std::vector<const char*> names = {"baseline", "avx2", "avx512"};
  const auto routines = inference::packed::runnable_routines(base::Instructions::automatic);
  for (const int d : {2, 4, 6})
    for (std::size_t i = 0; i < routines.size(); ++i)
      benchmark::RegisterBenchmark((std::to_string(d) + " dimensions, " + names[i]).c_str(),
                                   inference::packed::pass, routines[i], d);
  benchmark::RunSpecifiedBenchmarks();
}
