#include "fem/sections/section_mesh.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {
namespace {

/// Data of a corner of the outline.
struct Corner {
  bool sharp = false;  ///< two constrained edges meet at less than 60°
  int number = -1;     ///< number of the point in the mesh
};
constexpr int kOutside = -1, kUnknown = -2;
/// Edges shorter than this share of the section's size are not split, because of rounding errors.
constexpr double kShortest = 1e-10;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Corner, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;
using Edge = Triangulation::Edge;
using Point = Kernel::Point_2;

Point point(const Eigen::Vector2d& p) {
  return {p.x(), p.y()};
}

/// All rings. Corners of other rings that lie on an edge split the edge; close corners are merged.
std::vector<Ring> joined_rings(const Outline& outline, double near) {
  std::vector<Ring> rings;
  for (const Region& region : outline.regions) {
    rings.push_back(region.outer);
    rings.insert(rings.end(), region.holes.begin(), region.holes.end());
  }
  if (outline.regions.size() == 1) return rings;
  std::vector<Eigen::Vector2d> corners;
  for (Ring& ring : rings)
    for (Eigen::Vector2d& p : ring) {
      const auto known = std::ranges::find_if(
          corners, [&](const Eigen::Vector2d& c) { return (c - p).norm() <= near; });
      if (known == corners.end())
        corners.push_back(p);
      else
        p = *known;
    }
  for (Ring& ring : rings) {
    std::set<std::pair<double, double>> distinct;
    for (const Eigen::Vector2d& p : ring) distinct.emplace(p.x(), p.y());
    if (distinct.size() < 3)
      throw std::invalid_argument(
          "outline: with corners within a billionth of the section's size merged, a region or hole "
          "has fewer than 3 corners; remove it or correct its coordinates");
    Ring split;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const Eigen::Vector2d along = b - a;
      std::vector<std::pair<double, Eigen::Vector2d>> on;
      for (const Eigen::Vector2d& c : corners) {
        const double t = (c - a).dot(along) / along.squaredNorm();
        if (c != a && c != b && t > 0.0 && t < 1.0 && (c - a - t * along).norm() <= near)
          on.emplace_back(t, c);
      }
      std::ranges::sort(on, {}, [](const auto& pair) { return pair.first; });
      split.push_back(a);
      for (const auto& [t, c] : on) split.push_back(c);
    }
    ring = std::move(split);
  }
  return rings;
}

class Refinement {
 public:
  Refinement(const Outline& outline, const SectionMeshOptions& options) : options_(options) {
    double area = 0.0;
    const double size = outline_size(outline);
    for (const Region& region : outline.regions) {
      area += signed_area(region.outer);
      for (const Ring& hole : region.holes) area += signed_area(hole);
    }
    longest_squared_ = std::pow(options.coarseness, 2) * area;
    const double sine = std::sin(options.angle * std::numbers::pi / 180.0);
    ratio_squared_ = 0.25 / (sine * sine);  // (R / shortest edge)² = 1 / (2 sin angle)²
    shortest_squared_ = std::pow(kShortest * size, 2);
    for (const Ring& ring : joined_rings(outline, kSameCorner * size)) insert(ring);
    if (triangulation_.dimension() < 2)
      throw std::invalid_argument("outline: all its corners are on one line");
    mark_sharp_corners();
    mark_regions(outline);
  }

  TriangleMesh run() {
    for (Edge edge : triangulation_.finite_edges()) watch(edge);
    for (Face face : triangulation_.finite_face_handles()) watch(face);
    while (true) {
      if (!edges_.empty()) {
        const auto [a, b] = edges_.front();
        edges_.pop_front();
        Face face;
        int i = 0;
        if (triangulation_.is_edge(a, b, face, i) && face->is_constrained(i) &&
            encroached({face, i}))
          split({face, i});
      } else if (!forced_.empty()) {
        const auto [a, b] = forced_.front();
        forced_.pop_front();
        Face face;
        int i = 0;
        if (triangulation_.is_edge(a, b, face, i) && face->is_constrained(i)) split({face, i});
      } else if (!faces_.empty()) {
        const auto [a, b, c] = faces_.front();
        faces_.pop_front();
        Face face;
        if (triangulation_.is_face(a, b, c, face) && bad(face)) improve(face);
      } else {
        break;
      }
    }
    return mesh();
  }

