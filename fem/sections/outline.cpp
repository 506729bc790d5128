#include "fem/sections/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {
namespace {

using Point = Eigen::Vector2d;

std::string text(double value) {
  std::ostringstream out;
  out.precision(12);
  out << value;
  return out.str();
}

std::string text(const Point& p) {
  return "(" + text(p.x()) + ", " + text(p.y()) + ")";
}

/// Name of a faulty part: "regions[0].holes[1][4]".
std::string text(const OutlinePlace& place) {
  static constexpr const char* kParts[] = {"",         ".outer",   ".holes",
                                           ".modulus", ".poisson", ".density"};
  const auto at = [](std::size_t i) { return "[" + std::to_string(i) + "]"; };
  return "regions" + at(place.region) + kParts[static_cast<int>(place.part)] +
         (place.part == OutlinePlace::Part::hole ? at(place.hole) : "") +
         (place.corner ? at(*place.corner) : "");
}

[[noreturn]] void refuse_outline(const OutlinePlace& where, const std::string& what) {
  throw OutlineError(where, text(where), what);
}

double cross_product(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The side of a → b on which p lies; 0 if p lies on the line within rounding.
int side(const Point& a, const Point& b, const Point& p) {
  const double left = (b.x() - a.x()) * (p.y() - a.y()), right = (b.y() - a.y()) * (p.x() - a.x());
  const double difference = left - right;
  if (std::abs(difference) <= 4e-16 * (std::abs(left) + std::abs(right))) return 0;
  return difference > 0.0 ? 1 : -1;
}

bool within_box(const Point& a, const Point& b, const Point& p) {
  return (p.array() >= a.array().min(b.array())).all() &&
         (p.array() <= a.array().max(b.array())).all();
}

bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int ca = side(a, b, c), da = side(a, b, d), ac = side(c, d, a), bc = side(c, d, b);
  if (ca * da < 0 && ac * bc < 0) return true;
  return (ca == 0 && within_box(a, b, c)) || (da == 0 && within_box(a, b, d)) ||
         (ac == 0 && within_box(c, d, a)) || (bc == 0 && within_box(c, d, b));
}

/// True if two segments cross at a point inside both, farther than `near` from all four ends.
bool cross_properly(const Point& a, const Point& b, const Point& c, const Point& d, double near) {
  const auto height = [](const Point& p, const Point& q, const Point& r) {
    return cross_product(q - p, r - p) / (q - p).norm();
  };
  const double hc = height(a, b, c), hd = height(a, b, d), ha = height(c, d, a),
               hb = height(c, d, b);
  return hc * hd < 0.0 && ha * hb < 0.0 &&
         std::min({std::abs(ha), std::abs(hb), std::abs(hc), std::abs(hd)}) > near;
}

struct Segment {
  Point a, b;
  std::size_t ring, index, count;  ///< edge `index` of `count` of the ring
  double low() const { return std::min(a.x(), b.x()); }
  double high() const { return std::max(a.x(), b.x()); }
};

std::vector<Segment> segments_of(std::span<const Ring* const> rings) {
  std::vector<Segment> all;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const Ring& ring = *rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i)
      all.push_back({ring[i], ring[(i + 1) % ring.size()], r, i, ring.size()});
  }
  std::ranges::sort(all, {}, &Segment::low);
  return all;
}

/// Calls `visit` for all pairs whose extents along y overlap.
template <class Visit>
void each_pair(const std::vector<Segment>& all, const Visit& visit) {
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && all[j].low() <= all[i].high(); ++j)
      visit(all[i], all[j]);
}

void refuse_infinite(const Ring& ring, OutlinePlace place) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    place.corner = i;
    if (!ring[i].allFinite()) refuse_outline(place, text(ring[i]) + ": must be finite");
  }
}

