#include "fem/sections/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "base/index.hpp"

namespace wheeltap::fem {
EdgeNumbers number_edges(const TriangleMesh& mesh) {
  EdgeNumbers edges;
  edges.of_triangle.resize(mesh.triangles.size());
  std::unordered_map<std::uint64_t, int> known;
  known.reserve(2 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto [a, b] =
          std::minmax(mesh.triangles[t][index((i + 1) % 3)], mesh.triangles[t][index((i + 2) % 3)]);
      const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<unsigned>(b);
      const auto [place, added] = known.try_emplace(key, static_cast<int>(edges.ends.size()));
      const int triangle = static_cast<int>(t);
      if (added) {
        edges.ends.push_back({a, b});
        edges.triangles.push_back({triangle, -1});
      } else {
        edges.triangles[index(place->second)][1] = triangle;
      }
      edges.of_triangle[t][index(i)] = place->second;
    }
  return edges;
}

std::vector<double> split_shares(const TriangleMesh& mesh) {
  constexpr double pi = std::numbers::pi;
  constexpr double kStraight =
      0.35;  // rad: corners of polygons that approximate arcs turn less than this
  const EdgeNumbers edges = number_edges(mesh);
  const std::size_t n = mesh.points.size();
  std::vector<double> angle(n, 0.0);
  for (const auto& corners : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const auto& p = mesh.points[index(corners[index(i)])];
      const Eigen::Vector2d u = mesh.points[index(corners[index((i + 1) % 3)])] - p,
                            v = mesh.points[index(corners[index((i + 2) % 3)])] - p;
      angle[index(corners[index(i)])] +=
          std::atan2(std::abs(u.x() * v.y() - u.y() * v.x()), u.dot(v));
    }
  std::vector<bool> boundary(n, false);
  std::vector<std::vector<Eigen::Vector2d>> interface(n);
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    const auto [s, t] = edges.triangles[e];
    if (t < 0) {
      boundary[index(a)] = boundary[index(b)] = true;
    } else if (mesh.regions[index(s)] != mesh.regions[index(t)]) {
      const Eigen::Vector2d along = (mesh.points[index(b)] - mesh.points[index(a)]).normalized();
      interface[index(a)].push_back(along);
      interface[index(b)].push_back(-along);
    }
  }
  std::vector<double> shares(n, 0.5);
  for (std::size_t i = 0; i < n; ++i) {
    if (boundary[i] && angle[i] > pi + kStraight)
      shares[i] = std::exp2(-2.0 * std::max(1.0, angle[i] / pi));
    const auto& out = interface[i];
    const bool straight =
        !boundary[i] && out.size() == 2 && out[0].dot(out[1]) < -std::cos(kStraight);
    if (!out.empty() && !straight) shares[i] = std::exp2(-4.0);
  }
  return shares;
}

TriangleMesh refined(const TriangleMesh& mesh, std::vector<double>& shares) {
  const EdgeNumbers edges = number_edges(mesh);
  TriangleMesh fine;
  fine.points = mesh.points;
  fine.points.reserve(mesh.points.size() + edges.ends.size());
  for (const auto& [a, b] : edges.ends) {
    const double near_a = shares[index(a)], near_b = shares[index(b)];
    const double share = near_a < 0.5 && near_b < 0.5 ? 0.5 : near_a < 0.5 ? near_a : 1.0 - near_b;
    fine.points.emplace_back(mesh.points[index(a)] +
                             share * (mesh.points[index(b)] - mesh.points[index(a)]));
  }
  shares.resize(fine.points.size(), 0.5);
  fine.triangles.reserve(4 * mesh.triangles.size());
  fine.regions.reserve(4 * mesh.triangles.size());
  const int first = static_cast<int>(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const int bc = first + edges.of_triangle[t][0], ca = first + edges.of_triangle[t][1],
              ab = first + edges.of_triangle[t][2];
    for (const std::array<int, 3>& child :
         {std::array<int, 3>{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      fine.triangles.push_back(child);
      fine.regions.push_back(mesh.regions[t]);
    }
  }
  return fine;
}

TriangleMesh ringed(TriangleMesh mesh, std::vector<double>& shares, int rings) {
  const int corners = static_cast<int>(mesh.points.size());
  std::vector<std::vector<std::size_t>> around(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int corner : mesh.triangles[t]) around[index(corner)].push_back(t);
  for (int v = 0; v < corners; ++v) {
    if (shares[index(v)] >= 0.5) continue;
    for (int ring = 0; ring < rings; ++ring) {
      // Splits only edges that end at v. All triangles without the corner v stay unchanged.
      std::unordered_map<int, int> nearer;
      const auto towards = [&](int corner) {
        const auto [place, added] =
            nearer.try_emplace(corner, static_cast<int>(mesh.points.size()));
        if (added) {
          const Eigen::Vector2d p =
              mesh.points[index(v)] + (mesh.points[index(corner)] - mesh.points[index(v)]) / 3.0;
          mesh.points.push_back(p);
          around.emplace_back();
        }
        return place->second;
      };
      for (const std::size_t t : std::vector(around[index(v)])) {
        const auto corner = mesh.triangles[t];
        const int i = static_cast<int>(std::ranges::find(corner, v) - corner.begin());
        const int b = corner[index((i + 1) % 3)], c = corner[index((i + 2) % 3)];
        const int near_b = towards(b), near_c = towards(c);
        const auto add = [&](const std::array<int, 3>& triangle) {
          for (const int point : triangle) around[index(point)].push_back(mesh.triangles.size());
          mesh.triangles.push_back(triangle);
          mesh.regions.push_back(mesh.regions[t]);
        };
        mesh.triangles[t] = {v, near_b, near_c};
        std::erase(around[index(b)], t);
        std::erase(around[index(c)], t);
        around[index(near_b)].push_back(t);
        around[index(near_c)].push_back(t);
        add({near_b, b, c});
        add({near_b, c, near_c});
      }
    }
  }
  shares.resize(mesh.points.size(), 0.5);
  return mesh;
}

int pieces(const TriangleMesh& mesh) {
  std::vector<int> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[index(i)] != i) i = root[index(i)] = root[index(root[index(i)])];
    return i;
  };
  int count = static_cast<int>(root.size());
  for (const auto& [s, t] : number_edges(mesh).triangles) {
    if (t < 0) continue;
    const int a = find(s), b = find(t);
    if (a == b) continue;
    root[index(a)] = b;
    --count;
  }
  return count;
}

}  // namespace wheeltap::fem