 private:
  void insert(const Ring& ring) {
    std::vector<Vertex> corners;
    Face hint;
    for (const auto& p : ring) {
      corners.push_back(triangulation_.insert(point(p), hint));
      hint = corners.back()->face();
    }
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (const Vertex a = corners[i], b = corners[(i + 1) % ring.size()]; a != b) {
        triangulation_.insert_constraint(a, b);
        given_.insert(std::minmax(a, b));
      }
  }

  void mark_sharp_corners() {
    for (Vertex v : triangulation_.finite_vertex_handles()) {
      std::vector<Kernel::Vector_2> out;
      auto edge = triangulation_.incident_edges(v), end = edge;
      do {
        if (triangulation_.is_infinite(*edge) || !edge->first->is_constrained(edge->second))
          continue;
        const Vertex a = edge->first->vertex(Triangulation::cw(edge->second)),
                     b = edge->first->vertex(Triangulation::ccw(edge->second));
        out.push_back((a == v ? b : a)->point() - v->point());
      } while (++edge != end);
      for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          if (out[i] * out[j] >
              0.5 * std::sqrt(out[i].squared_length() * out[j].squared_length()) * (1.0 + 1e-9))
            v->info().sharp = true;
    }
  }

  /// Assigns a region to all faces. Constrained edges separate the regions.
  void mark_regions(const Outline& outline) {
    for (Face face : triangulation_.all_face_handles()) face->info() = kUnknown;
    for (Face seed : triangulation_.all_face_handles()) {
      if (seed->info() != kUnknown) continue;
      std::vector<Face> reached = {seed};
      seed->info() = kOutside;
      Face largest;
      double largest_area = 0.0;
      bool infinite = false;
      for (std::size_t i = 0; i < reached.size(); ++i) {
        const Face face = reached[i];
        if (triangulation_.is_infinite(face)) {
          infinite = true;
        } else if (const double area = triangulation_.triangle(face).area(); area > largest_area) {
          largest = face;
          largest_area = area;
        }
        for (int k = 0; k < 3; ++k) {
          const Face next = face->neighbor(k);
          if (face->is_constrained(k) || next->info() != kUnknown) continue;
          next->info() = kOutside;
          reached.push_back(next);
        }
      }
      if (infinite || largest == Face()) continue;
      const Point c = CGAL::centroid(triangulation_.triangle(largest));
      const Eigen::Vector2d middle(c.x(), c.y());
      for (std::size_t r = 0; r < outline.regions.size(); ++r) {
        const Region& region = outline.regions[r];
        if (!contains(region.outer, middle) ||
            std::ranges::any_of(region.holes,
                                [&](const Ring& hole) { return contains(hole, middle); }))
          continue;
        for (Face face : reached) face->info() = static_cast<int>(r);
      }
    }
  }

  bool inside(Face face) const { return !triangulation_.is_infinite(face) && face->info() >= 0; }

  std::pair<Vertex, Vertex> ends(const Edge& edge) const {
    return {edge.first->vertex(Triangulation::cw(edge.second)),
            edge.first->vertex(Triangulation::ccw(edge.second))};
  }

  bool too_short(const Edge& edge) const {
    const auto [a, b] = ends(edge);
    return CGAL::squared_distance(a->point(), b->point()) < shortest_squared_;
  }

  bool encroaches(const Edge& edge, const Point& p) const {
    const auto [a, b] = ends(edge);
    return CGAL::angle(a->point(), p, b->point()) == CGAL::OBTUSE;
  }

  /// The edge of the outline that contains the constrained edge a → b.
  std::pair<Vertex, Vertex> given_edge(Vertex a, Vertex b) const {
    if (const auto found = on_.find(a); found != on_.end()) return found->second;
    if (const auto found = on_.find(b); found != on_.end()) return found->second;
    return {a, b};
  }

  /// True if p and q lie on two edges that meet at a sharp corner. A new point between p and q
  /// would not widen the angle of this corner.
  bool across_a_sharp_corner(Vertex p, Vertex q) const {
    const auto reaches = [&](Vertex v, Vertex apex) {
      const auto found = on_.find(v);
      return found == on_.end() ? given_.contains(std::minmax(v, apex))
                                : found->second.first == apex || found->second.second == apex;
    };
    for (const Vertex v : {p, q}) {
      const auto found = on_.find(v);
      if (found == on_.end()) continue;
      for (const Vertex apex : {found->second.first, found->second.second})
        if (apex->info().sharp && reaches(v == p ? q : p, apex)) return true;
    }
    return false;
  }

