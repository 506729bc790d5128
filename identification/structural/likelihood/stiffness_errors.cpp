#include "identification/structural/likelihood/stiffness_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/eigen_solvers.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNoShare = 1e-9;  // smaller shares are rounding errors

}  // namespace

StiffnessPieces::StiffnessPieces(const fem::Discretisation& d, const fem::Mesh* mesh)
    : of_strain_(d.strains.size()) {
  if (mesh) {
    const auto members = static_cast<int>(mesh->structure().members.size());
    for (int m = 0; m < members; ++m) {
      const int first = mesh->first_element(m), elements = mesh->first_element(m + 1) - first;
      const int pieces = std::min(kOfMember, elements);
      const double length = mesh->member_length(m);
      for (int e = first; e < first + elements; ++e) {
        const fem::Mesh::Element& element = mesh->elements()[static_cast<std::size_t>(e)];
        const double from = element.from / length * pieces, to = element.to / length * pieces;
        for (int piece = 0; piece < pieces; ++piece) {
          const double share =
              (std::min(to, piece + 1.0) - std::max(from, static_cast<double>(piece))) /
              (to - from);
          if (share < kNoShare) continue;
          for (const int strain : element.strains)
            if (strain >= 0)
              of_strain_[static_cast<std::size_t>(strain)].push_back(
                  {count_ + piece, share > 1.0 - kNoShare ? 1.0 : share});
        }
      }
      count_ += pieces;
    }
  }
  for (std::size_t s = 0; s < of_strain_.size(); ++s)
    if (of_strain_[s].empty() && d.strains[s].factor > 0.0)
      of_strain_[s].push_back({count_++, 1.0});
}

namespace {

/// The value of one strain in each mode.
Eigen::RowVectorXd strained(const fem::SparseRow& row, const MatrixXd& shapes) {
  Eigen::RowVectorXd out = Eigen::RowVectorXd::Zero(shapes.cols());
  for (std::size_t i = 0; i < row.dofs.size(); ++i)
    out += row.coefficients[i] * shapes.row(row.dofs[i]);
  return out;
}

}  // namespace

std::vector<MatrixXd> StiffnessPieces::energies(const fem::Discretisation& d,
                                                const MatrixXd& shapes) const {
  const Index modes = shapes.cols();
  std::vector<MatrixXd> out(static_cast<std::size_t>(count_), MatrixXd::Zero(modes, modes));
  for (std::size_t s = 0; s < of_strain_.size(); ++s) {
    if (of_strain_[s].empty()) continue;
    const Eigen::RowVectorXd e = strained(d.strains[s].row, shapes);
    for (const auto& [piece, share] : of_strain_[s])
      out[static_cast<std::size_t>(piece)].noalias() +=
          (share * d.strains[s].factor) * e.transpose() * e;
  }
  return out;
}

std::vector<MatrixXd> StiffnessPieces::losses(const fem::Discretisation& intact,
                                              const fem::StructureChange& change,
                                              const MatrixXd& shapes) const {
  const Index modes = shapes.cols();
  std::vector<MatrixXd> out(static_cast<std::size_t>(count_), MatrixXd::Zero(modes, modes));
  for (const auto& softening : change.softenings) {
    Eigen::RowVectorXd e = Eigen::RowVectorXd::Zero(modes);
    const std::vector<Share>* shares = nullptr;  // all strains of a direction have the same parts
    for (const auto& [row, weight] : softening.direction) {
      const auto at = static_cast<std::size_t>(row);
      e += weight * strained(intact.strains[at].row, shapes);
      if (!of_strain_[at].empty()) shares = &of_strain_[at];
    }
    const double q = softening.remaining;
    if (shares == nullptr) continue;
    for (const auto& [piece, share] : *shares)
      out[static_cast<std::size_t>(piece)].noalias() += (share * q * (1.0 - q)) * e.transpose() * e;
  }
  return out;
}

StiffnessErrors::StiffnessErrors(int pieces)
    : a_(MatrixXd::Zero(pieces, pieces)), b_(VectorXd::Zero(pieces)) {}

void StiffnessErrors::add(const MatrixXd& sensitivities, const VectorXd& residual) {
  a_.noalias() += sensitivities.transpose() * sensitivities;
  b_.noalias() += sensitivities.transpose() * residual;
}

StiffnessErrors::Gain StiffnessErrors::integrated(double sigma) const {
  MatrixXd m = sigma * sigma * a_;
  m.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> llt(m);
  const double explained = (llt.matrixL().solve(VectorXd(sigma * b_))).squaredNorm();
  // The factorisation failed, or the squared error overflowed.
  if (llt.info() != Eigen::Success || !std::isfinite(explained))
    return {.log_density = -std::numeric_limits<double>::infinity(), .chi_square = 0.0};
  return {.log_density = 0.5 * explained - llt.matrixLLT().diagonal().array().log().sum(),
          .chi_square = explained};
}

}  // namespace wheeltap::identification
