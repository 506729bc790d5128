// The table of docs/speed.md. Every row is a ratio of times that were measured in turns within one
// run, so that it hardly depends on the machine. The table also gives the speed of the machine.
//
//   speed_table            prints Markdown
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "dynamics/simulate.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/sections/section.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace {

using namespace wheeltap;
using Clock = std::chrono::steady_clock;

constexpr int kRounds = 7;
volatile double sink = 0.0;

/// Time per call of each function [s]: the smallest of several rounds of all functions in turn.
std::vector<double> in_turns(const std::vector<std::pair<std::function<void()>, int>>& work) {
  std::vector<double> least(work.size(), 1e300);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < work.size(); ++i) {
      const auto start = Clock::now();
      for (int n = 0; n < work[i].second; ++n) work[i].first();
      const std::chrono::duration<double> taken = Clock::now() - start;
      least[i] = std::min(least[i], taken.count() / work[i].second);
    }
  }
  return least;
}

std::string time(double seconds) {
  char text[32];
  const double scaled = seconds < 1e-6   ? 1e9 * seconds
                        : seconds < 1e-3 ? 1e6 * seconds
                                         : 1e3 * seconds;
  std::snprintf(text, sizeof text, "%.3g %s", scaled,
                seconds < 1e-6   ? "ns"
                : seconds < 1e-3 ? "µs"
                                 : "ms");
  return text;
}

void row(const std::string& what, const std::string& figure, const std::string& beside) {
  std::printf("| %s | %s | %s |\n", what.c_str(), figure.c_str(), beside.c_str());
}

std::string ratio(double x, const std::string& of) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text + (" " + of);
}

// ---- the machine -----------------------------------------------------------------------------

/// Multiply-adds per second of one core, in eight independent chains of the portable vector width,
/// and bytes per second read from memory.
struct Machine {
  double multiply_adds, bandwidth;
};
Machine measure_machine() {
  constexpr int kTurns = 4096;
  const auto arithmetic = [] {
    double x[64];
    for (double& v : x) v = 1.0;
    for (int n = 0; n < kTurns; ++n) {
      for (double& v : x) v = v * 0.999 + 0.001;
    }
    sink = sink + x[0] + x[63];
  };
  std::vector<double> large(16U << 20U, 1.0);  // 128 MiB
  const auto read = [&] {
    double sum[8] = {};
    for (std::size_t i = 0; i + 8 <= large.size(); i += 8) {
      for (std::size_t j = 0; j < 8; ++j) sum[j] += large[i + j];
    }
    sink = sink + sum[0] + sum[7];
  };
  const auto seconds = in_turns({{arithmetic, 20}, {read, 1}});
  return {.multiply_adds = 64.0 * kTurns / seconds[0],
          .bandwidth = static_cast<double>(large.size() * sizeof(double)) / seconds[1]};
}

// ---- beams -----------------------------------------------------------------------------------

void beams() {
  constexpr int kModes = 20;
  const fem::Beam beam{
      .length = 1.0,
      .elements = 100,
      .supports = fem::named_supports("simply-supported", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = fem::section(fem::Rectangle{.width = 0.025, .height = 0.006}, 0.3)};
  const fem::Reanalysis reanalysis(beam, kModes);
  auto workspace = reanalysis.make_workspace();
  std::vector<double> f(kModes);
  base::Random random(1, 0, 0, base::Purpose::test);
  for (const int damages : {2, 5}) {
    std::vector<std::vector<fem::Damage>> designs(64);
    for (auto& design : designs) {
      for (int i = 0; i < damages; ++i) {
        design.push_back({.location = random.uniform(), .reduction = 0.6 * random.uniform()});
      }
    }
    const auto a = fem::assemble<double>(beam, {.damages = designs[0], .supports = {}});
    const Eigen::MatrixXd k(a.stiffness), m(a.mass);
    const auto seconds =
        in_turns({{[&] {
                     for (const auto& design : designs)
                       reanalysis.frequencies_hz(design, {}, workspace, f);
                     sink = sink + f[0];
                   },
                   10},
                  {[&] {
                     const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
                         k, m, Eigen::EigenvaluesOnly);
                     sink = sink + solver.eigenvalues()[0];
                   },
                   3}});
    const double each = seconds[0] / static_cast<double>(designs.size());
    row("20 frequencies of a beam of 100 elements with " + std::to_string(damages) + " damages",
        time(each), ratio(seconds[1] / each, "times faster than a dense eigensolve (values only)"));
  }
}

