#include "fem/beam/defect_columns.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen.hpp"
#include "base/index.hpp"
#include "fem/beam/assembly.hpp"

namespace wheeltap::fem::detail {
namespace {

/// A rigid support does not count if less than this share of its row is independent of other rows.
constexpr double kDependentRow = 1e-9;
/// A spring stiffer than this multiple of the beam's stiffness at its location counts as rigid.
constexpr double kRigidSpring = 1e14;

}  // namespace

void DefectColumns::set(const IntactModes& intact, const SecularKernel& kernel,
                        std::span<const Damage> damages, std::span<const SpringSupport> supports) {
  for (const SpringSupport& s : supports) validate(intact.beam, s);
  merge(intact, damages);
  most_ = index(damage_columns_) + supports.size();
  factor_.assign(most_ * most_, 0.0);
  springs_.assign(supports.size() * supports.size(), 0.0);
  row_.resize(std::max(most_, intact.stride));
  inverse_gamma_.clear();
  held_ = 0;
  added_stiffness_ = stiffest_spring_ = 0.0;
  support_column_.assign(supports.size(), -1);
  for (const bool rigid_ones : {false, true})
    for (std::size_t i = 0; i < supports.size(); ++i) {
      const auto column = static_cast<int>(inverse_gamma_.size());
      if (add_support(intact, kernel, supports[i], rigid_ones)) support_column_[i] = column;
    }
  support_columns_ = static_cast<int>(inverse_gamma_.size());
  add_damages(intact, kernel);
  rigid_ = rigid_body_freedom(intact.beam, supports);
}

void DefectColumns::merge(const IntactModes& intact, std::span<const Damage> damages) {
  elements_.clear();
  for (const Damage& d : damages) {
    validate(intact.beam, d);
    const int e = intact.beam.element_at(d.location);
    auto same = std::find_if(elements_.begin(), elements_.end(),
                             [e](const Element& other) { return other.element == e; });
    if (same == elements_.end()) same = elements_.insert(same, {e, 1.0, 0.0});
    same->remaining *= 1.0 - d.reduction;
    same->lost += d.reduction - same->lost * d.reduction;
  }
  std::sort(elements_.begin(), elements_.end(),
            [](const Element& a, const Element& b) { return a.element < b.element; });
  least_remaining_ = 1.0;
  damage_columns_ = 0;
  for (const Element& e : elements_) {
    least_remaining_ = std::min(least_remaining_, e.remaining);
    if (e.lost > 0.0) damage_columns_ += 2;
  }
}

double* DefectColumns::add_column(const IntactModes& intact, double inverse_gamma) {
  const std::size_t m = inverse_gamma_.size();
  inverse_gamma_.push_back(inverse_gamma);
  if (columns_.size() < (m + 1) * intact.stride) columns_.resize((m + 1) * intact.stride);
  return columns_.data() + m * intact.stride;
}

/// Appends one row of L_s by modified Gram-Schmidt on the columns [c / √s_j; 1/√k], whose Gram
/// matrix is L_s L_sᵀ. Returns false without a new row if the motion is already restrained.
bool DefectColumns::add_support(const IntactModes& intact, const SecularKernel& kernel,
                                const SpringSupport& s, bool rigid_ones) {
  const std::size_t mine = inverse_gamma_.size(), n = intact.stride;
  double* c = add_column(intact, 0.0);
  const double uncancelled = intact.motion(s.location, s.rotation, c);
  const double own = intact.compliance(c, c);
  const bool rigid = s.stiffness * own > kRigidSpring;
  bool keep = rigid == rigid_ones && own > 1e-20 * uncancelled;
  if (keep) {
    if (!rigid) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum += c[j] * c[j];
      added_stiffness_ += s.stiffness * sum;
      stiffest_spring_ = std::max(stiffest_spring_, s.stiffness * own);
      inverse_gamma_.back() = -1.0 / s.stiffness;
    }
    const std::size_t width = support_column_.size();
    double* spring = springs_.data() + mine * width;
    if (!rigid) spring[mine] = 1.0 / std::sqrt(s.stiffness);
    double* row = factor_.data() + mine * most_;
    for (std::size_t b = 0; b < mine; ++b) {
      const double* other = columns_.data() + b * n;
      const double* other_spring = springs_.data() + b * width;
      double part = intact.compliance(c, other);
      for (std::size_t i = 0; i <= b; ++i) part += spring[i] * other_spring[i];
      row[b] = part;
      kernel.subtract(c, other, part, static_cast<int>(n));
      for (std::size_t i = 0; i <= b; ++i) spring[i] -= part * other_spring[i];
    }
    double left = intact.compliance(c, c);
    for (std::size_t i = 0; i <= mine; ++i) left += spring[i] * spring[i];
    keep = !rigid || left > kDependentRow * kDependentRow * own;
    row[mine] = std::sqrt(left);
    for (std::size_t j = 0; j < n; ++j) c[j] /= row[mine];
    for (std::size_t i = 0; i <= mine; ++i) spring[i] /= row[mine];
    if (!keep) {
      std::fill_n(row, mine + 1, 0.0);
      std::fill_n(spring, mine + 1, 0.0);
    }
  }
  if (!keep) {
    inverse_gamma_.pop_back();
    return false;
  }
  held_ += rigid;
  return true;
}

