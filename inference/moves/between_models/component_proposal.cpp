#include "inference/moves/between_models/component_proposal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {

namespace {

constexpr int kMaxCells = 1200;
constexpr std::size_t kMaxResiduals = 256;

// A location needs many cells, a severity few cells. The first parameter gets the finest grid.
std::vector<int> choose_cells(std::size_t parameters) {
  switch (parameters) {
    case 1:
      return {400};
    case 2:
      return {100, 12};
    case 3:
      return {40, 6, 5};
    default:
      break;
  }
  std::vector<int> cells(parameters, 2);
  cells[0] = std::max(2, kMaxCells >> (parameters - 1));
  return cells;
}

}  // namespace

int EffectAtlas::cell(std::span<const double> z) const {
  int index = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double u = normal_cdf(z[i]);
    index = index * cells[i] + std::min(static_cast<int>(u * cells[i]), cells[i] - 1);
  }
  return index;
}

std::shared_ptr<const EffectAtlas> make_atlas(Target& target, int kind) {
  const ModelSpace& space = target.space();
  const auto j = static_cast<std::size_t>(kind);
  const std::size_t width = space.kinds()[j].parameters.size();
  if (width == 0) return nullptr;
  // Reference state: the model with the fewest components, with its own parameters at their
  // medians.
  int none = -1;
  int fewest = 0;
  for (int m = 0; m < space.size(); ++m) {
    int count = 0;
    for (const int k : space[m].counts) count += k;
    if (space[m].counts[j] == 0 && space.neighbour(m, kind, +1) >= 0 &&
        (none < 0 || count < fewest)) {
      none = m;
      fewest = count;
    }
  }
  if (none < 0) return nullptr;
  State reference;
  reference.model = none;
  reference.z.assign(static_cast<std::size_t>(space[none].dimension), 0.0);
  target.screen(reference);
  if (reference.residuals.empty() || reference.residuals.size() > kMaxResiduals ||
      !std::isfinite(reference.log_screen)) {
    return nullptr;
  }

  auto atlas = std::make_shared<EffectAtlas>();
  atlas->cells = choose_cells(width);
  atlas->total = 1;
  for (const int n : atlas->cells) atlas->total *= n;
  atlas->noise_scale = reference.noise_scale;
  const auto n = static_cast<Eigen::Index>(reference.residuals.size());
  atlas->effects.setZero(atlas->total, n);
  State one;
  one.model = space.neighbour(none, kind, +1);
  const std::size_t at_first = space.component(one.model, kind, 0).first;
  std::vector<double> centre(width);
  for (int c = 0; c < atlas->total; ++c) {
    for (int i = static_cast<int>(width) - 1, rest = c; i >= 0; --i) {
      const auto axis = static_cast<std::size_t>(i);
      centre[axis] = normal_quantile((rest % atlas->cells[axis] + 0.5) / atlas->cells[axis]);
      rest /= atlas->cells[axis];
    }
    one.z = reference.z;
    one.z.insert(one.z.begin() + static_cast<std::ptrdiff_t>(at_first), centre.begin(),
                 centre.end());
    target.screen(one);
    // The effect is unknown; only the term with ε proposes this cell.
    if (!std::isfinite(one.log_screen)) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      atlas->effects(c, i) = static_cast<float>(one.residuals[at] - reference.residuals[at]);
    }
  }
  atlas->half_square = 0.5F * atlas->effects.rowwise().squaredNorm();
  return atlas;
}

InformedProposal::InformedProposal(std::shared_ptr<const EffectAtlas> atlas,
                                   const ModelSpace& space, int kind)
    : atlas_(std::move(atlas)),
      space_(&space),
      width_(space.kinds()[static_cast<std::size_t>(kind)].parameters.size()),
      residual_(atlas_->effects.cols()),
      weights_(atlas_->total) {}

void InformedProposal::condition(const State& context, int kind, int skip, double beta) {
  flat_ = context.residuals.size() != static_cast<std::size_t>(residual_.size()) ||
          !std::isfinite(context.log_screen) || beta <= 0.0;
  if (flat_) return;
  // Residuals are in units of the table's noise, but beta refers to the noise of the state.
  const double scale = context.noise_scale / atlas_->noise_scale;
  for (Eigen::Index i = 0; i < residual_.size(); ++i) {
    residual_[i] = static_cast<float>(context.residuals[static_cast<std::size_t>(i)] * scale);
  }
  if (skip >= 0) {
    const std::span<const double> left_out =
        space_->component(context.model, kind, skip).of(context.z);
    residual_ -= atlas_->effects.row(atlas_->cell(left_out)).transpose();
  }
  const auto power = static_cast<float>(beta / (scale * scale));
  // -½ |r + D|² = const - r·D - ½ |D|²
  weights_.matrix().noalias() = -(atlas_->effects * residual_);
  weights_ = power * (weights_ - atlas_->half_square.array());
  weights_ = (weights_ - weights_.maxCoeff()).exp();
  sum_ = weights_.sum();
}

void InformedProposal::draw(base::Random& random, std::span<double> z) {
  if (flat_ || random.uniform() < kDefensive) {
    for (double& value : z) value = random.normal();
    return;
  }
  const auto goal = static_cast<float>(random.uniform()) * sum_;
  float running = 0.0F;
  int c = 0;
  for (; c + 1 < atlas_->total; ++c) {
    running += weights_[c];
    if (running >= goal) break;
  }
  for (int i = static_cast<int>(width_) - 1; i >= 0; --i) {
    const auto axis = static_cast<std::size_t>(i);
    const int n = atlas_->cells[axis];
    z[axis] = normal_quantile((c % n + random.uniform()) / n);
    c /= n;
  }
}

double InformedProposal::log_density_ratio(std::span<const double> z) const {
  if (flat_) return 0.0;
  const double share = static_cast<double>(weights_[atlas_->cell(z)]) / static_cast<double>(sum_);
  return std::log(kDefensive + (1.0 - kDefensive) * atlas_->total * share);
}

}  // namespace wheeltap::inference
