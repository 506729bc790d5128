#include "fem/root_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/eigen.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem::detail {
namespace {

/// Predicted relative error in λ at which a root is accepted.
constexpr double kRootError = 2e-13;
/// Rounding error of a Rayleigh quotient, relative to the λ of the evaluation.
constexpr double kRoundingOfRoot = 1e-15;
/// After this number of evaluations, every second evaluation bisects by the inertia count.
constexpr int kPatience = 20;
/// After this number of evaluations, even bisection has found only singular blocks. The result is
/// then the bracket.
constexpr int kGiveUp = 500;
/// If a pivot of A has a smaller relative size, rounding errors dominate the later pivots.
constexpr double kSmallestPivot = 1e-10;
/// Largest error of a shape's Rayleigh quotient, and largest residual, relative to λ.
constexpr double kShapeResidual = 1e-5;
/// Smallest contribution of the two modes to |a|² = 1 of a shape that is not a rounding error.
constexpr double kShapeShare = 1e-6;
/// Relative rounding error of the intact eigenvalues that bound the damaged eigenvalues.
constexpr double kBracketMargin = 1e-12;

}  // namespace

void RootSearch::set(const SecularProblem& problem, const SecularKernel& kernel) {
  problem_ = problem;
  kernel_ = &kernel;
  const Window& window = *problem.window;
  secular_ = {.columns = problem.columns,
              .supports = problem.supports,
              .near = window.near + problem.added_poles,
              .negative = problem.negative_poles,
              .residual_factor = problem.residual_factor,
              .terms = window.terms,
              .cap = window.cap,
              .eigenvalues = problem.eigenvalues,
              .scales = problem.scales,
              .stride = problem.stride,
              .c = problem.c};
  reserve();
  secular_.pairs = pairs_.data();
  kernel.fill_pairs(secular_, static_cast<int>(problem.stride), window.series.data(),
                    window.series_end.data(), product_.data(), pairs_.data());
}

/// Assigns memory to the arrays that `secular_` needs.
void RootSearch::reserve() {
  const std::size_t m = index(secular_.columns), rows = index(secular_.rows());
  const std::size_t pairs = index(secular_.chunks()) * kPairChunk;
  const std::size_t needed = 2 * rows + 2 * pairs + 4 * m;
  if (packs_.size() < needed) packs_.resize(needed);
  Pack* next = packs_.data();
  const auto take = [&next](std::size_t count) { return std::exchange(next, next + count); };
  scratch_.weights = take(rows);
  scratch_.slopes = take(rows);
  scratch_.matrix = take(pairs);
  scratch_.slope_matrix = take(pairs);
  scratch_.forward = take(2 * m);
  scratch_.forces = take(2 * m);
  if (pairs_.size() < pairs * rows) pairs_.resize(pairs * rows);
  product_.resize(problem_.stride);
  eta_.resize(m);
}

RootSearch::Search RootSearch::begin(int root) const {
  Search search;
  search.root = root;
  const double own = problem_.eigenvalues[root];
  const double scale = secular_.scales[root + problem_.added_poles];
  // Interlacing: each support or negative mass raises a root at most to the next intact eigenvalue.
  // Springs raise a root by at most the stiffness that they add to K.
  const int lifted = root + problem_.supports + problem_.negative_poles;
  const int held = root + problem_.held + problem_.negative_poles;
  double top = std::numeric_limits<double>::infinity();
  if (held < problem_.modes) top = problem_.eigenvalues[held] + problem_.added_stiffness;
  if (lifted < problem_.modes) top = std::min(top, problem_.eigenvalues[lifted]);
  search.low = std::max(problem_.least_remaining * own * (1.0 - kBracketMargin), 1e-20 * scale);
  search.high = (1.0 + kBracketMargin) * top;
  if (!problem_.starts.empty()) {
    search.z = std::clamp(problem_.starts[index(root)], search.low, search.high);
    return search;
  }
  // If the mode does not couple with others, 1 / κ = eᵀ J e: first order in added compliance.
  double softer = 1.0, stiffer = 0.0;
  for (int a = 0; a < secular_.columns; ++a) {
    const double c = secular_.c[index(a) * problem_.stride + index(root)];
    if (a < secular_.supports)
      stiffer += c * c;
    else
      softer += c * c / scale;
  }
  search.z = std::clamp((own + stiffer) / softer, search.low, search.high);
  if (std::isnan(search.z)) search.z = 0.5 * (search.low + search.high);
  return search;
}

RootSearch::Search RootSearch::confirm(int root) const {
  Search search = begin(root);
  search.confirming = true;
  search.lambda = found(root).lambda;
  search.z = search.lambda * (1.0 - kConfirmed);
  return search;
}

