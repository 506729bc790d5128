#include "fem/full_spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "fem/assembly.hpp"
#include "fem/skyline_ldlt.hpp"
#include "fem/strain_energy.hpp"
#include "fem/wide_pencil.hpp"

namespace wheeltap::fem {
namespace {

/// Eigenvalues closer than this fraction are treated as one, their vectors made orthogonal.
constexpr double kTwins = 1e-13;

/// Modes in the free degrees of freedom, ascending.
template <class Real>
struct Spectrum {
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  Vector eigenvalues;
  std::vector<Vector> modes;
};

/// Sturm counts isolate the eigenvalues above zero, and Rayleigh quotient iteration finishes each.
template <class Real>
class Bisection {
 public:
  using Vector = typename Spectrum<Real>::Vector;

  explicit Bisection(const Beam& beam)
      : assembly_(assemble<Real>(beam, {})),
        ldlt_(assembly_.stiffness, assembly_.mass),
        energy_(beam, {}) {
    const auto rigid = rigid_modes(beam, {});
    for (const auto& mode : rigid.colwise()) {
      Vector q(ldlt_.size());
      for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] = static_cast<Real>(mode[assembly_.free_dofs[static_cast<std::size_t>(i)]]);
      rigid_.push_back(q);
    }
    spectrum_.eigenvalues = Vector::Zero(ldlt_.size());
    spectrum_.modes = rigid_;
    spectrum_.modes.resize(static_cast<std::size_t>(ldlt_.size()));
  }

  Spectrum<Real> run() {
    // Gershgorin is loose in mixed units; doubling from the scale of the mesh finds the top.
    Real top = assembly_.stiffness.diagonal().cwiseQuotient(assembly_.mass.diagonal()).maxCoeff();
    const int n = ldlt_.size();
    for (int doubling = 0; count_below(top, top) < n; ++doubling) {
      if (doubling > 60) throw std::runtime_error("full_spectrum: no upper bound found");
      top *= Real{2};
    }
    isolate(Real{0}, static_cast<int>(rigid_.size()), top, n);
    return std::move(spectrum_);
  }

 private:
  /// Factors at σ; moves σ by a small share of `room` where the factorisation is unstable.
  int count_below(Real& sigma, Real room) {
    int below = ldlt_.factor(sigma);
    for (int attempt = 1; !ldlt_.stable() && attempt < 8; ++attempt) {
      sigma += Real{0.01 * attempt} * room;
      below = ldlt_.factor(sigma);
    }
    return below;
  }

  /// Eigenvalues number `below_low` … `below_high` - 1 lie in (low, high).
  void isolate(Real low, int below_low, Real high, int below_high) {
    while (below_high - below_low > 1) {
      // Natural frequencies spread evenly on a logarithmic scale at the bottom.
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
    }
    if (below_high > below_low) single(low, high, below_low);
  }

  /// Rayleigh quotient iteration for the only eigenvalue in (low, high), bisecting until it stays.
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
        // An end of the interval may be the eigenvalue itself, as often in meshes of one or two
        // elements.
        const Real slack = Real{kTwins} * high;
        if (!(quotient >= low - slack && quotient <= high + slack)) break;
        shift = quotient;
        // Off the eigenvalue by a little where it makes a leading block singular too.
        Real stable = shift;
        count_below(stable, Real{1e-6} * shift);
        quotient = improve(q);
        // Cubic convergence: the vector is now right to the cube of a smaller change.
        if (abs(quotient - shift) <= Real{kTwins} * shift) {
          spectrum_.eigenvalues[index] = quotient;
          spectrum_.modes[static_cast<std::size_t>(index)] = q;
          return;
        }
      }
    }
    throw std::runtime_error("full_spectrum: mode " + std::to_string(index) + " did not converge");
  }

  /// Inverse iteration on a block for eigenvalues begin … end - 1 next to `shift`.
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
    for (std::size_t c = 0; c < q.size(); ++c) {
      const int index = begin + static_cast<int>(c);
      spectrum_.modes[static_cast<std::size_t>(index)] = q[c];
      spectrum_.eigenvalues[index] = energy_.twice(assembly_.free_to_all * q[c]);
    }
  }

  /// A start with a part of every mode, different for each index.
  static void start(Vector& q, int index) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::sin(static_cast<double>(1 + i) * (1.2 + 0.7 * (index % 97)));
  }

  /// One inverse iteration, normalised; returns the Rayleigh quotient.
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
  std::vector<Vector> rigid_;  // kept out of every other mode
  Spectrum<Real> spectrum_;
};

