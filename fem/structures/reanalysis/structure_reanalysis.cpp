#include "fem/structures/reanalysis/structure_reanalysis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/index.hpp"
#include "fem/root_search.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/change_columns.hpp"
#include "fem/structures/reanalysis/intact_structure.hpp"

namespace wheeltap::fem {
namespace {

/// Relative rounding error of a frequency if all modes are kept.
constexpr double kRoundingBound = 1e-9;
/// Largest acceptable relative error bound; above it, the full problem is solved.
constexpr double kTooWide = 1e-6;

void require_sizes(const StructureReanalysis::Results& results) {
  const std::size_t n = results.frequencies_hz.size();
  if (!results.bounds_hz.empty() && results.bounds_hz.size() != n)
    throw std::invalid_argument("bounds_hz has size " + std::to_string(results.bounds_hz.size()) +
                                ": must be empty or " + std::to_string(n));
  if (!results.shapes.empty() && results.shapes.size() != n * results.motions.size())
    throw std::invalid_argument("shapes has size " + std::to_string(results.shapes.size()) +
                                ": must be empty or " + std::to_string(n * results.motions.size()));
}

void write_full_shapes(const Discretisation& intact, const StructureChange& change, int first,
                       const StructureReanalysis::Results& results) {
  const auto count = static_cast<int>(results.frequencies_hz.size());
  std::vector<SparseRow> motions(results.motions.begin(), results.motions.end());
  const StructureModes full = structure_modes(changed(intact, change, motions), count);
  for (int root = first; root < count; ++root)
    for (std::size_t m = 0; m < motions.size(); ++m)
      results.shapes[index(root) * motions.size() + m] = motions[m].of(full.shapes.col(root));
}

void write_full_frequencies(const Discretisation& intact, const StructureChange& change,
                            std::span<double> frequencies_hz) {
  const auto count = static_cast<int>(frequencies_hz.size());
  const StructureModes full = structure_modes(changed(intact, change), count);
  if (!full.certified)
    throw std::runtime_error("the changed structure: could not verify that its first " +
                             std::to_string(count) + " modes are complete");
  std::ranges::copy(full.frequencies_hz, frequencies_hz.begin());
}

}  // namespace

struct StructureReanalysis::Impl : detail::IntactStructure {
  using IntactStructure::IntactStructure;
};

struct StructureReanalysis::Workspace::Impl : detail::ChangeColumns {
  detail::RootSearch search;
  std::optional<detail::Window> window;  // with residual modes
  std::vector<double> starts, lambda, bounds;
  std::vector<double> coordinates, motion_rows;

  [[nodiscard]] std::size_t row_size() const { return stride - index(poles); }
  void observe_motions(const detail::IntactStructure& intact, const Results& results);
  void write_shape(int root, const Results& results) const;
  void take_intact(const detail::IntactStructure& intact, int count, const Results& results);
  void set_starts(const detail::IntactStructure& intact, const StructureChange& change, int count);
  void set_search(const detail::IntactStructure& intact);
  [[nodiscard]] bool find_roots(int first, const Results& results);
};

void StructureReanalysis::Workspace::Impl::observe_motions(const detail::IntactStructure& intact,
                                                           const Results& results) {
  motion_rows.resize(results.shapes.empty() ? 0 : results.motions.size() * row_size());
  for (std::size_t m = 0; !results.shapes.empty() && m < results.motions.size(); ++m)
    observe(intact, results.motions[m], motion_rows.data() + m * row_size());
}

/// Writes the motions of the mode with the current `coordinates`.
void StructureReanalysis::Workspace::Impl::write_shape(int root, const Results& results) const {
  const std::size_t size = row_size();
  for (std::size_t m = 0; m < results.motions.size(); ++m) {
    const double* row = motion_rows.data() + m * size;
    double sum = 0.0;
    for (std::size_t j = 0; j < size; ++j) sum += row[j] * coordinates[index(poles) + j];
    results.shapes[index(root) * results.motions.size() + m] = sum;
  }
}

/// Takes the first `count` modes from the intact structure, rigid-body modes first.
void StructureReanalysis::Workspace::Impl::take_intact(const detail::IntactStructure& intact,
                                                       int count, const Results& results) {
  for (int root = 0; root < count; ++root) {
    if (root >= rigid) lambda[index(root)] = intact.eigenvalues[index(root)];
    if (results.shapes.empty()) continue;
    std::ranges::fill(coordinates, 0.0);
    coordinates[index(poles + root)] = 1.0;
    write_shape(root, results);
  }
}

/// First-order estimate of each eigenvalue: compliance and mass reduce it, springs increase it.
void StructureReanalysis::Workspace::Impl::set_starts(const detail::IntactStructure& intact,
                                                      const StructureChange& change, int count) {
  starts.assign(index(count), 0.0);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t mode = std::min(i, intact.stride - 1), at = index(poles) + mode;
    double softer = 1.0, stiffer = 0.0;
    for (int a = 0; a < this->count(); ++a) {
      const double c = columns[index(a) * stride + at];
      if (a < supports - poles) {
        stiffer += c * c;
      } else if (a >= supports) {
        softer += c * c / intact.scales[mode];
      }
    }
    for (const StructureChange::Mass& m : change.masses) {
      double motion = 0.0;
      for (std::size_t k = 0; k < m.motion.dofs.size(); ++k)
        motion += m.motion.coefficients[k] *
                  intact.dof_rows[index(m.motion.dofs[k]) * intact.stride + mode];
      softer += m.mass * motion * motion;
    }
    starts[i] = (intact.eigenvalues[mode] + stiffer) / softer;
  }
  std::ranges::sort(starts);
}

