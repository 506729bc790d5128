#include "fem/structures/modes/sparse_factor.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {

SparseFactor::SparseFactor(const Eigen::SparseMatrix<double>& pattern) {
  if (pattern.rows() != pattern.cols())
    throw std::invalid_argument("a matrix of " + std::to_string(pattern.rows()) + " rows and " +
                                std::to_string(pattern.cols()) + " columns: must be square");
  const auto n = static_cast<std::size_t>(pattern.rows());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
  to_.resize(n);
  // The permutation contains the unknown at each position.
  for (std::size_t position = 0; position < n; ++position)
    to_[static_cast<std::size_t>(order.indices()[static_cast<Eigen::Index>(position)])] = position;

  std::vector<std::set<std::size_t>> below(n);
  for (int c = 0; c < pattern.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator it(pattern, c); it; ++it) {
      const std::size_t a = to_[static_cast<std::size_t>(it.row())];
      const std::size_t b = to_[static_cast<std::size_t>(it.col())];
      if (a != b) below[std::min(a, b)].insert(std::max(a, b));
    }
  // Fill-in: the rows of column j enter its parent, the column of its first row below the
  // diagonal.
  for (std::size_t j = 0; j < n; ++j) {
    start_.push_back(rows_.size());
    for (const std::size_t row : below[j]) rows_.push_back(static_cast<std::uint32_t>(row));
    columns_.resize(rows_.size(), static_cast<std::uint32_t>(j));
    if (below[j].size() > 1)
      below[*below[j].begin()].insert(std::next(below[j].begin()), below[j].end());
  }
  start_.push_back(rows_.size());
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t b = start_[j]; b < start_[j + 1]; ++b)
      for (std::size_t a = b + 1; a < start_[j + 1]; ++a)
        targets_.push_back(static_cast<std::uint32_t>(index(rows_[a], rows_[b])));
}

std::size_t SparseFactor::index(std::size_t a, std::size_t b) const {
  const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(start_.at(std::min(a, b)));
  const auto last = rows_.begin() + static_cast<std::ptrdiff_t>(start_.at(std::min(a, b) + 1));
  const auto at = std::lower_bound(first, last, std::max(a, b));
  if (at == last || *at != std::max(a, b))
    throw std::out_of_range("the factor has no entry at " + std::to_string(a) + ", " +
                            std::to_string(b));
  return static_cast<std::size_t>(at - rows_.begin());
}

template <int W>
void SparseFactor::factorise(Values& values) const {
  double* const diagonal = values.diagonal.data();
  double* const lower = values.lower.data();
  const std::uint32_t* target = targets_.data();
  for (std::size_t j = 0; j < size(); ++j)
    for (std::size_t b = start_[j]; b < start_[j + 1]; ++b) {
      double* const at = lower + b * W;
      double* const below = diagonal + std::size_t{rows_[b]} * W;
      double l[W];
      for (int w = 0; w < W; ++w) {
        l[w] = at[w] / diagonal[j * W + static_cast<std::size_t>(w)];
        below[w] -= l[w] * at[w];
        at[w] = l[w];
      }
      for (std::size_t a = b + 1; a < start_[j + 1]; ++a, ++target) {
        const double* const other = lower + a * W;
        double* const entry = lower + std::size_t{*target} * W;
        for (int w = 0; w < W; ++w) entry[w] -= other[w] * l[w];
      }
    }
}

template <int W>
void SparseFactor::solve(const Values& factor, double* x) const {
  const double* const lower = factor.lower.data();
  for (std::size_t j = 0; j < size(); ++j) {
    const double* const xj = x + j * W;
    for (std::size_t b = start_[j]; b < start_[j + 1]; ++b) {
      double* const to = x + std::size_t{rows_[b]} * W;
      for (int w = 0; w < W; ++w) to[w] -= lower[b * W + static_cast<std::size_t>(w)] * xj[w];
    }
  }
  for (std::size_t i = 0; i < size() * W; ++i) x[i] /= factor.diagonal[i];
  for (std::size_t j = size(); j-- > 0;) {
    // Two sums, so that an addition need not wait for the one before.
    double sum[W], other[W];
    for (int w = 0; w < W; ++w) {
      sum[w] = x[j * W + static_cast<std::size_t>(w)];
      other[w] = 0.0;
    }
    std::size_t b = start_[j];
    for (; b + 1 < start_[j + 1]; b += 2) {
      const double* const from = x + std::size_t{rows_[b]} * W;
      const double* const next = x + std::size_t{rows_[b + 1]} * W;
      for (int w = 0; w < W; ++w) {
        sum[w] -= lower[b * W + static_cast<std::size_t>(w)] * from[w];
        other[w] += lower[(b + 1) * W + static_cast<std::size_t>(w)] * next[w];
      }
    }
    if (b < start_[j + 1]) {
      const double* const from = x + std::size_t{rows_[b]} * W;
      for (int w = 0; w < W; ++w) sum[w] -= lower[b * W + static_cast<std::size_t>(w)] * from[w];
    }
    for (int w = 0; w < W; ++w) x[j * W + static_cast<std::size_t>(w)] = sum[w] - other[w];
  }
}

template <int R>
void SparseFactor::solve_several(const Values& factor, double* x) const {
  const double* const lower = factor.lower.data();
  for (std::size_t j = 0; j < size(); ++j) {
    const double* const xj = x + j * R;
    for (std::size_t b = start_[j]; b < start_[j + 1]; ++b) {
      double* const to = x + std::size_t{rows_[b]} * R;
      for (int r = 0; r < R; ++r) to[r] -= lower[b] * xj[r];
    }
  }
  for (std::size_t j = size(); j-- > 0;) {
    double sum[R];
    for (int r = 0; r < R; ++r)
      sum[r] = x[j * R + static_cast<std::size_t>(r)] / factor.diagonal[j];
    for (std::size_t b = start_[j]; b < start_[j + 1]; ++b) {
      const double* const from = x + std::size_t{rows_[b]} * R;
      for (int r = 0; r < R; ++r) sum[r] -= lower[b] * from[r];
    }
    for (int r = 0; r < R; ++r) x[j * R + static_cast<std::size_t>(r)] = sum[r];
  }
}

template void SparseFactor::factorise<1>(Values&) const;
template void SparseFactor::factorise<4>(Values&) const;
template void SparseFactor::solve<1>(const Values&, double*) const;
template void SparseFactor::solve<4>(const Values&, double*) const;
template void SparseFactor::solve_several<4>(const Values&, double*) const;

}  // namespace wheeltap::fem