// ---- tables ----------------------------------------------------------------------------------

void tables(const Machine& machine) {
  std::vector<emulator::Factor> factors;
  for (int j = 0; j < 4; ++j) {
    emulator::Factor factor{.name = std::to_string(j), .unit = "", .levels = {}};
    for (int i = 0; i < (j % 2 ? 4 : 10); ++i) factor.levels.push_back(0.1 * i);
    factors.push_back(factor);
  }
  const Eigen::Index responses = 20;
  const emulator::MultilinearInterpolant table(
      factors, emulator::RowMatrix::Random(emulator::full_factorial(factors).runs(), responses));
  const auto points = emulator::random_design(factors, 1024, 1).points;
  std::vector<double> out(static_cast<std::size_t>(responses));
  const auto seconds = in_turns({{[&] {
                                    for (Eigen::Index i = 0; i < points.rows(); ++i) {
                                      table.evaluate(std::span(points.row(i).data(), 4), out);
                                    }
                                    sink = sink + out[0];
                                  },
                                  20}});
  const double each = seconds[0] / static_cast<double>(points.rows());
  const double multiply_adds = 16.0 * static_cast<double>(responses);
  row("20 frequencies interpolated in a 4-D table", time(each),
      ratio(100.0 * multiply_adds / each / machine.multiply_adds,
            "% of the machine's multiply-adds (16 corners × 20)"));
}

// ---- chains ----------------------------------------------------------------------------------

constexpr std::size_t kSamples = 2000;
constexpr double kStep = 0.01;

std::vector<double> force() {
  std::vector<double> x(kSamples);
  double phase = 0.0;
  for (std::size_t n = 0; n < kSamples; ++n) {
    phase += 0.3 + 0.2 * std::sin(0.01 * static_cast<double>(n));
    x[n] = 10.0 * (std::sin(phase) + std::sin(2.7 * phase + 1.0));
  }
  return x;
}

/// Integrates three masses like a simple program: classical Runge-Kutta scheme with the sampling
/// step, force linear between samples. Returns the sum of squares of the displacements.
double plain_loop(const std::vector<double>& f, double k, double c, double k3) {
  double y[3] = {}, v[3] = {}, sum = 0.0;
  const auto accelerate = [&](const double* p, const double* s, double drive, double* a) {
    double before = k * p[0] + c * s[0];
    for (int i = 0; i < 3; ++i) {
      double after = 0.0;
      if (i < 2) {
        const double e = p[i + 1] - p[i];
        after = k * e + c * (s[i + 1] - s[i]) + (i == 0 ? k3 * e * e * e : 0.0);
      }
      a[i] = ((i == 0 ? drive : 0.0) + after - before) / 5.0;
      before = after;
    }
  };
  for (std::size_t n = 0; n < f.size(); ++n) {
    for (const double p : y) sum += p * p;
    if (n + 1 == f.size()) break;
    const double drive[4] = {f[n], 0.5 * (f[n] + f[n + 1]), 0.5 * (f[n] + f[n + 1]), f[n + 1]};
    const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double dy[3] = {}, dv[3] = {}, sy[3] = {}, sv[3] = {};
    for (int stage = 0; stage < 4; ++stage) {
      double p[3], s[3], a[3];
      for (int i = 0; i < 3; ++i) {
        p[i] = y[i] + part[stage] * kStep * dy[i];
        s[i] = v[i] + part[stage] * kStep * dv[i];
      }
      accelerate(p, s, drive[stage], a);
      for (int i = 0; i < 3; ++i) {
        dy[i] = s[i], dv[i] = a[i];
        sy[i] += weight[stage] * dy[i], sv[i] += weight[stage] * dv[i];
      }
    }
    for (int i = 0; i < 3; ++i) y[i] += kStep / 6.0 * sy[i], v[i] += kStep / 6.0 * sv[i];
  }
  return sum;
}

