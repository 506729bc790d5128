#include "identification/monitoring/candidate_bank.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/simd.hpp"

namespace wheeltap::identification::monitoring {

using detail::CandidateLayout;
using detail::kTile;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const detail::CandidateKernel& candidate_kernel() {
  static const detail::CandidateKernel* const widest = [] {
    base::Compiled<detail::CandidateKernel> compiled{.baseline = &detail::kBaselineCandidates};
#ifdef WHEELTAP_X86_KERNELS
    compiled.avx2 = &detail::kAvx2Candidates;
    compiled.avx512 = &detail::kAvx512Candidates;
#endif
    return base::runnable(compiled).back();
  }();
  return *widest;
}

}  // namespace

CandidateBank::CandidateBank(const std::vector<int>& blocks, const MatrixXd& prior_variance)
    : blocks_(blocks), prior_variance_(prior_variance), state_(blocks.size()) {}

detail::CandidateTiles CandidateBank::tiles(int draw) {
  return {.layout = layout(draw),
          .tiles = slots() / kTile,
          .state = state_[index(draw)].data(),
          .scratch = scratch_[index(draw)].data()};
}

void CandidateBank::clear(int slot) {
  for (std::size_t m = 0; m < state_.size(); ++m) {
    const CandidateLayout at = layout(static_cast<int>(m));
    double* const first = state_[m].data() + place(slot, at.rows(), 0);
    for (int row = 0; row < at.rows(); ++row) first[row * kTile] = 0.0;
    for (int size = 0; size < kSizes; ++size)
      for (int j = 0; j < at.features; ++j)
        first[(at.covariance() + size * at.half() + j * (j + 1) / 2 + j) * kTile] =
            prior_variance_(j, size);
    for (int i = 0; i < at.hypotheses(); ++i) first[(at.weight() + i) * kTile] = 1.0;
  }
}

int CandidateBank::add(const MatrixXd& weight, const VectorXd& draws) {
  auto free = std::ranges::find(used_, 0);
  if (free == used_.end()) {
    const int first = slots();
    used_.resize(used_.size() + kTile, 0);
    for (std::size_t m = 0; m < state_.size(); ++m)
      state_[m].resize(used_.size() * index(layout(static_cast<int>(m)).rows()));
    for (int slot = first; slot < slots(); ++slot) clear(slot);
    free = used_.begin() + first;
  }
  *free = 1;
  const int slot = static_cast<int>(free - used_.begin());
  for (std::size_t m = 0; m < state_.size(); ++m) {
    const CandidateLayout at = layout(static_cast<int>(m));
    for (Index h = 0; h < weight.rows(); ++h)
      for (Index size = 0; size < kSizes; ++size)
        state_[m][place(slot, at.rows(), at.weight() + static_cast<int>(h * kSizes + size))] =
            weight(h, size) * draws[static_cast<Index>(m)];
  }
  return slot;
}

void CandidateBank::release(int slot) {
  used_[index(slot)] = 0;
  clear(slot);
}

ShiftPosterior CandidateBank::posterior(int slot, int draw) const {
  const CandidateLayout at = layout(draw);
  const double* const first = state_[index(draw)].data() + place(slot, at.rows(), 0);
  const auto value = [&](int row) { return first[static_cast<std::ptrdiff_t>(row) * kTile]; };
  const Index p = at.features;
  ShiftPosterior out{.sensitivity = MatrixXd(at.states(), p),
                     .mean = MatrixXd(p, kSizes),
                     .covariance = MatrixXd(p, p * kSizes),
                     .single_mean = MatrixXd(p, kSizes),
                     .single_variance = MatrixXd(p, kSizes),
                     .log_weight = MatrixXd(1 + p, kSizes)};
  for (int r = 0; r < at.states(); ++r)
    for (int c = 0; c < at.features; ++c)
      out.sensitivity(r, c) = value(at.sensitivity() + r * at.features + c);
  for (int size = 0; size < kSizes; ++size) {
    int half = at.covariance() + size * at.half();
    for (int j = 0; j < at.features; ++j) {
      out.mean(j, size) = value(at.mean() + size * at.features + j);
      for (int k = 0; k <= j; ++k)
        out.covariance(j, size * p + k) = out.covariance(k, size * p + j) = value(half++);
      out.single_variance(j, size) =
          1.0 / (value(at.precision() + j) + 1.0 / prior_variance_(j, size));
      out.single_mean(j, size) = value(at.information() + j) * out.single_variance(j, size);
    }
    for (int h = 0; h <= at.features; ++h)
      out.log_weight(h, size) = std::log(value(at.weight() + h * kSizes + size));
  }
  return out;
}

