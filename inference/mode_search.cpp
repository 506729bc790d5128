#include "inference/mode_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"
#include "inference/evidence/model_posterior.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBound = 8.3;        // |z|: the prior's support but for a share of 1e-16
constexpr double kDifference = 0.05;  // of a width, for derivatives
constexpr double kArrived = 0.01;     // ln: what a further step would gain
constexpr int kMostSteps = 100;
constexpr int kSlices = 8;  // of a batch, each with a likelihood of its own
constexpr long kFirstBatch = 8, kMostBatch = 256;
constexpr double kValley = 2.0;       // ln: between two modes
constexpr double kNegligible = 25.0;  // ln: below the weightiest mode
constexpr std::size_t kMostModes = 60;
constexpr long kFirstSamples = 50;     // of a growing record
constexpr int kDrawsAMode = 4;         // to go on from, as a record grows
constexpr std::size_t kFollowed = 30;  // modes, as a record grows

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// ln π over labelled vectors, its calls counted.
class Surface {
 public:
  Surface(const Problem& problem, int model) : posterior_(problem, model) {}
  double operator()(const Vector& z) {
    if (z.size() > 0 && !(z.cwiseAbs().maxCoeff() <= kBound)) return -kInfinity;
    ordered_.assign(z.begin(), z.end());
    posterior_.order(ordered_);
    return posterior_(ordered_).log_posterior();
  }
  bool gradient(const Vector& z, Vector& g) {
    if (!offers_gradient_) return false;
    offers_gradient_ = posterior_.gradient({z.data(), static_cast<std::size_t>(z.size())},
                                           {g.data(), static_cast<std::size_t>(g.size())});
    return offers_gradient_;
  }
  void draw_prior(base::Random& random, Vector& z) {
    ordered_.resize(static_cast<std::size_t>(z.size()));
    posterior_.draw_prior(random, ordered_);
    std::ranges::copy(ordered_, z.begin());
  }
  std::vector<double> ordered(const Vector& z) {
    std::vector<double> out(z.begin(), z.end());
    posterior_.order(out);
    return out;
  }
  [[nodiscard]] Eigen::Index dimension() const { return posterior_.dimension(); }
  [[nodiscard]] long evaluations() const { return posterior_.evaluations(); }

 private:
  ModelPosterior posterior_;
  std::vector<double> ordered_;
  bool offers_gradient_ = true;  // until it does not
};

struct Known {  // a mode, ready for use
  Vector z;
  double value = 0.0;
  Matrix covariance, precision;
};

struct End {
  Vector z;
  double value = -kInfinity;
  Matrix inverse_hessian;  // what BFGS knows of it
  int known = -1;          // index of the mode it arrived at
  bool possible = false;   // the start was
};

// Distance from a mode in its own standard deviations, squared.
double square_distance(const Known& mode, const Vector& z) {
  const Vector e = z - mode.z;
  return e.dot(mode.precision * e);
}

class Climber {
 public:
  explicit Climber(Surface& f) : f_(f), d_(f.dimension()) {}

  End climb(const Vector& start, const std::vector<Known>& known) {
    End end{.z = start, .value = f_(start), .inverse_hessian = {}, .known = -1};
    if (end.value == -kInfinity) return end;
    end.possible = true;
    if (!known.empty() && arrives(end, known)) return end;
    ascend(end);
    return end;
  }

 private:
  // Newton steps with the curvature of the nearest known mode, while they do what its quadratic
  // says.
  bool arrives(End& end, const std::vector<Known>& known) {
    int nearest = 0;
    double least = kInfinity;
    for (int k = 0; k < static_cast<int>(known.size()); ++k) {
      const double distance = (known[static_cast<std::size_t>(k)].z - end.z).squaredNorm();
      if (distance < least) least = distance, nearest = k;
    }
    const Known& mode = known[static_cast<std::size_t>(nearest)];
    Vector z = end.z, g(d_);
    double value = end.value;
    for (int iteration = 0; iteration < 3; ++iteration) {
      if (!f_.gradient(z, g)) {
        for (Eigen::Index i = 0; i < d_; ++i) {
          const double h = kDifference * std::sqrt(mode.covariance(i, i));
          Vector to = z;
          to[i] += h;
          g[i] = (f_(to) - value) / h;
        }
      }
      if (!g.allFinite()) return false;
      const Vector step = mode.covariance * g;
      const double expected = 0.5 * g.dot(step);
      const Vector to = z + step;
      const double there = f_(to);
      const double gain = there - value;
      if (!(gain > 0.3 * expected - 0.5 && gain < 3.0 * expected + 0.5)) return false;
      if (iteration == 0 && overlooked(z, value, g, to, there, mode, end)) return false;
      z = to;
      value = there;
      if (square_distance(mode, z) <= 1.0 && value > mode.value - 2.0) {
        end.z = z;
        end.value = value;
        end.known = nearest;
        return true;
      }
    }
    return false;
  }

