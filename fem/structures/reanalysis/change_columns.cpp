#include "fem/structures/reanalysis/change_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem::detail {
namespace {

using Eigen::Index;

/// A spring stiffer than this multiple of the structure's stiffness at its place counts as rigid.
constexpr double kRigidJoint = 1e14;
/// If less than this share of a motion's compliance remains, other supports restrain the motion.
constexpr double kDependentChange = 1e-12;
/// The search for an error bound starts at kLeastBound and multiplies the bound by kWider.
constexpr double kLeastBound = 1e-9;
constexpr double kWider = 4.0;

/// Masses that change the structure, removed masses first.
std::vector<const StructureChange::Mass*> floating_masses(const StructureChange& change) {
  std::vector<const StructureChange::Mass*> masses;
  for (const bool lost : {true, false})
    for (const StructureChange::Mass& m : change.masses) {
      if (m.mass == 0.0 || (m.mass < 0.0) != lost || m.motion.empty()) continue;
      masses.push_back(&m);
    }
  return masses;
}

/// Eigenvalues, scales and compliances of floating masses, kept modes and residual modes.
void set_poles(const IntactStructure& intact, const ResidualModes& residual, ChangeColumns& out) {
  const std::size_t p = index(out.poles);
  const double lowest = intact.scales[0];
  out.eigenvalues.assign(p, 0.0);
  out.eigenvalues.insert(out.eigenvalues.end(), intact.eigenvalues.begin(),
                         intact.eigenvalues.end());
  out.compliances = intact.compliances;
  for (Index k = 0; k < out.extra; ++k) {
    out.eigenvalues.push_back(residual.eigenvalues[k]);
    out.compliances.push_back(1.0 / residual.eigenvalues[k]);
  }
  out.scales.clear();
  // |s| for the pole of a floating mass is the lowest elastic eigenvalue, so that a light mass
  // scales its column. s is negative if the mass counts with the opposite sign. All static parts
  // c²/|s| are thus positive.
  for (std::size_t m = 0; m < p; ++m)
    out.scales.push_back(index(out.negative_poles) > m ? -lowest : lowest);
  out.scales.insert(out.scales.end(), intact.scales.begin(), intact.scales.end());
  out.scales.insert(out.scales.end(), out.eigenvalues.end() - out.extra, out.eigenvalues.end());
}

/// Writes C and the rows of L; each row follows from the previous rows. The order of the forms is
/// springs, masses, softenings.
struct ColumnFactor {
  const IntactStructure& intact;
  const StructureChange& change;
  const SecularKernel& kernel;
  const std::vector<const StructureChange::Mass*>& masses;
  const std::vector<const StructureChange::Softening*>& softenings;
  const ResidualModes& residual;
  const Eigen::MatrixXd& flexibility;  // R₀ of the forms
  ChangeColumns& out;
  Eigen::MatrixXd& factor;  // L

  [[nodiscard]] std::size_t mass_form(std::size_t m) const { return change.springs.size() + m; }
  [[nodiscard]] Index softening_form(Index i) const {
    return static_cast<Index>(change.springs.size() + masses.size()) + i;
  }
  [[nodiscard]] double* column(Index a) const { return out.columns.data() + index(a) * out.stride; }
  [[nodiscard]] double* add_column() const {
    out.columns.resize(out.columns.size() + out.stride, 0.0);
    return out.columns.data() + out.columns.size() - out.stride;
  }
  [[nodiscard]] double compliance(const double* a, const double* b) const {
    const std::size_t p = masses.size();
    return kernel.weighted_dot(a + p, b + p, out.compliances.data(),
                               static_cast<int>(out.compliances.size()));
  }
  /// The motion in all modes: the kept modes, then the residual modes of its form.
  void fill(const SparseRow& motion, std::size_t form, double* to) const {
    intact.motion(motion, to);
    for (Index k = 0; k < out.extra; ++k)
      to[intact.stride + index(k)] = residual.forms(static_cast<Index>(form), k);
  }

