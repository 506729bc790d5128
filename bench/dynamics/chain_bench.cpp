// Run time of a time-history likelihood. The counter "per_set" is the time of one parameter vector.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "dynamics/simulate.hpp"
#include "signals/excitation.hpp"

namespace {

using namespace wheeltap::dynamics;

constexpr int kRigSamples = 186368;

/// A signal similar to noise. The exact values do not matter here.
std::vector<double> excitation(std::size_t samples, double amplitude) {
  std::vector<double> x(samples);
  double phase = 0.0;
  for (std::size_t n = 0; n < samples; ++n) {
    phase += 0.3 + 0.2 * std::sin(0.01 * static_cast<double>(n));
    x[n] = amplitude * (std::sin(phase) + std::sin(2.7 * phase + 1.0));
  }
  return x;
}

/// Tiboaca 2016, section 5.2: 2000 samples, displacements of all three masses.
Misfit three_masses(bool cubic, Integrator integrator, Instructions instructions) {
  const Coefficient k = Coefficient::of_parameter(0), c = Coefficient::of_parameter(1);
  Chain chain{.masses = {5.0, 5.0, 5.0}};
  for (int i = 0; i < 3; ++i)
    chain.links.push_back({.a = i, .b = i + 1, .stiffness = k, .damping = c});
  if (cubic) chain.links[1].laws.push_back(make_law<laws::Cubic>({Coefficient::of_parameter(2)}));
  constexpr std::size_t kSamples = 2000;
  Excitation drive{.sample_rate_hz = 100.0,
                   .forces = {{.mass = 1, .signal = {excitation(kSamples, 10.0)}}}};
  const std::vector<Sensor> sensors{{.mass = 1}, {.mass = 2}, {.mass = 3}};
  std::vector<Signal> observed(3, Signal{excitation(kSamples, 0.1)});
  return Misfit(Simulator(chain, drive, sensors, {},
                          {.integrator = integrator, .instructions = instructions}),
                observed);
}

/// The same chain with cubic springs and, if `friction` is true, dry friction in every link with
/// occasional sticking. Both variants use series; the ratio of their times shows the effect of
/// stick and slip.
Misfit three_masses_rubbing(bool friction) {
  Chain chain = three_masses(true, Integrator::series, Instructions::automatic).simulator().chain();
  for (Link& link : chain.links)
    if (friction) link.laws.push_back(make_law<laws::Coulomb>({Coefficient::of_parameter(3)}));
  constexpr std::size_t kSamples = 2000;
  return Misfit(
      Simulator(chain,
                {.sample_rate_hz = 100.0,
                 .forces = {{.mass = 1, .signal = {excitation(kSamples, 10.0)}}}},
                {{.mass = 1}, {.mass = 2}, {.mass = 3}}, {}, {.integrator = Integrator::series}),
      std::vector<Signal>(3, Signal{excitation(kSamples, 0.1)}));
}

/// Tiboaca 2016, section 6.3: the rig's full record under white base motion; accelerations of two
/// floors. With `substeps` = 0: the exact solution; with contact, piecewise.
Simulator rig(bool contact, int substeps, double rms, std::vector<Sensor> sensors) {
  Chain chain{.masses = {6.6450, 6.7713},
              .links = {{.a = 0,
                         .b = 1,
                         .stiffness = Coefficient::of_parameter(0),
                         .damping = Coefficient::of_parameter(1)},
                        {.a = 1,
                         .b = 2,
                         .stiffness = Coefficient::of_parameter(2),
                         .damping = Coefficient::of_parameter(3)}}};
  if (contact)
    chain.links[1].laws.push_back(make_law<laws::Contact>(
        {Coefficient::of_parameter(4), Coefficient::of_parameter(5)}, Side::closing));
  wheeltap::signals::Noise noise(1);
  Excitation drive{.sample_rate_hz = 1024.0,
                   .base = BaseMotion{.acceleration = {wheeltap::signals::white_noise(
                                          kRigSamples, rms * rms, noise)}}};
  return Simulator(chain, drive, std::move(sensors), {}, {.substeps = substeps});
}

Misfit rig_misfit(bool contact, int substeps, double rms) {
  return Misfit(rig(contact, substeps, rms,
                    {{.mass = 1, .quantity = Quantity::acceleration},
                     {.mass = 2, .quantity = Quantity::acceleration}}),
                std::vector<Signal>(2, Signal{excitation(kRigSamples, 1.0)}));
}

/// Returns the fraction of samples at which the gap is closed.
double touching(double rms, const std::vector<double>& theta) {
  const Eigen::MatrixXd z =
      rig(true, 0, rms,
          {{.mass = 1, .frame = Frame::relative}, {.mass = 2, .frame = Frame::relative}})
          .simulate(theta)
          .values;
  return ((z.col(1) - z.col(0)).array() < -theta[5]).cast<double>().mean();
}

void run(benchmark::State& state, const Misfit& misfit, const std::vector<double>& theta,
         int sets) {
  std::vector<double> thetas;
  for (int i = 0; i < sets; ++i)
    for (double x : theta) thetas.push_back(x * (1.0 + 1e-3 * i));
  std::vector<double> sums(static_cast<std::size_t>(sets * misfit.channels()));
  for (auto _ : state) {
    misfit.sums_of_squares(thetas, sets, sums);
    benchmark::DoNotOptimize(sums.data());
  }
  if (!std::isfinite(sums[0])) state.SkipWithError("blown up");
  state.counters["per_set"] =
      benchmark::Counter(static_cast<double>(state.iterations() * sets),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

constexpr auto kTheta = [] { return std::vector<double>{50.0, 0.1, 1000.0}; };
constexpr auto kRig = [] { return std::vector<double>{465e3, 61.1, 510e3, 12.5, 830e3, 1e-4}; };

void cubic_3dof(benchmark::State& state) {
  run(state, three_masses(true, Integrator::automatic, static_cast<Instructions>(state.range(1))),
      kTheta(), static_cast<int>(state.range(0)));
}
void friction_3dof(benchmark::State& state) {
  run(state, three_masses_rubbing(state.range(1) == 1), {50.0, 0.1, 1000.0, 2.0},
      static_cast<int>(state.range(0)));
}
void linear_3dof_exact(benchmark::State& state) {
  run(state, three_masses(false, Integrator::exact, static_cast<Instructions>(state.range(1))),
      kTheta(), static_cast<int>(state.range(0)));
}
void rig_linear(benchmark::State& state) {
  run(state, rig_misfit(false, 0, 5.0), kRig(), static_cast<int>(state.range(0)));
}
void rig_contact(benchmark::State& state) {
  const auto rms = static_cast<double>(state.range(2));
  run(state, rig_misfit(true, static_cast<int>(state.range(1)), rms), kRig(),
      static_cast<int>(state.range(0)));
  state.counters["touching"] = touching(rms, kRig());
}

}  // namespace

BENCHMARK(cubic_3dof)
    ->ArgNames({"sets", "instructions"})
    ->ArgsProduct({{1, 4, 8}, {0, 1, 2, 3}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(friction_3dof)
    ->ArgNames({"sets", "friction"})
    ->ArgsProduct({{1, 4, 8}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(linear_3dof_exact)
    ->ArgNames({"sets", "instructions"})
    ->ArgsProduct({{1, 4, 8}, {0, 1, 2, 3}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(rig_linear)->ArgNames({"sets"})->Arg(1)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK(rig_contact)
    ->ArgNames({"sets", "substeps", "rms"})
    ->ArgsProduct({{1, 4, 8}, {0, 4}, {5, 20}})
    ->Unit(benchmark::kMillisecond);