/// The ring without corners whose distance from the previous corner is below `near`.
Ring cleaned(const Ring& given, const OutlinePlace& name, double near) {
  const auto same = [&](const Point& a, const Point& b) { return (a - b).norm() <= near; };
  Ring ring;
  for (const Point& p : given)
    if (ring.empty() || !same(ring.back(), p)) ring.push_back(p);
  while (ring.size() > 1 && same(ring.back(), ring.front())) ring.pop_back();
  const auto exact = std::ranges::count_if(given, [&](const Point& p) { return p != given[0]; });
  if (ring.size() < 3 && exact > 2)
    refuse_outline(name,
                   "has corners closer together than a billionth of the outline's size: fewer than "
                   "3 different corners remain, but a polygon has at least 3");
  if (ring.size() < 3)
    refuse_outline(name,
                   std::to_string(ring.size()) + " different corners: a polygon has at least 3");
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()], &c = ring[(i + 2) % ring.size()];
    if (side(a, b, c) == 0 && (b - a).dot(c - b) < 0.0)
      refuse_outline(name, "turns back onto itself and encloses no area there, at " + text(b));
  }
  return ring;
}

/// Makes the ring counter-clockwise or clockwise.
void orient(Ring& ring, const OutlinePlace& name, bool counter_clockwise) {
  double size = 0.0;
  for (const Point& p : ring) size = std::max(size, (p - ring[0]).norm());
  const double area = signed_area(ring);
  if (std::abs(area) <= 1e-14 * size * size)
    refuse_outline(name, "its area is " + text(area) + " m2: must not be 0");
  if ((area > 0.0) != counter_clockwise) std::ranges::reverse(ring);
}

void refuse_own_crossings(const std::vector<const Ring*>& rings,
                          const std::vector<OutlinePlace>& names) {
  each_pair(segments_of(rings), [&](const Segment& s, const Segment& t) {
    const bool same = s.ring == t.ring;
    if (same && ((s.index + 1) % s.count == t.index || (t.index + 1) % t.count == s.index)) return;
    if (!meet(s.a, s.b, t.a, t.b)) return;
    const std::string edges = "the edge from " + text(s.a) + " to " + text(s.b) +
                              " meets the edge from " + text(t.a) + " to " + text(t.b);
    if (same) refuse_outline(names[s.ring], "crosses or touches itself: " + edges);
    const auto [low, high] = std::minmax(s.ring, t.ring);
    refuse_outline(names[high],
                   (low == 0 ? "a hole must lie inside the outer polygon: "
                             : "a hole must not touch another (" + text(names[low]) + "): ") +
                       edges);
  });
}

double distance(const Point& p, const Point& a, const Point& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

double distance(const Point& p, const Region& region) {
  double nearest = INFINITY;
  const auto visit = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i)
      nearest = std::min(nearest, distance(p, ring[i], ring[(i + 1) % ring.size()]));
  };
  visit(region.outer);
  for (const Ring& hole : region.holes) visit(hole);
  return nearest;
}

bool inside(const Region& region, const Point& p) {
  return contains(region.outer, p) &&
         std::ranges::none_of(region.holes, [&](const Ring& hole) { return contains(hole, p); });
}

/// Points at the distance `by` inside the edges of the region. Corners of `other` divide an edge
/// into pieces; each piece has one point.
std::vector<Point> just_inside(const Region& region, const Region& other, double near, double by) {
  std::vector<Point> points;
  const auto visit = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const Point along = b - a, left = Point(-along.y(), along.x()).normalized();
      std::vector<double> cuts = {0.0, 1.0};
      const auto cut = [&](const Ring& corners) {
        for (const Point& c : corners)
          if (distance(c, a, b) <= near) cuts.push_back((c - a).dot(along) / along.squaredNorm());
      };
      cut(other.outer);
      for (const Ring& hole : other.holes) cut(hole);
      std::ranges::sort(cuts);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
        if ((cuts[k + 1] - cuts[k]) * along.norm() > 2.0 * by)
          points.emplace_back(a + 0.5 * (cuts[k] + cuts[k + 1]) * along + by * left);
    }
  };
  visit(region.outer);
  for (const Ring& hole : region.holes) visit(hole);
  return points;
}

