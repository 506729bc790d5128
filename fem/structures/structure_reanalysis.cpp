#include "fem/structures/structure_reanalysis.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fem/root_search.hpp"
#include "fem/structures/structure_modes.hpp"
#include "fem/structures/structure_spectrum.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;

/// Added springs may raise root i as far as intact eigenvalue i + their number; this many are
/// served by a short sum over the near modes, more by the sum over all.
constexpr int kFewSupports = 8;
/// A spring stiffer than this multiple of the structure's own stiffness there is rigid.
constexpr double kRigidSpring = 1e14;
/// What is left of a held motion's compliance, relative, that others do not hold already.
constexpr double kDependentRow = 1e-12;
/// s of a lost mass's pole over the lowest elastic eigenvalue: it adds nothing to static parts.
constexpr double kFloating = 1e30;

std::size_t index(Index i) {
  return static_cast<std::size_t>(i);
}

/// I - B K⁻¹ Bᵀ: what self-stresses the structure can carry; 0 where it is statically determinate.
/// Rigid motions strain nothing, so any degrees of freedom may hold them.
Eigen::MatrixXd self_stress_projector(const Discretisation& d) {
  using Real = long double;
  using Sparse = Eigen::SparseMatrix<Real>;
  const Index n = d.size(), rows = static_cast<Index>(d.strains.size());
  std::vector<bool> held(index(n));
  if (d.rigid_motions.cols() > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(d.rigid_motions.transpose());
    for (Index r = 0; r < d.rigid_motions.cols(); ++r)
      held[index(qr.colsPermutation().indices()[r])] = true;
  }
  std::vector<Eigen::Triplet<Real>> entries;
  const auto add = [&](Index i, Index j, Real value) {
    if (!held[index(i)] && !held[index(j)])
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (const Strain& s : d.strains)
    for (std::size_t i = 0; i < s.row.dofs.size(); ++i)
      for (std::size_t j = 0; j < s.row.dofs.size(); ++j)
        add(s.row.dofs[i], s.row.dofs[j],
            static_cast<Real>(s.factor) * s.row.coefficients[i] * s.row.coefficients[j]);
  for (int k = 0; k < d.rest.outerSize(); ++k)
    for (Discretisation::Sparse::InnerIterator it(d.rest, k); it; ++it)
      add(it.row(), it.col(), static_cast<Real>(it.value()));
  for (Index i = 0; i < n; ++i)
    if (held[index(i)]) entries.emplace_back(static_cast<int>(i), static_cast<int>(i), Real{1});
  Sparse k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Sparse> ldlt(k);
  Eigen::MatrixXd out(rows, rows);
  Eigen::Matrix<Real, Eigen::Dynamic, 1> load(n);
  for (Index a = 0; a < rows; ++a) {
    load.setZero();
    const SparseRow& from = d.strains[index(a)].row;
    for (std::size_t i = 0; i < from.dofs.size(); ++i)
      if (!held[index(from.dofs[i])]) load[from.dofs[i]] = from.coefficients[i];
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> u = ldlt.solve(load);
    for (Index b = 0; b < rows; ++b) {
      const SparseRow& to = d.strains[index(b)].row;
      Real sum = 0;
      for (std::size_t i = 0; i < to.dofs.size(); ++i)
        if (!held[index(to.dofs[i])]) sum += to.coefficients[i] * u[to.dofs[i]];
      out(b, a) = static_cast<double>((a == b ? Real{1} : Real{0}) - sum);
    }
  }
  return 0.5 * (out + out.transpose());
}

}  // namespace

struct StructureReanalysis::Impl {
  std::shared_ptr<const Discretisation> discretisation;
  int wanted;
  int modes;                                             // with mass
  int rigid;                                             // of them at λ = 0
  std::size_t stride;                                    // modes, and at least two
  std::vector<double> eigenvalues, scales, compliances;  // stride
  std::vector<double> frequencies;                       // wanted
  std::vector<double> dof_rows;                          // n × stride
  std::vector<double> strain_rows;                       // strains × stride
  Eigen::MatrixXd self_stresses;                         // strains × strains
  bool compressed = false;  // geometric stiffness takes from that of the strains
  std::vector<detail::Window> windows;

