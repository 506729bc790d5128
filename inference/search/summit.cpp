#include "inference/search/summit.hpp"

#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kStep = 3e-5;      // step of first differences, in standard deviations
constexpr double kSettled = 1e-10;  // step at convergence, in standard deviations
constexpr double kNear = 3.0;  // largest distance of a maximum of this mode, in standard deviations

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

class Summit {
 public:
  Summit(Surface& f, const KnownMode& mode)
      : f_(f), mode_(mode), d_(mode.z.size()), level_(mode.value + kAboveSummit) {}

  // Finds the maximum of ln π + ½ |z|² · of_prior. Near the maximum, `covariance` is the inverse of
  // minus the Hessian; a secant update (BFGS) corrects `covariance` in each step.
  std::optional<Vector> maximise(double of_prior, Matrix covariance) {
    Vector z = mode_.z, g(d_), before_g, step;
    for (int iteration = 0; iteration < kSummitSteps && !f_.stopped(); ++iteration) {
      if (!gradient(z, g)) return found_;
      g += of_prior * z;
      if (iteration > 0) correct(covariance, step, before_g - g);
      step = covariance * g;
      before_g = g;
      if (!step.allFinite()) return found_;
      z += step;
      const Vector e = z - mode_.z;
      if (e.dot(mode_.precision * e) > kNear * kNear) return found_;
      note(z, f_(z));
      if (found_ || step.dot(mode_.precision * step) < kSettled * kSettled) return found_;
    }
    return found_;
  }

 private:
  void note(const Vector& z, double value) {
    if (value > level_) found_ = z, level_ = value;
  }

  // Returns false if a point above the mode was found, or if no finite value exists at z.
  bool gradient(const Vector& z, Vector& g) {
    if (f_.gradient(z, g)) return g.allFinite();
    const Vector h = kStep * mode_.covariance.diagonal().cwiseSqrt();
    Matrix to = z.replicate(1, 2 * d_);
    to.leftCols(d_).diagonal() += h;
    to.rightCols(d_).diagonal() -= h;
    const Vector values = f_.values(to);
    for (Eigen::Index k = 0; k < 2 * d_; ++k) note(to.col(k), values[k]);
    g = ((values.head(d_) - values.tail(d_)).array() / (2.0 * h.array())).matrix();
    return !found_ && g.allFinite();
  }

  static void correct(Matrix& b, const Vector& s, const Vector& y) {
    const double sy = s.dot(y);
    if (!(sy > 1e-12 * s.norm() * y.norm())) return;
    const Vector by = b * y;
    b += (1.0 + y.dot(by) / sy) / sy * s * s.transpose() -
         (by * s.transpose() + s * by.transpose()) / sy;
  }

  Surface& f_;
  const KnownMode& mode_;
  Eigen::Index d_;
  double level_;
  std::optional<Vector> found_;
};

}  // namespace

std::optional<Vector> above_summit(Surface& f, const KnownMode& mode) {
  Summit summit(f, mode);
  if (auto found = summit.maximise(0.0, mode.covariance)) return found;
  // Without the prior, minus the Hessian is smaller by 1, the contribution of the prior.
  const Eigen::Index d = mode.z.size();
  const Matrix precision = mode.precision - Matrix::Identity(d, d);
  const Eigen::LLT<Matrix> llt(precision);
  constexpr double kFlat = 0.1;
  if (llt.info() != Eigen::Success || !(llt.matrixLLT().diagonal().minCoeff() > kFlat)) return {};
  return summit.maximise(1.0, llt.solve(Matrix::Identity(d, d)));
}

}  // namespace wheeltap::inference
