#include "modal_coverage.hpp"

#include <boost/math/distributions/fisher_f.hpp>
#include <cstdio>
#include <ostream>
#include <stdexcept>

#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;

struct Found {
  bool has = false;
  double frequency = 0.0, frequency_sd = 0.0, damping = 0.0, damping_sd = 0.0;
  bool shape_held = false;
};

/// True if the ellipsoid of the real parts, except the entry 1, contains the true shape.
bool holds(const Mode& mode, const Eigen::VectorXd& truth, int blocks) {
  Index top = 0;
  mode.pole.shape.cwiseAbs().maxCoeff(&top);
  const Index n = truth.size();
  Eigen::VectorXd off(n - 1);
  Eigen::MatrixXd covariance(n - 1, n - 1);
  for (Index i = 0, a = 0; i < n; ++i) {
    if (i == top) continue;
    off[a] = mode.pole.shape[i].real() - truth[i] / truth[top];
    for (Index j = 0, b = 0; j < n; ++j)
      if (j != top) covariance(a, b++) = mode.shape_covariance(i, j);
    ++a;
  }
  // Hotelling's T²: the covariance is known from so many blocks only.
  const double distance = off.dot(covariance.ldlt().solve(off));
  const auto freedom = static_cast<double>(blocks - 1), p = static_cast<double>(n - 1);
  return distance <= freedom * p / (freedom - p + 1.0) *
                         boost::math::quantile(boost::math::fisher_f(p, freedom - p + 1.0), 0.95);
}

CoverageRow row_of(std::string name, double truth, const std::vector<double>& x,
                   const std::vector<double>& sd, double law) {
  CoverageRow row{.name = std::move(name), .truth = truth, .found = static_cast<int>(x.size())};
  if (x.size() < 2) return row;
  const auto n = static_cast<double>(x.size());
  double mean = 0.0, square = 0.0, predicted = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean += x[i] / n;
    predicted += sd[i] * sd[i] / n;
    row.covered += (std::abs(x[i] - truth) <= 1.96 * sd[i] ? 1.0 : 0.0) / n;
  }
  for (const double v : x) square += (v - mean) * (v - mean) / (n - 1.0);
  const double empirical = std::sqrt(square);
  row.bias = (mean - truth) / empirical;
  row.predicted = std::sqrt(predicted) / empirical;
  std::vector<double> sorted = sd;
  std::ranges::sort(sorted);
  row.typical = sorted[sorted.size() / 2] / empirical;
  row.against_law = law > 0.0 ? empirical / law : 0.0;
  return row;
}

}  // namespace

CoverageCase coverage_case(const std::string& name) {
  if (name == "chain") return {.name = name, .structure = chain(3, 1.0, 200.0), .lowest_hz = 0.3};
  if (name == "close") {
    CoverageCase out{.name = name, .structure = chain(3, 1.0, 200.0), .lowest_hz = 0.3};
    out.structure.stiffness << 204, -4, 0, -4, 204, 0, 0, 0, 600;
    return out;
  }
  if (name == "frame") {
    CoverageCase out{
        .name = name, .structure = chain(8, 1.0, 1500.0), .lowest_hz = 0.4, .largest_order = 40};
    out.structure.step = 0.03;
    return out;
  }
  throw std::invalid_argument("case = " + name + ": must be chain, close or frame");
}