void CandidateBank::begin(int draw, const RowStart& row) {
  draw_ = draw;
  entries_ = 0;
  degrees_ = row.degrees;
  h_ = row.h;
  gains_.clear();
  scratch_.resize(state_.size());
  const CandidateLayout at = layout(draw);
  std::vector<double>& scratch = scratch_[index(draw)];
  scratch.resize(used_.size() * index(at.scratch_rows()));
  for (int slot = 0; slot < slots(); ++slot) {
    scratch[place(slot, at.scratch_rows(), at.profile())] = row.profile[index(slot)];
    scratch[place(slot, at.scratch_rows(), at.log_mass())] = row.log_mass[index(slot)];
  }
  inverse_prior_.resize(index(kSizes * at.features));
  for (int size = 0; size < kSizes; ++size)
    for (int j = 0; j < at.features; ++j)
      inverse_prior_[index(size * at.features + j)] = 1.0 / prior_variance_(j, size);
  candidate_kernel().begin(
      tiles(draw),
      {.h = h_.data(), .fast = row.fast, .slow = row.slow, .is_present = row.present.data()});
}

double CandidateBank::score(int j, double v, double s) {
  feature_ = j;
  v_ = v;
  s_ = s;
  const CandidateLayout at = layout(draw_);
  along_.clear();
  for (int e = 0; e < entries_; ++e)
    along_.push_back(h_.dot(
        Eigen::Map<const VectorXd>(gains_.data() + e * at.states() + j * at.block, at.block)));
  return candidate_kernel().score(tiles(draw_), {.j = j,
                                                 .e = entries_,
                                                 .v = v,
                                                 .s = s,
                                                 .degrees = degrees_,
                                                 .along = along_.data(),
                                                 .prior = inverse_prior_.data()});
}

void CandidateBank::update(double inflated, const VectorXd& gain) {
  candidate_kernel().update(tiles(draw_),
                            {.j = feature_,
                             .e = entries_,
                             .v = v_,
                             .s = s_,
                             .degrees = degrees_,
                             .along = along_.data(),
                             .prior = inverse_prior_.data()},
                            inflated);
  gains_.insert(gains_.end(), gain.begin(), gain.end());
  ++entries_;
}

void CandidateBank::finish() {
  candidate_kernel().finish(tiles(draw_), entries_, degrees_, gains_.data());
}

std::vector<double> CandidateBank::weigh(const VectorXd& unshifted, double share) {
  const double most = unshifted.maxCoeff();
  const auto draws = static_cast<int>(state_.size());
  const auto at_slot = [&](int draw, int slot, int row) {
    return scratch_[index(draw)][place(slot, layout(draw).scratch_rows(), row)];
  };
  std::vector<double> reference(used_.size(), 2.0 * detail::kExcluded), totals(used_.size(), 0.0);
  for (int m = 0; m < draws; ++m)
    for (int slot = 0; slot < slots(); ++slot)
      reference[index(slot)] = std::max(
          reference[index(slot)], at_slot(m, slot, layout(m).log_most()) + unshifted[m] - most);
  std::vector<detail::CandidateTiles> all;
  for (int m = 0; m < draws; ++m) {
    all.push_back(tiles(m));
    candidate_kernel().weigh(all.back(), unshifted[m] - most, reference.data());
    for (int slot = 0; slot < slots(); ++slot)
      totals[index(slot)] += at_slot(m, slot, layout(m).total());
  }
  candidate_kernel().normalise(all.data(), draws, totals.data(), share);
  std::vector<double> out(used_.size());
  for (std::size_t slot = 0; slot < out.size(); ++slot)
    out[slot] = most + reference[slot] + std::log(totals[slot]);
  return out;
}

}  // namespace wheeltap::identification::monitoring
