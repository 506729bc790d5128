// Run time of the sampler without its likelihood, and effective draws per likelihood evaluation.
//
// Counters: ess_k and ess_left are effective draws of the model index and of "the first damage lies
// in the left half", per million likelihood evaluations after warm-up and per second of the whole
// run with warm-up. The counter warmup_calls is the number of likelihood evaluations of the
// warm-up.
#include <benchmark/benchmark.h>

#include <cmath>

#include "dynamics/simulate.hpp"
#include "emulator/design.hpp"
#include "emulator/experiment.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "fem/beam/reanalysis.hpp"
#include "fem/sections/section.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap {
namespace {

using namespace inference;

// The beam and the data of the validation set "simply_supported_10_one_damage".
const std::vector<double> kFrequencies{13.859233, 55.270344,  124.354486, 220.94621,   343.81395,
                                       495.25228, 674.383972, 882.310315, 1115.348938, 1377.779485};
constexpr double kCov = 0.001;

fem::Beam beam() {
  return {1.0,
          100,
          fem::named_supports("simply-supported", 1.0),
          {70e9, 0.3, 2700.0},
          fem::section(fem::Rectangle{0.025, 0.006}, 0.3)};
}

// Likelihood of frequencies with Gaussian errors about the frequencies from `predict`.
template <typename Predictor>
class Frequencies : public Likelihood {
 public:
  explicit Frequencies(Predictor predictor)
      : predictor_(std::move(predictor)),
        predicted_(kFrequencies.size()),
        residuals_(kFrequencies.size()) {}
  double log_likelihood(int, std::span<const double> x) override {
    predictor_(x, predicted_);
    double sum = 0.0;
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      const double sd = kCov * kFrequencies[i];
      residuals_[i] = (kFrequencies[i] - predicted_[i]) / sd;
      sum -= 0.5 * residuals_[i] * residuals_[i];
    }
    return sum;
  }
  void evaluate(double, int model, std::span<const double> x, Evaluation& out) override {
    out.log_likelihood = log_likelihood(model, x);
    out.prediction = predicted_;
    out.residuals = residuals_;
  }

 private:
  Predictor predictor_;
  std::vector<double> predicted_, residuals_;
};

Problem damage_problem(LikelihoodFactory likelihood) {
  return {.space = ModelSpace::of_components(
              {},
              {{"damage",
                "damages",
                {{"location", Uniform{0.0, 1.0}}, {"reduction", Uniform{0.0, 0.6}}}}},
              {{{0}, 1.0}, {{1}, 1.0}, {{2}, 1.0}}),
          .likelihood = std::move(likelihood),
          .reflections = {{0, 0, 0.5}}};
}

void report(benchmark::State& state, const Posterior& posterior) {
  ChainsOf k, left;
  for (const Chain& chain : posterior.chains) {
    auto& counts = k.emplace_back();
    auto& halves = left.emplace_back();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Draw draw = chain.draw(i, *posterior.space);
      counts.push_back(draw.model);
      halves.push_back(draw.model > 0 && draw.theta[0] < 0.5 ? 1.0 : 0.0);
    }
  }
  const double calls =
      static_cast<double>(posterior.likelihood_evaluations - posterior.warmup_evaluations);
  state.counters["ess_k/Mcall"] = ess_mean(k) / calls * 1e6;
  state.counters["ess_k/s"] = ess_mean(k) / posterior.wall_seconds;
  state.counters["ess_left/Mcall"] = ess_mean(left) / calls * 1e6;
  state.counters["warmup_calls"] = static_cast<double>(posterior.warmup_evaluations);
  state.counters["calls"] = calls;
  state.counters["us/call"] =
      posterior.wall_seconds / static_cast<double>(posterior.likelihood_evaluations) * 1e6;
}

