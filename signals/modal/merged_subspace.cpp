#include "signals/modal/merged_subspace.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kKeptRatio =
    2.0;  // smallest ratio of the variance of a component to that of its scatter

/// Extracts the rows of some channels from every block row.
MatrixXd rows_of(const MatrixXd& h, Index channels, const std::vector<int>& which) {
  const Index blocks = h.rows() / channels, count = static_cast<Index>(which.size());
  MatrixXd out(blocks * count, h.cols());
  for (Index b = 0; b < blocks; ++b)
    for (Index c = 0; c < count; ++c)
      out.row(b * count + c) = h.row(b * channels + which[index(c)]);
  return out;
}

/// Adds `rows` to the rows of some sensors in every block row.
void add_rows(MatrixXd& into, Index sensors, const std::vector<int>& which, const MatrixXd& rows) {
  const Index count = static_cast<Index>(which.size());
  for (Index b = 0; b < into.rows() / sensors; ++b)
    for (Index c = 0; c < count; ++c)
      into.row(b * sensors + which[index(c)]) += rows.row(b * count + c);
}

/// The parts of a set-up. All set-ups have the same units of the references.
struct Piece {
  Index channels = 0;
  VectorXd row_scale = {}, column_scale = {};
  std::vector<int> moved = {}, moved_sensors = {};
  MatrixXd reference = {}, mov = {}, z = {}, observability = {};  ///< H_ref, H_mov, Z, O_mov
  // Initialised, because copying a default-constructed LLT reads uninitialised memory.
  Eigen::LLT<MatrixXd> gram = Eigen::LLT<MatrixXd>(MatrixXd());  ///< Z Zᵀ

  [[nodiscard]] MatrixXd scaled(const MatrixXd& h) const {
    MatrixXd out = h;
    for (Index r = 0; r < out.rows(); ++r) out.row(r) *= row_scale[r % channels];
    for (Index c = 0; c < out.cols(); ++c) out.col(c) *= column_scale[c % column_scale.size()];
    return out;
  }
};

/// B A⁻¹; handled separately if B has no rows, because Eigen accesses the first element.
MatrixXd times_inverse(const MatrixXd& b, const Eigen::LLT<MatrixXd>& a) {
  if (b.rows() == 0) return b;
  return a.solve(b.transpose()).transpose();
}

/// Computes ΔH Zᵀ + H ΔZᵀ - O (ΔZ Zᵀ + Z ΔZᵀ). The product with (Z Zᵀ)⁻¹ is ΔO.
MatrixXd numerator(const MatrixXd& dh, const MatrixXd& h, const MatrixXd& o, const MatrixXd& z,
                   const MatrixXd& dz) {
  const MatrixXd cross = dz * z.transpose();
  return dh * z.transpose() + h * dz.transpose() - o * (cross + cross.transpose());
}

}  // namespace