  Impl(std::shared_ptr<const Discretisation> given, int wanted_modes);

  void motion(const SparseRow& row, double* out) const {
    std::fill_n(out, stride, 0.0);
    for (std::size_t i = 0; i < row.dofs.size(); ++i) {
      const double* from = dof_rows.data() + index(row.dofs[i]) * stride;
      for (std::size_t j = 0; j < stride; ++j) out[j] += row.coefficients[i] * from[j];
    }
  }
};

StructureReanalysis::Impl::Impl(std::shared_ptr<const Discretisation> given, int wanted_modes)
    : discretisation(std::move(given)), wanted(wanted_modes) {
  const Discretisation& d = *discretisation;
  const auto available = static_cast<int>(mode_count(d));
  if (wanted < 1 || wanted > available)
    throw std::invalid_argument("modes = " + std::to_string(wanted) + ": must be between 1 and " +
                                std::to_string(available) +
                                ", the free degrees of freedom that have mass");
  const StructureSpectrum spectrum = structure_spectrum(d, std::min(available, 3 * wanted + 20));
  modes = static_cast<int>(spectrum.eigenvalues.size());
  if (modes < wanted)
    throw std::invalid_argument(
        "modes = " + std::to_string(wanted) + ": only " + std::to_string(modes) +
        " of its eigenvalues can be told apart in double precision; its masses or stiffnesses "
        "differ by too many powers of ten");
  rigid = spectrum.rigid_body_modes;
  stride = index(std::max(modes, 2));
  eigenvalues.assign(stride, 0.0);
  for (int j = 0; j < modes; ++j) eigenvalues[index(j)] = spectrum.eigenvalues[j];
  if (modes < 2) eigenvalues[1] = kFloating * std::max(eigenvalues[0], 1.0);
  const int elastic = std::min(rigid, modes - 1);
  for (std::size_t j = 0; j < stride; ++j) {
    scales.push_back(eigenvalues[std::max(j, index(elastic))]);
    compliances.push_back(1.0 / scales.back());
  }
  for (int j = 0; j < wanted; ++j)
    frequencies.push_back(std::sqrt(eigenvalues[index(j)]) / (2.0 * std::numbers::pi));
  dof_rows.assign(index(d.size()) * stride, 0.0);
  strain_rows.assign(d.strains.size() * stride, 0.0);
  for (int j = 0; j < modes; ++j) {
    for (Index i = 0; i < d.size(); ++i)
      dof_rows[index(i) * stride + index(j)] = static_cast<double>(spectrum.shapes(i, j));
    if (j < rigid) continue;  // rigid motions strain nothing
    for (std::size_t r = 0; r < d.strains.size(); ++r) {
      const SparseRow& row = d.strains[r].row;
      long double sum = 0;
      for (std::size_t i = 0; i < row.dofs.size(); ++i)
        sum += row.coefficients[i] * spectrum.shapes(row.dofs[i], j);
      strain_rows[r * stride + index(j)] = static_cast<double>(sum);
    }
  }
  self_stresses = self_stress_projector(d);
  compressed = std::ranges::any_of(d.strains, [](const Strain& s) { return s.factor < 0.0; });
  for (const int supports : {0, kFewSupports, modes})
    windows.emplace_back(eigenvalues, modes, std::min(wanted + supports, modes));
}

struct StructureReanalysis::Workspace::Impl {
  /// Columns of the changes, supports first; see DefectColumns.
  void set(const StructureReanalysis::Impl& intact, const StructureChange& change,
           const detail::SecularKernel& kernel);

  detail::RootSearch search;
  std::vector<double> eigenvalues, scales, starts, lambda;
  std::vector<double> columns;             // count × stride, floating masses first in each
  std::vector<double> raw_row, mass_rows;  // scratch
  Eigen::MatrixXd factor;                  // L
  std::vector<double> coordinates, motion_row;
  std::vector<const StructureChange::Softening*> softenings;
  int poles = 0, negative_poles = 0, supports = 0, held = 0, rigid = 0;
  std::size_t stride = 0;
  double least_remaining = 1.0, added_stiffness = 0.0, residual_factor = 1.0;

