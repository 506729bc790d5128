#include "fem/beam/wide_pencil.hpp"

namespace wheeltap::fem {

using Real = DoubleDouble;
using Vector = WidePencil::Vector;

Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> rigid_modes(const Beam& beam,
                                                                const Defects& defects) {
  const int count = rigid_body_freedom(beam, defects.supports);
  const int dofs = 2 * beam.nodes();
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> modes(dofs, count);
  if (count == 0) return modes;
  const TimoshenkoElement<Real> element(beam);
  // Translation and rotation about the middle of the beam are orthogonal. A restrained deflection
  // leaves only the rotation about its location, and a restrained rotation only the translation.
  bool rotation_held = false;
  std::optional<double> held_at;
  const auto hold = [&](double at, bool rotation) {
    if (rotation)
      rotation_held = true;
    else
      held_at = at;
  };
  for (const Support& s : beam.supports) {
    if (s.deflection) hold(s.at, false);
    if (s.rotation) hold(s.at, true);
  }
  for (const SpringSupport& s : defects.supports) hold(s.location, s.rotation);
  const auto fill = [&](Eigen::Index column, bool turn, Real about) {
    for (int node = 0; node < beam.nodes(); ++node) {
      modes(2 * node, column) = turn ? element.length() * Real(node) - about : Real(1);
      modes(2 * node + 1, column) = turn ? Real(1) : Real(0);
    }
  };
  if (count == 2) {
    fill(0, false, 0.0);
    fill(1, true, element.length() * Real(beam.elements) / Real(2));
  } else if (rotation_held) {
    fill(0, false, 0.0);
  } else {
    fill(0, true, *held_at);
  }
  const auto mass = element.mass();
  for (auto mode : modes.colwise()) {
    Real sum = 0;
    for (int e = 0; e < beam.elements; ++e) {
      const Eigen::Matrix<Real, 4, 1> u = mode.segment<4>(2 * e);
      sum += u.dot(mass * u);
    }
    mode /= sqrt(sum);
  }
  return modes;
}

WidePencil::WidePencil(const Beam& beam, const Defects& defects)
    : assembly_(assemble<Real>(beam, defects)),
      ldlt_(assembly_.stiffness, assembly_.mass),
      energy_(beam, defects) {
  const auto modes = fem::rigid_modes(beam, defects);
  for (const auto& mode : modes.colwise()) {
    rigid_.push_back(mode(assembly_.free_dofs));
    rigid_momentum_.push_back(assembly_.mass * rigid_.back());
  }
}

std::optional<int> WidePencil::count_below(Real sigma) {
  const int below = ldlt_.factor(sigma);
  if (!ldlt_.stable()) return std::nullopt;
  return below;
}

bool WidePencil::holds(int index, Real lambda, double error) {
  const auto count = [&](double side) {
    auto below = count_below(lambda * (Real(1) + Real(side * error)));
    // If σ is an eigenvalue of a leading block, retries slightly closer to λ.
    for (const double part : {0.7, 0.5, 0.3})
      if (!below) below = count_below(lambda * (Real(1) + Real(side * part * error)));
    return below;
  };
  const auto low = count(-1.0);
  if (!low || *low > index) return false;
  const auto high = count(1.0);
  return high && *high > index;
}

double WidePencil::rigid_share(const Vector& q) const {
  if (rigid_.empty()) return 0.0;
  Real sum = 0;
  for (const Vector& momentum : rigid_momentum_) sum += momentum.dot(q) * momentum.dot(q);
  return static_cast<double>(sum / q.dot(assembly_.mass * q));
}

/// Orthogonalises q to rigid motions and `others`, normalises q, returns the Rayleigh quotient.
Real WidePencil::normalise(Vector& q, const std::vector<Vector>& others) const {
  for (std::size_t i = 0; i < rigid_.size(); ++i) q -= rigid_momentum_[i].dot(q) * rigid_[i];
  for (const Vector& other : others) q -= other.dot(assembly_.mass * q) * other;
  q /= sqrt(q.dot(assembly_.mass * q));
  return energy_.twice(all_dofs(q));
}

std::optional<Real> WidePencil::refine(Vector& q, const std::vector<Vector>& others) {
  // A vector error δ towards a mode at the relative distance g changes the quotient by g δ². The
  // step that shows this change leaves δ³, 3e-14 for g = 1e-13; closer modes count as equal.
  constexpr double kDone = 1e-22;
  constexpr double kSmallestChange = 1e-14;  // limit of accuracy for very soft springs
  Real quotient = normalise(q, others);
  for (int step = 0; step < 12; ++step) {
    ldlt_.factor(quotient);
    // If the quotient makes a leading block singular, too, shifts it slightly.
    for (int attempt = 1; !ldlt_.stable() && attempt < 4; ++attempt)
      ldlt_.factor(quotient * (Real(1) + Real(1e-9 * attempt)));
    Vector next = assembly_.mass * q;
    ldlt_.solve(next);
    const Real last = quotient;
    quotient = normalise(next, others);
    if (!isfinite(quotient)) return std::nullopt;
    q = next;
    const Real change = abs(quotient - last);
    if (change <= Real(kDone) * quotient) return quotient;
    if (step >= 3 && change <= Real(kSmallestChange) * quotient) return quotient;
  }
  return std::nullopt;
}

}  // namespace wheeltap::fem
