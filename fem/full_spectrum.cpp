#include "fem/full_spectrum.hpp"

#include <Eigen/Dense>
#include <stdexcept>
#include <vector>

#include "fem/assembly.hpp"
#include "fem/skyline_ldlt.hpp"
#include "fem/strain_energy.hpp"

namespace wheeltap::fem {
namespace {

using Real = long double;
using Vector = FullSpectrum::Vector;
using Matrix = FullSpectrum::Matrix;

class Solver {
 public:
  explicit Solver(const Beam& beam)
      : assembly_(assemble<Real>(beam, {})),
        ldlt_(assembly_.stiffness, assembly_.mass),
        energy_(beam, {}) {
    const Eigen::Index n = ldlt_.size();
    spectrum_.rigid_body_modes = rigid_body_freedom(beam, {});
    spectrum_.eigenvalues = Vector::Zero(n);
    spectrum_.shapes.resize(2 * beam.nodes(), n);
  }

  FullSpectrum run() {
    // Gershgorin is loose in mixed units; doubling from the scale of the mesh finds the top.
    Real top = assembly_.stiffness.diagonal().cwiseQuotient(assembly_.mass.diagonal()).maxCoeff();
    const int n = ldlt_.size();
    while (count_below(top, top) < n) top *= 2;
    const int rigid = spectrum_.rigid_body_modes;
    if (rigid > 0) {
      rigid_ = cluster(0, rigid, -top * kTwins);
      spectrum_.eigenvalues.head(rigid).setZero();
    }
    isolate(0, rigid, top, n);
    return std::move(spectrum_);
  }

 private:
  /// Eigenvalues closer than this fraction are treated as one, their vectors made orthogonal.
  static constexpr Real kTwins = 1e-13L;

  /// Factors at σ; moves σ by a small share of `room` where the factorisation is unstable.
  int count_below(Real& sigma, Real room) {
    int below = ldlt_.factor(sigma);
    for (int attempt = 1; !ldlt_.stable() && attempt < 8; ++attempt) {
      sigma += 0.01L * static_cast<Real>(attempt) * room;
      below = ldlt_.factor(sigma);
    }
    return below;
  }

  /// Eigenvalues number `below_low` … `below_high` - 1 lie in (low, high).
  void isolate(Real low, int below_low, Real high, int below_high) {
    while (below_high - below_low > 1) {
      // Natural frequencies spread evenly on a logarithmic scale at the bottom.
      Real middle = low > 0 && high > 4 * low ? std::sqrt(low * high) : (low + high) / 2;
      if (high - low <= kTwins * high) {
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
    Vector q(ldlt_.size());
    for (int attempt = 0; attempt < 200; ++attempt) {
      Real shift = (low + high) / 2;
      const int below = count_below(shift, high - low);
      (below > index ? high : low) = shift;
      start(q, index);
      Real quotient = improve(q);
      for (int step = 0; step < 12 && quotient > low && quotient < high; ++step) {
        shift = quotient;
        // Off the eigenvalue by a little where it makes a leading block singular too.
        Real stable = shift;
        count_below(stable, 1e-6L * shift);
        quotient = improve(q);
        // Cubic convergence: the vector is now right to the cube of a smaller change.
        if (std::abs(quotient - shift) <= kTwins * shift) {
          spectrum_.eigenvalues[index] = quotient;
          spectrum_.shapes.col(index) = assembly_.free_to_all * q;
          return;
        }
      }
    }
    throw std::runtime_error("full_spectrum: mode " + std::to_string(index) + " did not converge");
  }

  /// Inverse iteration on a block for eigenvalues begin … end - 1 next to `shift`.
  std::vector<Vector> cluster(int begin, int end, Real shift) {
    ldlt_.factor(shift);
    std::vector<Vector> q(static_cast<std::size_t>(end - begin), Vector(ldlt_.size()));
    for (std::size_t c = 0; c < q.size(); ++c) start(q[c], begin + static_cast<int>(c));
    for (int pass = 0; pass < 4; ++pass)
      for (std::size_t c = 0; c < q.size(); ++c) {
        improve(q[c]);
        for (std::size_t other = 0; other < c; ++other)
          q[c] -= q[other].dot(assembly_.mass * q[c]) * q[other];
        q[c] /= std::sqrt(q[c].dot(assembly_.mass * q[c]));
      }
    for (std::size_t c = 0; c < q.size(); ++c) {
      const int index = begin + static_cast<int>(c);
      spectrum_.shapes.col(index) = assembly_.free_to_all * q[c];
      spectrum_.eigenvalues[index] = energy_.twice(spectrum_.shapes.col(index));
    }
    return q;
  }

  /// A start with a part of every mode, different for each index.
  static void start(Vector& q, int index) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::sin(static_cast<Real>(1 + i) * (1.2L + 0.7L * static_cast<Real>(index % 97)));
  }

  /// One inverse iteration, normalised; returns the Rayleigh quotient.
  Real improve(Vector& q) {
    Vector next = assembly_.mass * q;
    ldlt_.solve(next);
    for (const Vector& rigid : rigid_) next -= rigid.dot(assembly_.mass * next) * rigid;
    q = next / std::sqrt(next.dot(assembly_.mass * next));
    return energy_.twice(assembly_.free_to_all * q);
  }

  Assembly<Real> assembly_;
  SkylineLdlt<Real> ldlt_;
  StrainEnergy<Real> energy_;
  std::vector<Vector> rigid_;  // kept out of every other mode
  FullSpectrum spectrum_;
};

}  // namespace

FullSpectrum full_spectrum(const Beam& beam) {
  return Solver(beam).run();
}

}  // namespace wheeltap::fem
