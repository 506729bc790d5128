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

/// A spring stiffer than this multiple of the structure's own stiffness there is rigid.
constexpr double kRigidJoint = 1e14;
/// What is left of a held motion's compliance, relative, that others do not hold already.
constexpr double kDependentChange = 1e-12;
/// Bounds are looked for from here on, relative, each so many times the last.
constexpr double kLeastBound = 1e-9;
constexpr double kWider = 4.0;

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

/// How many eigenvalues the whole structure has below z < λ_{p+1} at most. With the residual modes
/// in place of the others, Cᵀ (K - zM)⁻¹ C is too small by a matrix between 0 and
/// z³ ρ / (1 - ρ) R₃, ρ = z / λ_{p+1}, where R₃ is theirs, too.
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
  std::vector<const StructureChange::Mass*> masses;
  negative_poles = 0;
  for (const bool lost : {true, false})  // lost ones first
    for (const StructureChange::Mass& m : change.masses) {
      if (m.mass == 0.0 || (m.mass < 0.0) != lost || m.motion.empty()) continue;
      masses.push_back(&m);
      negative_poles += lost;
    }
  softenings_.clear();
  for (const StructureChange::Softening& s : change.softenings)
    if (s.remaining < 1.0) softenings_.push_back(&s);
  poles = static_cast<int>(masses.size());
  const std::size_t p = masses.size();
  set_residual_modes(intact, change, masses);
  stride = p + intact.stride + index(extra);
  const double lowest = intact.scales[0];
  eigenvalues.assign(p, 0.0);
  eigenvalues.insert(eigenvalues.end(), intact.eigenvalues.begin(), intact.eigenvalues.end());
  compliances = intact.compliances;
  for (Index k = 0; k < extra; ++k) {
    eigenvalues.push_back(residual_.eigenvalues[k]);
    compliances.push_back(1.0 / residual_.eigenvalues[k]);
  }
  scales.clear();
  // A floating mass's pole has the lowest elastic eigenvalue for its |s|, so that its column is
  // scaled by the mass where that is light; s is negative where the mass counts with the other
  // sign, so that each static part c²/|s| adds to the others'.
  for (std::size_t m = 0; m < p; ++m)
    scales.push_back(index(negative_poles) > m ? -lowest : lowest);
  scales.insert(scales.end(), intact.scales.begin(), intact.scales.end());
  scales.insert(scales.end(), eigenvalues.end() - extra, eigenvalues.end());
  columns.clear();
  held = rigid = 0;
  least_remaining = 1.0;
  added_stiffness = 0.0;

  const auto compliance = [&](const double* a, const double* b) {
    return kernel.weighted_dot(a + p, b + p, compliances.data(),
                               static_cast<int>(compliances.size()));
  };
  // A motion in all modes: the kept ones, then those of its form that stand for the others.
  const auto fill = [&](const SparseRow& motion, std::size_t form, double* out) {
    intact.motion(motion, out);
    for (Index k = 0; k < extra; ++k)
      out[intact.stride + index(k)] = residual_.forms(static_cast<Index>(form), k);
  };
  const auto column = [&](std::size_t a) { return columns.data() + a * stride; };
  const auto add_column = [&]() {
    columns.resize(columns.size() + stride, 0.0);
    return columns.data() + columns.size() - stride;
  };

  // Supports: springs, then the links of floating masses. L_s L_sᵀ = 1/k + Σ c cᵀ / s, row by row;
  // what is held already is dropped.
  factor_.setZero(static_cast<Index>(change.springs.size() + p + softenings_.size()),
                  static_cast<Index>(change.springs.size() + p + softenings_.size()));
  supports = 0;
  const auto add_support = [&](const SparseRow& motion, std::size_t form, double stiffness,
                               int pole, double mass) {
    double* c = add_column();
    fill(motion, form, c + p);
    const double own = compliance(c, c);
    if (pole >= 0) c[pole] = -1.0 / std::sqrt(std::abs(mass));
    const bool is_rigid = pole >= 0 || stiffness * own > kRigidJoint;
    double left = own;
    if (!is_rigid) left += 1.0 / stiffness;
    if (pole >= 0) left += c[pole] * c[pole] / std::abs(scales[index(pole)]);
    const double before = left;
    const Index a = supports;
    for (Index b = 0; b < a; ++b) {
      double part = compliance(c, column(index(b)));
      for (Index k = 0; k < b; ++k) part -= factor_(a, k) * factor_(b, k);
      factor_(a, b) = part / factor_(b, b);
      left -= factor_(a, b) * factor_(a, b);
    }
    const bool keep = own > 0.0 && (pole >= 0 || !is_rigid || left > kDependentChange * before);
    if (!keep) {
      factor_.row(a).setZero();
      columns.resize(columns.size() - stride);
      return;
    }
    factor_(a, a) = std::sqrt(std::max(left, kDependentChange * before));
    held += is_rigid ? 1 : 0;
    if (!is_rigid && pole < 0) {
      double sum = 0.0;
      for (std::size_t j = p; j < stride; ++j) sum += c[j] * c[j];
      added_stiffness += stiffness * sum;
    }
    ++supports;
  };
  raw_row_.resize(stride);
  residual_factor = 1.0;
  if (negative_poles > 0) {
    // θ = 1 - the largest eigenvalue of R (M + Pᵀ P)⁻¹ Rᵀ, R the rows √|μ| r of lost masses, P
    // those of gained ones.
    const std::size_t width = stride - p;
    mass_rows_.resize(p * width);
    Eigen::MatrixXd gram(poles, poles);
    for (int a = 0; a < poles; ++a) {
      double* row = mass_rows_.data() + index(a) * width;
      fill(masses[index(a)]->motion, change.springs.size() + index(a), row);
      for (int b = 0; b <= a; ++b) {
        const double* other = mass_rows_.data() + index(b) * width;
        double sum = 0.0;
        for (std::size_t j = 0; j < width; ++j) sum += row[j] * other[j];
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
  for (std::size_t s = 0; s < change.springs.size(); ++s) {
    const StructureChange::Spring& spring = change.springs[s];
    if (!spring.motion.empty()) add_support(spring.motion, s, spring.stiffness, -1, 0.0);
  }
  const std::size_t first_mass = change.springs.size(), first_softening = first_mass + p;
  for (std::size_t m = 0; m < p; ++m)
    add_support(masses[m]->motion, first_mass + m, 0.0, static_cast<int>(m), masses[m]->mass);

  // Softenings: R Rᵀ = q / (1 - q) + self-stresses + W Wᵀ.
  const auto first = static_cast<Index>(supports);
  const auto count = static_cast<Index>(softenings_.size());
  for (Index i = 0; i < count; ++i) {
    const StructureChange::Softening& s = *softenings_[index(i)];
    // All strain energy is at least q of what it was, unless compression takes a part of it.
    least_remaining = intact.compressed ? 0.0 : std::min(least_remaining, s.remaining);
    double* c = add_column();
    for (const auto& [row, weight] : s.direction) {
      const double* from = intact.strain_rows.data() + index(row) * intact.stride;
      for (std::size_t j = 0; j < intact.stride; ++j) c[p + j] += weight * from[j];
    }
    for (Index k = 0; k < extra; ++k)
      c[p + intact.stride + index(k)] = residual_.forms(static_cast<Index>(first_softening) + i, k);
  }
  for (Index i = 0; i < count; ++i) {
    const StructureChange::Softening& s = *softenings_[index(i)];
    const double* c = column(index(first + i));
    for (Index b = 0; b < first; ++b) {
      double part = compliance(c, column(index(b)));
      for (Index k = 0; k < b; ++k) part -= factor_(first + i, k) * factor_(b, k);
      factor_(first + i, b) = part / factor_(b, b);
    }
    for (Index b = 0; b <= i; ++b) {
      const StructureChange::Softening& other = *softenings_[index(b)];
      double value = b == i ? s.remaining / (1.0 - s.remaining) : 0.0;
      for (const auto& [row, weight] : s.direction)
        for (const auto& [column_row, other_weight] : other.direction)
          if (!intact.residual)
            value += weight * other_weight * intact.self_stresses(row, column_row);
          else if (row == column_row)
            value += weight * other_weight;
      if (intact.residual)  // what the strains yield to, of what they measure
        value -= moments_[0](static_cast<Index>(first_softening) + i,
                             static_cast<Index>(first_softening) + b) +
                 kernel.weighted_dot(c + p, column(index(first + b)) + p, compliances.data(),
                                     static_cast<int>(intact.stride));
      for (Index k = 0; k < first; ++k) value += factor_(first + i, k) * factor_(first + b, k);
      for (Index k = 0; k < b; ++k)
        value -= factor_(first + i, first + k) * factor_(first + b, first + k);
      if (b < i) {
        factor_(first + i, first + b) = value / factor_(first + b, first + b);
        continue;
      }
      // The pivot cannot be less than what this softening itself leaves, but for compression: there
      // it is positive as long as the structure does not buckle (Sylvester).
      if (intact.compressed && !(value > 0.0))
        throw ImpossibleChange("remaining stiffness = " + std::to_string(s.remaining) +
                               ": too little for the axial forces, the structure buckles");
      if (!intact.compressed) value = std::max(value, s.remaining / (1.0 - s.remaining));
      factor_(first + i, first + i) = std::sqrt(value);
    }
  }
  // L⁻¹ C, forwards.
  for (Index a = 0; a < first + count; ++a) {
    double* c = column(index(a));
    for (Index b = 0; b < a; ++b)
      if (factor_(a, b) != 0.0)
        kernel.subtract(c, column(index(b)), factor_(a, b), static_cast<int>(stride));
    const double inverse = 1.0 / factor_(a, a);
    for (std::size_t j = 0; j < stride; ++j) c[j] *= inverse;
  }

  // Rigid motions that the springs leave.
  rigid = intact.rigid;
  if (intact.rigid > 0 && !change.springs.empty()) {
    Eigen::MatrixXd holds(static_cast<Index>(change.springs.size()), intact.rigid);
    for (std::size_t s = 0; s < change.springs.size(); ++s) {
      intact.motion(change.springs[s].motion, raw_row_.data());
      for (Index r = 0; r < intact.rigid; ++r) holds(static_cast<Index>(s), r) = raw_row_[index(r)];
    }
    rigid -= static_cast<int>(Eigen::FullPivLU<Eigen::MatrixXd>(holds).rank());
  }
}

}  // namespace wheeltap::fem::detail
