#include "fem/beam/assembly.hpp"

#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {
namespace {

/// A motion that is restrained by a spring, or rigidly if the stiffness is infinite.
struct Hold {
  double at;
  bool rotation;
  double stiffness;
};

std::vector<Hold> holds(const Beam& beam, const Defects& defects) {
  std::vector<Hold> all;
  for (const Support& s : beam.supports) {
    const double stiffness = s.stiffness.value_or(std::numeric_limits<double>::infinity());
    if (s.deflection) all.push_back({s.at, false, stiffness});
    if (s.rotation) all.push_back({s.at, true, stiffness});
  }
  for (const SpringSupport& s : defects.supports)
    all.push_back({s.location, s.rotation, s.stiffness});
  return all;
}

void require_inside(const char* name, double x, double length) {
  if (x >= 0.0 && x <= length) return;
  std::ostringstream message;
  message.precision(12);
  message << name << " = " << x << " m: must lie on the beam, in [0, " << length << "] m";
  throw std::invalid_argument(message.str());
}

/// Rigid supports R u = 0 in reduced echelon form. Each row gives one dof in terms of the others.
template <class Real>
class Constraints {
 public:
  using Row = std::map<int, Real>;

  /// Adds a row, unless the row depends on the earlier rows.
  void add(const MotionRow<Real>& motion, Real element_length) {
    Row row;
    Real size = 0;
    for (int i = 0; i < 4; ++i) {
      const int dof = motion.first_dof + i;
      if (motion.coefficients[i] != Real{0}) row[dof] = motion.coefficients[i];
      size = std::max(size, weight(row, dof, element_length));
    }
    for (const auto& [pivot, solved] : solved_) subtract(row, solved, pivot);
    int pivot = -1;
    Real largest = kDependent * size;
    for (const auto& entry : row) {
      const Real w = weight(row, entry.first, element_length);
      if (w > largest) largest = w, pivot = entry.first;
    }
    if (pivot < 0) return;
    const Real scale = row[pivot];
    for (auto& entry : row) entry.second /= scale;
    for (auto& [other, solved] : solved_) subtract(solved, row, pivot);
    solved_[pivot] = std::move(row);
  }

  /// The row of each pivot dof: u_pivot = -Σ coefficient · u of the other entries.
  [[nodiscard]] const std::map<int, Row>& solved() const { return solved_; }

 private:
  static constexpr Real kDependent = static_cast<Real>(1e-10);

  /// A rotation θ moves an end of the element by θ l. Its coefficient is therefore divided by l.
  static Real weight(const Row& row, int dof, Real element_length) {
    const auto found = row.find(dof);
    if (found == row.end()) return 0;
    using std::abs;
    return abs(found->second) / (dof % 2 == 1 ? element_length : Real{1});
  }

  static void subtract(Row& row, const Row& solved, int pivot) {
    const auto found = row.find(pivot);
    if (found == row.end()) return;
    const Real factor = found->second;
    for (const auto& [dof, value] : solved) row[dof] -= factor * value;
    row.erase(pivot);
  }

  std::map<int, Row> solved_;
};

}  // namespace

void validate(const Beam& beam, const Damage& damage) {
  require_inside("damage.location", damage.location, beam.length);
  if (damage.reduction >= 0.0 && damage.reduction < 1.0) return;
  std::ostringstream message;
  message.precision(12);
  message << "damage.reduction = " << damage.reduction << ": must be in [0, 1)";
  throw std::invalid_argument(message.str());
}

void validate(const Beam& beam, const SpringSupport& support) {
  require_inside("support.location", support.location, beam.length);
  if (support.stiffness > 0.0) return;
  std::ostringstream message;
  message << "support.stiffness = " << support.stiffness << ": must be positive (infinite: rigid)";
  throw std::invalid_argument(message.str());
}

template <class Real>
MotionRow<Real> motion_row(const Beam& beam, const TimoshenkoElement<Real>& element, double x,
                           bool rotation) {
  const int e = beam.element_at(x);
  const Real xi = static_cast<Real>(x) / element.length() - static_cast<Real>(e);
  const double place = static_cast<double>(xi), snap = 1e-9 * beam.elements;
  MotionRow<Real> row{.first_dof = 2 * e, .coefficients = Eigen::Matrix<Real, 4, 1>::Zero()};
  if (std::abs(place) <= snap)
    row.coefficients[rotation ? 1 : 0] = 1;
  else if (std::abs(place - 1.0) <= snap)
    row.coefficients[rotation ? 3 : 2] = 1;
  else
    row.coefficients = rotation ? element.rotation_row(xi) : element.deflection_row(xi);
  return row;
}