  // Whether a long step has leapt over something: points on its way that lie above the cubic
  // through values and slopes of its two ends. The climb then starts from the highest of them.
  bool overlooked(const Vector& from, double f0, const Vector& gradient, const Vector& to,
                  double f1, const Known& mode, End& end) {
    const Vector step = to - from;
    const double s0 = gradient.dot(step), s1 = -(to - mode.z).dot(mode.precision * step);
    const double slack = 1.0 + 0.1 * std::fabs(f1 - f0);
    double most = 0.0;
    for (const double t : {0.25, 0.5, 0.75}) {
      const double t2 = t * t, t3 = t2 * t;
      const double cubic = (2.0 * t3 - 3.0 * t2 + 1.0) * f0 + (t3 - 2.0 * t2 + t) * s0 +
                           (3.0 * t2 - 2.0 * t3) * f1 + (t3 - t2) * s1;
      const Vector at = from + t * step;
      const double value = f_(at);
      if (value - cubic <= slack + most) continue;
      most = value - cubic - slack;
      end.z = at;
      end.value = value;
    }
    return most > 0.0;
  }

  struct Slopes {
    Vector gradient, curvature;  // minus the second derivatives
  };

  // Central differences over steps of a few per cent of the widths so far.
  Slopes slopes(const Vector& z, double value, const Vector& width) {
    Slopes s{Vector(d_), Vector(d_)};
    for (Eigen::Index i = 0; i < d_; ++i) {
      const double h = kDifference * width[i];
      Vector to = z;
      to[i] = z[i] + h;
      const double up = f_(to);
      to[i] = z[i] - h;
      const double down = f_(to);
      const bool above = up > -kInfinity, below = down > -kInfinity;
      if (above && below) {
        s.gradient[i] = (up - down) / (2.0 * h);
        s.curvature[i] = (2.0 * value - up - down) / (h * h);
      } else {  // beside a cliff: away from it, and no further than it is
        s.gradient[i] = above ? (up - value) / h : below ? (value - down) / h : 0.0;
        s.curvature[i] = 1.0 / (h * h);
      }
    }
    return s;
  }

  static void adapt(Vector& width, const Vector& curvature) {
    for (Eigen::Index i = 0; i < width.size(); ++i)
      width[i] = curvature[i] > 1.0 ? 1.0 / std::sqrt(curvature[i]) : 1.0;
  }

  void ascend(End& end) {
    Vector width = Vector::Ones(d_);
    Slopes at = slopes(end.z, end.value, width);
    adapt(width, at.curvature);
    Matrix b = width.array().square().matrix().asDiagonal();
    double reach =
        2.0 * std::sqrt(static_cast<double>(d_));  // as far as one prior draw is from another
    bool diagonal = true;                          // b is the diagonal of second differences
    for (int iteration = 0; iteration < kMostSteps; ++iteration) {
      Vector step = b * at.gradient;
      double slope = at.gradient.dot(step);
      if (!(slope > 0.0) || !std::isfinite(slope)) {
        if (diagonal) break;
        b = width.array().square().matrix().asDiagonal();
        diagonal = true;
        continue;
      }
      if (const double length = step.norm(); length > reach) {
        step *= reach / length;
        slope *= reach / length;
      }
      // Along the line, f(t) ≈ f + t slope - ½ t² slope.
      double t = 1.0, there = -kInfinity;
      Vector to;
      bool moved = false;
      for (int halving = 0; halving < 30; ++halving) {
        to = end.z + t * step;
        there = f_(to);
        const double gain = there - end.value, linear = t * slope;
        const double expected = linear - 0.5 * t * t * slope;
        if (gain > 0.1 * expected && gain <= 10.0 * linear) {
          moved = true;
          break;
        }
        // Where the parabola through value, slope and this point has its top.
        double next = 0.25 * t;
        if (std::isfinite(gain) && linear > gain)
          next = std::clamp(0.5 * t * linear / (linear - gain), 0.02 * t, 0.5 * t);
        t = next;
      }
      if (!moved) {
        if (diagonal) break;
        b = width.array().square().matrix().asDiagonal();
        diagonal = true;
        continue;
      }
      const double gain = there - end.value;
      const Vector s = to - end.z;
      end.z = to;
      end.value = there;
      const Slopes next = slopes(to, there, width);
      const Vector y = at.gradient - next.gradient;  // of minus the function
      at = next;
      adapt(width, at.curvature);
      const double sy = s.dot(y);
      if (sy > 1e-12 * s.norm() * y.norm()) {
        const Vector by = b * y;
        b += (1.0 + y.dot(by) / sy) / sy * s * s.transpose() -
             (by * s.transpose() + s * by.transpose()) / sy;
        diagonal = false;
      } else {
        b = width.array().square().matrix().asDiagonal();
        diagonal = true;
      }
      const double promise = 0.5 * at.gradient.dot(b * at.gradient);
      if (gain < kArrived && promise < kArrived) break;
    }
    end.inverse_hessian = b;
  }