Coverage modal_coverage(const CoverageCase& of, int records, std::uint64_t seed, int threads) {
  const VibratingStructure::Modes truth = of.structure.modes();
  const auto count = static_cast<std::size_t>(truth.frequencies_hz.size());
  std::vector<std::vector<Found>> found(static_cast<std::size_t>(records),
                                        std::vector<Found>(count));
  std::vector<int> surplus(found.size()), doubted(found.size());
  base::parallel_for(records, threads, [&](int r) {
    const auto place = static_cast<std::size_t>(r);
    const auto samples = std::lround(of.seconds / of.structure.step);
    const ModalResult result =
        identify_modes(of.structure.accelerations(samples, of.noise, seed + place),
                       {.sample_rate_hz = 1.0 / of.structure.step,
                        .lowest_hz = of.lowest_hz,
                        .highest_hz = of.highest_hz,
                        .largest_order = of.largest_order,
                        .blocks = of.blocks,
                        .threads = 1});
    std::vector<bool> taken(result.modes.size());
    for (std::size_t m = 0; m < count; ++m) {
      const double f = truth.frequencies_hz[static_cast<Index>(m)];
      const Eigen::VectorXd shape = truth.shapes.col(static_cast<Index>(m));
      double nearest = 0.3;
      std::size_t best = result.modes.size();
      for (std::size_t i = 0; i < result.modes.size(); ++i) {
        const Pole& p = result.modes[i].pole;
        const double d = std::abs(p.frequency_hz - f) / f + 1.0 -
                         modal_assurance(p.shape, shape.cast<std::complex<double>>());
        if (taken[i] || d > nearest) continue;
        nearest = d;
        best = i;
      }
      if (best == result.modes.size()) continue;
      taken[best] = true;
      const Mode& mode = result.modes[best];
      found[place][m] = {.has = true,
                         .frequency = mode.pole.frequency_hz,
                         .frequency_sd = mode.pole.frequency_sd,
                         .damping = mode.pole.damping,
                         .damping_sd = mode.pole.damping_sd,
                         .shape_held = holds(mode, shape, result.blocks)};
    }
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i]) {
        ++surplus[place];
        if (!result.modes[i].doubts.empty()) ++doubted[place];
      }
  });
  Coverage out{.rows = {}, .records = records};
  double total = 0.0, inverse = 0.0;
  std::vector<CoverageRow> shapes;
  for (std::size_t m = 0; m < count; ++m) {
    std::vector<double> f, f_sd, z, z_sd;
    CoverageRow shape{.name = "shape " + std::to_string(m + 1), .truth = 1.0};
    for (const std::vector<Found>& one : found) {
      if (!one[m].has) continue;
      f.push_back(one[m].frequency);
      f_sd.push_back(one[m].frequency_sd);
      z.push_back(one[m].damping);
      z_sd.push_back(one[m].damping_sd);
      ++shape.found;
      shape.covered += one[m].shape_held ? 1.0 : 0.0;
    }
    if (shape.found > 0) shape.covered /= shape.found;
    const double hz = truth.frequencies_hz[static_cast<Index>(m)],
                 zeta = of.structure.damping_ratio;
    const double cycles = hz * of.seconds;
    out.rows.push_back(row_of("f" + std::to_string(m + 1), hz, f, f_sd,
                              hz * std::sqrt(zeta / (2.0 * std::numbers::pi * cycles))));
    out.rows.push_back(row_of("damping " + std::to_string(m + 1), zeta, z, z_sd,
                              zeta / std::sqrt(2.0 * std::numbers::pi * zeta * cycles)));
    shapes.push_back(std::move(shape));
  }
  for (const CoverageRow& row : out.rows) {
    out.covered += row.covered * row.found;
    total += row.found;
    inverse += row.predicted / static_cast<double>(out.rows.size());
  }
  out.covered /= std::max(total, 1.0);
  out.predicted = inverse;
  out.rows.insert(out.rows.end(), shapes.begin(), shapes.end());
  double none = 0.0, said = 0.0;
  for (std::size_t r = 0; r < surplus.size(); ++r) {
    none += surplus[r];
    said += doubted[r];
  }
  out.surplus = none / records;
  out.doubted = none > 0.0 ? said / none : 1.0;
  return out;
}

void print(std::ostream& out, const Coverage& coverage) {
  char line[160];
  std::snprintf(line, sizeof line, "%-12s %10s %6s %8s %9s %10s %10s %8s\n", "", "truth", "found",
                "covered", "bias/sd", "pred/emp", "typ/emp", "emp/Au");
  out << line;
  for (const CoverageRow& r : coverage.rows) {
    std::snprintf(line, sizeof line, "%-12s %10.5f %6d %8.3f %9.3f %10.3f %10.3f %8.3f\n",
                  r.name.c_str(), r.truth, r.found, r.covered, r.bias, r.predicted, r.typical,
                  r.against_law);
    out << line;
  }
  std::snprintf(line, sizeof line,
                "all f, damping: covered %.3f, predicted/empirical %.3f; surplus modes a record "
                "%.2f, %.0f %% of them doubtful\n",
                coverage.covered, coverage.predicted, coverage.surplus, 100.0 * coverage.doubted);
  out << line;
}

}  // namespace wheeltap::signals