  [[nodiscard]] int count() const {
    return stride == 0 ? 0 : static_cast<int>(columns.size() / stride);
  }
};

void StructureReanalysis::Workspace::Impl::set(const StructureReanalysis::Impl& intact,
                                               const StructureChange& change,
                                               const detail::SecularKernel& kernel) {
  std::vector<const StructureChange::Mass*> masses;
  negative_poles = 0;
  for (const bool lost : {true, false})  // lost ones first
    for (const StructureChange::Mass& m : change.masses) {
      if (m.mass == 0.0 || (m.mass < 0.0) != lost || m.motion.empty()) continue;
      masses.push_back(&m);
      negative_poles += lost;
    }
  softenings.clear();
  for (const StructureChange::Softening& s : change.softenings)
    if (s.remaining < 1.0) softenings.push_back(&s);
  poles = static_cast<int>(masses.size());
  const std::size_t p = masses.size();
  stride = intact.stride + p;
  const double lowest = intact.scales[0];
  eigenvalues.assign(p, 0.0);
  eigenvalues.insert(eigenvalues.end(), intact.eigenvalues.begin(), intact.eigenvalues.end());
  scales.clear();
  // A gained mass's pole has the lowest elastic eigenvalue for its s, so that its column is scaled
  // by the mass where that is light; a lost one's adds nothing to static parts, whatever its sign.
  for (std::size_t m = 0; m < p; ++m)
    scales.push_back(index(negative_poles) > m ? kFloating * lowest : lowest);
  scales.insert(scales.end(), intact.scales.begin(), intact.scales.end());
  columns.clear();
  held = rigid = 0;
  least_remaining = 1.0;
  added_stiffness = 0.0;

  const auto compliance = [&](const double* a, const double* b) {
    return kernel.weighted_dot(a + p, b + p, intact.compliances.data(),
                               static_cast<int>(intact.stride));
  };
  const auto column = [&](std::size_t a) { return columns.data() + a * stride; };
  const auto add_column = [&]() {
    columns.resize(columns.size() + stride, 0.0);
    return columns.data() + columns.size() - stride;
  };

  // Supports: springs, then the links of floating masses. L_s L_sᵀ = 1/k + Σ c cᵀ / s, row by row;
  // what is held already is dropped.
  factor.setZero(static_cast<Index>(change.springs.size() + p + softenings.size()),
                 static_cast<Index>(change.springs.size() + p + softenings.size()));
  supports = 0;
  const auto add_support = [&](const SparseRow& motion, double stiffness, int pole, double mass) {
    double* c = add_column();
    intact.motion(motion, c + p);
    const double own = compliance(c, c);
    if (pole >= 0) c[pole] = -1.0 / std::sqrt(std::abs(mass));
    const bool is_rigid = pole >= 0 || stiffness * own > kRigidSpring;
    double left = own;
    if (!is_rigid) left += 1.0 / stiffness;
    if (pole >= 0) left += c[pole] * c[pole] / scales[index(pole)];
    const double before = left;
    const Index a = supports;
    for (Index b = 0; b < a; ++b) {
      double part = compliance(c, column(index(b)));
      for (Index k = 0; k < b; ++k) part -= factor(a, k) * factor(b, k);
      factor(a, b) = part / factor(b, b);
      left -= factor(a, b) * factor(a, b);
    }
    const bool keep = own > 0.0 && (pole >= 0 || !is_rigid || left > kDependentRow * before);
    if (!keep) {
      factor.row(a).setZero();
      columns.resize(columns.size() - stride);
      return;
    }
    factor(a, a) = std::sqrt(std::max(left, kDependentRow * before));
    held += is_rigid ? 1 : 0;
    if (!is_rigid && pole < 0) {
      intact.motion(motion, raw_row.data());
      double sum = 0.0;
      for (std::size_t j = 0; j < intact.stride; ++j) sum += raw_row[j] * raw_row[j];
      added_stiffness += stiffness * sum;
    }
    ++supports;
  };
  raw_row.resize(stride);
  residual_factor = 1.0;
  if (negative_poles > 0) {
    // θ = 1 - the largest eigenvalue of R (M + Pᵀ P)⁻¹ Rᵀ, R the rows √|μ| r of lost masses, P
    // those of gained ones.
    mass_rows.resize(p * intact.stride);
    Eigen::MatrixXd gram(poles, poles);
    for (int a = 0; a < poles; ++a) {
      double* row = mass_rows.data() + index(a) * intact.stride;
      intact.motion(masses[index(a)]->motion, row);
      for (int b = 0; b <= a; ++b) {
        const double* other = mass_rows.data() + index(b) * intact.stride;
        double sum = 0.0;
        for (std::size_t j = 0; j < intact.stride; ++j) sum += row[j] * other[j];
        gram(a, b) = gram(b, a) =
            std::sqrt(std::abs(masses[index(a)]->mass * masses[index(b)]->mass)) * sum;
      }
    }
    const Index gained = poles - negative_poles;
    Eigen::MatrixXd lost = gram.topLeftCorner(negative_poles, negative_poles);
    if (gained > 0) {
      const Eigen::MatrixXd cross = gram.bottomLeftCorner(gained, negative_poles);
      const Eigen::MatrixXd held_back =
          Eigen::MatrixXd::Identity(gained, gained) + gram.bottomRightCorner(gained, gained);
      lost -= cross.transpose() * held_back.llt().solve(cross);
    }
    const double share = negative_poles == 1 ? lost(0, 0)
                                             : Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                                   lost, Eigen::EigenvaluesOnly)
                                                   .eigenvalues()
                                                   .maxCoeff();
    if (!(share < 1.0)) throw ImpossibleChange("lost mass: more than there is");
    residual_factor = 1.0 / (1.0 - share);
  }
  for (const StructureChange::Spring& s : change.springs)
    if (!s.motion.empty()) add_support(s.motion, s.stiffness, -1, 0.0);
  for (std::size_t m = 0; m < p; ++m)
    add_support(masses[m]->motion, 0.0, static_cast<int>(m), masses[m]->mass);

  // Softenings: R Rᵀ = q / (1 - q) + self-stresses + W Wᵀ.
  const auto first = static_cast<Index>(supports);
  const auto count = static_cast<Index>(softenings.size());
  for (Index i = 0; i < count; ++i) {
    const StructureChange::Softening& s = *softenings[index(i)];
    // All strain energy is at least q of what it was, unless compression takes a part of it.
    least_remaining = intact.compressed ? 0.0 : std::min(least_remaining, s.remaining);
    double* c = add_column();
    for (const auto& [row, weight] : s.direction) {
      const double* from = intact.strain_rows.data() + index(row) * intact.stride;
      for (std::size_t j = 0; j < intact.stride; ++j) c[p + j] += weight * from[j];
    }
  }
  for (Index i = 0; i < count; ++i) {
    const StructureChange::Softening& s = *softenings[index(i)];
    const double* c = column(index(first + i));
    for (Index b = 0; b < first; ++b) {
      double part = compliance(c, column(index(b)));
      for (Index k = 0; k < b; ++k) part -= factor(first + i, k) * factor(b, k);
      factor(first + i, b) = part / factor(b, b);
    }
    for (Index b = 0; b <= i; ++b) {
      const StructureChange::Softening& other = *softenings[index(b)];
      double value = b == i ? s.remaining / (1.0 - s.remaining) : 0.0;
      for (const auto& [row, weight] : s.direction)
        for (const auto& [column_row, other_weight] : other.direction)
          value += weight * other_weight * intact.self_stresses(row, column_row);
      for (Index k = 0; k < first; ++k) value += factor(first + i, k) * factor(first + b, k);
      for (Index k = 0; k < b; ++k)
        value -= factor(first + i, first + k) * factor(first + b, first + k);
      if (b < i) {
        factor(first + i, first + b) = value / factor(first + b, first + b);
        continue;
      }
      // The pivot cannot be less than what this softening itself leaves, but for compression: there
      // it is positive as long as the structure does not buckle (Sylvester).
      if (intact.compressed && !(value > 0.0))
        throw ImpossibleChange("remaining stiffness = " + std::to_string(s.remaining) +
                               ": too little for the axial forces, the structure buckles");
      if (!intact.compressed) value = std::max(value, s.remaining / (1.0 - s.remaining));
      factor(first + i, first + i) = std::sqrt(value);
    }
  }
  // L⁻¹ C, forwards.
  for (Index a = 0; a < first + count; ++a) {
    double* c = column(index(a));
    for (Index b = 0; b < a; ++b)
      if (factor(a, b) != 0.0)
        kernel.subtract(c, column(index(b)), factor(a, b), static_cast<int>(stride));
    const double inverse = 1.0 / factor(a, a);
    for (std::size_t j = 0; j < stride; ++j) c[j] *= inverse;
  }

  // Rigid motions that the springs leave.
  rigid = intact.rigid;
  if (intact.rigid > 0 && !change.springs.empty()) {
    Eigen::MatrixXd holds(static_cast<Index>(change.springs.size()), intact.rigid);
    for (std::size_t s = 0; s < change.springs.size(); ++s) {
      intact.motion(change.springs[s].motion, raw_row.data());
      for (Index r = 0; r < intact.rigid; ++r) holds(static_cast<Index>(s), r) = raw_row[index(r)];
    }
    rigid -= static_cast<int>(Eigen::FullPivLU<Eigen::MatrixXd>(holds).rank());
  }
}