/// Returns the lower of the two modes nearest to z.
int RootSearch::lower_pole(double z, int guess) const {
  const double* value = secular_.eigenvalues;
  const int first = secular_.negative;  // poles of negative masses are at 0, far from all roots
  int p = std::clamp(guess, first, secular_.near - 2);
  while (p > first && z - value[p - 1] < value[p + 1] - z) --p;
  while (p + 2 < secular_.near && value[p + 2] - z < z - value[p]) ++p;
  return p;
}

void RootSearch::evaluate(const Pack& z, const int (&poles)[kLanes]) {
  kernel_->evaluate(secular_, z, poles, scratch_, steps_);
}

/// The number of damaged eigenvalues below both eigenvalues that H approximates. `below` is the
/// number of intact modes below z, without the two modes of H.
int RootSearch::first_followed(int below, int lane) const {
  return below + static_cast<int>(steps_.negative.lane[lane]) - secular_.supports -
         secular_.negative;
}

/// The number of damaged eigenvalues below the λ of the lane.
int RootSearch::count_below(int pole, int lane) const {
  return first_followed(pole, lane) + (steps_.low.lane[lane] < 0.0) +
         (steps_.high.lane[lane] < 0.0);
}

/// True if the inertia in this lane is reliable.
bool RootSearch::counts(int lane) const {
  return std::isfinite(steps_.low.lane[lane]) && std::isfinite(steps_.high.lane[lane]) &&
         !(steps_.smallest_pivot.lane[lane] < kSmallestPivot);
}

int RootSearch::left_out_below(double z, int pole) const {
  const double* value = secular_.eigenvalues;
  const auto below = std::lower_bound(value, value + secular_.near, z) - value;
  return static_cast<int>(below) - (value[pole] < z) - (value[pole + 1] < z);
}

/// True if the two modes of H contribute to the mode of the root. Otherwise A is singular at the
/// root and H gives no information, for example for rigid motions that the change does not affect.
bool RootSearch::tells_shape(int root, double lambda, int pole, int lane) const {
  const int first = first_followed(left_out_below(lambda, pole), lane);
  if (root != first && root != first + 1) return false;
  const bool low = root == first;
  const double step = (low ? steps_.low_step : steps_.high_step).lane[lane];
  const double squared = (low ? steps_.low_residual : steps_.high_residual).lane[lane];
  const double a1 = (low ? steps_.low_a1 : steps_.high_a1).lane[lane];
  const double a2 = (low ? steps_.low_a2 : steps_.high_a2).lane[lane];
  return std::abs(step) <= kShapeResidual * lambda &&
         squared <= kShapeResidual * lambda * kShapeResidual * lambda &&
         a1 * a1 + a2 * a2 >= kShapeShare;
}

/// The pair of modes with the largest share in the mode of the root. With η from S(λ) η = 0, the
/// component along intact mode j is a_j = c_jᵀ η / (λ_j - λ).
int RootSearch::pole_of_shape(double lambda) const {
  const Eigen::Index m = secular_.columns;
  const auto modes = static_cast<Eigen::Index>(problem_.stride);
  const Eigen::Map<const Eigen::MatrixXd> c(secular_.c, modes, m);
  Eigen::VectorXd gaps(modes), weights(modes);
  for (Eigen::Index j = 0; j < modes; ++j) {
    const double value = secular_.eigenvalues[j], scale = secular_.scales[j];
    gaps[j] = value == lambda ? kBracketMargin * lambda : value - lambda;
    weights[j] = (scale / gaps[j] - 1.0) / (j < secular_.negative ? -scale : scale);
  }
  Eigen::MatrixXd s = -c.transpose() * weights.asDiagonal() * c;
  for (Eigen::Index a = 0; a < m; ++a) s(a, a) += a < secular_.supports ? -1.0 : 1.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(s);
  Eigen::Index at = 0;
  solver.eigenvalues().cwiseAbs().minCoeff(&at);
  const Eigen::VectorXd has =
      (c * solver.eigenvectors().col(at)).cwiseQuotient(gaps).cwiseAbs().head(secular_.near);
  Eigen::Index most = secular_.negative;
  has.tail(secular_.near - secular_.negative).maxCoeff(&most);
  most += secular_.negative;
  const bool below =
      most + 1 >= secular_.near || (most > secular_.negative && has[most - 1] > has[most + 1]);
  return static_cast<int>(below ? most - 1 : most);
}

void RootSearch::narrow(Search& search, double z, int below) {
  if (search.root < below)
    search.high = std::min(search.high, z);
  else
    search.low = std::max(search.low, z);
}

/// Divides the bracket of `search` into equal parts, or into parts of equal logarithmic length if
/// the bracket is wide. The logarithmic division starts at 1/64 of the upper end, because most
/// brackets have no lower bound at first.
double RootSearch::cut(const Search& search, int part, int parts) {
  const double share = static_cast<double>(part) / parts;
  const double low = std::max(search.low, search.high / 64.0);
  return search.high > 4.0 * low ? low * std::pow(search.high / low, share)
                                 : low + share * (search.high - low);
}

