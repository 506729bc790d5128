#include "fem/beam/lowest_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {
namespace {

/// Eigenvalues with a smaller relative distance count as equal; their vectors are orthogonalised.
constexpr double kTwins = 1e-13;
/// Below this relative distance, long double may have mixed the vectors of two modes.
constexpr double kClose = 1e-4;

/// Isolates the positive eigenvalues by Sturm counts, and refines each eigenvalue by Rayleigh
/// quotient iteration.
template <class Real>
class Bisection {
 public:
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  Bisection(const Beam& beam, const Defects& defects, int count)
      : assembly_(assemble<Real>(beam, defects)),
        ldlt_(assembly_.stiffness, assembly_.mass),
        energy_(beam, defects),
        count_(count) {
    const auto rigid = rigid_modes(beam, defects);
    for (const auto& mode : rigid.colwise()) {
      Vector q(ldlt_.size());
      for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] = static_cast<Real>(mode[assembly_.free_dofs[static_cast<std::size_t>(i)]]);
      rigid_.push_back(q);
    }
    modes_ = rigid_;
    modes_.resize(static_cast<std::size_t>(ldlt_.size()));
  }

  std::vector<Vector> run() {
    // Gershgorin's bound is far too large in mixed units. Doubling a typical value of the mesh
    // gives an upper bound.
    Real top = assembly_.stiffness.diagonal().cwiseQuotient(assembly_.mass.diagonal()).maxCoeff();
    const int n = ldlt_.size();
    for (int doubling = 0; count_below(top, top) < n; ++doubling) {
      if (doubling > 60) throw std::runtime_error("lowest_modes: no upper bound found");
      top *= Real{2};
    }
    isolate(Real{0}, static_cast<int>(rigid_.size()), top, n);
    modes_.resize(static_cast<std::size_t>(count_));
    return std::move(modes_);
  }

 private:
  /// Factors at σ. If the factorisation is unstable, changes σ by a small share of `room`.
  int count_below(Real& sigma, Real room) {
    int below = ldlt_.factor(sigma);
    for (int attempt = 1; !ldlt_.stable() && attempt < 8; ++attempt) {
      sigma += Real{0.01 * attempt} * room;
      below = ldlt_.factor(sigma);
    }
    return below;
  }

  /// Isolates the eigenvalues `below_low` … `below_high` - 1, which lie in (low, high).
  void isolate(Real low, int below_low, Real high, int below_high) {
    if (below_low >= count_) return;
    while (below_high - below_low > 1) {
      // The lowest natural frequencies are roughly uniform on a logarithmic scale.
      using std::sqrt;
      Real middle =
          low > Real{0} && high > Real{4} * low ? sqrt(low * high) : (low + high) / Real{2};
      if (high - low <= Real{kTwins} * high) {
        cluster(below_low, below_high, middle);
        return;
      }
      const int below = std::clamp(count_below(middle, high - low), below_low, below_high);
      if (below > below_low) isolate(low, below_low, middle, below);
      low = middle;
      below_low = below;
      if (below_low >= count_) return;
    }
    if (below_high > below_low) single(low, high, below_low);
  }

  /// Rayleigh quotient iteration for the only eigenvalue in (low, high), with bisection until the
  /// iteration stays in this interval.
  void single(Real low, Real high, int index) {
    using std::abs;
    Vector q(ldlt_.size());
    for (int attempt = 0; attempt < 200; ++attempt) {
      Real shift = (low + high) / Real{2};
      const int below = count_below(shift, high - low);
      (below > index ? high : low) = shift;
      start(q, index);
      Real quotient = improve(q);
      for (int step = 0; step < 12; ++step) {
        // An end of the interval may be the eigenvalue itself, in particular for meshes of one or
        // two elements.
        const Real slack = Real{kTwins} * high;
        if (!(quotient >= low - slack && quotient <= high + slack)) break;
        shift = quotient;
        // If the quotient makes a leading block singular, too, factors slightly beside it.
        Real stable = shift;
        count_below(stable, Real{1e-6} * shift);
        quotient = improve(q);
        // Convergence is cubic: the error of the vector is now the cube of a smaller change.
        if (abs(quotient - shift) <= Real{kTwins} * shift) {
          modes_[static_cast<std::size_t>(index)] = q;
          return;
        }
      }
    }
    throw std::runtime_error("lowest_modes: mode " + std::to_string(index) + " did not converge");
  }

  /// Block inverse iteration for the eigenvalues begin … end - 1 next to `shift`.
  void cluster(int begin, int end, Real shift) {
    using std::sqrt;
    ldlt_.factor(shift);
    std::vector<Vector> q(static_cast<std::size_t>(end - begin), Vector(ldlt_.size()));
    for (std::size_t c = 0; c < q.size(); ++c) start(q[c], begin + static_cast<int>(c));
    for (int pass = 0; pass < 4; ++pass)
      for (std::size_t c = 0; c < q.size(); ++c) {
        improve(q[c]);
        for (std::size_t other = 0; other < c; ++other)
          q[c] -= q[other].dot(assembly_.mass * q[c]) * q[other];
        q[c] /= sqrt(q[c].dot(assembly_.mass * q[c]));
      }
    for (std::size_t c = 0; c < q.size(); ++c) modes_[static_cast<std::size_t>(begin) + c] = q[c];
  }