StructureReanalysis::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StructureReanalysis::Workspace::Workspace(Workspace&&) noexcept = default;
StructureReanalysis::Workspace& StructureReanalysis::Workspace::operator=(Workspace&&) noexcept =
    default;
StructureReanalysis::Workspace::~Workspace() = default;

StructureReanalysis::StructureReanalysis(std::shared_ptr<const Discretisation> discretisation,
                                         int modes)
    : impl_(std::make_unique<const Impl>(std::move(discretisation), modes)) {}
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
  const std::size_t n = results.frequencies_hz.size();
  if (!results.shapes.empty() && results.shapes.size() != n * results.motions.size())
    throw std::invalid_argument("shapes has size " + std::to_string(results.shapes.size()) +
                                ": must be empty or " + std::to_string(n * results.motions.size()));
  const detail::SecularKernel& kernel = detail::secular_kernel();
  work.set(intact, change, kernel);
  const auto count = static_cast<int>(n);
  const int total = intact.modes + work.poles - work.held;
  if (count > std::min(intact.wanted, total))
    throw std::invalid_argument("modes = " + std::to_string(count) + ": must be at most " +
                                std::to_string(std::min(intact.wanted, total)) + " here");
  work.lambda.assign(n, 0.0);
  const auto write_shape = [&](int root) {
    for (std::size_t m = 0; m < results.motions.size(); ++m) {
      intact.motion(results.motions[m], work.motion_row.data());
      double sum = 0.0;
      for (std::size_t j = 0; j < intact.stride; ++j)
        sum += work.motion_row[j] * work.coordinates[index(work.poles) + j];
      results.shapes[index(root) * results.motions.size() + m] = sum;
    }
  };
  work.motion_row.resize(intact.stride);
  work.coordinates.assign(work.stride, 0.0);
  const bool unchanged = work.count() == 0;
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
    const detail::Window& window = intact.windows[lifting == 0              ? 0
                                                  : lifting <= kFewSupports ? 1
                                                                            : 2];
    work.search.set({.eigenvalues = work.eigenvalues.data(),
                     .scales = work.scales.data(),
                     .stride = work.stride,
                     .modes = intact.modes + work.poles,
                     .window = &window,
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
        work.search.coordinates(mode, work.coordinates.data());
        write_shape(mode.root);
      });
  }
  std::ranges::transform(work.lambda, results.frequencies_hz.begin(),
                         [](double value) { return std::sqrt(value) / (2.0 * std::numbers::pi); });
}

}  // namespace wheeltap::fem
