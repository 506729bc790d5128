// Displacements of the ends of an element, in the axes of the element. Internal to the mesh.
#pragma once

#include <array>
#include <map>

#include "fem/structures/discretisation.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem::detail {

/// A weighted sum of rows.
class RowSum {
 public:
  void add(double factor, const SparseRow& row) {
    if (factor == 0.0) return;
    for (std::size_t i = 0; i < row.dofs.size(); ++i)
      terms_[row.dofs[i]] += factor * row.coefficients[i];
  }
  [[nodiscard]] SparseRow row(double factor = 1.0) const {
    SparseRow out;
    for (const auto& [dof, coefficient] : terms_) {
      if (coefficient == 0.0) continue;
      out.dofs.push_back(dof);
      out.coefficients.push_back(factor * coefficient);
    }
    return out;
  }

 private:
  std::map<int, double> terms_;
};

/// The six displacements and rotations of a node, or of a boundary between elements.
using Motions = std::array<SparseRow, kDirections>;
/// The displacements of both ends, [end][k]: translations along the member's own axes (k = 0, 1,
/// 2), then rotations about these axes (k = 3, 4, 5).
using OwnMotions = std::array<std::array<SparseRow, 6>, 2>;

[[nodiscard]] OwnMotions own_motions(const MemberFrame& frame, const Motions& first,
                                     const Motions& second);
/// Returns the deflections and slopes (w₁, w₁', w₂, w₂') of an element. For a deflection along z,
/// w' = -θ_y; for a deflection along y, w' = θ_z.
[[nodiscard]] std::array<SparseRow, 4> plane_motions(const OwnMotions& own, bool along_z);

}  // namespace wheeltap::fem::detail