/// Processes one evaluation; returns true if the root is found.
bool RootSearch::advance(Search& search, int pole, int lane) {
  const double low_sign = steps_.low.lane[lane], high_sign = steps_.high.lane[lane];
  const double* value = secular_.eigenvalues;
  ++search.evaluations;
  const auto bisect = [&search] {
    search.z = search.high > 4.0 * search.low ? std::sqrt(search.high * search.low)
                                              : 0.5 * (search.high + search.low);
    return false;
  };
  const bool finite = std::isfinite(low_sign) && std::isfinite(high_sign);
  if (!finite || (steps_.smallest_pivot.lane[lane] < kSmallestPivot && search.evaluations < 4)) {
    // If a leading block of A is singular at this λ, retries nearby.
    if (search.evaluations > kGiveUp) {
      found(search.root) = {.lambda = 0.5 * (search.low + search.high),
                            .radius = 0.5 * (search.high - search.low),
                            .at = search.low,
                            .below = search.root};
      return true;
    }
    const bool up = search.high - search.z > search.z - search.low;
    search.z += (search.confirming ? 1e-2 * kConfirmed * search.z
                                   : 1e-3 * ((up ? search.high : search.low) - search.z)) *
                (search.confirming && !up ? -1.0 : 1.0);
    return false;
  }
  const int first = first_followed(pole, lane), below = count_below(pole, lane);
  narrow(search, search.z, below);

  const bool is_low = search.root == first, followed = is_low || search.root == first + 1;
  const double step = (is_low ? steps_.low_step : steps_.high_step).lane[lane];
  const double squared = (is_low ? steps_.low_residual : steps_.high_residual).lane[lane];
  const double other = (is_low ? steps_.high_step : steps_.low_step).lane[lane];
  const double next = search.z + step;
  if (search.confirming) return advance_confirmation(search, followed, next);

  const double rounding = kRoundingOfRoot * std::max(search.z, next);
  const Found here{
      .lambda = next, .radius = std::sqrt(squared) + rounding, .at = search.z, .below = below};
  if (search.root == last_) {  // evaluated but not refined
    found(search.root) = here;
    if (!followed) found(search.root).radius = std::numeric_limits<double>::infinity();
    return true;
  }
  if (search.high - search.low <= 4e-16 * search.high) {
    found(search.root) = here;
    found(search.root).lambda = 0.5 * (search.high + search.low);
    found(search.root).radius += std::abs(found(search.root).lambda - next);
    return true;
  }
  if (followed && next >= search.low && next <= search.high) {
    // No other eigenvalue is much closer than the other eigenvalue of H and the modes next to the
    // poles.
    double gap = std::abs(other - step);
    if (pole > 0) gap = std::min(gap, std::abs(next - value[pole - 1]));
    if (pole + 2 < secular_.near) gap = std::min(gap, std::abs(value[pole + 2] - next));
    const double error = std::min(squared / gap + rounding, here.radius);
    if (error <= kRootError * next) {
      found(search.root) = here;
      return true;
    }
    if (search.evaluations < kPatience || search.evaluations % 2 == 0) {
      search.z = next;
      return false;
    }
  }
  return bisect();
}

/// Counts on both sides of `lambda`. If they disagree, tries the result of the last evaluation, and
/// finally bisects.
bool RootSearch::advance_confirmation(Search& search, bool followed, double next) const {
  const auto accept = [&](double lambda) {
    search.lambda = lambda;
    return true;
  };
  const double low = search.lambda * (1.0 - kConfirmed), high = search.lambda * (1.0 + kConfirmed);
  if (search.low >= low && search.high <= high) return accept(search.lambda);
  if (search.high - search.low <= 2.0 * kConfirmed * search.high)
    return accept(0.5 * (search.low + search.high));
  if (search.lambda >= search.low && search.lambda <= search.high) {  // no contradiction so far
    search.z = search.low < low ? low : high;
    return false;
  }
  if (search.evaluations < kPatience && followed && next > search.low && next < search.high) {
    search.lambda = next;
    const double aside = next * (1.0 - kConfirmed);
    search.z = aside > search.low ? aside : next * (1.0 + kConfirmed);
  } else {
    search.lambda = 0.5 * (search.low + search.high);
    search.z = search.lambda;
  }
  return false;
}

