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

/// What rounding leaves of a frequency where all modes are kept, relative.
constexpr double kRoundingBound = 1e-9;
/// A wider bound, relative, is not offered: the changed structure is solved in full.
constexpr double kTooWide = 1e-6;

}  // namespace

struct StructureReanalysis::Impl : detail::IntactStructure {
  using IntactStructure::IntactStructure;
};

struct StructureReanalysis::Workspace::Impl : detail::ChangeColumns {
  detail::RootSearch search;
  std::optional<detail::Window> window;  // with residual modes
  std::vector<double> starts, lambda, bounds;
  std::vector<double> coordinates, motion_rows;
};

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
    throw std::invalid_argument("a part of the stiffness that changes as a whole: no low rank");
  const std::size_t n = results.frequencies_hz.size();
  if (!results.bounds_hz.empty() && results.bounds_hz.size() != n)
    throw std::invalid_argument("bounds_hz has size " + std::to_string(results.bounds_hz.size()) +
                                ": must be empty or " + std::to_string(n));
  if (!results.shapes.empty() && results.shapes.size() != n * results.motions.size())
    throw std::invalid_argument("shapes has size " + std::to_string(results.shapes.size()) +
                                ": must be empty or " + std::to_string(n * results.motions.size()));
  const detail::SecularKernel& kernel = detail::secular_kernel();
  work.set(intact, change, kernel);
  const auto count = static_cast<int>(n);
  work.window.reset();
  if (work.extra > 0)
    work.window.emplace(work.eigenvalues, intact.modes + work.extra, intact.modes + work.extra);
  const int modes = intact.modes + work.poles + work.extra, total = modes - work.held;
  if (count > std::min(intact.wanted, total))
    throw std::invalid_argument("modes = " + std::to_string(count) + ": must be at most " +
                                std::to_string(std::min(intact.wanted, total)) + " here");
  work.lambda.assign(n, 0.0);
  const std::size_t row_size = intact.stride + index(work.extra);
  work.motion_rows.resize(results.shapes.empty() ? 0 : results.motions.size() * row_size);
  for (std::size_t m = 0; !results.shapes.empty() && m < results.motions.size(); ++m)
    work.observe(intact, results.motions[m], work.motion_rows.data() + m * row_size);
  const auto write_shape = [&](int root) {
    for (std::size_t m = 0; m < results.motions.size(); ++m) {
      const double* row = work.motion_rows.data() + m * row_size;
      double sum = 0.0;
      for (std::size_t j = 0; j < row_size; ++j)
        sum += row[j] * work.coordinates[index(work.poles) + j];
      results.shapes[index(root) * results.motions.size() + m] = sum;
    }
  };
  work.coordinates.assign(work.stride, 0.0);
  const bool unchanged = work.count() == 0;
  bool shapes_told = true;
  const int first = unchanged ? count : std::min(count, work.rigid);
  for (int root = 0; root < first; ++root) {
    if (root >= work.rigid) work.lambda[index(root)] = intact.eigenvalues[index(root)];
    if (results.shapes.empty()) continue;
    std::ranges::fill(work.coordinates, 0.0);
    work.coordinates[index(work.poles + root)] = 1.0;
    write_shape(root);
  }
  if (first < count) {
    // First order, mode by mode: softened by compliance and mass, lifted by springs.
    work.starts.assign(index(std::min(count + 1, total)), 0.0);
    for (std::size_t i = 0; i < work.starts.size(); ++i) {
      const std::size_t mode = std::min(i, intact.stride - 1), at = index(work.poles) + mode;
      double softer = 1.0, stiffer = 0.0;
      for (int a = 0; a < work.count(); ++a) {
        const double c = work.columns[index(a) * work.stride + at];
        if (a < work.supports - work.poles) {
          stiffer += c * c;
        } else if (a >= work.supports) {
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
      work.starts[i] = (intact.eigenvalues[mode] + stiffer) / softer;
    }
    std::ranges::sort(work.starts);
    const int lifting = work.supports - work.poles + work.negative_poles;
    const detail::Window& window = intact.window_for(lifting);
    work.search.set({.eigenvalues = work.eigenvalues.data(),
                     .scales = work.scales.data(),
                     .stride = work.stride,
                     .modes = modes,
                     .window = work.window ? &*work.window : &window,
                     .added_poles = work.poles,
                     .negative_poles = work.negative_poles,
                     .residual_factor = work.residual_factor,
                     .columns = work.count(),
                     .supports = work.supports,
                     .held = work.held,
                     .least_remaining = work.least_remaining,
                     .added_stiffness = work.added_stiffness,
                     .c = work.columns.data(),
                     .starts = work.starts},
                    kernel);
    work.search.find(first, work.lambda);
    if (!results.shapes.empty())
      work.search.modes(first, work.lambda, [&](const detail::RootSearch::Mode& mode) {
        shapes_told &= mode.found;
        work.search.coordinates(mode, work.coordinates.data());
        write_shape(mode.root);
      });
  }
  if (!shapes_told) {  // as where three modes or more are one: the full solution's
    std::vector<SparseRow> motions(results.motions.begin(), results.motions.end());
    const StructureModes full =
        structure_modes(changed(*intact.discretisation, change, motions), count);
    for (int root = first; root < count; ++root)
      for (std::size_t m = 0; m < motions.size(); ++m)
        results.shapes[index(root) * motions.size() + m] = motions[m].of(full.shapes.col(root));
  }
  const auto hz = [](double value) { return std::sqrt(value) / (2.0 * std::numbers::pi); };
  std::ranges::transform(work.lambda, results.frequencies_hz.begin(), hz);
  // Where all modes are kept, rounding is all there is.
  work.bounds.assign(n, kRoundingBound);
  if (intact.residual && !unchanged) {
    for (int root = first; root < count; ++root)
      work.bounds[index(root)] =
          std::max(kRoundingBound, work.bound(work.lambda[index(root)], root, intact.next));
    if (std::ranges::any_of(work.bounds, [](double bound) { return bound > kTooWide; })) {
      const StructureModes full = structure_modes(changed(*intact.discretisation, change), count);
      if (!full.certified)
        throw std::runtime_error("the changed structure: whether its first " +
                                 std::to_string(count) + " modes are all found was not shown");
      std::ranges::copy(full.frequencies_hz, results.frequencies_hz.begin());
      std::ranges::fill(work.bounds, kRoundingBound);
    }
  }
  for (std::size_t i = 0; i < results.bounds_hz.size(); ++i)
    results.bounds_hz[i] = results.frequencies_hz[i] * work.bounds[i];
}

}  // namespace wheeltap::fem