void StructureReanalysis::Workspace::Impl::set_search(const detail::IntactStructure& intact) {
  const int lifting = supports - poles + negative_poles;
  search.set({.eigenvalues = eigenvalues.data(),
              .scales = scales.data(),
              .stride = stride,
              .modes = intact.modes + poles + extra,
              .window = window ? &*window : &intact.window_for(lifting),
              .added_poles = poles,
              .negative_poles = negative_poles,
              .residual_factor = residual_factor,
              .columns = count(),
              .supports = supports,
              .held = held,
              .least_remaining = least_remaining,
              .added_stiffness = added_stiffness,
              .c = columns.data(),
              .starts = starts},
             detail::secular_kernel());
}

/// Finds the roots from `first` on, and their shapes. Returns false if a shape is not determined.
bool StructureReanalysis::Workspace::Impl::find_roots(int first, const Results& results) {
  search.find(first, lambda);
  bool shapes_told = true;
  if (!results.shapes.empty())
    search.modes(first, lambda, [&](const detail::RootSearch::Mode& mode) {
      shapes_told &= mode.found;
      search.coordinates(mode, coordinates.data());
      write_shape(mode.root, results);
    });
  return shapes_told;
}

StructureReanalysis::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StructureReanalysis::Workspace::Workspace(Workspace&&) noexcept = default;
StructureReanalysis::Workspace& StructureReanalysis::Workspace::operator=(Workspace&&) noexcept =
    default;
StructureReanalysis::Workspace::~Workspace() = default;

StructureReanalysis::StructureReanalysis(std::shared_ptr<const Discretisation> discretisation,
                                         int modes, int kept)
    : impl_(std::make_unique<const Impl>(std::move(discretisation), modes, kept)) {}
StructureReanalysis::~StructureReanalysis() = default;
StructureReanalysis::StructureReanalysis(StructureReanalysis&&) noexcept = default;
StructureReanalysis& StructureReanalysis::operator=(StructureReanalysis&&) noexcept = default;

int StructureReanalysis::modes() const {
  return impl_->wanted;
}
int StructureReanalysis::rigid_body_modes() const {
  return impl_->rigid;
}
std::span<const double> StructureReanalysis::intact_frequencies_hz() const {
  return impl_->frequencies;
}
const Discretisation& StructureReanalysis::discretisation() const {
  return *impl_->discretisation;
}
StructureReanalysis::Workspace StructureReanalysis::make_workspace() const {
  return Workspace(std::make_unique<Workspace::Impl>());
}

void StructureReanalysis::solve(const StructureChange& change, Workspace& workspace,
                                const Results& results) const {
  const Impl& intact = *impl_;
  Workspace::Impl& work = *workspace.impl_;
  validate(*intact.discretisation, change);
  if (!change.scalings.empty())
    throw std::invalid_argument(
        "a changed part of the stiffness matrix has a rank that is too high for reanalysis");
  require_sizes(results);
  work.set(intact, change, detail::secular_kernel());
  const std::size_t n = results.frequencies_hz.size();
  const auto count = static_cast<int>(n);
  work.window.reset();
  if (work.extra > 0)
    work.window.emplace(work.eigenvalues, intact.modes + work.extra, intact.modes + work.extra);
  const int total = intact.modes + work.poles + work.extra - work.held;
  if (count > std::min(intact.wanted, total))
    throw std::invalid_argument("modes = " + std::to_string(count) + ": must be at most " +
                                std::to_string(std::min(intact.wanted, total)) + " here");
  work.lambda.assign(n, 0.0);
  work.observe_motions(intact, results);
  work.coordinates.assign(work.stride, 0.0);
  const bool unchanged = work.count() == 0;
  const int first = unchanged ? count : std::min(count, work.rigid);
  work.take_intact(intact, first, results);
  if (first < count) {
    work.set_starts(intact, change, std::min(count + 1, total));
    work.set_search(intact);
    if (!work.find_roots(first, results))  // for example if three or more modes coincide
      write_full_shapes(*intact.discretisation, change, first, results);
  }
  const auto hz = [](double value) { return std::sqrt(value) / (2.0 * std::numbers::pi); };
  std::ranges::transform(work.lambda, results.frequencies_hz.begin(), hz);
  // If all modes are kept, rounding is the only error.
  work.bounds.assign(n, kRoundingBound);
  if (intact.residual && !unchanged) {
    for (int root = first; root < count; ++root)
      work.bounds[index(root)] =
          std::max(kRoundingBound, work.bound(work.lambda[index(root)], root, intact.next));
    if (std::ranges::any_of(work.bounds, [](double bound) { return bound > kTooWide; })) {
      write_full_frequencies(*intact.discretisation, change, results.frequencies_hz);
      std::ranges::fill(work.bounds, kRoundingBound);
    }
  }
  for (std::size_t i = 0; i < results.bounds_hz.size(); ++i)
    results.bounds_hz[i] = results.frequencies_hz[i] * work.bounds[i];
}

}  // namespace wheeltap::fem
