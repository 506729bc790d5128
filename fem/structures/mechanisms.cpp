#include "fem/structures/mechanisms.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Discretisation::Sparse;

constexpr double kMechanismShift = 1e-11;
constexpr int kSteps = 12;
/// Largest number of mechanisms that the iteration can separate.
constexpr Index kMostApart = 12;
constexpr std::size_t kNamed = 3;

/// Makes columns D-orthonormal in two passes; omits columns that depend on other columns.
MatrixXd orthonormal_in(const VectorXd& weight, const MatrixXd& columns) {
  MatrixXd out(columns.rows(), columns.cols());
  Index n = 0;
  for (const auto& column : columns.colwise()) {
    VectorXd v = column;
    const double before = std::sqrt(v.dot(weight.cwiseProduct(v)));
    if (!(before > 0.0) || !std::isfinite(before)) continue;
    v /= before;
    for (int pass = 0; pass < 2; ++pass)
      v -= out.leftCols(n) * (out.leftCols(n).transpose() * weight.cwiseProduct(v));
    const double left = std::sqrt(v.dot(weight.cwiseProduct(v)));
    if (left > 1e-10) out.col(n++) = v / left;
  }
  return out.leftCols(n);
}

/// Scales each motion to a largest entry of 1, at a degree of freedom where the others have 0.
std::vector<VectorXd> separated(const MatrixXd& motions) {
  const Index k = motions.cols();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(motions.transpose());
  std::vector<Index> pivots;
  for (Index i = 0; i < k; ++i) pivots.push_back(qr.colsPermutation().indices()[i]);
  const MatrixXd apart = motions * motions(pivots, Eigen::all).inverse();
  std::vector<VectorXd> out;
  for (Index i = 0; i < k; ++i) {
    Index largest = 0;
    apart.col(i).cwiseAbs().maxCoeff(&largest);
    out.emplace_back(apart.col(i) / apart(largest, i));
  }
  return out;
}

std::string name_of(const DofName& name) {
  return name.place + (name.direction.empty() ? "" : ", " + name.direction);
}

}  // namespace

double no_strain(const Discretisation& d) {
  return d.rest.nonZeros() > 0 ? 2e-15 : 1e-22;
}

std::vector<VectorXd> mechanisms(const Discretisation& d) {
  const Index n = d.size();
  VectorXd weight = d.stiffness.diagonal();
  for (double& w : weight)
    if (!(w > 0.0)) w = 1.0;
  Sparse shifted = d.stiffness;
  for (Index i = 0; i < n; ++i) shifted.coeffRef(i, i) += kMechanismShift * weight[i];
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt(shifted);
  if (ldlt.info() != Eigen::Success) return {};
  const Index columns = std::min(n, d.rigid_motions.cols() + kMostApart);
  MatrixXd v(n, columns);
  for (Index c = 0; c < columns; ++c)
    for (Index i = 0; i < n; ++i)
      v(i, c) = std::sin((1.0 + 0.37 * static_cast<double>(c)) * static_cast<double>(i + 1)) + 0.1;
  v.leftCols(std::min(columns, d.rigid_motions.cols())) =
      d.rigid_motions.leftCols(std::min(columns, d.rigid_motions.cols()));
  for (int step = 0; step < kSteps; ++step) {
    v = orthonormal_in(weight, v);
    if (step + 1 < kSteps) v = ldlt.solve(MatrixXd(weight.asDiagonal() * v));
  }
  if (v.cols() == 0) return {};
  const Eigen::SelfAdjointEigenSolver<MatrixXd> ritz(d.projected_stiffness(v));
  const MatrixXd motions = v * ritz.eigenvectors();
  std::vector<Index> unresisted;
  for (Index c = 0; c < motions.cols(); ++c) {
    const VectorXd motion = motions.col(c);
    if (std::abs(d.energy(motion)) <= no_strain(d) * d.uncancelled_energy(motion))
      unresisted.push_back(c);
  }
  // The remaining motions after removal of the rigid motions.
  MatrixXd all(n, d.rigid_motions.cols() + static_cast<Index>(unresisted.size()));
  all << d.rigid_motions, motions(Eigen::all, unresisted);
  const MatrixXd independent = orthonormal_in(weight, all);
  const Index rigid = orthonormal_in(weight, d.rigid_motions).cols();
  const Index left = static_cast<Index>(unresisted.size()) - rigid;
  if (left <= 0 || independent.cols() <= rigid) return {};
  return separated(independent.middleCols(rigid, std::min(left, independent.cols() - rigid)));
}

std::string motion_in_words(const Discretisation& d, const VectorXd& motion) {
  const auto name = [&](Index i) -> const DofName& { return d.names[static_cast<std::size_t>(i)]; };
  const auto turns = [&](Index i) { return name(i).direction.starts_with('r'); };
  // Rotations have another unit. They are named only if no node is displaced.
  constexpr double kDisplaced = 1e-6;
  double displaced = 0.0, turned = 0.0;
  for (Index i = 0; i < motion.size(); ++i)
    (turns(i) ? turned : displaced) = std::max(turns(i) ? turned : displaced, std::abs(motion[i]));
  const bool rotations = displaced < kDisplaced * turned;
  // Nodes precede other locations: the first of several nearly equal motions is named.
  constexpr double kAsMuch = 0.95;
  std::string text;
  std::size_t named = 0;
  for (Index i = 0; i < motion.size() && named < kNamed; ++i) {
    if (turns(i) != rotations || std::abs(motion[i]) < kAsMuch * (rotations ? turned : displaced))
      continue;
    text += (named++ == 0 ? "" : " and ") + name_of(name(i));
  }
  return text;
}

void refuse_mechanisms(const Discretisation& d) {
  const std::vector<VectorXd> found = mechanisms(d);
  if (found.empty()) return;
  std::string text = "is a mechanism: nothing resists ";
  if (found.size() == 1) {
    text += "a motion that is largest at " + motion_in_words(d, found[0]);
  } else {
    text += std::to_string(found.size()) + " motions, largest at " + motion_in_words(d, found[0]);
    for (std::size_t i = 1; i < std::min(found.size(), kNamed); ++i)
      text += ", at " + motion_in_words(d, found[i]);
    if (found.size() > kNamed) text += ", …";
  }
  throw InvalidStructure(
      InvalidStructure::Part::whole, 0,
      text + ": restrain it by a support, a spring or a member, or make a hinge rigid");
}

}  // namespace wheeltap::fem