void refuse_overlap(const Outline& outline) {
  std::vector<const Ring*> rings;
  std::vector<std::size_t> owner;
  for (std::size_t r = 0; r < outline.regions.size(); ++r) {
    rings.push_back(&outline.regions[r].outer);
    for (const Ring& hole : outline.regions[r].holes) rings.push_back(&hole);
    owner.resize(rings.size(), r);
  }
  const double near = kSameCorner * outline_size(outline);
  each_pair(segments_of(rings), [&](const Segment& s, const Segment& t) {
    const std::size_t p = owner[s.ring], q = owner[t.ring];
    if (p != q && cross_properly(s.a, s.b, t.a, t.b, near))
      refuse_outline({std::max(p, q)}, "overlaps " + text(OutlinePlace{std::min(p, q)}) +
                                           ": the edge from " + text(s.a) + " to " + text(s.b) +
                                           " crosses the edge from " + text(t.a) + " to " +
                                           text(t.b));
  });
  for (std::size_t p = 0; p < outline.regions.size(); ++p)
    for (std::size_t q = 0; q < outline.regions.size(); ++q) {
      if (p == q) continue;
      for (const Point& point :
           just_inside(outline.regions[p], outline.regions[q], near, 100.0 * near))
        if (inside(outline.regions[q], point) && distance(point, outline.regions[q]) > near)
          refuse_outline({std::max(p, q)}, "overlaps " + text(OutlinePlace{std::min(p, q)}) + ": " +
                                               text(point) + " lies in both");
    }
}

}  // namespace

double outline_size(const Outline& outline) {
  const Point* first = nullptr;
  double size = 0.0;
  for (const Region& region : outline.regions)
    for (const Point& p : region.outer) {
      if (first == nullptr) first = &p;
      size = std::max(size, (p - *first).norm());
    }
  return size;
}

double signed_area(std::span<const Point> ring) {
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    twice += cross_product(ring[i] - ring[0], ring[i + 1] - ring[0]);
  return 0.5 * twice;
}

bool contains(std::span<const Point> ring, const Point& point) {
  bool odd = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if ((cross_product(b - a, point - a) > 0.0) == (b.y() > a.y())) odd = !odd;
  }
  return odd;
}

Outline checked(const Outline& outline) {
  using Part = OutlinePlace::Part;
  if (outline.regions.empty())
    throw std::invalid_argument("regions: there are none, but a section has at least 1");
  for (std::size_t r = 0; r < outline.regions.size(); ++r) {
    refuse_infinite(outline.regions[r].outer, {r, Part::outer});
    for (std::size_t h = 0; h < outline.regions[r].holes.size(); ++h)
      refuse_infinite(outline.regions[r].holes[h], {r, Part::hole, h});
  }
  const double near = kSameCorner * outline_size(outline);
  Outline result;
  for (std::size_t r = 0; r < outline.regions.size(); ++r) {
    const Region& given = outline.regions[r];
    Region region = given;
    if (!(given.modulus > 0.0 && std::isfinite(given.modulus)))
      refuse_outline({r, Part::modulus}, text(given.modulus) + ": must be positive");
    if (!(given.density > 0.0 && std::isfinite(given.density)))
      refuse_outline({r, Part::density}, text(given.density) + ": must be positive");
    if (!(given.poisson > -1.0 && given.poisson <= 0.5))
      refuse_outline({r, Part::poisson},
                     text(given.poisson) + ": must be above -1 and at most 0.5");
    std::vector<OutlinePlace> names = {{r, Part::outer}};
    region.outer = cleaned(given.outer, names[0], near);
    for (std::size_t h = 0; h < given.holes.size(); ++h) {
      names.push_back({r, Part::hole, h});
      region.holes[h] = cleaned(given.holes[h], names.back(), near);
    }
    std::vector<const Ring*> rings = {&region.outer};
    for (const Ring& hole : region.holes) rings.push_back(&hole);
    refuse_own_crossings(rings, names);
    orient(region.outer, names[0], true);
    for (std::size_t h = 0; h < region.holes.size(); ++h)
      orient(region.holes[h], names[h + 1], false);
    for (std::size_t h = 0; h < region.holes.size(); ++h) {
      const Point& p = region.holes[h][0];
      if (!contains(region.outer, p))
        refuse_outline(names[h + 1], "lies outside the outer polygon, e.g. " + text(p));
      for (std::size_t other = 0; other < region.holes.size(); ++other)
        if (other != h && contains(region.holes[other], p))
          refuse_outline(names[h + 1],
                         "lies inside " + text(names[other + 1]) + ", e.g. " + text(p));
    }
    result.regions.push_back(std::move(region));
  }
  refuse_overlap(result);
  return result;
}