  Surface& f_;
  Eigen::Index d_;
};

// The Hessian by differences over steps that lower ln π by about a twentieth of a nat.
Known measure(Surface& f, const End& end) {
  const Eigen::Index d = end.z.size();
  Known mode{.z = end.z, .value = end.value, .covariance = {}, .precision = {}};
  Vector h(d), up(d), down(d);
  for (Eigen::Index i = 0; i < d; ++i) {
    double step = 0.3;
    if (end.inverse_hessian.rows() == d && end.inverse_hessian(i, i) > 0.0)
      step = std::min(1.0, 0.3 * std::sqrt(end.inverse_hessian(i, i)));
    for (int iteration = 0; iteration < 30; ++iteration) {
      Vector to = mode.z;
      to[i] = mode.z[i] + step;
      up[i] = f(to);
      to[i] = mode.z[i] - step;
      down[i] = f(to);
      const double fall = mode.value - 0.5 * (up[i] + down[i]);
      if (fall > 0.2) {
        step *= std::clamp(std::sqrt(0.05 / fall), 0.05, 0.7);
      } else if (fall < 0.01 && step < 1.0) {
        step = std::min(1.0, step * (fall > 1e-4 ? std::sqrt(0.05 / fall) : 4.0));
      } else {
        break;
      }
      if (step < 1e-12) break;
    }
    h[i] = step;
  }
  Matrix hessian(d, d);  // of minus the function
  for (Eigen::Index i = 0; i < d; ++i) {
    hessian(i, i) = std::isfinite(up[i] + down[i])
                        ? (2.0 * mode.value - up[i] - down[i]) / (h[i] * h[i])
                        : 1.0 / (h[i] * h[i]);
    for (Eigen::Index j = 0; j < i; ++j) {
      Vector to = mode.z;
      to[i] += h[i];
      to[j] += h[j];
      const double both_up = f(to);
      to = mode.z;
      to[i] -= h[i];
      to[j] -= h[j];
      const double both_down = f(to);
      const double mixed =
          (both_up + both_down - up[i] - down[i] - up[j] - down[j] + 2.0 * mode.value) /
          (2.0 * h[i] * h[j]);
      hessian(i, j) = hessian(j, i) = std::isfinite(mixed) ? -mixed : 0.0;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(hessian);
  // No direction is much wider than the prior.
  const Vector curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(0.25);
  mode.precision = eigen.eigenvectors() * curvature.asDiagonal() * eigen.eigenvectors().transpose();
  mode.covariance = eigen.eigenvectors() * curvature.cwiseInverse().asDiagonal() *
                    eigen.eigenvectors().transpose();
  return mode;
}

double laplace_mass(const Known& mode) {
  const Eigen::LLT<Matrix> llt(mode.covariance);
  const Matrix factor = llt.matrixL();
  return mode.value + 0.5 * static_cast<double>(mode.z.size()) * std::log(2.0 * std::numbers::pi) +
         factor.diagonal().array().log().sum();
}

// No valley between the two.
bool joined(Surface& f, const Vector& a, double value_a, const Vector& b, double value_b) {
  for (const double t : {0.5, 0.25, 0.75})
    if (f(a + t * (b - a)) < std::min(value_a, value_b) - kValley) return false;
  return true;
}

class Search {
 public:
  Search(const Problem& problem, int model, const ModeSearchOptions& options)
      : model_(model), options_(options) {
    for (int s = 0; s < kSlices; ++s)
      surfaces_.push_back(std::make_unique<Surface>(problem, model));
  }

  [[nodiscard]] Eigen::Index dimension() const { return surfaces_.front()->dimension(); }

  // From the prior.
  void run() {
    const long most = options_.climbs > 0 ? options_.climbs : kMostClimbs;
    long begun = 0;
    for (long batch = kFirstBatch; begun < most; batch = std::min(2 * batch, kMostBatch)) {
      const long n = std::min(batch, most - begun);
      const long first = begun;
      merge(climb(n, [&](long i, Surface& surface, Vector& z) {
        base::Random random(options_.seed, static_cast<std::uint64_t>(model_),
                            static_cast<std::uint64_t>(first + i), base::Purpose::search);
        surface.draw_prior(random, z);
      }));
      begun += n;
      const double spent =
          static_cast<double>(evaluations()) / static_cast<double>(std::max(options_.budget, 1L));
      const double share = options_.climbs > 0
                               ? static_cast<double>(begun) / static_cast<double>(most)
                               : std::min(1.0, spent);
      if (options_.progress && !options_.progress(share)) break;
      if (options_.climbs == 0 && begun >= kFewestClimbs && spent >= 1.0) break;
    }
  }

  void run(const std::vector<std::vector<double>>& starts) {
    merge(climb(static_cast<long>(starts.size()), [&](long i, Surface&, Vector& z) {
      z = Eigen::Map<const Vector>(starts[static_cast<std::size_t>(i)].data(), z.size());
    }));
  }

  // From the modes of a shorter record.
  void follow(const std::vector<Mode>& modes, std::uint64_t level) {
    const auto each = static_cast<long>(kDrawsAMode) + 1;
    std::vector<Matrix> factors;
    for (const Mode& m : modes) factors.push_back(Eigen::LLT<Matrix>(m.covariance).matrixL());
    merge(climb(static_cast<long>(modes.size()) * each, [&](long i, Surface&, Vector& z) {
      const auto m = static_cast<std::size_t>(i / each);
      z = Eigen::Map<const Vector>(modes[m].z.data(), z.size());
      if (i % each == 0) return;
      base::Random random(options_.seed, static_cast<std::uint64_t>(model_) | level << 32U,
                          static_cast<std::uint64_t>(i), base::Purpose::search);
      Vector u(z.size());
      for (double& v : u) v = random.normal();
      z += factors[m] * u;
    }));
  }

  [[nodiscard]] long evaluations() const {
    long sum = 0;
    for (const auto& surface : surfaces_) sum += surface->evaluations();
    return sum;
  }

  ModeSearch result() {
    ModeSearch out{.modes = {}, .climbs = climbs_, .likelihood_evaluations = 0};
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const Known& mode = known_[k];
      out.modes.push_back({.z = surfaces_.front()->ordered(mode.z),
                           .log_posterior = mode.value,
                           .covariance = mode.covariance,
                           .log_mass = laplace_mass(mode),
                           .climbs = hits_[k]});
    }
    std::ranges::stable_sort(out.modes, std::ranges::greater{}, &Mode::log_mass);
    std::erase_if(out.modes, [&](const Mode& m) {
      return !(m.log_mass > out.modes.front().log_mass - kNegligible);
    });
    out.likelihood_evaluations = evaluations();
    return out;
  }

 private:
  // Each start on its own, with the modes known before.
  template <typename Start>
  std::vector<End> climb(long n, Start&& start) {
    std::vector<End> ends(static_cast<std::size_t>(n));
    base::parallel_for(kSlices, options_.threads, [&](int s) {
      Surface& surface = *surfaces_[static_cast<std::size_t>(s)];
      Climber climber(surface);
      Vector z(surface.dimension());
      for (long i = s; i < n; i += kSlices) {
        start(i, surface, z);
        ends[static_cast<std::size_t>(i)] = climber.climb(z, known_);
      }
    });
    return ends;
  }

  // In the order of the starts, whichever thread climbed from them.
  void merge(const std::vector<End>& ends) {
    Surface& f = *surfaces_.front();
    for (const End& end : ends) {
      if (!end.possible) continue;
      ++climbs_;
      if (end.known >= 0) {
        ++hits_[static_cast<std::size_t>(end.known)];
        continue;
      }
      const int same = find(f, end);
      if (same >= 0) {
        const auto k = static_cast<std::size_t>(same);
        ++hits_[k];
        if (end.value > known_[k].value + 0.5) known_[k] = measure(f, ordered(f, end));
        continue;
      }
      // A mode far below the best matters only if it is wide: not by more than the prior is.
      double best = -kInfinity;
      for (const Known& k : known_) best = std::max(best, k.value);
      const double slack = kNegligible + 12.0 * static_cast<double>(end.z.size());
      if (end.value < best - slack) continue;
      known_.push_back(measure(f, ordered(f, end)));
      hits_.push_back(1);
    }
    // The lowest go where there are too many: not before, since ends name them by their index.
    while (known_.size() > kMostModes) {
      const auto least = std::ranges::min_element(known_, {}, &Known::value) - known_.begin();
      known_.erase(known_.begin() + least);
      hits_.erase(hits_.begin() + least);
    }
  }

  static End ordered(Surface& f, End end) {
    const std::vector<double> z = f.ordered(end.z);
    const Vector to = Eigen::Map<const Vector>(z.data(), end.z.size());
    if (to != end.z) end.inverse_hessian.resize(0, 0);
    end.z = to;
    return end;
  }

  int find(Surface& f, const End& end) {
    const End e = ordered(f, end);
    std::vector<std::pair<double, int>> near;
    for (int k = 0; k < static_cast<int>(known_.size()); ++k)
      near.emplace_back(square_distance(known_[static_cast<std::size_t>(k)], e.z), k);
    std::ranges::sort(near);
    for (std::size_t n = 0; n < std::min<std::size_t>(near.size(), 4); ++n) {
      const Known& mode = known_[static_cast<std::size_t>(near[n].second)];
      if (near[n].first < 0.25 && std::fabs(mode.value - e.value) < 0.5) return near[n].second;
      if (joined(f, mode.z, mode.value, e.z, e.value)) return near[n].second;
    }
    return -1;
  }

  int model_;
  const ModeSearchOptions& options_;
  std::vector<std::unique_ptr<Surface>> surfaces_;
  std::vector<Known> known_;
  std::vector<long> hits_;
  long climbs_ = 0;
};

}  // namespace