  /// True if the diametral circle of the edge contains the opposite corner of an adjacent triangle.
  bool encroached(const Edge& edge) const {
    if (too_short(edge)) return false;
    const Edge mirror = triangulation_.mirror_edge(edge);
    return (inside(edge.first) && encroaches(edge, edge.first->vertex(edge.second)->point())) ||
           (inside(mirror.first) &&
            encroaches(mirror, mirror.first->vertex(mirror.second)->point()));
  }

  bool bad(Face face) const {
    if (!inside(face)) return false;
    const Point &a = face->vertex(0)->point(), &b = face->vertex(1)->point(),
                &c = face->vertex(2)->point();
    const double sides[3] = {CGAL::squared_distance(b, c), CGAL::squared_distance(c, a),
                             CGAL::squared_distance(a, b)};
    const auto [shortest, longest] = std::minmax_element(sides, sides + 3);
    if (*longest > longest_squared_) return true;
    if (*shortest < shortest_squared_) return false;
    // No refinement removes the angles at a sharp corner, or those of triangles across this corner.
    const auto opposite = static_cast<int>(shortest - sides);
    if (face->vertex(opposite)->info().sharp) return false;
    if (face->vertex((opposite + 1) % 3)->info().sharp ||
        face->vertex((opposite + 2) % 3)->info().sharp)
      return false;
    if (across_a_sharp_corner(face->vertex((opposite + 1) % 3), face->vertex((opposite + 2) % 3)))
      return false;
    const double area = triangulation_.triangle(face).area();
    return sides[0] * sides[1] * sides[2] > 16.0 * area * area * ratio_squared_ * *shortest;
  }

  void watch(const Edge& edge) {
    if (triangulation_.is_infinite(edge) || !edge.first->is_constrained(edge.second)) return;
    if (encroached(edge)) edges_.push_back(ends(edge));
  }

  void watch(Face face) {
    if (bad(face)) faces_.push_back({face->vertex(0), face->vertex(1), face->vertex(2)});
  }

  void watch_around(Vertex v) {
    auto face = triangulation_.incident_faces(v), end = face;
    do {
      watch(face);
      for (int i = 0; i < 3; ++i) watch(Edge(face, i));
    } while (++face != end);
    if (static_cast<int>(triangulation_.number_of_vertices()) > options_.most_points)
      throw std::invalid_argument("outline: needs more than " +
                                  std::to_string(options_.most_points) +
                                  " points to mesh, the limit most_points; remove small details");
  }

  void split(Edge edge) {
    if (triangulation_.is_infinite(edge.first)) edge = triangulation_.mirror_edge(edge);
    const auto [a, b] = ends(edge);
    const int this_side = edge.first->info(),
              that_side = triangulation_.mirror_edge(edge).first->info();
    const Point pa = a->point(), pb = b->point();
    double share = 0.5;
    if (a->info().sharp != b->info().sharp) {
      const double length = std::sqrt(CGAL::squared_distance(pa, pb));
      const double shell = std::exp2(std::round(std::log2(0.5 * length)));
      share = (a->info().sharp ? shell : length - shell) / length;
    }
    const Point p(pa.x() + share * (pb.x() - pa.x()), pa.y() + share * (pb.y() - pa.y()));
    const auto side = CGAL::orientation(pa, pb, edge.first->vertex(edge.second)->point());
    const auto given = given_edge(a, b);
    const Vertex v = triangulation_.insert(p, Triangulation::EDGE, edge.first, edge.second);
    on_.emplace(v, given);
    auto face = triangulation_.incident_faces(v), end = face;
    do {
      face->info() = kOutside;
      if (triangulation_.is_infinite(face)) continue;
      const int i = face->index(v);
      Vertex third = face->vertex(Triangulation::cw(i));
      if (third == a || third == b) third = face->vertex(Triangulation::ccw(i));
      face->info() = CGAL::orientation(pa, pb, third->point()) == side ? this_side : that_side;
    } while (++face != end);
    watch_around(v);
  }

