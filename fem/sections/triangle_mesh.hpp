// Triangles in the plane, and their refinement towards corners where gradients are singular.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::fem {

/// Straight-sided triangles, counter-clockwise, that meet edge to edge.
struct TriangleMesh {
  std::vector<Eigen::Vector2d> points;        ///< (y, z) [m]
  std::vector<std::array<int, 3>> triangles;  ///< numbers of points, from 0
  std::vector<int> regions;                   ///< of each triangle, from 0
};

/// The middles of the edges, numbered from 0.
struct EdgeNumbers {
  std::vector<std::array<int, 3>> of_triangle;  ///< edge i lies opposite corner i
  std::vector<std::array<int, 2>> ends;         ///< points, the smaller number first
  std::vector<std::array<int, 2>> triangles;    ///< on both sides; -1 for none
};
[[nodiscard]] EdgeNumbers number_edges(const TriangleMesh& mesh);

/// Where refinement splits an edge, as a share of its length from this point: ½, but less at the
/// corners of the domain and of interfaces that point inwards. There a function behaves as r^λ,
/// λ = π / angle, and quadratic elements keep their order h⁴ (of energies) with shares of at most
/// 2^(-2/λ) (Babuška, Kellogg & Pitkäranta 1979, Numer. Math. 33:447). Where an interface ends on
/// the boundary or turns, λ depends on the moduli; ½, the least there is, is taken.
[[nodiscard]] std::vector<double> split_shares(const TriangleMesh& mesh);

/// Every triangle in four. The points of the mesh keep their numbers; `shares` is extended by ½ for
/// the new ones. An edge between two points of share below ½ is halved.
[[nodiscard]] TriangleMesh refined(const TriangleMesh& mesh, std::vector<double>& shares);

/// `rings` rings of smaller triangles around each point of share below ½, each ring a third of the
/// size of that around it. The points keep their numbers; `shares` is extended as above.
[[nodiscard]] TriangleMesh ringed(TriangleMesh mesh, std::vector<double>& shares, int rings);

/// How many pieces there are that no edge connects.
[[nodiscard]] int pieces(const TriangleMesh& mesh);

}  // namespace wheeltap::fem
