#include "inference/model/likelihood_probe.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <vector>

#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

constexpr long kMostCalls = 2000;
constexpr double kProbePatience = 10.0;  // largest time, relative to the requested time

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

LikelihoodTime probe(const Problem& problem, double seconds) {
  std::vector<int> models;
  for (int m = 0; m < problem.space.size(); ++m)
    if (problem.space[m].dimension > 0 && std::isfinite(problem.space[m].log_prior))
      models.push_back(m);
  if (models.empty()) return {};
  Target target(problem, false);
  std::vector<double> possible, impossible;
  const auto n = static_cast<long>(models.size());
  const double began = processor_seconds();
  double now = began;
  for (long i = 0; i < kMostCalls; ++i) {
    if (now - began > (i < n ? kProbePatience : 1.0) * seconds) break;
    base::Random random(1, 0, static_cast<std::uint64_t>(i), base::Purpose::prediction);
    State state;
    target.draw_prior(models[static_cast<std::size_t>(i % n)], random, state);
    const double before = processor_seconds();
    target.evaluate(state);
    now = processor_seconds();
    (std::isfinite(state.log_likelihood) ? possible : impossible).push_back(now - before);
  }
  std::vector<double>& took = possible.empty() ? impossible : possible;
  if (took.size() > 4) took.erase(took.begin());  // the first call fills caches and allocates
  std::ranges::sort(took);
  return {.mean = std::accumulate(took.begin(), took.end(), 0.0) / static_cast<double>(took.size()),
          .middle = took[took.size() / 2],
          .calls = static_cast<long>(possible.size() + impossible.size())};
}

}  // namespace wheeltap::inference
