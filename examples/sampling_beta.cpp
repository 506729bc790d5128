// Samples Beta(2, 3) by five methods (chapter 3 of Tiboaca 2016) and compares their accuracy.
//
//   sampling_beta                     a table: the mean by each sampler and the exact mean
//   sampling_beta --figure 3.1        the density                                   (CSV)
//   sampling_beta --figure 3.2        density, proposal, polynomial                 (CSV)
//   sampling_beta --figure 3.3        density under its envelope                    (CSV)
//   sampling_beta --figure 3.4        Metropolis-Hastings histogram of N(0, 1)      (CSV)
//   sampling_beta --figure samples    the draws of every sampler                    (CSV)
// Further options, with defaults: --samples N (10000) and --seed N (1).
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "examples/beta_samplers.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace {

using namespace wheeltap::examples;
namespace base = wheeltap::base;
using wheeltap::inference::ess_mean, wheeltap::inference::mcse_mean, wheeltap::inference::mean;

constexpr double kStart = 0.5, kWalk = 0.4, kSlice = 0.3;

// Each sampler has a separate random stream, so its draws do not depend on the other samplers.
base::Random stream(std::uint64_t seed, std::uint64_t sampler) {
  return {seed, sampler, 0, base::Purpose::simulation};
}

std::vector<std::pair<const char*, std::vector<double>>> all_draws(int n, std::uint64_t seed) {
  base::Random r = stream(seed, 1), g = stream(seed, 2), m = stream(seed, 3), s = stream(seed, 4);
  return {{"rejection", rejection(n, r)},
          {"gibbs", gibbs(n, g)},
          {"metropolis-hastings", metropolis_hastings(beta_density, kStart, kWalk, n, m)},
          {"slice", slice(beta_density, kStart, kSlice, n, s)}};
}

void print_table(int n, std::uint64_t seed) {
  std::printf("%-20s %10s %10s %10s %12s\n", "sampler", "E[y]", "error", "MCSE", "effective");
  const auto row = [](const char* name, double mean, double error, double effective) {
    std::printf("%-20s %10.5f %+10.5f %10.5f %12.0f\n", name, mean, mean - 2.0 - 4.0 / 35.0, error,
                effective);
  };
  base::Random random = stream(seed, 0);
  const WeightedMean weighted = importance(polynomial, n, random);
  row("importance", weighted.mean, weighted.standard_error, weighted.effective_draws);
  for (const auto& [name, draws] : all_draws(n, seed)) {
    wheeltap::inference::ChainsOf y(1);
    for (const double mu : draws) y[0].push_back(polynomial(mu));
    row(name, mean(y), mcse_mean(y), ess_mean(y));
  }
  std::printf("%-20s %10.5f\n", "exact", 2.0 + 4.0 / 35.0);
}

bool print_figure(const std::string& figure, int n, std::uint64_t seed) {
  constexpr int kPoints = 200;
  const double j = envelope_factor();
  if (figure == "samples") {
    std::puts("sampler,iteration,mu");
    for (const auto& [name, draws] : all_draws(n, seed))
      for (std::size_t i = 0; i < draws.size(); ++i)
        std::printf("%s,%zu,%.9g\n", name, i, draws[i]);
  } else if (figure == "3.4") {
    base::Random random = stream(seed, 5);
    const auto normal = [](double x) {
      return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    };
    const auto draws = metropolis_hastings(normal, 0.0, 1.0, n, random);
    constexpr double kLow = -4.0, kWidth = 0.2;
    std::vector<int> counts(40, 0);
    for (const double x : draws) {
      const double bin = std::floor((x - kLow) / kWidth);
      if (bin >= 0.0 && bin < 40.0) ++counts[static_cast<std::size_t>(bin)];
    }
    std::puts("x,histogram,density");
    for (std::size_t b = 0; b < counts.size(); ++b) {
      const double x = kLow + (static_cast<double>(b) + 0.5) * kWidth;
      std::printf("%.9g,%.9g,%.9g\n", x, counts[b] / (n * kWidth), normal(x));
    }
  } else if (figure == "3.1" || figure == "3.2" || figure == "3.3") {
    std::puts(figure == "3.1"   ? "mu,density"
              : figure == "3.2" ? "mu,density,proposal,polynomial"
                                : "mu,density,envelope");
    for (int i = 0; i <= kPoints; ++i) {
      const double mu = static_cast<double>(i) / kPoints;
      std::printf("%.9g,%.9g", mu, beta_density(mu));
      if (figure == "3.2") std::printf(",%.9g,%.9g", proposal_density(mu), polynomial(mu));
      if (figure == "3.3") std::printf(",%.9g", j * proposal_density(mu));
      std::puts("");
    }
  } else {
    return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kUsage = 64;
  std::string figure;
  int n = 10000;
  std::uint64_t seed = 1;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    char* end = nullptr;
    bool good = i + 1 < argc;
    if (good && option == "--figure") {
      figure = argv[i + 1];
    } else if (good && option == "--samples") {
      const long value = std::strtol(argv[i + 1], &end, 10);
      good = *end == '\0' && value >= 10 && value <= 100000000;
      n = static_cast<int>(value);
    } else if (good && option == "--seed") {
      seed = std::strtoull(argv[i + 1], &end, 10);
      good = *end == '\0';
    } else {
      good = false;
    }
    if (!good) {
      std::fputs(
          "usage: sampling_beta [--figure 3.1|3.2|3.3|3.4|samples] [--samples N >= 10] "
          "[--seed N]\n",
          stderr);
      return kUsage;
    }
  }
  if (figure.empty()) {
    print_table(n, seed);
  } else if (!print_figure(figure, n, seed)) {
    std::fprintf(stderr, "sampling_beta: no figure '%s'; there are 3.1, 3.2, 3.3, 3.4, samples\n",
                 figure.c_str());
    return kUsage;
  }
}
