#include "fem/structures/matrix_structure.hpp"

#include <cmath>

namespace wheeltap::fem {
namespace {

using Part = InvalidStructure::Part;

/// Largest asymmetry from rounding in another program, relative to the largest entry.
constexpr double kSymmetric = 1e-8;

void validate_matrix(const Discretisation::Sparse& a, Eigen::Index n, const std::string& name,
                     Part part, int index) {
  const auto refuse = [&](const std::string& message) {
    throw InvalidStructure(part, index, name + " " + message);
  };
  if (a.rows() != n || a.cols() != n)
    refuse("is " + std::to_string(a.rows()) + " x " + std::to_string(a.cols()) + ": must be " +
           std::to_string(n) + " x " + std::to_string(n));
  double largest = 0.0;
  for (int k = 0; k < a.outerSize(); ++k)
    for (Discretisation::Sparse::InnerIterator it(a, k); it; ++it) {
      if (!std::isfinite(it.value()))
        refuse("has an entry that is not finite at row " + std::to_string(it.row() + 1) +
               ", column " + std::to_string(it.col() + 1));
      largest = std::max(largest, std::abs(it.value()));
    }
  const Discretisation::Sparse difference = a - Discretisation::Sparse(a.transpose());
  for (int k = 0; k < difference.outerSize(); ++k)
    for (Discretisation::Sparse::InnerIterator it(difference, k); it; ++it)
      if (std::abs(it.value()) > kSymmetric * largest)
        refuse("is not symmetric: entry (" + std::to_string(it.row() + 1) + ", " +
               std::to_string(it.col() + 1) + ") and its mirror entry differ by " +
               std::to_string(std::abs(it.value())));
}

}  // namespace

void validate(const MatrixStructure& s) {
  const Eigen::Index n = s.mass.rows();
  if (n == 0) throw InvalidStructure(Part::masses, 0, "the mass matrix is empty");
  validate_matrix(s.mass, n, "the mass matrix", Part::masses, 0);
  if (s.parts.empty()) throw InvalidStructure(Part::whole, 0, "has no stiffness matrix");
  for (std::size_t j = 0; j < s.parts.size(); ++j) {
    validate_matrix(s.parts[j].stiffness, n, "the stiffness matrix \"" + s.parts[j].name + "\"",
                    Part::members, static_cast<int>(j));
    if (!(s.parts[j].change > -1.0) || !std::isfinite(s.parts[j].change))
      throw InvalidStructure(Part::members, static_cast<int>(j),
                             "scale change of \"" + s.parts[j].name + "\" = " +
                                 std::to_string(s.parts[j].change) + ": must be above -1");
  }
  if (!s.names.empty() && static_cast<Eigen::Index>(s.names.size()) != n)
    throw InvalidStructure(
        Part::whole, 0,
        std::to_string(s.names.size()) + " names for " + std::to_string(n) + " degrees of freedom");
}

Discretisation discretise(const MatrixStructure& s) {
  validate(s);
  Discretisation d;
  d.mass = 0.5 * (s.mass + Discretisation::Sparse(s.mass.transpose()));
  const Eigen::Index n = d.mass.rows();
  d.rest.resize(n, n);
  for (const MatrixStructure::Part& part : s.parts) {
    d.parts.emplace_back((1.0 + part.change) * 0.5 *
                         (part.stiffness + Discretisation::Sparse(part.stiffness.transpose())));
    d.rest += d.parts.back();
  }
  d.stiffness = d.rest;
  d.rigid_motions.resize(n, 0);
  d.names = s.names;
  if (d.names.empty())
    for (Eigen::Index i = 0; i < n; ++i)
      d.names.push_back({"degree of freedom " + std::to_string(i + 1), ""});
  return d;
}

}  // namespace wheeltap::fem