  /// Steps from `start` to the face that contains `target`, or to a constrained edge in between.
  Face walk(Face start, const Point& target, std::optional<Edge>& in_the_way) const {
    const Point from = CGAL::centroid(triangulation_.triangle(start));
    Face face = start, before;
    while (true) {
      Face next;
      for (int i = 0; i < 3 && next == Face(); ++i) {
        if (face->neighbor(i) == before) continue;
        const Point &u = face->vertex(Triangulation::ccw(i))->point(),
                    &w = face->vertex(Triangulation::cw(i))->point();
        // The face lies to the left of u → w.
        if (CGAL::orientation(u, w, target) != CGAL::RIGHT_TURN) continue;
        if (CGAL::orientation(from, target, u) == CGAL::LEFT_TURN ||
            CGAL::orientation(from, target, w) == CGAL::RIGHT_TURN)
          continue;
        if (face->is_constrained(i)) {
          in_the_way = Edge(face, i);
          return face;
        }
        next = face->neighbor(i);
      }
      if (next == Face()) return face;
      before = face;
      face = next;
    }
  }

  void improve(Face face) {
    const std::array<Vertex, 3> corners = {face->vertex(0), face->vertex(1), face->vertex(2)};
    const Point centre = CGAL::circumcenter(triangulation_.triangle(face));
    std::optional<Edge> in_the_way;
    const Face target = walk(face, centre, in_the_way);
    if (in_the_way) {
      if (too_short(*in_the_way)) return;
      forced_.push_back(ends(*in_the_way));
      faces_.push_back(corners);
      return;
    }
    std::vector<Edge> around;
    triangulation_.get_boundary_of_conflicts(centre, std::back_inserter(around), target);
    const std::size_t queued = forced_.size();
    for (const Edge& edge : around)
      if (edge.first->is_constrained(edge.second) && encroaches(edge, centre) && !too_short(edge))
        forced_.push_back(ends(edge));
    if (forced_.size() > queued) {
      faces_.push_back(corners);
      return;
    }
    const int region = face->info();
    const std::size_t known = triangulation_.number_of_vertices();
    const Vertex v = triangulation_.insert(centre, target);
    if (triangulation_.number_of_vertices() == known)
      return;  // an existing corner, within rounding
    auto next = triangulation_.incident_faces(v), end = next;
    do next->info() = region;
    while (++next != end);
    watch_around(v);
  }

  TriangleMesh mesh() const {
    TriangleMesh result;
    for (Face face : triangulation_.finite_face_handles()) {
      if (!inside(face)) continue;
      std::array<int, 3> corners{};
      for (int i = 0; i < 3; ++i) {
        const Vertex v = face->vertex(i);
        if (v->info().number < 0) {
          v->info().number = static_cast<int>(result.points.size());
          result.points.emplace_back(v->point().x(), v->point().y());
        }
        corners[static_cast<std::size_t>(i)] = v->info().number;
      }
      result.triangles.push_back(corners);
      result.regions.push_back(face->info());
    }
    return result;
  }

  SectionMeshOptions options_;
  Triangulation triangulation_;
  double longest_squared_ = 0.0, shortest_squared_ = 0.0, ratio_squared_ = 0.0;
  std::set<std::pair<Vertex, Vertex>> given_;       ///< the outline's edges
  std::map<Vertex, std::pair<Vertex, Vertex>> on_;  ///< the edge on which each point was inserted
  std::deque<std::pair<Vertex, Vertex>> edges_, forced_;  ///< to split: if encroached; always
  std::deque<std::array<Vertex, 3>> faces_;               ///< faces to check for bad angles
};

}  // namespace

TriangleMesh section_mesh(const Outline& outline, const SectionMeshOptions& options) {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) + ": must be " +
                                allowed);
  };
  if (!(options.coarseness > 0.0)) refuse("coarseness", options.coarseness, "positive");
  if (!(options.angle > 0.0 && options.angle <= 30.0))
    refuse("angle", options.angle, "above 0 and at most 30 degrees");
  if (options.most_points < 3) refuse("most_points", options.most_points, "at least 3");
  TriangleMesh mesh = Refinement(checked(outline), options).run();
  if (const int count = pieces(mesh); count != 1)
    throw std::invalid_argument("outline: consists of " + std::to_string(count) +
                                " unconnected parts; the regions of a section must share edges");
  return mesh;
}

}  // namespace wheeltap::fem
