#include "fem/beam/reanalysis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/defect_columns.hpp"
#include "fem/beam/intact_modes.hpp"
#include "fem/beam/mode_readings.hpp"
#include "fem/root_search.hpp"

namespace wheeltap::fem {
namespace {

/// Half the step of the difference quotient for the slope of a support, in element lengths.
constexpr double kSupportStep = 1e-3;

}  // namespace

struct Reanalysis::Impl {
  detail::IntactModes intact;
};

struct Reanalysis::Workspace::Impl {
  detail::DefectColumns columns;
  detail::RootSearch search;
  detail::ModeReadings readings;
  std::vector<double> lambda;         // roots
  Defects moved;                      // with one defect moved
  std::vector<double> before, after;  // frequencies at the two positions
};

Reanalysis::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reanalysis::Workspace::Workspace(Workspace&&) noexcept = default;
Reanalysis::Workspace& Reanalysis::Workspace::operator=(Workspace&&) noexcept = default;
Reanalysis::Workspace::~Workspace() = default;

Reanalysis::Reanalysis(const Beam& beam, int modes)
    : impl_(std::make_unique<const Impl>(Impl{detail::IntactModes(beam, modes)})) {}
Reanalysis::~Reanalysis() = default;
Reanalysis::Reanalysis(Reanalysis&&) noexcept = default;
Reanalysis& Reanalysis::operator=(Reanalysis&&) noexcept = default;

int Reanalysis::modes() const {
  return impl_->intact.wanted;
}
int Reanalysis::rigid_body_modes() const {
  return impl_->intact.rigid;
}
const Beam& Reanalysis::beam() const {
  return impl_->intact.beam;
}
std::span<const double> Reanalysis::intact_frequencies_hz() const {
  return impl_->intact.frequencies;
}

Reanalysis::Workspace Reanalysis::make_workspace() const {
  return Workspace(std::make_unique<Workspace::Impl>());
}

void Reanalysis::frequencies_hz(std::span<const Damage> damages,
                                std::span<const SpringSupport> supports, Workspace& workspace,
                                std::span<double> out) const {
  solve(damages, supports, workspace,
        {.frequencies_hz = out,
         .damage_gradients_hz = {},
         .element_gradients_hz = {},
         .shapes = {},
         .points = {}});
}

void Reanalysis::solve(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                       Workspace& workspace, const Results& results) const {
  const detail::IntactModes& intact = impl_->intact;
  const detail::SecularKernel& kernel = detail::secular_kernel();
  auto& [columns, search, readings, lambda, moved, before, after] = *workspace.impl_;
  columns.set(intact, kernel, damages, supports);
  const auto count = static_cast<int>(results.frequencies_hz.size());
  const int available = std::min(intact.wanted, intact.modes - columns.held());
  if (count > available)
    throw std::invalid_argument("modes = " + std::to_string(count) + ": must be at most " +
                                std::to_string(available) + " here");
  readings.set(intact, kernel, columns, damages, results);

  lambda.assign(index(count), 0.0);
  const bool unchanged = columns.count() == 0;
  const int first = unchanged ? count : std::min(count, columns.rigid_body_modes());
  for (int root = 0; root < first; ++root) {
    if (root >= columns.rigid_body_modes()) lambda[index(root)] = intact.eigenvalues[index(root)];
    if (readings.wanted()) readings.read_unchanged(root);
  }
  if (first < count) {
    const int held_motions = columns.supports();
    search.set({.eigenvalues = intact.eigenvalues.data(),
                .scales = (held_motions > 0 ? intact.held_scales : intact.scales).data(),
                .stride = intact.stride,
                .modes = intact.modes,
                .window = &intact.window(held_motions),
                .columns = columns.count(),
                .supports = held_motions,
                .held = columns.held(),
                .least_remaining = columns.least_remaining(),
                .added_stiffness = columns.added_stiffness(),
                .c = columns.columns()},
               kernel);
    search.find(first, lambda);
    if (readings.wanted())
      search.modes(first, lambda, [&](const detail::RootSearch::Mode& mode) {
        if (!mode.found)
          throw std::runtime_error("mode " + std::to_string(mode.root + 1) +
                                   ": its shape cannot be separated from those of other modes");
        readings.read(search, mode);
      });
  }
  std::transform(lambda.begin(), lambda.end(), results.frequencies_hz.begin(),
                 [](double value) { return std::sqrt(value) / (2.0 * std::numbers::pi); });
}

double Reanalysis::error_bound(std::span<const Damage> damages,
                               std::span<const SpringSupport> supports, double frequency_hz,
                               Workspace& workspace) const {
  const detail::IntactModes& intact = impl_->intact;
  detail::DefectColumns& columns = workspace.impl_->columns;
  columns.set(intact, detail::secular_kernel(), damages, supports);
  const double bound = 1e-10 + 1e-16 * columns.stiffest_spring();
  const bool held_by_added = intact.rigid > 0 && columns.supports() > 0;
  if (!held_by_added && intact.modes > columns.count() + 2) return bound;
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  return bound + 4e-15 * (1.0 / columns.least_remaining() +
                          intact.eigenvalues[index(intact.stiff)] / (omega * omega));
}

void Reanalysis::location_slopes(std::span<const Damage> damages,
                                 std::span<const SpringSupport> supports, Workspace& workspace,
                                 const LocationSlopes& slopes) const {
  const Beam& beam = impl_->intact.beam;
  const std::size_t n = index(slopes.modes);
  detail::require_size("damages_hz_m", slopes.damages_hz_m.size(), n * damages.size());
  detail::require_size("supports_hz_m", slopes.supports_hz_m.size(), n * supports.size());
  for (const Damage& d : damages) validate(beam, d);
  for (const SpringSupport& s : supports) validate(beam, s);
  Workspace::Impl& work = *workspace.impl_;
  work.before.resize(n);
  work.after.resize(n);
  Defects& moved = work.moved;
  moved.damages.assign(damages.begin(), damages.end());
  moved.supports.assign(supports.begin(), supports.end());
  // Writes one column of `out` from the frequencies with `place` = low and `place` = high.
  const auto differ = [&](double& place, double low, double high, std::size_t columns,
                          double* out) {
    const double here = place;
    place = low;
    frequencies_hz(moved.damages, moved.supports, workspace, work.before);
    place = high;
    frequencies_hz(moved.damages, moved.supports, workspace, work.after);
    place = here;
    for (std::size_t i = 0; i < n; ++i)
      out[i * columns] = high > low ? (work.after[i] - work.before[i]) / (high - low) : 0.0;
  };
  if (!slopes.damages_hz_m.empty())
    for (std::size_t d = 0; d < damages.size(); ++d) {
      const int e = beam.element_at(damages[d].location);
      differ(moved.damages[d].location, beam.element_midpoint(std::max(e - 1, 0)),
             beam.element_midpoint(std::min(e + 1, beam.elements - 1)), damages.size(),
             slopes.damages_hz_m.data() + d);
    }
  if (!slopes.supports_hz_m.empty())
    for (std::size_t s = 0; s < supports.size(); ++s) {
      const double at = supports[s].location, step = kSupportStep * beam.element_length();
      differ(moved.supports[s].location, std::max(at - step, 0.0), std::min(at + step, beam.length),
             supports.size(), slopes.supports_hz_m.data() + s);
    }
}

}  // namespace wheeltap::fem
