// Triangle meshes in the plane, with refinement towards corners with singular gradients.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::fem {

/// Straight-sided triangles, counter-clockwise and conforming (edge to edge).
struct TriangleMesh {
  std::vector<Eigen::Vector2d> points;        ///< (y, z) [m]
  std::vector<std::array<int, 3>> triangles;  ///< point numbers, from 0
  std::vector<int> regions;                   ///< region number of each triangle, from 0
};

/// The midpoints of the edges, numbered from 0.
struct EdgeNumbers {
  std::vector<std::array<int, 3>> of_triangle;  ///< edge i lies opposite corner i
  std::vector<std::array<int, 2>> ends;         ///< point numbers, the smaller first
  std::vector<std::array<int, 2>> triangles;    ///< on both sides; -1 if there is none
};
[[nodiscard]] EdgeNumbers number_edges(const TriangleMesh& mesh);

/// Shares of an edge's length, one per point, measured from the point, at which refinement splits
/// the edge. The share is ½, but less at re-entrant corners of the domain and of interfaces. There
/// a function behaves as r^λ, λ = π / angle, and quadratic elements keep their order h⁴ (of
/// energies) with shares of at most 2^(-2/λ) (Babuška, Kellogg & Pitkäranta 1979, Numer. Math.
/// 33:447). At corners and ends of an interface, λ depends on the moduli; its smallest possible
/// value, ½, is used there.
[[nodiscard]] std::vector<double> split_shares(const TriangleMesh& mesh);

/// Splits every triangle into four. Existing points keep their numbers; `shares` gets ½ for each
/// new point. An edge between two points of share below ½ is halved.
[[nodiscard]] TriangleMesh refined(const TriangleMesh& mesh, std::vector<double>& shares);

/// Adds `rings` rings of smaller triangles around each point of share below ½; each ring is a third
/// of the size of the one around it. Existing points keep their numbers; `shares` gets ½ for each
/// new point.
[[nodiscard]] TriangleMesh ringed(TriangleMesh mesh, std::vector<double>& shares, int rings);

/// The number of connected parts of the mesh.
[[nodiscard]] int pieces(const TriangleMesh& mesh);

}  // namespace wheeltap::fem
