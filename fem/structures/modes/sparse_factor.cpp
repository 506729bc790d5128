#include "fem/structures/modes/sparse_factor.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <set>
#include <span>
#include <stdexcept>
#include <string>

#include "base/simd.hpp"

namespace wheeltap::fem {
namespace detail {

const SparseKernel* const* sparse_kernels() {
  static const std::vector<const SparseKernel*> kernels = [] {
    base::Compiled<SparseKernel> compiled{.baseline = &kBaselineSparse};
#ifdef WHEELTAP_X86_KERNELS
    compiled.avx2 = &kAvx2Sparse;
    compiled.avx512 = &kAvx512Sparse;
#endif
    std::vector<const SparseKernel*> found = base::runnable(compiled);
    std::reverse(found.begin(), found.end());
    found.push_back(nullptr);
    return found;
  }();
  return kernels.data();
}

}  // namespace detail

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
  group_columns();
}

/// Forms the groups, with the runs of their rows and targets.
void SparseFactor::group_columns() {
  const std::size_t n = size();
  const auto count = [&](std::size_t j) { return start_[j + 1] - start_[j]; };
  // In L, the rows of column j below its first row also occur in the column of this first row.
  // Column j + 1 has no other rows if it has one row less.
  const auto continues = [&](std::size_t j) {
    return j + 1 < n && count(j) > 0 && rows_[start_[j]] == j + 1 && count(j + 1) + 1 == count(j);
  };
  struct Place {
    std::size_t row_runs, targets;
  };
  std::vector<Place> places;
  const auto append = [&](std::size_t first, std::uint32_t at) {
    if (runs_.size() > first && runs_.back().first + runs_.back().length == at)
      ++runs_.back().length;
    else
      runs_.push_back({.first = at, .length = 1});
  };
  for (std::size_t j = 0; j < n;) {
    std::size_t columns = 1;
    while (columns < detail::kMostColumns && continues(j + columns - 1)) ++columns;
    const std::size_t last = j + columns - 1;
    const std::span<const std::uint32_t> below =
        std::span(rows_).subspan(start_[last], count(last));
    groups_.push_back({.first = static_cast<std::uint32_t>(j),
                       .columns = static_cast<std::uint32_t>(columns),
                       .below = static_cast<std::uint32_t>(below.size()),
                       .rows = below.data(),
                       .row_runs = nullptr,
                       .targets = nullptr});
    places.push_back({.row_runs = runs_.size(), .targets = 0});
    for (const std::uint32_t row : below) append(places.back().row_runs, row);
    places.back().targets = runs_.size();
    for (std::size_t b = 0; b < below.size(); ++b) {
      const std::size_t first = runs_.size();
      for (std::size_t a = b + 1; a < below.size(); ++a)
        append(first, static_cast<std::uint32_t>(index(below[a], below[b])));
    }
    for (std::size_t column = j; column <= last; ++column)
      products_ += count(column) * (count(column) + 1) / 2;
    j += columns;
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    groups_[i].row_runs = runs_.data() + places[i].row_runs;
    groups_[i].targets = runs_.data() + places[i].targets;
  }
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

detail::SparsePattern SparseFactor::pattern() const {
  return {
      .size = size(), .groups = groups_.size(), .group = groups_.data(), .start = start_.data()};
}

template <int W>
void SparseFactor::factorise(Values& values) const {
  const detail::SparseKernel& kernel = *detail::sparse_kernels()[0];
  (W == 1 ? kernel.factorise : kernel.factorise4)(pattern(), values.diagonal.data(),
                                                  values.lower.data());
}

template <int W>
void SparseFactor::solve(const Values& factor, double* x) const {
  const detail::SparseKernel& kernel = *detail::sparse_kernels()[0];
  (W == 1 ? kernel.solve : kernel.solve4)(pattern(), factor.diagonal.data(), factor.lower.data(),
                                          x);
}

template <int R>
void SparseFactor::solve_several(const Values& factor, double* x) const {
  detail::sparse_kernels()[0]->solve_several4(pattern(), factor.diagonal.data(),
                                              factor.lower.data(), x);
}

template void SparseFactor::factorise<1>(Values&) const;
template void SparseFactor::factorise<4>(Values&) const;
template void SparseFactor::solve<1>(const Values&, double*) const;
template void SparseFactor::solve<4>(const Values&, double*) const;
template void SparseFactor::solve_several<4>(const Values&, double*) const;

}  // namespace wheeltap::fem
