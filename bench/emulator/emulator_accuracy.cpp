// Compares emulators of a beam with one to five damages: errors against further FE runs, run times
// and sizes of the tables. Prints a Markdown table:
//   emulator_accuracy [holdout runs]
// The beam is that of Tiboaca 2016 (simply supported aluminium, 1 m, 100 elements, 20 modes), with
// reductions up to 0.6 at any location. Emulators and FE receive the midpoint of the damaged
// element.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "emulator/anova.hpp"
#include "emulator/cubic_interpolant.hpp"
#include "emulator/gaussian_process.hpp"
#include "emulator/grid_refinement.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "fem/beam/reanalysis.hpp"
#ifdef WHEELTAP_WITH_CGAL
#include "emulator/delaunay_interpolant.hpp"
#endif

namespace {

using namespace wheeltap;
using namespace wheeltap::emulator;
using Eigen::Index;

constexpr Index kModes = 20;
constexpr int kElements = 100;
constexpr double kNoise = 0.001;  // relative to a frequency

fem::Beam source_beam() {
  return {.length = 1.0,
          .elements = kElements,
          .supports = fem::named_supports("simply-supported", 1.0),
          .material = {.young = 70e9, .poisson = 0.3, .density = 2700},
          .section = {.area = 0.025 * 0.006,
                      .second_moment = 0.025 * 0.006 * 0.006 * 0.006 / 12,
                      .shear_coefficient = 13.0 / 15.3}};
}

const fem::Reanalysis& beam() {
  static const fem::Reanalysis reanalysis(source_beam(), kModes);
  return reanalysis;
}

/// Maps location[1], reduction[1], location[2], … to frequencies.
Model make_model() {
  return [workspace = std::make_shared<fem::Reanalysis::Workspace>(beam().make_workspace())](
             std::span<const double> x, std::span<double> y) {
    std::vector<fem::Damage> damages;
    for (std::size_t i = 0; i < x.size(); i += 2) damages.push_back({x[i], x[i + 1]});
    beam().frequencies_hz(damages, {}, *workspace, y);
  };
}

std::vector<Factor> factors(int count, const std::vector<double>& sites,
                            const std::vector<double>& reductions, Scale scale) {
  std::vector<Factor> out;
  for (int i = 1; i <= count; ++i) {
    const std::string number = std::to_string(i);
    out.push_back({std::string("location").append(number), "m", sites});
    out.push_back({std::string("reduction").append(number), "", reductions, scale});
  }
  return out;
}

std::vector<double> every_element() {
  std::vector<double> sites;
  for (int e = 0; e < kElements; ++e) sites.push_back(source_beam().element_midpoint(e));
  return sites;
}

/// The sites of Tiboaca 2016. Both damages may be at any of these sites: one table serves any pair.
std::vector<double> source_sites() {
  std::vector<double> sites;
  for (int e = 4; e < kElements; e += 10) sites.push_back(source_beam().element_midpoint(e));
  return sites;
}

/// Uniform random points in the box, with locations moved to the midpoints of their elements.
Design holdout_design(int count, Index runs, double low, double high) {
  Design design = random_design(factors(count, {low, high}, {0.0, 0.6}, Scale::linear), runs, 2024);
  for (Index i = 0; i < runs; ++i)
    for (Index j = 0; j < 2 * count; j += 2)
      design.points(i, j) =
          source_beam().element_midpoint(source_beam().element_at(design.points(i, j)));
  return design;
}

double seconds_of(const std::function<void()>& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void report(const char* kind, int count, Index runs, double build_seconds,
            const Predictor& predictor, const Design& holdout, const RowMatrix& truth) {
  RowMatrix predicted;
  const double evaluation = seconds_of([&] { predicted = predict(predictor, holdout, kModes); }) /
                            static_cast<double>(holdout.runs());
  const auto errors = holdout_error(truth, predicted);
  const auto intact = beam().intact_frequencies_hz();
  const auto to_noise = [&](std::size_t mode) {
    return errors[mode].rmse / (kNoise * intact[mode]);
  };
  double worst = 0, worst_max = 0, least_q2 = 1;
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    worst = std::max(worst, to_noise(mode));
    worst_max = std::max(worst_max, errors[mode].max_error / (kNoise * intact[mode]));
    least_q2 = std::min(least_q2, errors[mode].q2);
  }
  std::printf(
      "| %s | %d | %ld | %.2f | %.2f | %.2f | %.4f | %.4f | %.4f | %.4f | %.4f | %.3f | %.6f |\n",
      kind, count, static_cast<long>(runs),
      static_cast<double>(runs * kModes) * sizeof(double) / 1e6, build_seconds, evaluation * 1e6,
      to_noise(0), to_noise(4), to_noise(9), to_noise(19), worst, worst_max, least_q2);
  std::fflush(stdout);
}

struct Grid {
  std::vector<Factor> factors;
  RowMatrix values;
  double seconds;
};

Grid run_grid(std::vector<Factor> f) {
  Grid grid{.factors = std::move(f), .values = {}, .seconds = 0};
  grid.seconds = seconds_of([&] {
    grid.values = run_experiment(full_factorial(grid.factors), kModes, make_model, {.threads = 2});
  });
  return grid;
}

}  // namespace