/// Updates R by rotations, so that RᵀR increases by row rowᵀ. Overwrites `row`.
void DefectColumns::rotate_in(double* row) {
  const std::size_t first = index(support_columns_), last = first + index(damage_columns_);
  for (std::size_t a = first; a < last; ++a) {
    const double x = row[a - first];
    if (x == 0.0) continue;
    double& diagonal = factor_[a * most_ + a];
    const double size = std::hypot(diagonal, x), c = diagonal / size, s = x / size;
    diagonal = size;
    for (std::size_t b = a + 1; b < last; ++b) {
      double& upper = factor_[b * most_ + a];  // R(a, b), stored as L(b, a)
      const double y = row[b - first];
      row[b - first] = c * y - s * upper;
      upper = c * upper + s * y;
    }
  }
}

void DefectColumns::add_damages(const IntactModes& intact, const SecularKernel& kernel) {
  const std::size_t first = index(support_columns_), n = intact.stride;
  const auto size = static_cast<int>(n);
  const auto rows_of = [&](auto&& visit) {  // visit(column, row of the intact strains, element)
    std::size_t a = first;
    for (const Element& e : elements_)
      for (std::size_t r = 2 * index(e.element); r < 2 * index(e.element) + 2 && e.lost > 0.0; ++r)
        visit(a++, r, e);
  };
  rows_of([&](std::size_t a, std::size_t r, const Element& e) {
    double* c = add_column(intact, 1.0 / e.lost);
    std::copy_n(intact.element_rows.data() + r * n, n, c);
    double* row = factor_.data() + a * most_;
    row[a] = std::sqrt(e.remaining / e.lost);
    for (std::size_t s = 0; s < first; ++s)
      row[s] = intact.compliance(c, columns_.data() + s * n);  // W
  });
  for (std::size_t s = 0; s < first; ++s) {
    for (int d = 0; d < damage_columns_; ++d)
      row_[index(d)] = factor_[(first + index(d)) * most_ + s];
    rotate_in(row_.data());
  }
  for (int k = 0; k < intact.self_stresses; ++k) {
    rows_of([&](std::size_t a, std::size_t r, const Element&) {
      row_[a - first] = intact.stress_rows[r * index(intact.self_stresses) + index(k)];
    });
    rotate_in(row_.data());
  }
  if (first > 0)
    for (std::size_t j = index(intact.rigid); j < index(intact.stiff); ++j) {
      const double share = std::sqrt(1.0 / intact.eigenvalues[j] - intact.compliances[j]);
      for (int d = 0; d < damage_columns_; ++d)
        row_[index(d)] = share * columns_[(first + index(d)) * n + j];
      rotate_in(row_.data());
    }
  // Computes L⁻¹ C by forward substitution.
  for (std::size_t a = first; a < inverse_gamma_.size(); ++a) {
    double* c = columns_.data() + a * n;
    const double* row = factor_.data() + a * most_;
    for (std::size_t b = 0; b < a; ++b)
      if (row[b] != 0.0) kernel.subtract(c, columns_.data() + b * n, row[b], size);
    Eigen::Map<Eigen::ArrayXd>(c, size) *= 1.0 / row[a];
  }
}

void DefectColumns::strains(std::span<double> eta) const {
  for (std::size_t a = inverse_gamma_.size(); a-- > 0;) {
    eta[a] /= factor_[a * most_ + a];
    for (std::size_t b = 0; b < a; ++b) eta[b] -= factor_[a * most_ + b] * eta[a];
  }
  for (std::size_t a = 0; a < inverse_gamma_.size(); ++a) eta[a] *= inverse_gamma_[a];
}

}  // namespace wheeltap::fem::detail