/// The modes of long double, finished in 106 bits; false unless Sturm counts in those confirm that
/// each is there once.
bool finish(const Spectrum<long double>& rough, WidePencil& pencil,
            Spectrum<DoubleDouble>& finished) {
  using Real = DoubleDouble;
  const auto n = static_cast<std::size_t>(pencil.size());
  const auto rigid = static_cast<std::size_t>(pencil.rigid_body_modes());
  finished.eigenvalues = Spectrum<Real>::Vector::Zero(pencil.size());
  finished.modes.clear();
  for (std::size_t i = 0; i < n; ++i) {
    Spectrum<Real>::Vector q(pencil.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) q[k] = Real::from(rough.modes[i][k]);
    if (i >= rigid) {
      const auto lambda = pencil.refine(q);
      if (!lambda) return false;
      finished.eigenvalues[static_cast<Eigen::Index>(i)] = *lambda;
    }
    finished.modes.push_back(q);
  }
  const auto value = [&](std::size_t i) { return finished.eigenvalues[static_cast<int>(i)]; };
  std::vector<Spectrum<Real>::Vector> momenta;  // of the modes that equal the one at hand
  for (std::size_t i = rigid; i < n; ++i) {
    if (i + 1 < n && value(i + 1) < value(i)) {  // twins may have changed places
      std::swap(finished.eigenvalues[static_cast<int>(i)],
                finished.eigenvalues[static_cast<int>(i + 1)]);
      std::swap(finished.modes[i], finished.modes[i + 1]);
    }
    if (i > rigid && value(i) < value(i - 1)) return false;
    const bool twin = i > rigid && value(i) - value(i - 1) <= Real(kTwins) * value(i);
    if (!twin) {
      momenta.clear();
      if (i > rigid) {
        const auto below = pencil.count_below((value(i - 1) + value(i)) / Real(2));
        if (below && *below != static_cast<int>(i)) return false;
      }
    }
    for (std::size_t k = 0; k < momenta.size(); ++k)
      finished.modes[i] -=
          momenta[k].dot(finished.modes[i]) * finished.modes[i - momenta.size() + k];
    Spectrum<Real>::Vector momentum = pencil.assembly().mass * finished.modes[i];
    const Real size = sqrt(momentum.dot(finished.modes[i]));
    if (!(size > Real(1e-6))) return false;  // the same mode twice
    finished.modes[i] /= size;
    momenta.push_back(momentum / size);
  }
  return true;
}

}  // namespace

FullSpectrum full_spectrum(const Beam& beam) {
  using Real = DoubleDouble;
  WidePencil pencil(beam, {});
  const Eigen::Index n = pencil.size();
  FullSpectrum result;
  result.rigid_body_modes = pencil.rigid_body_modes();
  result.eigenvalues.resize(n);
  result.shapes.resize(2 * beam.nodes(), n);
  result.strains.resize(2 * beam.elements, n);
  if (n == 0) return result;

  Spectrum<Real> spectrum;
  bool finished = false;
  try {
    finished = finish(Bisection<long double>(beam).run(), pencil, spectrum);
  } catch (const std::runtime_error&) {  // NOLINT(bugprone-empty-catch): the wider numbers follow
  }
  if (!finished) spectrum = Bisection<Real>(beam).run();

  const TimoshenkoElement<Real> element(beam);
  const auto bending = element.bending(), shear = element.shear();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto shape = pencil.all_dofs(spectrum.modes[static_cast<std::size_t>(i)]);
    result.eigenvalues[i] = static_cast<long double>(spectrum.eigenvalues[i]);
    for (Eigen::Index dof = 0; dof < shape.size(); ++dof)
      result.shapes(dof, i) = static_cast<long double>(shape[dof]);
    for (int e = 0; e < beam.elements; ++e) {
      const Eigen::Matrix<Real, 4, 1> u = shape.segment<4>(2 * e);
      const bool rigid = i < result.rigid_body_modes;  // rigid motions do not strain elements
      result.strains(2 * e, i) = rigid ? 0.0 : static_cast<double>(bending.dot(u));
      result.strains(2 * e + 1, i) = rigid ? 0.0 : static_cast<double>(shear.dot(u));
    }
  }
  return result;
}

}  // namespace wheeltap::fem