HankelFactor merge_covariances(const std::vector<SetUpCovariances>& set_ups, int sensors,
                               int columns, int rank) {
  if (set_ups.empty()) throw std::invalid_argument("set-ups = 0: must be at least one");
  const auto& first = set_ups.front();
  const auto references = static_cast<Index>(first.covariances.references.size());
  std::vector<int> reference_sensors;
  for (const int c : first.covariances.references)
    reference_sensors.push_back(first.sensors[index(c)]);

  HankelFactor out{.scale = VectorXd::Zero(sensors)};
  const double share = 1.0 / static_cast<double>(set_ups.size());
  for (const SetUpCovariances& s : set_ups)
    for (Index r = 0; r < references; ++r)
      out.scale[reference_sensors[index(r)]] +=
          share * std::pow(s.covariances.scale[s.covariances.references[index(r)]], 2);
  for (const int k : reference_sensors) out.scale[k] = std::sqrt(out.scale[k]);

  std::vector<Piece> pieces;
  for (const SetUpCovariances& s : set_ups) {
    const OutputCovariances& own = s.covariances;
    Piece piece{.channels = own.channels(),
                .row_scale = VectorXd::Ones(own.channels()),
                .column_scale = VectorXd(references)};
    for (Index r = 0; r < references; ++r) {
      const int c = own.references[index(r)];
      piece.row_scale[c] = piece.column_scale[r] =
          own.scale[c] / out.scale[reference_sensors[index(r)]];
    }
    // All set-ups get the same weight, regardless of their excitation; Z_s contains any factor.
    const double level = piece.column_scale.norm() / std::sqrt(static_cast<double>(references));
    piece.column_scale /= level * level;
    for (Index c = 0; c < piece.channels; ++c) {
      if (out.scale[s.sensors[index(c)]] > 0.0) continue;
      out.scale[s.sensors[index(c)]] = own.scale[c];
      piece.moved.push_back(static_cast<int>(c));
      piece.moved_sensors.push_back(s.sensors[index(c)]);
    }
    const MatrixXd h = piece.scaled(block_hankel(own.mean, piece.channels, columns));
    piece.reference = rows_of(h, piece.channels, own.references);
    piece.mov = rows_of(h, piece.channels, piece.moved);
    pieces.push_back(std::move(piece));
  }

  const Index height = pieces.front().reference.rows(), width = pieces.front().reference.cols();
  if (rank < 2 || rank > std::min(height, width))
    throw std::invalid_argument("rank = " + std::to_string(rank) + ": must be from 2 to " +
                                std::to_string(std::min(height, width)) +
                                ", the largest rank of the references' covariances");
  MatrixXd all(height, width * static_cast<Index>(pieces.size()));
  for (std::size_t s = 0; s < pieces.size(); ++s)
    all.middleCols(static_cast<Index>(s) * width, width) = pieces[s].reference;
  const Eigen::BDCSVD<MatrixXd> svd(all, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const MatrixXd basis = svd.matrixU().leftCols(rank);
  const MatrixXd turn = svd.matrixV().leftCols(rank) * std::sqrt(share);
  const VectorXd weight = svd.singularValues().head(rank) * std::sqrt(share);

  // The changes by each block show which components of Z exceed their scatter. The moved sensors
  // are regressed only on these components; regression on other components would fit noise.
  std::vector<std::vector<MatrixXd>> moves(pieces.size());
  VectorXd scatter = VectorXd::Zero(rank);
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    const OutputCovariances& own = set_ups[s].covariances;
    const double blocks = static_cast<double>(own.blocks.size());
    const double norm = 1.0 / std::sqrt(blocks * (blocks - 1.0));
    for (const MatrixXd& block : own.blocks) {
      moves[s].push_back(
          norm * pieces[s].scaled(block_hankel(block - own.mean, pieces[s].channels, columns)));
      scatter +=
          share * (basis.transpose() * rows_of(moves[s].back(), pieces[s].channels, own.references))
                      .rowwise()
                      .squaredNorm();
    }
  }
  Index kept = 2;
  while (kept < rank && weight[kept] * weight[kept] > kKeptRatio * scatter[kept]) ++kept;

  MatrixXd gram = MatrixXd::Zero(rank, rank), product = MatrixXd::Zero(height, rank);
  for (Piece& p : pieces) {
    const MatrixXd z = basis.transpose() * p.reference;
    gram += z * z.transpose();
    product += p.reference * z.transpose();
    const auto leading = z.topRows(kept);
    p.gram.compute(leading * leading.transpose());
    p.observability = times_inverse(p.mov * leading.transpose(), p.gram);
    p.z = z;
  }
  const Eigen::LLT<MatrixXd> whole(gram);
  const MatrixXd reference = times_inverse(product, whole);
  const auto weighted = [&](const MatrixXd& some) -> MatrixXd {
    MatrixXd out_of = MatrixXd::Zero(some.rows(), rank);
    out_of.leftCols(some.cols()) = some * weight.head(some.cols()).asDiagonal();
    return out_of;
  };
  MatrixXd observability = MatrixXd::Zero(height / references * sensors, rank);
  add_rows(observability, sensors, reference_sensors, reference);
  for (const Piece& p : pieces) {
    MatrixXd rows = MatrixXd::Zero(p.observability.rows(), rank);
    rows.leftCols(kept) = p.observability;
    add_rows(observability, sensors, p.moved_sensors, rows);
  }
  out.hankel = weighted(observability);

  for (std::size_t s = 0; s < pieces.size(); ++s) {
    const Piece& p = pieces[s];
    for (const MatrixXd& moved : moves[s]) {
      const MatrixXd dh = rows_of(moved, p.channels, set_ups[s].covariances.references);
      const MatrixXd dz = basis.transpose() * dh;
      const MatrixXd of_references = numerator(dh, p.reference, reference, p.z, dz);
      const MatrixXd of_moved = numerator(rows_of(moved, p.channels, p.moved), p.mov,
                                          p.observability, p.z.topRows(kept), dz.topRows(kept));
      MatrixXd one = observability * (dz * turn.middleRows(static_cast<Index>(s) * width, width));
      add_rows(one, sensors, reference_sensors, weighted(times_inverse(of_references, whole)));
      add_rows(one, sensors, p.moved_sensors, weighted(times_inverse(of_moved, p.gram)));
      out.moves.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace wheeltap::signals
