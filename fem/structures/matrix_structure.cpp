#include "fem/structures/matrix_structure.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number.hpp"

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

/// Largest negative eigenvalue from rounding of a positive semidefinite matrix by another program,
/// relative to a unit diagonal: rounding to six digits.
constexpr double kDefinite = 1e-5;
/// Diagonal entries up to this share of the largest are rounding errors of zero.
constexpr double kRoundedMass = 1e-14;

[[noreturn]] void refuse_mass(const std::string& message) {
  throw InvalidStructure(Part::masses, 0, "the mass matrix " + message);
}

std::string entry_in_words(Eigen::Index row, Eigen::Index column, double value) {
  return "entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
         ") = " + base::significant(value, 6);
}

/// Rejects a mass matrix with a negative diagonal entry, or with a negative determinant for two
/// degrees of freedom. Returns true if all rows are diagonally dominant, so that the matrix is
/// positive semidefinite.
bool check_masses(const Discretisation::Sparse& m, const Eigen::VectorXd& diagonal) {
  const double none = kRoundedMass * diagonal.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < diagonal.size(); ++i)
    if (diagonal[i] < -none)
      refuse_mass("has a negative mass: " + entry_in_words(i, i, diagonal[i]) +
                  " must be >= 0 (0 for a degree of freedom without mass)");
  Eigen::VectorXd beside = Eigen::VectorXd::Zero(diagonal.size());
  for (int c = 0; c < m.outerSize(); ++c)
    for (Discretisation::Sparse::InnerIterator it(m, c); it; ++it) {
      if (it.row() == c) continue;
      beside[it.row()] += std::abs(it.value());
      const Eigen::Index a = std::min<Eigen::Index>(it.row(), c), b = it.row() + c - a;
      const double product = std::max(diagonal[a], 0.0) * std::max(diagonal[b], 0.0);
      if (std::abs(it.value()) > (1.0 + kDefinite) * std::sqrt(product) + none)
        refuse_mass("is not positive semidefinite: " + entry_in_words(a, b, it.value()) + ", but " +
                    entry_in_words(a, a, diagonal[a]) + " and " +
                    entry_in_words(b, b, diagonal[b]) +
                    "; its square must not exceed their product");
    }
  return (beside.array() <= diagonal.array()).all();
}

/// Rejects an indefinite mass matrix. D^(-1/2) M D^(-1/2) + kDefinite I, without the rows that have
/// no mass, has as many negative pivots as negative eigenvalues.
void refuse_indefinite(const Discretisation::Sparse& m, const Eigen::VectorXd& diagonal) {
  const double none = kRoundedMass * diagonal.maxCoeff();
  std::vector<Eigen::Index> rows;
  std::vector<int> kept(static_cast<std::size_t>(diagonal.size()), -1);
  for (Eigen::Index i = 0; i < diagonal.size(); ++i)
    if (diagonal[i] > none) {
      kept[static_cast<std::size_t>(i)] = static_cast<int>(rows.size());
      rows.push_back(i);
    }
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < m.outerSize(); ++c)
    for (Discretisation::Sparse::InnerIterator it(m, c); it; ++it) {
      const int i = kept[static_cast<std::size_t>(it.row())], j = kept[static_cast<std::size_t>(c)];
      if (i < 0 || j < 0) continue;
      entries.emplace_back(
          i, j,
          i == j ? 1.0 + kDefinite : it.value() / std::sqrt(diagonal[it.row()] * diagonal[c]));
    }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Discretisation::Sparse scaled(n, n);
  scaled.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Discretisation::Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt(
      scaled);
  const std::string start = "is not positive semidefinite: a motion ";
  const std::string end = "has a negative mass; correct the matrix, or export it with more digits";
  if (ldlt.info() != Eigen::Success) refuse_mass(start + end);
  const Eigen::VectorXd pivots = ldlt.vectorD();
  for (Eigen::Index k = 0; k < n; ++k)
    if (pivots[k] < 0.0) {
      const int row = ldlt.permutationPinv().size() > 0 ? ldlt.permutationPinv().indices()[k]
                                                        : static_cast<int>(k);
      refuse_mass(start + "of degree of freedom " +
                  std::to_string(rows[static_cast<std::size_t>(row)] + 1) +
                  " (row of M) and others " + end);
    }
}

/// All checks of `validate` but that of a positive semidefinite mass matrix. Returns true if this
/// check is not needed.
bool check_entries(const MatrixStructure& s) {
  const Eigen::Index n = s.mass.rows();
  if (n == 0) throw InvalidStructure(Part::masses, 0, "the mass matrix is empty");
  validate_matrix(s.mass, n, "the mass matrix", Part::masses, 0);
  const bool dominant = check_masses(s.mass, s.mass.diagonal());
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
  return dominant;
}

}  // namespace

void validate(const MatrixStructure& s) {
  if (!check_entries(s)) refuse_indefinite(s.mass, s.mass.diagonal());
}

Discretisation discretise(const MatrixStructure& s) {
  check_entries(s);
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
