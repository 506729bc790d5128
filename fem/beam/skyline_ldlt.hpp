// Factorisation L D Lᵀ of the banded matrices K - σ M, for inertia counts and inverse iteration.
#pragma once

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>
#include "base/eigen.hpp"

namespace wheeltap::fem {

/// The factorisation K - σ M = L D Lᵀ without pivoting. Each row is stored from its first entry
/// (Jennings' skyline). By Sylvester's law of inertia, the number of negative entries of D is the
/// number of eigenvalues of K φ = λ M φ below σ.
template <class Real>
class SkylineLdlt {
 public:
  using Sparse = Eigen::SparseMatrix<Real>;

  /// K and M must be symmetric n × n matrices; both triangles must be stored.
  SkylineLdlt(const Sparse& k, const Sparse& m)
      : first_(static_cast<std::size_t>(k.rows())), start_(first_.size() + 1, 0) {
    for (std::size_t i = 0; i < first_.size(); ++i) first_[i] = i;
    for (const Sparse* matrix : {&k, &m})
      for (Eigen::Index column = 0; column < matrix->outerSize(); ++column)
        for (typename Sparse::InnerIterator it(*matrix, column); it; ++it) {
          const auto i = static_cast<std::size_t>(it.row());
          first_[i] = std::min(first_[i], static_cast<std::size_t>(column));
        }
    for (std::size_t i = 0; i < first_.size(); ++i) start_[i + 1] = start_[i] + i - first_[i] + 1;
    k_.assign(start_.back(), Real{0});
    m_ = l_ = k_;
    for (auto [matrix, stored] : {std::pair{&k, &k_}, std::pair{&m, &m_}})
      for (Eigen::Index column = 0; column < matrix->outerSize(); ++column)
        for (typename Sparse::InnerIterator it(*matrix, column); it; ++it)
          if (it.row() >= column)
            (*stored)[place(static_cast<std::size_t>(it.row()), static_cast<std::size_t>(column))] =
                it.value();
  }

  [[nodiscard]] int size() const { return static_cast<int>(first_.size()); }

  /// Factors K - σ M; returns the number of eigenvalues below σ.
  int factor(Real sigma) {
    using std::abs;
    int negative = 0;
    growth_ = 0;
    for (std::size_t i = 0; i < l_.size(); ++i) l_[i] = k_[i] - sigma * m_[i];
    for (std::size_t i = 0; i < first_.size(); ++i) {
      Real* row = &l_[start_[i]] - first_[i];
      for (std::size_t j = first_[i]; j < i; ++j) {
        const Real* other = &l_[start_[j]] - first_[j];
        for (std::size_t c = std::max(first_[i], first_[j]); c < j; ++c)
          row[j] -= row[c] * other[c];
      }
      const std::size_t diagonal = start_[i + 1] - 1;
      Real removed = 0;
      for (std::size_t j = first_[i]; j < i; ++j) {
        const Real scaled = row[j];
        row[j] /= l_[start_[j + 1] - 1];
        row[i] -= scaled * row[j];
        removed = std::max(removed, abs(scaled * row[j]));
      }
      const Real size = abs(k_[diagonal]) + abs(sigma * m_[diagonal]);
      growth_ = std::max(growth_, removed / size);
      if (row[i] == Real{0}) row[i] = std::numeric_limits<Real>::epsilon() * size;
      negative += row[i] < Real{0};
    }
    return negative;
  }

  /// False if σ is nearly an eigenvalue of a leading principal submatrix. One pivot is then tiny,
  /// its rounding errors dominate the rows below it, and the eigenvalue count and the solutions are
  /// unreliable. The caller should retry with a slightly different σ.
  [[nodiscard]] bool stable() const { return growth_ < Real{kLargestGrowth}; }

  /// Replaces x by (K - σ M)⁻¹ x, for the σ of the last factorisation.
  template <class Vector>
  void solve(Vector& x) const {
    const std::size_t n = first_.size();
    const auto at = [&x](std::size_t i) -> Real& { return x[static_cast<Eigen::Index>(i)]; };
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = first_[i]; j < i; ++j) at(i) -= l_[place(i, j)] * at(j);
    for (std::size_t i = n; i-- > 0;) at(i) /= l_[start_[i + 1] - 1];
    for (std::size_t i = n; i-- > 0;)
      for (std::size_t j = first_[i]; j < i; ++j) at(j) -= l_[place(i, j)] * at(i);
  }

 private:
  /// A factorisation counts as stable if its entries grow by at most this factor. A factorisation
  /// in double or long double may lose four digits, and one in 106-bit arithmetic twelve digits.
  static constexpr double kLargestGrowth = std::numeric_limits<Real>::digits > 100 ? 1e12 : 1e4;

  [[nodiscard]] std::size_t place(std::size_t i, std::size_t j) const {
    return start_[i] + j - first_[i];
  }

  std::vector<std::size_t> first_;  // first stored column of each row
  std::vector<std::size_t> start_;  // start of each row
  Real growth_ = 0;                 // largest update of a diagonal entry, divided by the entry
  std::vector<Real> k_, m_, l_;     // the skylines of K, M, and of L with D on the diagonal
};

}  // namespace wheeltap::fem
