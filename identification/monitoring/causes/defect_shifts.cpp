#include "identification/monitoring/causes/defect_shifts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "identification/structural/forward/assembled_model.hpp"
#include "identification/structural/forward/beam_model.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;

constexpr int kMostNodes = 65, kFewestNodes = 9;
constexpr int kSolutions = 30'000;  // largest number for each kind
constexpr int kPlaces = 60;         // least number if the effect varies within an element

std::shared_ptr<const ForwardModel> model_of(const DamageCase& damage_case, int modes) {
  if (!damage_case.solved_as_structure())
    return std::make_shared<const BeamModel>(damage_case.beam, damage_case.kinds, modes,
                                             damage_case.rigid_body_modes);
  return std::make_shared<const AssembledModel>(damage_case.solved_structure(), damage_case.kinds,
                                                modes + damage_case.rigid_body_modes,
                                                damage_case.rigid_body_modes);
}

/// Severities with equal prior probability between them; tails beyond five sds are cut off.
std::vector<double> severities_of(const DefectKind& kind, int nodes) {
  const inference::Prior* prior = kind.severity_prior();
  if (prior == nullptr) return {kind.known_severity()};
  std::vector<double> out;
  for (int i = 0; i < nodes; ++i) {
    const double share = static_cast<double>(i) / (nodes - 1);
    out.push_back(
        prior->from_standard_normal(std::clamp(inference::normal_quantile(share), -5.0, 5.0)));
  }
  return out;
}

/// Extents at quantiles of equal probability.
std::vector<double> extents_of(const DefectKind& kind) {
  if (!kind.extent_prior) return {0.0};
  std::vector<double> out;
  for (const double share : {1.0 / 6.0, 0.5, 5.0 / 6.0})
    out.push_back(kind.extent_prior->from_standard_normal(inference::normal_quantile(share)));
  return out;
}

/// ln of the prior probability that the location is in [from, to] of the line.
double log_share(const inference::Prior& location, double from, double to) {
  return std::log(inference::normal_cdf(location.to_standard_normal(to)) -
                  inference::normal_cdf(location.to_standard_normal(from)));
}

void add_paths(const DefectKind& kind, int number, std::vector<DefectPath>& out) {
  const SiteLine& line = kind.line;
  // A reduction has the same effect anywhere in its element; a joint or storey is one place.
  const bool whole_cells = kind.type->name == "reduction" && !kind.extent && !kind.extent_prior;
  const bool points = line.stretches().front().size == 0.0;
  const int parts = whole_cells || points ? 1 : std::max(1, (kPlaces - 1) / line.cells() + 1);
  const std::vector<double> extents = extents_of(kind);
  const int places = line.cells() * parts * static_cast<int>(extents.size());
  const std::vector<double> severities =
      severities_of(kind, std::clamp(kSolutions / places, kFewestNodes, kMostNodes));
  for (int cell = 0; cell < line.cells(); ++cell) {
    const double start = line.cell_start(cell), size = line.cell_start(cell + 1) - start;
    for (int part = 0; part < parts; ++part) {
      const double from = start + size * part / parts, to = start + size * (part + 1) / parts;
      const double share = log_share(kind.location, from, to);
      if (share == -kInfinity) continue;
      for (const double extent : extents)
        out.push_back({.kind = number,
                       .from = from,
                       .to = to,
                       .extent = extent,
                       .log_prior = share - std::log(static_cast<double>(extents.size())),
                       .severities = severities});
    }
  }
}

}  // namespace

std::vector<DefectPath> defect_paths(const DamageCase& damage_case, const std::vector<int>& modes,
                                     int threads) {
  const int wanted = *std::ranges::max_element(modes) + 1;
  const auto model = model_of(damage_case, wanted);
  std::vector<DefectPath> out;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k)
    add_paths(damage_case.kinds[k], static_cast<int>(k), out);
  const auto p = static_cast<Index>(modes.size());
  const auto logarithms = [&](ForwardModel::Solver& solver,
                              const std::vector<PlacedDefect>& defects) {
    Prediction prediction;
    prediction.frequencies_hz.resize(index(wanted));
    Eigen::VectorXd found = Eigen::VectorXd::Constant(p, kNaN);
    if (!solver.predict({}, defects, ForwardModel::Quantity::frequencies, prediction)) return found;
    for (Index j = 0; j < p; ++j)
      found[j] = std::log(prediction.frequencies_hz[index(modes[index(j)])]);
    return found;
  };
  const Eigen::VectorXd intact = logarithms(*model->make_solver(), {});
  base::parallel_for(static_cast<int>(out.size()), threads, [&](int i) {
    DefectPath& path = out[index(i)];
    const auto solver = model->make_solver();
    path.shifts.resize(p, static_cast<Index>(path.severities.size()));
    for (Index s = 0; s < path.shifts.cols(); ++s)
      path.shifts.col(s) = logarithms(*solver, {{.kind = path.kind,
                                                 .location = 0.5 * (path.from + path.to),
                                                 .severity = path.severities[index(s)],
                                                 .extent = path.extent}}) -
                           intact;
  });
  return out;
}

}  // namespace wheeltap::identification::monitoring
