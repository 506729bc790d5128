// Triangle meshes in the plane, with refinement towards corners at which gradients are singular.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::fem {

/// A mesh of straight-sided triangles. The triangles are counter-clockwise and conforming (edge to
/// edge).
struct TriangleMesh {
  std::vector<Eigen::Vector2d> points;        ///< (y, z) [m]
  std::vector<std::array<int, 3>> triangles;  ///< point indices, from 0
  std::vector<int> regions;                   ///< region index of each triangle, from 0
};

/// The edges of a mesh, numbered from 0.
struct EdgeNumbers {
  std::vector<std::array<int, 3>> of_triangle;  ///< edge i lies opposite corner i
  std::vector<std::array<int, 2>> ends;         ///< point indices, the smaller first
  std::vector<std::array<int, 2>> triangles;    ///< triangles on both sides of the edge; -1 if
                                                ///< there is none
};
[[nodiscard]] EdgeNumbers number_edges(const TriangleMesh& mesh);

/// Returns the split ratio of each point. Refinement splits an edge at this fraction of the edge's
/// length, measured from the point. The ratio is ½, but below ½ at re-entrant corners of the domain
/// and of interfaces. At these corners, the solution behaves as r^λ, λ = π / angle. With quadratic
/// elements, energies keep the order of convergence h⁴ if the ratios are at most 2^(-2/λ) (Babuška,
/// Kellogg & Pitkäranta 1979, Numer. Math. 33:447). At corners and ends of an interface, λ depends
/// on the moduli. The ratio there is computed for the smallest possible value of λ, ½.
[[nodiscard]] std::vector<double> split_shares(const TriangleMesh& mesh);

/// Splits every triangle into four triangles. Existing points keep their indices; `shares` gets the
/// entry ½ for each new point. If both ends of an edge have split ratios below ½, the edge is
/// halved.
[[nodiscard]] TriangleMesh refined(const TriangleMesh& mesh, std::vector<double>& shares);

/// Adds `rings` rings of smaller triangles around each point with a split ratio below ½. Each ring
/// is a third as large as the ring around it. Existing points keep their indices; `shares` gets the
/// entry ½ for each new point.
[[nodiscard]] TriangleMesh ringed(TriangleMesh mesh, std::vector<double>& shares, int rings);

/// Returns the number of connected components of the mesh.
[[nodiscard]] int pieces(const TriangleMesh& mesh);

}  // namespace wheeltap::fem