template <class Real>
Eigen::Matrix<Real, Eigen::Dynamic, 1> remaining_stiffness(const Beam& beam,
                                                           const Defects& defects) {
  Eigen::Matrix<Real, Eigen::Dynamic, 1> remaining =
      Eigen::Matrix<Real, Eigen::Dynamic, 1>::Ones(beam.elements);
  for (const Damage& d : defects.damages)
    remaining[beam.element_at(d.location)] *= Real{1} - Real{d.reduction};
  return remaining;
}

int rigid_body_freedom(const Beam& beam, std::span<const SpringSupport> added) {
  // Rank of the restraints over the rigid motions w = α + β (x/L), θ L = β. A rotation, or
  // deflections at two locations, restrain β. One deflection restrains α or couples α to β.
  double first_at = -1.0;
  bool deflection = false, second = false;
  const auto hold = [&](double at, bool rotation) {
    if (rotation)
      second = true;
    else if (!deflection)
      deflection = true, first_at = at;
    else if (std::abs(at - first_at) > 1e-9 * beam.length)
      second = true;
  };
  for (const Support& s : beam.supports) {
    if (s.deflection) hold(s.at, false);
    if (s.rotation) hold(s.at, true);
  }
  for (const SpringSupport& s : added) hold(s.location, s.rotation);
  return 2 - static_cast<int>(deflection) - static_cast<int>(second);
}

template <class Real>
Assembly<Real> assemble(const Beam& beam, const Defects& defects) {
  validate(beam);
  for (const Damage& d : defects.damages) validate(beam, d);
  for (const SpringSupport& s : defects.supports) validate(beam, s);

  const TimoshenkoElement<Real> element(beam);
  const auto stiffness = element.stiffness();
  const auto mass = element.mass();
  const auto remaining = remaining_stiffness<Real>(beam, defects);
  const int dofs = 2 * beam.nodes();
  std::vector<Eigen::Triplet<Real>> k, m;
  for (int e = 0; e < beam.elements; ++e)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        k.emplace_back(2 * e + i, 2 * e + j, remaining[e] * stiffness(i, j));
        m.emplace_back(2 * e + i, 2 * e + j, mass(i, j));
      }

  Constraints<Real> constraints;
  for (const Hold& h : holds(beam, defects)) {
    const MotionRow<Real> row = motion_row(beam, element, h.at, h.rotation);
    if (std::isinf(h.stiffness)) {
      constraints.add(row, element.length());
      continue;
    }
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        k.emplace_back(row.first_dof + i, row.first_dof + j,
                       Real{h.stiffness} * row.coefficients[i] * row.coefficients[j]);
  }

  std::vector<int> free_index(static_cast<std::size_t>(dofs), -1);
  std::vector<Eigen::Triplet<Real>> t;
  std::vector<int> free_dofs;
  int free = 0;
  for (int dof = 0; dof < dofs; ++dof)
    if (!constraints.solved().contains(dof)) {
      free_index[static_cast<std::size_t>(dof)] = free;
      t.emplace_back(dof, free++, Real{1});
      free_dofs.push_back(dof);
    }
  for (const auto& [pivot, row] : constraints.solved())
    for (const auto& [dof, value] : row)
      if (dof != pivot && value != Real{0})
        t.emplace_back(pivot, free_index[static_cast<std::size_t>(dof)], -value);

  using Sparse = typename Assembly<Real>::Sparse;
  Sparse all_k(dofs, dofs), all_m(dofs, dofs), transform(dofs, free);
  all_k.setFromTriplets(k.begin(), k.end());
  all_m.setFromTriplets(m.begin(), m.end());
  transform.setFromTriplets(t.begin(), t.end());
  const Sparse transposed = transform.transpose();
  return {.stiffness = transposed * (all_k * transform),
          .mass = transposed * (all_m * transform),
          .free_to_all = transform,
          .free_dofs = free_dofs};
}

#define WHEELTAP_INSTANTIATE(Real)                                                                \
  template MotionRow<Real> motion_row(const Beam&, const TimoshenkoElement<Real>&, double, bool); \
  template Eigen::Matrix<Real, Eigen::Dynamic, 1> remaining_stiffness(const Beam&,                \
                                                                      const Defects&);            \
  template Assembly<Real> assemble(const Beam&, const Defects&);
WHEELTAP_INSTANTIATE(double)
WHEELTAP_INSTANTIATE(long double)
WHEELTAP_INSTANTIATE(DoubleDouble)
#undef WHEELTAP_INSTANTIATE

}  // namespace wheeltap::fem
