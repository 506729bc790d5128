#include "inference/search/climb.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kBound = 8.3;        // largest |z_i|
constexpr double kDifference = 0.05;  // step of differences, in widths of the mode
constexpr double kArrived = 0.01;     // expected gain in ln π of a further step at convergence
constexpr long kRefusals = 4;  // failures after which a likelihood counts as one without gradient
constexpr int kMostSteps = 100;
constexpr int kMostDampedSteps = 40;
constexpr double kLeastDamping = 1e-6;
constexpr double kStrongerDamping = 10.0;                    // factor between trials
constexpr std::array<double, 3> kOnTheWay{0.25, 0.5, 0.75};  // check points on a long step
constexpr double kSameHeight = 0.5;  // largest difference in ln π of two ends at the same mode
constexpr double kSameTop = 0.05;    // largest squared distance of such ends, in widths of the mode
constexpr double kCreeping = 1.0;    // gain in ln π below which no other method is tried

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

class Climber {
 public:
  Climber(Surface& f, bool fine) : f_(f), d_(f.dimension()), fine_(fine) {}

  ClimbEnd climb(const Vector& start, const std::vector<KnownMode>& known) {
    ClimbEnd end{.z = start, .value = f_(start), .inverse_hessian = {}, .known = -1};
    if (end.value == -kInfinity) return end;
    end.possible = true;
    overlooked_ = false;
    if (!known.empty() && arrives(end, known)) return end;
    if (!ascend_by_residuals(end, known)) ascend(end);
    end.possible = !f_.stopped();  // a stopped climb has not reached a mode
    return end;
  }