void beam_by_reanalysis(benchmark::State& state) {
  const fem::Reanalysis reanalysis(beam(), static_cast<int>(kFrequencies.size()));
  const Problem problem = damage_problem([&] {
    auto predict = [&, workspace = reanalysis.make_workspace(),
                    damages = std::vector<fem::Damage>()](std::span<const double> x,
                                                          std::span<double> out) mutable {
      damages.clear();
      for (std::size_t i = 0; i + 1 < x.size(); i += 2) damages.push_back({x[i], x[i + 1]});
      reanalysis.frequencies_hz(damages, {}, workspace, out);
    };
    return std::make_unique<Frequencies<decltype(predict)>>(std::move(predict));
  });
  for (auto _ : state)
    report(state, reversible_jump(problem, {.draws = static_cast<int>(state.range(0))}));
}
BENCHMARK(beam_by_reanalysis)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// The same problem with a table of every element as a site and seven multipliers. The likelihood is
// then cheap, so the sampler itself takes most of the run time.
void beam_by_table(benchmark::State& state) {
  const fem::Beam b = beam();
  const fem::Reanalysis reanalysis(b, static_cast<int>(kFrequencies.size()));
  emulator::Factor site{.name = "location", .unit = "m", .levels = {}};
  for (int e = 0; e < b.elements; ++e) site.levels.push_back(b.element_midpoint(e));
  const emulator::Factor reduction{
      .name = "reduction", .unit = "1", .levels = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}};
  const auto table = [&](int k) {
    std::vector<emulator::Factor> factors;
    for (int i = 0; i < k; ++i) {
      for (emulator::Factor f : {site, reduction}) {
        f.name += std::to_string(i + 1);
        factors.push_back(f);
      }
    }
    return emulator::MultilinearInterpolant(
        factors, emulator::run_experiment(
                     emulator::full_factorial(factors),
                     static_cast<Eigen::Index>(kFrequencies.size()), [&]() -> emulator::Model {
                       auto workspace = std::make_shared<fem::Reanalysis::Workspace>(
                           reanalysis.make_workspace());
                       return [&, workspace](std::span<const double> x, std::span<double> out) {
                         std::vector<fem::Damage> damages;
                         for (std::size_t i = 0; i + 1 < x.size(); i += 2)
                           damages.push_back({x[i], x[i + 1]});
                         reanalysis.frequencies_hz(damages, {}, *workspace, out);
                       };
                     }));
  };
  const emulator::MultilinearInterpolant one = table(1), two = table(2);
  std::vector<double> intact(reanalysis.intact_frequencies_hz().begin(),
                             reanalysis.intact_frequencies_hz().end());
  const Problem problem = damage_problem([&] {
    auto predict = [&, point = std::vector<double>()](std::span<const double> x,
                                                      std::span<double> out) mutable {
      if (x.empty()) {
        std::copy(intact.begin(), intact.end(), out.begin());
        return;
      }
      point.assign(x.begin(), x.end());
      for (std::size_t i = 0; i < point.size(); i += 2)
        point[i] = b.element_midpoint(b.element_at(point[i]));
      (x.size() == 2 ? one : two).evaluate(point, out);
    };
    return std::make_unique<Frequencies<decltype(predict)>>(std::move(predict));
  });
  for (auto _ : state)
    report(state, reversible_jump(problem, {.draws = static_cast<int>(state.range(0))}));
}
BENCHMARK(beam_by_table)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// Linear against Duffing oscillator on 300 samples of displacement: the case of the validation set
// with other noise.
void duffing(benchmark::State& state) {
  namespace dyn = dynamics;
  constexpr double kNoise = 0.05;
  constexpr int kSamples = 300;
  const auto chain = [](bool cubic) {
    dyn::Link link{.a = 0, .b = 1, .stiffness = dyn::Coefficient::of_parameter(0), .damping = 0.1};
    if (cubic)
      link.laws.push_back(dyn::make_law<dyn::laws::Cubic>({dyn::Coefficient::of_parameter(1)}));
    return dyn::Chain{.masses = {0.5}, .links = {link}};
  };
  base::Random random(3, 0, 0, base::Purpose::simulation);
  std::vector<double> force(kSamples);
  for (double& f : force) f = 10.0 * random.normal();
  const dyn::Excitation excitation{.sample_rate_hz = 100.0, .forces = {{1, {force}}}};
  const dyn::SimulatorOptions once{.integrator = dyn::Integrator::runge_kutta, .substeps = 1};
  const dyn::Simulator linear(chain(false), excitation, {dyn::Sensor{}}, {}, once);
  const dyn::Simulator cubic(chain(true), excitation, {dyn::Sensor{}}, {}, once);
  const dyn::Response clean = cubic.simulate(std::vector<double>{50.0, 1000.0});
  std::vector<double> data(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    data[static_cast<std::size_t>(i)] = clean.values(i, 0) + kNoise * random.normal();
  }
  const std::vector<dyn::Misfit> misfits{{linear, {{data}}}, {cubic, {{data}}}};
  class Displacement : public Likelihood {
   public:
    explicit Displacement(const std::vector<dyn::Misfit>& misfits) : misfits_(misfits) {}
    double log_likelihood(int model, std::span<const double> x) override {
      double sum = 0.0;
      misfits_[static_cast<std::size_t>(model)].sums_of_squares(x, 1, {&sum, 1});
      return -0.5 * sum / (kNoise * kNoise);
    }

   private:
    const std::vector<dyn::Misfit>& misfits_;
  };
  const Problem problem{
      .space = ModelSpace::of_models({{"k", Uniform{0.0, 100.0}}, {"k3", Uniform{0.0, 1e4}}},
                                     {{"linear", 1, {"k"}}, {"duffing", 1, {"k", "k3"}}}),
      .likelihood = [&] { return std::make_unique<Displacement>(misfits); }};
  for (auto _ : state)
    report(state, reversible_jump(problem, {.draws = static_cast<int>(state.range(0))}));
}
BENCHMARK(duffing)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// Change points in the coal-mining disasters (Green 1995); the data are beside the checkout. The
// components have no residuals, so only the prior and the pilots propose them.
void coal(benchmark::State& state) {
  const std::vector<double> days = coal_days();
  if (days.empty()) {
    state.SkipWithError("the validation set 'coal' is not beside this checkout");
    return;
  }
  const Problem problem = coal_problem(days, kCoalDays, 1, 6);
  for (auto _ : state)
    report(state, reversible_jump(problem, {.draws = static_cast<int>(state.range(0))}));
}
BENCHMARK(coal)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// Six parameters and a likelihood of a few nanoseconds: the sampler takes nearly all time.
void overhead_of_six_parameters(benchmark::State& state) {
  class Cheap : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double sum = 0.0;
      for (const double v : x) sum -= 8.0 * (v - 0.4) * (v - 0.4);
      return sum;
    }
  };
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 1; i <= 6; ++i) {
    names.push_back("p" + std::to_string(i));
    parameters.push_back({names.back(), Uniform{0.0, 1.0}});
  }
  const std::vector<std::string> fewer(names.begin(), names.end() - 1);
  const Problem problem{
      .space = ModelSpace::of_models(parameters, {{"five", 1, fewer}, {"six", 1, names}}),
      .likelihood = [] { return std::make_unique<Cheap>(); }};
  constexpr int kDraws = 400000;
  for (auto _ : state) {
    // The difference between runs of 2n and n draws does not contain the warm-up.
    const auto seconds = [&](int draws) {
      return reversible_jump(problem, {.chains = 1, .threads = 1, .draws = draws, .thin = 1})
          .wall_seconds;
    };
    state.counters["ns/iteration"] = (seconds(2 * kDraws) - seconds(kDraws)) / kDraws * 1e9;
  }
}
BENCHMARK(overhead_of_six_parameters)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace wheeltap

BENCHMARK_MAIN();