std::vector<Region> nested(const std::vector<Ring>& rings) {
  std::vector<std::vector<std::size_t>> around(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i)
    for (std::size_t k = 0; k < rings.size(); ++k)
      if (k != i && !rings[i].empty() && contains(rings[k], rings[i][0])) around[i].push_back(k);
  std::vector<Region> regions;
  std::vector<std::size_t> region_of(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i)
    if (around[i].size() % 2 == 0) {
      region_of[i] = regions.size();
      regions.push_back({.outer = rings[i]});
    }
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (around[i].size() % 2 == 0) continue;
    const std::size_t owner =
        *std::ranges::max_element(around[i], {}, [&](std::size_t k) { return around[k].size(); });
    regions[region_of[owner]].holes.push_back(rings[i]);
  }
  return regions;
}

Ring arc(const Point& from, const Point& to, double turn, int per_turn) {
  const double whole = 2.0 * std::numbers::pi;
  if (!(std::abs(turn) > 0.0 && std::abs(turn) < whole))
    throw std::invalid_argument("arc: turn = " + text(turn) +
                                ": must not be 0, and its magnitude must be below 2 pi");
  const Point chord = to - from;
  const double radius = 0.5 * chord.norm() / std::abs(std::sin(0.5 * turn));
  // For a turn below π, the centre lies to the left of the chord, seen from `from`.
  const Point normal(-chord.y(), chord.x());
  const Point centre = from + 0.5 * chord + 0.5 / std::tan(0.5 * turn) * normal;
  const int n = std::max(2, static_cast<int>(std::ceil(std::abs(turn) / whole * per_turn)));
  const double step = turn / n;
  // The radius R of the inner corners follows from ½ r² |turn| = ½ |sin step| ((n - 2) R² + 2 r R).
  const double sine = std::abs(std::sin(step)), sector = radius * radius * std::abs(turn) / sine;
  const double inner = n == 2 ? 0.5 * sector / radius
                              : (-radius + std::sqrt(radius * radius + (n - 2) * sector)) / (n - 2);
  Ring ring = {from};
  const Point start = (from - centre) / radius;
  for (int i = 1; i < n; ++i) {
    const double c = std::cos(i * step), s = std::sin(i * step);
    ring.emplace_back(centre +
                      inner * Point(c * start.x() - s * start.y(), s * start.x() + c * start.y()));
  }
  return ring;
}

Ring circle(const Point& centre, double radius, int corners) {
  const double step = 2.0 * std::numbers::pi / corners;
  const double of_equal_area = radius * std::sqrt(step / std::sin(step));
  Ring ring;
  for (int i = 0; i < corners; ++i)
    ring.emplace_back(centre + of_equal_area * Point(std::cos(i * step), std::sin(i * step)));
  return ring;
}

}  // namespace wheeltap::fem