  /// Sets a start vector with components in every mode; the vector differs for each index.
  static void start(Vector& q, int index) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::sin(static_cast<double>(1 + i) * (1.2 + 0.7 * (index % 97)));
  }

  /// Makes one inverse iteration, normalises q and returns the Rayleigh quotient.
  Real improve(Vector& q) {
    using std::sqrt;
    Vector next = assembly_.mass * q;
    ldlt_.solve(next);
    for (const Vector& rigid : rigid_) next -= rigid.dot(assembly_.mass * next) * rigid;
    q = next / sqrt(next.dot(assembly_.mass * next));
    return energy_.twice(assembly_.free_to_all * q);
  }

  Assembly<Real> assembly_;
  SkylineLdlt<Real> ldlt_;
  StrainEnergy<Real> energy_;
  std::vector<Vector> rigid_;  // made orthogonal to every other mode
  int count_;                  // number of lowest modes
  std::vector<Vector> modes_;
};

WidePencil::Vector as_double_double(const Eigen::Matrix<long double, Eigen::Dynamic, 1>& x) {
  WidePencil::Vector wide(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) wide[i] = DoubleDouble::from(x[i]);
  return wide;
}

}  // namespace

std::optional<LowestModes> finish(WidePencil& pencil, std::vector<WidePencil::Vector> starts) {
  using Real = DoubleDouble;
  const std::size_t count = starts.size();
  const std::size_t rigid = std::min(count, pencil.rigid_modes().size());
  // The exact rigid motions replace the start vectors with the largest shares of rigid motion.
  std::sort(starts.begin(), starts.end(), [&](const auto& a, const auto& b) {
    return pencil.rigid_share(a) > pencil.rigid_share(b);
  });
  std::vector<Real> values(count, Real(-1.0));
  for (std::size_t i = rigid; i < count; ++i) {
    WidePencil::Vector q = starts[i];
    auto lambda = pencil.refine(q);
    // If mixtures of close modes converge to one mode, excludes the modes found so far.
    std::vector<WidePencil::Vector> close;
    if (lambda) {
      const WidePencil::Vector momentum = pencil.assembly().mass * q;
      bool met = false;
      for (std::size_t k = rigid; k < i; ++k)
        if (abs(values[k] - *lambda) <= Real(kClose) * *lambda) {
          close.push_back(starts[k]);
          met = met || abs(momentum.dot(starts[k])) > Real(1e-3);
        }
      if (met) {
        q = starts[i];
        lambda = pencil.refine(q, close);
      }
    }
    starts[i] = q;
    values[i] = lambda.value_or(Real(-1.0));
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(rigid), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  LowestModes result;
  for (std::size_t i = 0; i < rigid; ++i) {
    result.eigenvalues.emplace_back(0.0);
    result.modes.push_back(pencil.rigid_modes()[i]);
  }
  std::size_t twins = 0;  // earlier modes with an equal eigenvalue
  std::vector<WidePencil::Vector> momenta;
  for (std::size_t i = rigid; i < count; ++i) {
    const Real lambda = values[order[i]];
    if (!(lambda > Real(0.0))) return std::nullopt;
    WidePencil::Vector q = starts[order[i]];
    const bool twin = i > rigid && lambda - result.eigenvalues.back() <= Real(kTwins) * lambda;
    twins = twin ? twins + 1 : 0;
    if (!twin) momenta.clear();
    for (std::size_t k = 0; k < twins; ++k) q -= momenta[k].dot(q) * result.modes[i - twins + k];
    WidePencil::Vector momentum = pencil.assembly().mass * q;
    const Real size = sqrt(momentum.dot(q));
    if (!(size > Real(1e-6))) return std::nullopt;  // the same mode was found twice
    momenta.push_back(momentum / size);
    result.eigenvalues.push_back(lambda);
    result.modes.emplace_back(q / size);
  }
  result.proven = true;
  for (std::size_t i = rigid; i < count && result.proven; ++i)
    result.proven = pencil.holds(static_cast<int>(i), result.eigenvalues[i], kProven);
  return result;
}

LowestModes lowest_modes(const Beam& beam, const Defects& defects, int count, WidePencil& pencil) {
  try {
    std::vector<WidePencil::Vector> starts;
    for (const auto& q : Bisection<long double>(beam, defects, count).run())
      starts.push_back(as_double_double(q));
    const auto modes = finish(pencil, std::move(starts));
    if (modes && modes->proven) return *modes;
  } catch (const std::runtime_error&) {  // NOLINT(bugprone-empty-catch): the wider numbers follow
  }
  auto modes = finish(pencil, Bisection<DoubleDouble>(beam, defects, count).run());
  if (!modes) throw std::runtime_error("lowest_modes: two modes could not be separated");
  return *modes;
}

}  // namespace wheeltap::fem