void chains() {
  using dynamics::Coefficient;
  const std::vector<double> f = force();
  for (const bool cubic : {true, false}) {
    dynamics::Chain chain{.masses = {5.0, 5.0, 5.0}};
    for (int i = 0; i < 3; ++i) {
      chain.links.push_back({.a = i,
                             .b = i + 1,
                             .stiffness = Coefficient::of_parameter(0),
                             .damping = Coefficient::of_parameter(1)});
    }
    if (cubic) {
      chain.links[1].laws.push_back(
          dynamics::make_law<dynamics::laws::Cubic>({Coefficient::of_parameter(2)}));
    }
    const dynamics::Misfit misfit(
        dynamics::Simulator(chain,
                            {.sample_rate_hz = 1.0 / kStep, .forces = {{.mass = 1, .signal = {f}}}},
                            {{.mass = 1}, {.mass = 2}, {.mass = 3}}),
        std::vector<dynamics::Signal>(3, dynamics::Signal{std::vector<double>(kSamples, 0.0)}));
    constexpr int kSets = 8;
    std::vector<double> thetas, sums(3 * kSets);
    for (int i = 0; i < kSets; ++i) {
      for (const double x : {50.0, 0.1, 1000.0}) thetas.push_back(x * (1.0 + 1e-3 * i));
    }
    const auto seconds =
        in_turns({{[&] {
                     misfit.sums_of_squares({thetas.data(), 3}, 1, {sums.data(), 3});
                   },
                   20},
                  {[&] { misfit.sums_of_squares(thetas, kSets, sums); }, 20},
                  {[&] { sink = sink + plain_loop(f, 50.0, 0.1, cubic ? 1000.0 : 0.0); }, 20}});
    const std::string what =
        cubic ? "three masses with a cubic spring, " : "three masses, linear and exact, ";
    row(what + "2000 samples, one set / eight at once",
        time(seconds[0]) + " / " + time(seconds[1] / kSets),
        ratio(seconds[2] / seconds[0], "/ ") +
            ratio(seconds[2] * kSets / seconds[1], "times a plain Runge-Kutta loop's speed"));
  }
}

// ---- the sampler -----------------------------------------------------------------------------

void sampler(const Machine& machine) {
  class Cheap : public inference::Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double sum = 0.0;
      for (const double v : x) sum -= 8.0 * (v - 0.4) * (v - 0.4);
      return sum;
    }
  };
  std::vector<inference::Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 1; i <= 6; ++i) {
    names.push_back("p" + std::to_string(i));
    parameters.push_back({names.back(), inference::Uniform{0.0, 1.0}});
  }
  const std::vector<std::string> fewer(names.begin(), names.end() - 1);
  const inference::Problem problem{.space = inference::ModelSpace::of_models(
                                       parameters, {{"five", 1, fewer}, {"six", 1, names}}),
                                   .likelihood = [] { return std::make_unique<Cheap>(); }};
  const auto seconds = [&](int draws) {
    return inference::reversible_jump(problem,
                                      {.chains = 1, .threads = 1, .draws = draws, .thin = 1})
        .wall_seconds;
  };
  constexpr int kDraws = 300000;
  const double each = (seconds(2 * kDraws) - seconds(kDraws)) / kDraws;  // the warm-up cancels
  row("the sampler above its likelihood, 6 parameters, an iteration", time(each),
      ratio(each * machine.multiply_adds, "multiply-adds of the machine's"));
}

}  // namespace

int main() {
  const Machine machine = measure_machine();
  std::string processor = "unknown processor", line;
  std::ifstream cpuinfo("/proc/cpuinfo");
  while (std::getline(cpuinfo, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    processor = line.substr(line.find(": ") + 2);
    break;
  }
  std::printf("%s, one core: %.3g·10⁹ multiply-adds a second, %.3g GB/s read from memory\n\n",
              processor.c_str(), 1e-9 * machine.multiply_adds, 1e-9 * machine.bandwidth);
  std::printf("| what | time here | beside |\n|---|---|---|\n");
  beams();
  tables(machine);
  chains();
  sampler(machine);
  return sink == 0.123 ? 1 : 0;
}