  [[nodiscard]] Eigen::MatrixXd mass_gram(std::vector<double>& rows) const;
  void add_supports();
  void add_support(const SparseRow& motion, std::size_t form, double stiffness, int pole,
                   double mass);
  void add_softenings();
  void add_softening_column(Index i);
  void add_softening_row(Index i);
  [[nodiscard]] double softening_entry(Index i, Index b) const;
  void divide_columns();
};

/// √|μ_a μ_b| r_aᵀ r_b of all floating masses; `rows` is scratch memory.
Eigen::MatrixXd ColumnFactor::mass_gram(std::vector<double>& rows) const {
  const std::size_t width = out.stride - masses.size();
  rows.resize(masses.size() * width);
  Eigen::MatrixXd gram(out.poles, out.poles);
  for (int a = 0; a < out.poles; ++a) {
    double* row = rows.data() + index(a) * width;
    fill(masses[index(a)]->motion, mass_form(index(a)), row);
    for (int b = 0; b <= a; ++b) {
      const double* other = rows.data() + index(b) * width;
      double sum = 0.0;
      for (std::size_t j = 0; j < width; ++j) sum += row[j] * other[j];
      gram(a, b) = gram(b, a) =
          std::sqrt(std::abs(masses[index(a)]->mass * masses[index(b)]->mass)) * sum;
    }
  }
  return gram;
}

/// The largest eigenvalue of R (M + Pᵀ P)⁻¹ Rᵀ, with the rows √|μ| r in R for removed masses and in
/// P for added masses. `gram` is a result of `mass_gram`, removed masses first.
double lost_share(const Eigen::MatrixXd& gram, Index lost_masses) {
  const Index gained = gram.rows() - lost_masses;
  Eigen::MatrixXd lost = gram.topLeftCorner(lost_masses, lost_masses);
  if (gained > 0) {
    const Eigen::MatrixXd cross = gram.bottomLeftCorner(gained, lost_masses);
    const Eigen::MatrixXd held_back =
        Eigen::MatrixXd::Identity(gained, gained) + gram.bottomRightCorner(gained, gained);
    lost -= cross.transpose() * held_back.llt().solve(cross);
  }
  if (lost_masses == 1) return lost(0, 0);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(lost, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// Adds the supports: springs, then the links of floating masses. Computes L_s L_sᵀ = 1/k + Σ c cᵀ
/// / s row by row, and omits motions that are already restrained.
void ColumnFactor::add_supports() {
  for (std::size_t s = 0; s < change.springs.size(); ++s) {
    const StructureChange::Spring& spring = change.springs[s];
    if (!spring.motion.empty()) add_support(spring.motion, s, spring.stiffness, -1, 0.0);
  }
  for (std::size_t m = 0; m < masses.size(); ++m)
    add_support(masses[m]->motion, mass_form(m), 0.0, static_cast<int>(m), masses[m]->mass);
}

/// Adds a spring, or the link of the mass `pole` if `pole` is not -1.
void ColumnFactor::add_support(const SparseRow& motion, std::size_t form, double stiffness,
                               int pole, double mass) {
  const std::size_t p = masses.size();
  double* c = add_column();
  fill(motion, form, c + p);
  const double own = compliance(c, c);
  if (pole >= 0) c[pole] = -1.0 / std::sqrt(std::abs(mass));
  const bool is_rigid = pole >= 0 || stiffness * own > kRigidJoint;
  double left = own;
  if (!is_rigid) left += 1.0 / stiffness;
  if (pole >= 0) left += c[pole] * c[pole] / std::abs(out.scales[index(pole)]);
  const double before = left;
  const Index a = out.supports;
  for (Index b = 0; b < a; ++b) {
    double part = compliance(c, column(b));
    for (Index k = 0; k < b; ++k) part -= factor(a, k) * factor(b, k);
    factor(a, b) = part / factor(b, b);
    left -= factor(a, b) * factor(a, b);
  }
  const bool keep = own > 0.0 && (pole >= 0 || !is_rigid || left > kDependentChange * before);
  if (!keep) {
    factor.row(a).setZero();
    out.columns.resize(out.columns.size() - out.stride);
    return;
  }
  factor(a, a) = std::sqrt(std::max(left, kDependentChange * before));
  out.held += is_rigid ? 1 : 0;
  if (!is_rigid && pole < 0) {
    double sum = 0.0;
    for (std::size_t j = p; j < out.stride; ++j) sum += c[j] * c[j];
    out.added_stiffness += stiffness * sum;
  }
  ++out.supports;
}

/// Adds the softenings, after the supports: R Rᵀ = q / (1 - q) + self-stresses + W Wᵀ.
void ColumnFactor::add_softenings() {
  const auto count = static_cast<Index>(softenings.size());
  for (Index i = 0; i < count; ++i) add_softening_column(i);
  for (Index i = 0; i < count; ++i) add_softening_row(i);
}

void ColumnFactor::add_softening_column(Index i) {
  const std::size_t p = masses.size();
  const StructureChange::Softening& s = *softenings[index(i)];
  // Without compression, the strain energy is at least q times its original value.
  out.least_remaining = intact.compressed ? 0.0 : std::min(out.least_remaining, s.remaining);
  double* c = add_column();
  for (const auto& [row, weight] : s.direction) {
    const double* from = intact.strain_rows.data() + index(row) * intact.stride;
    for (std::size_t j = 0; j < intact.stride; ++j) c[p + j] += weight * from[j];
  }
  for (Index k = 0; k < out.extra; ++k)
    c[p + intact.stride + index(k)] = residual.forms(softening_form(i), k);
}

void ColumnFactor::add_softening_row(Index i) {
  const auto first = static_cast<Index>(out.supports);
  const StructureChange::Softening& s = *softenings[index(i)];
  const double* c = column(first + i);
  for (Index b = 0; b < first; ++b) {
    double part = compliance(c, column(b));
    for (Index k = 0; k < b; ++k) part -= factor(first + i, k) * factor(b, k);
    factor(first + i, b) = part / factor(b, b);
  }
  for (Index b = 0; b <= i; ++b) {
    double value = softening_entry(i, b);
    for (Index k = 0; k < first; ++k) value += factor(first + i, k) * factor(first + b, k);
    for (Index k = 0; k < b; ++k)
      value -= factor(first + i, first + k) * factor(first + b, first + k);
    if (b < i) {
      factor(first + i, first + b) = value / factor(first + b, first + b);
      continue;
    }
    // Without compression, the pivot cannot be less than the remaining share of this softening
    // alone. With compression, the pivot is positive unless the structure buckles (Sylvester).
    if (intact.compressed && !(value > 0.0))
      throw ImpossibleChange("remaining stiffness = " + std::to_string(s.remaining) +
                             ": too small for the axial forces, so the structure buckles");
    if (!intact.compressed) value = std::max(value, s.remaining / (1.0 - s.remaining));
    factor(first + i, first + i) = std::sqrt(value);
  }
}

/// The term q / (1 - q) on the diagonal, and the self-stresses.
double ColumnFactor::softening_entry(Index i, Index b) const {
  const std::size_t p = masses.size();
  const auto first = static_cast<Index>(out.supports);
  const StructureChange::Softening& s = *softenings[index(i)];
  const StructureChange::Softening& other = *softenings[index(b)];
  double value = b == i ? s.remaining / (1.0 - s.remaining) : 0.0;
  for (const auto& [row, weight] : s.direction)
    for (const auto& [column_row, other_weight] : other.direction)
      if (!intact.residual)
        value += weight * other_weight * intact.self_stresses(row, column_row);
      else if (row == column_row)
        value += weight * other_weight;
  if (intact.residual)  // flexibility of the strains, per unit of the strains
    value -= flexibility(softening_form(i), softening_form(b)) +
             kernel.weighted_dot(column(first + i) + p, column(first + b) + p,
                                 out.compliances.data(), static_cast<int>(intact.stride));
  return value;
}

/// Computes L⁻¹ C by forward substitution.
void ColumnFactor::divide_columns() {
  const Index all = out.count();
  for (Index a = 0; a < all; ++a) {
    double* c = column(a);
    for (Index b = 0; b < a; ++b)
      if (factor(a, b) != 0.0)
        kernel.subtract(c, column(b), factor(a, b), static_cast<int>(out.stride));
    const double inverse = 1.0 / factor(a, a);
    for (std::size_t j = 0; j < out.stride; ++j) c[j] *= inverse;
  }
}

/// Number of rigid motions that the springs do not restrain; `row` is scratch memory.
int rigid_left(const IntactStructure& intact, const StructureChange& change,
               std::vector<double>& row) {
  if (intact.rigid == 0 || change.springs.empty()) return intact.rigid;
  row.resize(intact.stride);
  Eigen::MatrixXd holds(static_cast<Index>(change.springs.size()), intact.rigid);
  for (std::size_t s = 0; s < change.springs.size(); ++s) {
    intact.motion(change.springs[s].motion, row.data());
    for (Index r = 0; r < intact.rigid; ++r) holds(static_cast<Index>(s), r) = row[index(r)];
  }
  return intact.rigid - static_cast<int>(Eigen::FullPivLU<Eigen::MatrixXd>(holds).rank());
}

}  // namespace

void ChangeColumns::set_residual_modes(const IntactStructure& intact, const StructureChange& change,
                                       const std::vector<const StructureChange::Mass*>& masses) {
  extra = 0;
  forms_.clear();
  if (!intact.residual) return;
  require_mass_left(*intact.discretisation, change);
  for (const StructureChange::Spring& s : change.springs)
    forms_.push_back(intact.residual->motion(s.motion));
  for (const StructureChange::Mass* m : masses)
    forms_.push_back(intact.residual->motion(m->motion));
  for (const StructureChange::Softening* s : softenings_) forms_.push_back(s->direction);
  const auto m = static_cast<Index>(forms_.size());
  for (Eigen::MatrixXd& r : moments_) r.resize(m, m);
  for (Index a = 0; a < m; ++a)
    for (Index b = 0; b <= a; ++b) {
      const auto part = intact.residual->moments(forms_[index(a)], forms_[index(b)]);
      for (int n = 0; n < 4; ++n) moments_[n](a, b) = moments_[n](b, a) = part.r[n];
    }
  residual_ = residual_modes(moments_);
  extra = static_cast<int>(residual_.eigenvalues.size());
}

void ChangeColumns::observe(const IntactStructure& intact, const SparseRow& row,
                            double* out) const {
  intact.motion(row, out);
  out += intact.stride;
  std::fill_n(out, extra, 0.0);
  const auto m = static_cast<Index>(forms_.size());
  for (Index a = 0; extra > 0 && a < m; ++a) {
    const auto [u, w] = intact.residual->responses(row, forms_[index(a)]);
    for (Index k = 0; k < extra; ++k)
      out[k] += residual_.weights(a, k) * u + residual_.weights(m + a, k) * w;
  }
}

/// An upper bound on the number of eigenvalues of the whole structure below z < λ_{p+1}. With the
/// residual modes instead of the other modes, Cᵀ (K - zM)⁻¹ C is too small by a matrix between 0
/// and z³ ρ / (1 - ρ) R₃, ρ = z / λ_{p+1}. The residual modes have the same R₃.
int ChangeColumns::eigenvalues_below_at_most(double z, double next) const {
  const Index m = count();
  const double ratio = z / next, rest = z * z * z * ratio / (1.0 - ratio);
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(m, m);
  int below = 0;
  for (std::size_t j = 0; j < stride; ++j) {
    const double gap = eigenvalues[j] - z, sign = index(negative_poles) > j ? -1.0 : 1.0;
    below += gap < 0.0;
    double weight = sign * (scales[j] / gap - 1.0) / scales[j];
    if (j + index(extra) >= stride) weight += rest / std::pow(eigenvalues[j], 4);
    const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>> c(
        columns.data() + j, m, Eigen::InnerStride<>(static_cast<Index>(stride)));
    s.selfadjointView<Eigen::Lower>().rankUpdate(Eigen::VectorXd(c), -weight);
  }
  for (Index a = 0; a < m; ++a) s(a, a) += a < supports ? -1.0 : 1.0;
  if (!s.allFinite()) return std::numeric_limits<int>::max();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(s, Eigen::EigenvaluesOnly);
  return below + static_cast<int>((solver.eigenvalues().array() < 0.0).count()) - supports -
         negative_poles;
}

double ChangeColumns::bound(double found, int root, double next) const {
  for (double width = kLeastBound; width < 1.0; width *= kWider) {
    const double z = found * (1.0 - width);
    if (z < next && eigenvalues_below_at_most(z, next) <= root) return width;
  }
  return std::numeric_limits<double>::infinity();
}

void ChangeColumns::set(const IntactStructure& intact, const StructureChange& change,
                        const detail::SecularKernel& kernel) {
  const std::vector<const StructureChange::Mass*> masses = floating_masses(change);
  poles = static_cast<int>(masses.size());
  negative_poles = static_cast<int>(
      std::ranges::count_if(masses, [](const StructureChange::Mass* m) { return m->mass < 0.0; }));
  softenings_.clear();
  for (const StructureChange::Softening& s : change.softenings)
    if (s.remaining < 1.0) softenings_.push_back(&s);
  set_residual_modes(intact, change, masses);
  stride = masses.size() + intact.stride + index(extra);
  set_poles(intact, residual_, *this);
  columns.clear();
  supports = held = rigid = 0;
  least_remaining = residual_factor = 1.0;
  added_stiffness = 0.0;
  const auto most = static_cast<Index>(change.springs.size() + masses.size() + softenings_.size());
  factor_.setZero(most, most);

  ColumnFactor factored{.intact = intact,
                        .change = change,
                        .kernel = kernel,
                        .masses = masses,
                        .softenings = softenings_,
                        .residual = residual_,
                        .flexibility = moments_[0],
                        .out = *this,
                        .factor = factor_};
  if (negative_poles > 0) {
    const double share = lost_share(factored.mass_gram(mass_rows_), negative_poles);
    if (!(share < 1.0)) throw ImpossibleChange("lost mass: exceeds the mass of the structure");
    residual_factor = 1.0 / (1.0 - share);  // 1/θ, θ = 1 - share
  }
  factored.add_supports();
  factored.add_softenings();
  factored.divide_columns();
  rigid = rigid_left(intact, change, raw_row_);
}

}  // namespace wheeltap::fem::detail