int main(int argc, char** argv) {
  const Index runs = argc > 1 ? std::atol(argv[1]) : 2000;
  std::printf(
      "Errors are root mean squares over %ld fresh FE runs, in units of a noise of %g of the "
      "intact "
      "frequency.\n\n"
      "| emulator | damages | runs | MB | build s | µs a call | mode 1 | mode 5 | mode 10 | mode "
      "20 | "
      "worst mode | largest error | least Q² |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      static_cast<long>(runs), kNoise);

  const std::vector<double> levels = {0.0, 0.2, 0.4, 0.6};
  std::vector<Design> holdout;
  std::vector<RowMatrix> truth;
  for (int count = 1; count <= 5; ++count) {
    holdout.push_back(holdout_design(count, runs, 0.0, 1.0));
    truth.push_back(run_experiment(holdout.back(), kModes, make_model, {.threads = 2}));
  }

  // Five damages would need 102 million runs of 20 modes, 16 GB. With every element as a site,
  // three damages need 10 GB.
  for (int count : {1, 2, 3, 4}) {
    const Grid grid = run_grid(factors(count, source_sites(), levels, Scale::linear));
    const MultilinearInterpolant f(grid.factors, grid.values);
    const Design inside = holdout_design(count, runs, 0.05, 0.95);
    report(
        "source: 10 sites, multilinear", count, grid.values.rows(), grid.seconds,
        [&](std::span<const double> x, std::span<double> y) { f.evaluate(x, y); }, inside,
        run_experiment(inside, kModes, make_model, {.threads = 2}));
  }

  struct Kind {
    const char* name;
    Scale scale;
    AxisRule rule;
  };
  for (const Kind& kind :
       {Kind{"every element, linear in r", Scale::linear, AxisRule::linear},
        Kind{"every element, linear in 1/(1-r)", Scale::compliance, AxisRule::linear},
        Kind{"every element, monotone cubic in 1/(1-r)", Scale::compliance,
             AxisRule::monotone_cubic}}) {
    const auto interpolant = [&](const Grid& grid) {
      std::vector<AxisRule> rules;
      for (std::size_t j = 0; j < grid.factors.size(); ++j)
        rules.push_back(j % 2 ? kind.rule : AxisRule::linear);
      return CubicInterpolant(grid.factors, grid.values, rules);
    };
    const Grid one = run_grid(factors(1, every_element(), levels, kind.scale));
    const Grid two = run_grid(factors(2, every_element(), levels, kind.scale));
    const CubicInterpolant single = interpolant(one), pair = interpolant(two);
    const Predictor call_single = [&](std::span<const double> x, std::span<double> y) {
      single.evaluate(x, y);
    };
    const Predictor call_pair = [&](std::span<const double> x, std::span<double> y) {
      pair.evaluate(x, y);
    };
    report(kind.name, 1, one.values.rows(), one.seconds, call_single, holdout[0], truth[0]);
    report(kind.name, 2, two.values.rows(), two.seconds, call_pair, holdout[1], truth[1]);
    if (kind.scale == Scale::linear) continue;
    const auto intact = beam().intact_frequencies_hz();
    for (Additive additive :
         {Additive::response, Additive::logarithm, Additive::square, Additive::inverse_square}) {
      const AnovaEmulator f({intact.begin(), intact.begin() + kModes}, 2, call_single, call_pair,
                            additive);
      for (int count = 3; count <= 5; ++count)
        report((std::string(kind.name) + ", ANOVA in the " + std::string(name(additive))).c_str(),
               count, one.values.rows() + two.values.rows(), one.seconds + two.seconds,
               [&](std::span<const double> x, std::span<double> y) { f.evaluate(x, y); },
               holdout[static_cast<std::size_t>(count - 1)],
               truth[static_cast<std::size_t>(count - 1)]);
    }
  }

  for (int count : {1, 2}) {
    RefinementOptions options{.tolerance = {},
                              .interpolant = &kCubic,
                              .waves = {},
                              .candidates = {},
                              .most_runs = 200'000,
                              .experiment = {.threads = 2}};
    for (Index mode = 0; mode < kModes; ++mode)
      options.tolerance.push_back(0.5 * kNoise *
                                  beam().intact_frequencies_hz()[static_cast<std::size_t>(mode)]);
    for (int i = 0; i < count; ++i) {
      options.waves.insert(options.waves.end(), {true, false});
      options.candidates.insert(options.candidates.end(), {every_element(), {}});
    }
    std::vector<double> coarse;
    for (int e : {0, 11, 22, 33, 44, 55, 66, 77, 88, 99})
      coarse.push_back(source_beam().element_midpoint(e));
    std::optional<RefinedGrid> grid;
    const double seconds = seconds_of([&] {
      grid = refine_grid(factors(count, coarse, {0.0, 0.6}, Scale::compliance), kModes, make_model,
                         options);
    });
    Table table;
    table.factors = grid->factors;
    table.values = grid->values;
    const auto f = kCubic.train(table, {.waves = options.waves});
    const std::string kind =
        "refined to half the noise: " + std::to_string(grid->factors[0].levels.size()) +
        " sites, " + std::to_string(grid->factors[1].levels.size()) + " levels" +
        (grid->reached ? "" : " (not reached)");
    report(
        kind.c_str(), count, grid->values.rows(), seconds,
        [&](std::span<const double> x, std::span<double> y) { f->evaluate(x, y); },
        holdout[static_cast<std::size_t>(count - 1)], truth[static_cast<std::size_t>(count - 1)]);
  }

  for (const auto& [count, size] : {std::pair{1, 400}, std::pair{2, 1600}, std::pair{3, 1600},
                                    std::pair{4, 1600}, std::pair{5, 1600}}) {
    Design design = with_corners(
        latin_hypercube(factors(count, {0.005, 0.995}, {0.0, 0.6}, Scale::compliance), size, 1));
    for (Index i = 0; i < design.runs(); ++i)
      for (Index j = 0; j < design.points.cols(); j += 2)
        design.points(i, j) =
            source_beam().element_midpoint(source_beam().element_at(design.points(i, j)));
    const RowMatrix values = run_experiment(design, kModes, make_model, {.threads = 2});
    const auto& fresh = holdout[static_cast<std::size_t>(count - 1)];
    const auto& expected = truth[static_cast<std::size_t>(count - 1)];
#ifdef WHEELTAP_WITH_CGAL
    if (design.points.cols() <= 5) {
      std::optional<DelaunayInterpolant> f;
      const double seconds = seconds_of([&] { f.emplace(design.factors, design.points, values); });
      report(
          "Latin hypercube, Delaunay", count, design.runs(), seconds,
          [&](std::span<const double> x, std::span<double> y) { f->evaluate(x, y); }, fresh,
          expected);
    }
#endif
    for (const Kernel kernel : {Kernel::matern52, Kernel::squared_exponential}) {
      std::optional<GaussianProcess> f;
      const double seconds = seconds_of([&] {
        f.emplace(design.factors, design.points, values,
                  GaussianProcessOptions{.kernel = kernel, .threads = 2});
      });
      report(
          kernel == Kernel::matern52 ? "Latin hypercube, Gaussian process (Matérn 5/2)"
                                     : "Latin hypercube, Gaussian process (squared exponential)",
          count, design.runs(), seconds,
          [&](std::span<const double> x, std::span<double> y) { f->evaluate(x, y); }, fresh,
          expected);
    }
  }
}
