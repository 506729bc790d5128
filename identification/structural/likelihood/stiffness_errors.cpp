#include "identification/structural/likelihood/stiffness_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/eigen_solvers.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

StiffnessPieces::StiffnessPieces(const fem::Discretisation& d, const fem::Mesh* mesh)
    : of_strain_(d.strains.size(), -1) {
  if (mesh) {
    const auto members = static_cast<int>(mesh->structure().members.size());
    for (int m = 0; m < members; ++m) {
      const int first = mesh->first_element(m), elements = mesh->first_element(m + 1) - first;
      const int pieces = std::min(kOfMember, elements);
      const double length = mesh->member_length(m);
      std::vector<int> numbers(static_cast<std::size_t>(kOfMember), -1);
      for (int e = first; e < first + elements; ++e) {
        const fem::Mesh::Element& element = mesh->elements()[static_cast<std::size_t>(e)];
        const double middle = 0.5 * (element.from + element.to) / length;
        const auto piece =
            static_cast<std::size_t>(std::clamp(static_cast<int>(middle * pieces), 0, pieces - 1));
        if (numbers[piece] < 0) numbers[piece] = count_++;
        for (const int strain : element.strains)
          if (strain >= 0) of_strain_[static_cast<std::size_t>(strain)] = numbers[piece];
      }
    }
  }
  for (std::size_t s = 0; s < of_strain_.size(); ++s)
    if (of_strain_[s] < 0 && d.strains[s].factor > 0.0) of_strain_[s] = count_++;
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
    if (of_strain_[s] < 0) continue;
    const Eigen::RowVectorXd e = strained(d.strains[s].row, shapes);
    out[static_cast<std::size_t>(of_strain_[s])].noalias() +=
        d.strains[s].factor * e.transpose() * e;
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
    int piece = -1;
    for (const auto& [row, weight] : softening.direction) {
      const auto at = static_cast<std::size_t>(row);
      e += weight * strained(intact.strains[at].row, shapes);
      piece = std::max(piece, of_strain_[at]);
    }
    const double q = softening.remaining;
    if (piece >= 0)
      out[static_cast<std::size_t>(piece)].noalias() += q * (1.0 - q) * e.transpose() * e;
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