ModeSearch search_modes(const Problem& problem, int model, const ModeSearchOptions& options) {
  if (problem.space[model].dimension == 0) return {};
  if (!problem.shortened || problem.samples <= kFirstSamples) {
    Search search(problem, model, options);
    search.run(options.starts);
    search.run();
    ModeSearch found = search.result();
    found.climbs -= std::min(found.climbs, static_cast<long>(options.starts.size()));
    return found;
  }
  std::shared_ptr<const Problem> part = problem.shortened(kFirstSamples);
  ModeSearch found;
  {
    Search first(*part, model, options);
    first.run();
    found = first.result();
  }
  const long climbs = found.climbs;
  long evaluations = found.likelihood_evaluations;
  std::uint64_t level = 1;
  for (long n = kFirstSamples; n < problem.samples && !found.modes.empty(); ++level) {
    n = std::min(2 * n, problem.samples);
    if (found.modes.size() > kFollowed) found.modes.resize(kFollowed);
    if (n < problem.samples) part = problem.shortened(n);
    Search next(n < problem.samples ? *part : problem, model, options);
    next.follow(found.modes, level);
    if (n == problem.samples) next.run(options.starts);
    found = next.result();
    evaluations += found.likelihood_evaluations;
    if (options.progress && !options.progress(1.0)) break;
  }
  // Few climbs from the prior may all begin at impossible places: what else was given must not be
  // lost with them.
  if (found.modes.empty() && !options.starts.empty()) {
    Search whole(problem, model, options);
    whole.run(options.starts);
    found = whole.result();
    evaluations += found.likelihood_evaluations;
  }
  found.climbs = climbs;
  found.likelihood_evaluations = evaluations;
  return found;
}

double search_resolution(long climbs) {
  return climbs < 1 ? 1.0 : -std::expm1(std::log(0.01) / static_cast<double>(climbs));
}

}  // namespace wheeltap::inference