void RootSearch::run(bool confirming) {
  std::size_t next = 0;
  int active = 0;
  Search lanes[kLanes];
  const auto refill = [&](Search& lane) {
    lane = {};
    if (next >= queue_.size()) return;
    lane = confirming ? confirm(queue_[next]) : begin(queue_[next]);
    ++next;
    ++active;
  };
  for (Search& lane : lanes) refill(lane);
  int poles[kLanes] = {};
  Pack z;
  while (active > 0) {
    // Idle lanes evaluate points in the bracket of the root with the most evaluations.
    const auto longest = std::ranges::max_element(
        lanes, {}, [](const Search& s) { return s.root < 0 ? -1 : s.evaluations; });
    const bool helped = std::isfinite(longest->high);
    for (int l = 0, part = 0; l < kLanes; ++l) {
      const Search& lane = lanes[l].root < 0 ? *longest : lanes[l];
      z.lane[l] = lanes[l].root < 0 && helped ? cut(lane, ++part, kLanes - active + 1) : lane.z;
      poles[l] = lower_pole(z.lane[l], lane.root);
    }
    evaluate(z, poles);
    for (int l = 0; l < kLanes && helped; ++l)
      if (lanes[l].root < 0 && counts(l)) narrow(*longest, z.lane[l], count_below(poles[l], l));
    for (int l = 0; l < kLanes; ++l) {
      Search& lane = lanes[l];
      if (lane.root < 0 || !advance(lane, poles[l], l)) continue;
      if (confirming) found(lane.root).lambda = lane.lambda;
      --active;
      refill(lane);
    }
  }
}

/// Queues the roots whose error bound r² / gap is too large, out of `total` eigenvalues.
void RootSearch::queue_unproven(int first, int count, int total) {
  const auto low = [&](int i) { return i < first ? 0.0 : found(i).lambda - found(i).radius; };
  const auto high = [&](int i) { return i < first ? 0.0 : found(i).lambda + found(i).radius; };
  // If b disjoint intervals lie below a λ that has b eigenvalues below, each contains one of them.
  const int known = std::min(count + 1, total);
  int disjoint = first;
  while (disjoint < known && low(disjoint) > (disjoint == 0 ? 0.0 : high(disjoint - 1))) ++disjoint;
  int located = first;
  double above = 0.0;  // no eigenvalue lies between the last located root and this root
  const auto anchor = [&](double at, int below) {
    if (below < located || below > disjoint || (below > 0 && high(below - 1) > at)) return;
    above = below > located ? at : std::max(above, at);
    located = below;
  };
  for (int i = first; i < known; ++i) anchor(found(i).at, found(i).below);
  if (disjoint == total) anchor(std::numeric_limits<double>::infinity(), total);
  queue_.clear();
  for (int i = first; i < count; ++i) {
    const Found& f = found(i);
    bool proven = false;
    if (i < located) {
      double gap = i + 1 < located ? low(i + 1) - f.lambda : above - f.lambda;
      if (i > 0) gap = std::min(gap, f.lambda - high(i - 1));
      proven = std::min(f.radius * f.radius / gap, f.radius) <= kConfirmed * f.lambda;
    }
    if (!proven) queue_.push_back(i);
  }
}

void RootSearch::find(int first, std::span<double> lambda) {
  const int count = static_cast<int>(lambda.size());
  const int total = problem_.modes - problem_.held;
  found_.resize(index(count) + 1);
  last_ = count < total ? count : -1;
  queue_.clear();
  for (int root = first; root < std::min(count + 1, total); ++root) queue_.push_back(root);
  run(false);
  queue_unproven(first, count, total);
  if (!queue_.empty()) run(true);
  for (int root = first; root < count; ++root) lambda[index(root)] = found(root).lambda;
}

RootSearch::Mode RootSearch::mode_at(int root, double lambda, int pole, int lane) {
  const auto at = [lane](const Pack& pack) { return pack.lane[lane]; };
  const int first = first_followed(left_out_below(lambda, pole), lane);
  const bool is_low =
      root == first || (root != first + 1 && std::abs(at(steps_.low)) < std::abs(at(steps_.high)));
  const double v1 = at(is_low ? steps_.low_v1 : steps_.high_v1);
  const double v2 = at(is_low ? steps_.low_v2 : steps_.high_v2);
  const std::size_t m = index(secular_.columns);
  for (std::size_t a = 0; a < m; ++a)
    eta_[a] = at(scratch_.forces[a]) * v1 + at(scratch_.forces[m + a]) * v2;
  return {.root = root,
          .lambda = lambda,
          .pole = pole,
          .a1 = at(is_low ? steps_.low_a1 : steps_.high_a1),
          .a2 = at(is_low ? steps_.low_a2 : steps_.high_a2),
          .eta = eta_,
          .found = tells_shape(root, lambda, pole, lane)};
}

void RootSearch::coordinates(const Mode& mode, double* coordinates) const {
  kernel_->coordinates(secular_, static_cast<int>(problem_.stride), mode.eta.data(), mode.lambda,
                       mode.pole, coordinates);
  coordinates[mode.pole] = mode.a1;
  coordinates[mode.pole + 1] = mode.a2;
}

}  // namespace wheeltap::fem::detail