 private:
  // Makes Newton steps with the curvature of the nearest known mode, as long as the quadratic model
  // of this mode predicts the gains.
  bool arrives(ClimbEnd& end, const std::vector<KnownMode>& known) {
    int nearest = 0;
    double least = kInfinity;
    for (int k = 0; k < static_cast<int>(known.size()); ++k) {
      const double distance = (known[static_cast<std::size_t>(k)].z - end.z).squaredNorm();
      if (distance < least) least = distance, nearest = k;
    }
    const KnownMode& mode = known[static_cast<std::size_t>(nearest)];
    Vector z = end.z, g(d_);
    double value = end.value;
    for (int iteration = 0; iteration < 3; ++iteration) {
      if (!f_.gradient(z, g)) {
        const Vector h = kDifference * mode.covariance.diagonal().cwiseSqrt();
        Matrix to = z.replicate(1, d_);
        to.diagonal() += h;
        g = ((f_.values(to).array() - value) / h.array()).matrix();
      }
      if (!g.allFinite()) return false;
      const Vector step = mode.covariance * g;
      const double expected = 0.5 * g.dot(step);
      const Vector to = z + step;
      const double there = f_(to);
      const double gain = there - value;
      if (f_.stopped()) return false;
      if (!(gain > 0.3 * expected - 0.5 && gain < 3.0 * expected + 0.5)) return false;
      const auto looks = static_cast<long>(iteration == 0 ? kOnTheWay.size() : 0);
      overlooked_ = iteration == 0 && overlooked(z, value, g, to, there, mode, end);
      if (overlooked_) return false;
      end.way += step.norm();
      end.points += 1 + looks;
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

  // True if a long step passed over another mode: points on the step lie above the cubic through
  // the values and slopes of its ends. The climb then continues from the highest of these points.
  bool overlooked(const Vector& from, double f0, const Vector& gradient, const Vector& to,
                  double f1, const KnownMode& mode, ClimbEnd& end) {
    const Vector step = to - from;
    const double s0 = gradient.dot(step), s1 = -(to - mode.z).dot(mode.precision * step);
    const double slack = 1.0 + 0.1 * std::fabs(f1 - f0);
    double most = 0.0;
    Matrix looks(d_, 3);
    for (Eigen::Index k = 0; k < 3; ++k)
      looks.col(k) = from + kOnTheWay[static_cast<std::size_t>(k)] * step;
    const Vector values = f_.values(looks);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double t = kOnTheWay[static_cast<std::size_t>(k)], t2 = t * t, t3 = t2 * t;
      const double cubic = (2.0 * t3 - 3.0 * t2 + 1.0) * f0 + (t3 - 2.0 * t2 + t) * s0 +
                           (3.0 * t2 - 2.0 * t3) * f1 + (t3 - t2) * s1;
      if (values[k] - cubic <= slack + most) continue;
      most = values[k] - cubic - slack;
      end.z = looks.col(k);
      end.value = values[k];
    }
    return most > 0.0;
  }

  // Climbs by Levenberg & Marquardt's method with steps s,
  //
  //   (I + λ diag I) s = g,
  //
  // where I approximates -∇² ln π, and λ is the smallest damping whose gain agrees with the
  // quadratic model within the limits of ascend(). A step beyond the region in which the model is
  // valid may leave the basin. Returns false if the likelihood has no Gauss-Newton approximation or
  // the method does not converge; `end` is then the last point. Ends early within one standard
  // deviation of a known mode whose height the model predicts.
  bool ascend_by_residuals(ClimbEnd& end, const std::vector<KnownMode>& known) {
    Vector g(d_), width = Vector::Ones(d_);
    Matrix information(d_, d_);
    double damping = 0.0;
    for (int iteration = 0; iteration < kMostDampedSteps && !f_.stopped(); ++iteration) {
      for (int finer = 0; finer < 8; ++finer) {
        if (!f_.gauss_newton(end.z, kDifference * width, g, information)) return false;
        const Vector before = width;
        adapt(width, information.diagonal());
        // Near a mode, the differences for a draw of the prior give a wrong direction.
        if (iteration > 0 || !fine_ || (width.array() > 0.5 * before.array()).all()) break;
      }
      const Eigen::LLT<Matrix> llt(information);
      const double promise = 0.5 * g.dot(llt.solve(g));
      // A mode within a wide known mode, found by `arrives`, needs the whole climb.
      const Vector top = end.z + llt.solve(g);
      for (std::size_t k = 0; k < known.size() && !overlooked_ && llt.info() == Eigen::Success; ++k)
        if (std::abs(end.value + promise - known[k].value) < kSameHeight &&
            square_distance(known[k], end.z) <= 1.0 && square_distance(known[k], top) <= kSameTop) {
          end.known = static_cast<int>(k);
          return true;
        }
      const double gain = damped_step(end, g, information, damping);
      const bool still = gain == 0.0 || (gain < kArrived && damping <= kLeastDamping);
      const bool last = iteration + 1 == kMostDampedSteps;
      if (still && !(promise < 2.0 * kArrived)) return false;
      if (still || (last && gain < kCreeping)) {
        end.inverse_hessian = llt.solve(Matrix::Identity(d_, d_));
        return true;
      }
      damping = damping <= kLeastDamping ? 0.0 : damping / kStrongerDamping;
    }
    return false;
  }

  // Tries steps with increasing damping, from `damping` on. Moves `end` by the first step whose
  // gain agrees with the model. Returns this gain, or 0 if no step succeeds. The first step is
  // evaluated alone, the other steps together.
  double damped_step(ClimbEnd& end, const Vector& g, const Matrix& information, double& damping) {
    const double reach = 2.0 * std::sqrt(static_cast<double>(d_));
    const Vector diagonal = information.diagonal();
    double next = damping;
    for (int trials = 0; trials < 3; ++trials) {
      const Eigen::Index n = trials == 0 ? 1 : 8;
      Matrix to(d_, n);
      Vector linear(n), expected(n), dampings(n);
      for (Eigen::Index k = 0; k < n; ++k) {
        Matrix damped = information;
        damped.diagonal() += next * diagonal;
        Vector step = damped.llt().solve(g);
        if (const double length = step.norm(); length > reach) step *= reach / length;
        to.col(k) = (end.z + step).cwiseMax(-kBound).cwiseMin(kBound);
        step = to.col(k) - end.z;
        linear[k] = g.dot(step);
        expected[k] = linear[k] - 0.5 * step.dot(information * step);
        dampings[k] = next;
        next = next > 0.0 ? kStrongerDamping * next : kLeastDamping;
      }
      // The evaluation of a step ends as soon as it shows no gain.
      const Vector values = f_.values(to, end.value);
      for (Eigen::Index k = 0; k < n; ++k) {
        const double gain = values[k] - end.value;
        if (!(gain > 0.1 * expected[k] && gain > 0.0 && gain <= 10.0 * linear[k])) continue;
        end.way += (to.col(k) - end.z).norm();
        ++end.points;
        end.z = to.col(k);
        end.value = values[k];
        damping = dampings[k];
        return gain;
      }
    }
    return 0.0;
  }

  struct Slopes {
    Vector gradient, curvature;  // minus the second derivatives
  };

  // Exact derivatives, or central differences with steps of a few per cent of the current widths.
  Slopes slopes(const Vector& z, double value, const Vector& width) {
    Slopes s{Vector(d_), Vector(d_)};
    Matrix information(d_, d_);
    if (f_.has_exact_derivatives() &&
        f_.gauss_newton(z, kDifference * width, s.gradient, information)) {
      s.curvature = information.diagonal();
      return s;
    }
    Matrix to = z.replicate(1, 2 * d_);
    to.leftCols(d_).diagonal() += kDifference * width;
    to.rightCols(d_).diagonal() -= kDifference * width;
    const Vector values = f_.values(to);
    for (Eigen::Index i = 0; i < d_; ++i) {
      const double h = kDifference * width[i];
      const double up = values[i], down = values[d_ + i];
      const bool above = up > -kInfinity, below = down > -kInfinity;
      if (above && below) {
        s.gradient[i] = (up - down) / (2.0 * h);
        s.curvature[i] = (2.0 * value - up - down) / (h * h);
      } else {  // beside a discontinuity: one-sided, away from it
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

  void ascend(ClimbEnd& end) {
    Vector width = Vector::Ones(d_);
    Slopes at = slopes(end.z, end.value, width);
    adapt(width, at.curvature);
    for (int finer = 0; fine_ && finer < 8; ++finer) {
      const Vector before = width;
      at = slopes(end.z, end.value, width);
      adapt(width, at.curvature);
      if ((width.array() > 0.5 * before.array()).all()) break;
    }
    Matrix b = width.array().square().matrix().asDiagonal();
    double reach =
        2.0 * std::sqrt(static_cast<double>(d_));  // typical distance between two prior draws
    bool diagonal = true;                          // b is the diagonal of second differences
    for (int iteration = 0; iteration < kMostSteps && !f_.stopped(); ++iteration) {
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
      // Along the step, f(t) ≈ f + t slope - ½ t² slope.
      double t = 1.0, there = -kInfinity;
      Vector to;
      bool moved = false;
      for (int halving = 0; halving < 30 && !f_.stopped(); ++halving) {
        to = end.z + t * step;
        there = f_(to);
        const double gain = there - end.value, linear = t * slope;
        const double expected = linear - 0.5 * t * t * slope;
        if (gain > 0.1 * expected && gain <= 10.0 * linear) {
          moved = true;
          break;
        }
        // Maximum of the parabola through value, slope and this point.
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
      end.way += s.norm();
      ++end.points;
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
  bool fine_;
  bool overlooked_ = false;  // the first step towards a known mode passed over something
};

}  // namespace

double Surface::operator()(const Vector& z) {
  if (z.size() > 0 && !(z.cwiseAbs().maxCoeff() <= kBound)) return -kInfinity;
  ordered_.assign(z.begin(), z.end());
  posterior_.order(ordered_);
  return posterior_(ordered_).log_posterior();
}

Vector Surface::values(const Matrix& zs, double level) {
  Vector out = Vector::Constant(zs.cols(), -kInfinity);
  batch_.clear();
  places_.clear();
  for (Eigen::Index k = 0; k < zs.cols(); ++k) {
    if (!(zs.col(k).cwiseAbs().maxCoeff() <= kBound)) continue;
    ordered_.assign(zs.col(k).begin(), zs.col(k).end());
    posterior_.order(ordered_);
    batch_.insert(batch_.end(), ordered_.begin(), ordered_.end());
    places_.push_back(k);
  }
  if (places_.empty()) return out;
  values_.resize(places_.size());
  posterior_.evaluate(batch_, values_, level);
  for (std::size_t i = 0; i < places_.size(); ++i) out[places_[i]] = values_[i].log_posterior();
  return out;
}

bool Surface::gradient(const Vector& z, Vector& g) {
  // Some likelihoods have no gradient at a few points, but at all others.
  if (gradients_ == 0 && refusals_ >= kRefusals) return false;
  const auto n = static_cast<std::size_t>(z.size());
  const bool found = posterior_.gradient({z.data(), n}, {g.data(), n});
  ++(found ? gradients_ : refusals_);
  return found;
}

bool Surface::gauss_newton(const Vector& z, const Vector& dz, Vector& g, Matrix& information) {
  const auto n = static_cast<std::size_t>(z.size());
  const bool found = posterior_.gauss_newton({z.data(), n}, {dz.data(), n}, {g.data(), n},
                                             {information.data(), n * n});
  if (found && has_exact_derivatives()) saved_ += 2 * z.size() - 2;
  return found;
}

void Surface::draw_prior(base::Random& random, Vector& z) {
  ordered_.resize(static_cast<std::size_t>(z.size()));
  posterior_.draw_prior(random, ordered_);
  std::ranges::copy(ordered_, z.begin());
}

std::vector<double> Surface::ordered(const Vector& z) {
  std::vector<double> out(z.begin(), z.end());
  posterior_.order(out);
  return out;
}

double square_distance(const KnownMode& mode, const Vector& z) {
  const Vector e = z - mode.z;
  return e.dot(mode.precision * e);
}

ClimbEnd climb(Surface& f, const Vector& start, const std::vector<KnownMode>& known, bool fine) {
  return Climber(f, fine).climb(start, known);
}

namespace {

// Sets the covariance of a mode from its Hessian; no direction is much wider than the prior.
void take_hessian(const Matrix& hessian, KnownMode& mode) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(hessian);
  const Vector curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(0.25);
  mode.precision = eigen.eigenvectors() * curvature.asDiagonal() * eigen.eigenvectors().transpose();
  mode.covariance = eigen.eigenvectors() * curvature.cwiseInverse().asDiagonal() *
                    eigen.eigenvectors().transpose();
}

// Computes the Hessian by differences of exact gradients; false if a point has no gradient.
bool measure_by_gradients(Surface& f, const ClimbEnd& end, KnownMode& mode) {
  const Eigen::Index d = end.z.size();
  if (!f.has_exact_derivatives() || end.inverse_hessian.rows() != d) return false;
  Matrix hessian(d, d);
  Vector z = end.z, up(d), down(d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const double variance = end.inverse_hessian(i, i);
    const double h = 0.3 * (variance > 0.0 ? std::min(1.0, std::sqrt(variance)) : 1.0);
    if (!(std::abs(end.z[i]) + h <= kBound)) return false;
    z[i] = end.z[i] + h;
    if (!f.gradient(z, up)) return false;
    z[i] = end.z[i] - h;
    if (!f.gradient(z, down)) return false;
    z[i] = end.z[i];
    hessian.col(i) = (down - up) / (2.0 * h);
  }
  take_hessian(0.5 * (hessian + hessian.transpose()), mode);
  return true;
}

}  // namespace

KnownMode measure(Surface& f, const ClimbEnd& end) {
  const Eigen::Index d = end.z.size();
  KnownMode mode{.z = end.z, .value = end.value, .covariance = {}, .precision = {}};
  Vector h = Vector::Constant(d, 0.3), up(d), down(d);
  std::vector<Eigen::Index> open(static_cast<std::size_t>(d));  // steps that have not converged
  for (Eigen::Index i = 0; i < d; ++i) {
    open[static_cast<std::size_t>(i)] = i;
    if (end.inverse_hessian.rows() == d && end.inverse_hessian(i, i) > 0.0)
      h[i] = std::min(1.0, 0.3 * std::sqrt(end.inverse_hessian(i, i)));
  }
  if (f.stopped()) {  // keeps the estimate of the climb
    const bool known = end.inverse_hessian.rows() == d;
    mode.covariance = known ? end.inverse_hessian : Matrix(Matrix::Identity(d, d));
    const Eigen::LLT<Matrix> llt(mode.covariance);
    if (llt.info() != Eigen::Success) mode.covariance = Matrix::Identity(d, d);
    mode.precision = Eigen::LLT<Matrix>(mode.covariance).solve(Matrix::Identity(d, d));
    return mode;
  }
  if (measure_by_gradients(f, end, mode)) return mode;
  for (int iteration = 0; iteration < 30 && !open.empty(); ++iteration) {
    const auto n = static_cast<Eigen::Index>(open.size());
    Matrix to = mode.z.replicate(1, 2 * n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index i = open[static_cast<std::size_t>(k)];
      to(i, k) += h[i];
      to(i, n + k) -= h[i];
    }
    const Vector values = f.values(to);
    std::vector<Eigen::Index> next;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index i = open[static_cast<std::size_t>(k)];
      up[i] = values[k];
      down[i] = values[n + k];
      const double fall = mode.value - 0.5 * (up[i] + down[i]);
      double step = h[i];
      if (fall > 0.2) {
        step *= std::clamp(std::sqrt(0.05 / fall), 0.05, 0.7);
      } else if (fall < 0.01 && step < 1.0) {
        step = std::min(1.0, step * (fall > 1e-4 ? std::sqrt(0.05 / fall) : 4.0));
      } else {
        continue;
      }
      h[i] = step;
      if (step >= 1e-12) next.push_back(i);
    }
    open = std::move(next);
  }
  const Eigen::Index pairs = d * (d - 1) / 2;
  Vector mixed(2 * pairs);
  if (pairs > 0) {
    Matrix to = mode.z.replicate(1, 2 * pairs);
    for (Eigen::Index i = 0, k = 0; i < d; ++i) {
      for (Eigen::Index j = 0; j < i; ++j, ++k) {
        for (const Eigen::Index of : {i, j}) {
          to(of, k) += h[of];
          to(of, pairs + k) -= h[of];
        }
      }
    }
    mixed = f.values(to);
  }
  Matrix hessian(d, d);  // of minus the function
  for (Eigen::Index i = 0, k = 0; i < d; ++i) {
    hessian(i, i) = std::isfinite(up[i] + down[i])
                        ? (2.0 * mode.value - up[i] - down[i]) / (h[i] * h[i])
                        : 1.0 / (h[i] * h[i]);
    for (Eigen::Index j = 0; j < i; ++j, ++k) {
      const double slope =
          (mixed[k] + mixed[pairs + k] - up[i] - down[i] - up[j] - down[j] + 2.0 * mode.value) /
          (2.0 * h[i] * h[j]);
      hessian(i, j) = hessian(j, i) = std::isfinite(slope) ? -slope : 0.0;
    }
  }
  take_hessian(hessian, mode);
  return mode;
}

}  // namespace wheeltap::inference
