#include "io/drawings/dxf.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

/// Largest distance of two ends that are joined, relative to the drawing's size.
constexpr double kJoin = 1e-6;

struct Pair {
  int code;
  std::string value;
  int line;  ///< line of the value, from 1
};

struct Entity {
  std::string type;
  int line;
  std::vector<Pair> pairs;
};

[[noreturn]] void fail(const std::filesystem::path& name, int line, const std::string& reason) {
  throw FileError(FileError::Kind::corrupt, name, {.line = line}, reason);
}

std::vector<Pair> pairs_of(const std::string& bytes, const std::filesystem::path& name) {
  if (bytes.starts_with("AutoCAD Binary DXF"))
    throw FileError(FileError::Kind::foreign, name, "is a binary DXF; save it as ASCII DXF");
  std::vector<Pair> pairs;
  std::size_t at = 0;
  int line = 0;
  const auto next = [&]() -> std::optional<std::string> {
    if (at >= bytes.size()) return std::nullopt;
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string text(trimmed(std::string_view(bytes).substr(at, end - at)));
    at = end + 1;
    ++line;
    return text;
  };
  while (const auto code = next()) {
    if (code->empty() && at >= bytes.size()) break;
    const auto number = parse_number(*code);
    if (!number || *number != std::floor(*number) || std::abs(*number) > 1e5) {
      if (pairs.empty())
        throw FileError(FileError::Kind::foreign, name, "does not begin like a DXF file");
      fail(name, line, "'" + code->substr(0, 40) + "': must be a group code, a whole number");
    }
    const auto value = next();
    if (!value) fail(name, line, "the file ends within a pair");
    pairs.push_back({static_cast<int>(*number), *value, line});
  }
  return pairs;
}

double number_of(const Pair& pair, const std::filesystem::path& name) {
  const auto number = parse_number(pair.value);
  if (!number || !std::isfinite(*number))
    fail(name, pair.line, "'" + pair.value.substr(0, 40) + "': must be a number");
  return *number;
}

/// Metres per unit of $INSUNITS.
double drawing_unit(int code) {
  static const std::map<int, double> units = {{1, 0.0254}, {2, 0.3048},  {4, 1e-3},    {5, 1e-2},
                                              {6, 1.0},    {8, 2.54e-8}, {9, 2.54e-5}, {10, 0.9144},
                                              {13, 1e-6},  {14, 0.1}};
  const auto found = units.find(code);
  return found == units.end() ? 0.0 : found->second;
}

/// An open chain of edges.
struct Chain {
  ClosedPath corners;  ///< the last corner has no edge
  int line;
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::filesystem::path& name) : name_(name) {
    std::string section;
    bool names_section = false, header_units = false;
    int last = 0;
    for (const Pair& pair : pairs_of(bytes, name)) {
      if (pair.code == 0) {
        names_section = pair.value == "SECTION";
        if (pair.value == "ENDSEC") section.clear();
        if (section == "ENTITIES") entities_.push_back({pair.value, pair.line, {}});
      } else if (names_section && pair.code == 2) {
        section = pair.value;
        names_section = false;
      } else if (section == "HEADER" && pair.code == 9) {
        header_units = pair.value == "$INSUNITS";
      } else if (header_units && pair.code == 70) {
        drawing_.unit = drawing_unit(static_cast<int>(number_of(pair, name)));
        header_units = false;
      } else if (section == "ENTITIES" && !entities_.empty()) {
        entities_.back().pairs.push_back(pair);
      }
      last = pair.line;
    }
    if (section == "ENTITIES")
      fail(name, last, "the file is truncated: its section ENTITIES does not end with ENDSEC");
  }

  Drawing run() {
    for (std::size_t i = 0; i < entities_.size(); ++i) {
      const Entity& e = entities_[i];
      if (value(e, 67, 0.0) == 1.0) continue;  // on the layout sheet, not in the model
      if (e.type == "LWPOLYLINE") {
        polyline(e, corners(e, mirrored(e)));
      } else if (e.type == "POLYLINE") {
        ClosedPath path;
        for (std::size_t k = i + 1; k < entities_.size() && entities_[k].type == "VERTEX"; ++k) {
          if (static_cast<int>(value(entities_[k], 70, 0.0)) & 16)
            continue;  // control point of a spline
          const ClosedPath one = corners(entities_[k], mirrored(e));
          path.insert(path.end(), one.begin(), one.end());
        }
        polyline(e, path);
      } else if (e.type == "LINE") {
        chains_.push_back({{{need(e, 10), need(e, 20)}, {need(e, 11), need(e, 21)}}, e.line});
      } else if (e.type == "ARC" || e.type == "CIRCLE") {
        round(e);
      } else if (e.type == "SPLINE" || e.type == "ELLIPSE" || e.type == "INSERT") {
        fail(name_, e.line,
             e.type + ": is not read; convert it to polylines, lines and arcs (explode it)");
      }
    }
    join();
    if (drawing_.outlines.empty())
      throw FileError(
          FileError::Kind::corrupt, name_,
          "holds no closed LWPOLYLINE, POLYLINE, CIRCLE, or closed path of LINEs and ARCs");
    return std::move(drawing_);
  }

 private:
  double value(const Entity& e, int code, double otherwise) const {
    const auto found = std::ranges::find(e.pairs, code, &Pair::code);
    return found == e.pairs.end() ? otherwise : number_of(*found, name_);
  }

  double need(const Entity& e, int code) const {
    if (std::ranges::find(e.pairs, code, &Pair::code) == e.pairs.end())
      fail(name_, e.line, e.type + ": group " + std::to_string(code) + " is missing");
    return value(e, code, 0.0);
  }

  /// True if the entity's plane is seen from behind.
  bool mirrored(const Entity& e) const { return value(e, 230, 1.0) < 0.0; }

  /// The corners of an entity. The vertices of a POLYLINE are mirrored if the POLYLINE is.
  ClosedPath corners(const Entity& e, bool is_mirrored) const {
    ClosedPath path;
    const double sign = is_mirrored ? -1.0 : 1.0;
    bool complete = true;
    for (const Pair& pair : e.pairs) {
      if (pair.code == 10) {
        if (!complete) fail(name_, pair.line, e.type + ": a corner has no y, group 20");
        path.push_back({sign * number_of(pair, name_), 0.0});
        complete = false;
      }
      if (pair.code == 20 && !path.empty()) {
        path.back().y = number_of(pair, name_);
        complete = true;
      }
      if (pair.code == 42 && !path.empty()) path.back().bulge = sign * number_of(pair, name_);
    }
    if (!complete) fail(name_, e.line, e.type + ": a corner has no y, group 20");
    return path;
  }

  void polyline(const Entity& e, const ClosedPath& path) {
    if (path.size() < 2) return;
    if (static_cast<int>(value(e, 70, 0.0)) & 1)
      drawing_.outlines.push_back(path);
    else
      chains_.push_back({path, e.line});
  }

  void round(const Entity& e) {
    const double sign = mirrored(e) ? -1.0 : 1.0;
    const double x = need(e, 10), y = need(e, 20), r = need(e, 40);
    if (!(r > 0.0)) fail(name_, e.line, e.type + ": its radius must be positive");
    if (e.type == "CIRCLE") {
      drawing_.outlines.push_back({{sign * x - r, y, 1.0}, {sign * x + r, y, 1.0}});
      return;
    }
    const double degree = std::numbers::pi / 180.0;
    const double from = need(e, 50) * degree, to = need(e, 51) * degree;
    double turn = std::fmod(to - from, 2.0 * std::numbers::pi);
    if (turn <= 0.0) turn += 2.0 * std::numbers::pi;
    // Use two edges, because the bulge of a full circle would be infinite.
    const auto corner = [&](double angle, double bulge) {
      return PathCorner{sign * (x + r * std::cos(angle)), y + r * std::sin(angle), sign * bulge};
    };
    const double bulge = std::tan(turn / 8.0);
    chains_.push_back(
        {{corner(from, bulge), corner(from + 0.5 * turn, bulge), corner(from + turn, 0.0)},
         e.line});
  }

  /// Joins chains end to end.
  void join() {
    constexpr double far = std::numeric_limits<double>::infinity();
    double low_x = far, high_x = -far, low_y = far, high_y = -far;
    for (const Chain& chain : chains_)
      for (const PathCorner& c : chain.corners) {
        low_x = std::min(low_x, c.x), high_x = std::max(high_x, c.x);
        low_y = std::min(low_y, c.y), high_y = std::max(high_y, c.y);
      }
    const double near = kJoin * std::max(high_x - low_x, high_y - low_y);
    const auto apart = [](const PathCorner& a, const PathCorner& b) {
      return std::hypot(a.x - b.x, a.y - b.y);
    };
    // Both ends of every chain, sorted by x.
    struct End {
      double x;
      std::size_t chain;
      bool back;
    };
    std::vector<End> ends;
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      ends.push_back({chains_[k].corners.front().x, k, false});
      ends.push_back({chains_[k].corners.back().x, k, true});
    }
    std::ranges::stable_sort(ends, {}, &End::x);
    std::vector<bool> used(chains_.size(), false);
    for (std::size_t start = 0; start < chains_.size(); ++start) {
      if (used[start]) continue;
      used[start] = true;
      ClosedPath path = chains_[start].corners;
      while (path.size() < 3 || apart(path.front(), path.back()) > near) {
        std::size_t best = chains_.size();
        bool turned = false;
        double gap = far;
        for (auto end = std::ranges::lower_bound(ends, path.back().x - near, {}, &End::x);
             end != ends.end() && end->x <= path.back().x + near; ++end) {
          if (used[end->chain]) continue;
          const ClosedPath& c = chains_[end->chain].corners;
          const double distance = apart(path.back(), end->back ? c.back() : c.front());
          if (distance < gap) best = end->chain, turned = end->back, gap = distance;
        }
        if (gap > near) {
          std::string where = std::to_string(path.back().x) + ", " + std::to_string(path.back().y);
          fail(name_, chains_[start].line,
               "the edges that begin here do not close: no edge continues from (" + where + ")");
        }
        used[best] = true;
        append(path, chains_[best].corners, turned);
      }
      path.pop_back();
      drawing_.outlines.push_back(std::move(path));
    }
  }

  static void append(ClosedPath& path, ClosedPath next, bool turned) {
    if (turned) {
      std::ranges::reverse(next);
      // After the reversal, the bulge of an edge belongs to its other end, with opposite sign.
      for (std::size_t i = 0; i + 1 < next.size(); ++i) next[i].bulge = -next[i + 1].bulge;
    }
    path.back().bulge = next.front().bulge;
    path.insert(path.end(), next.begin() + 1, next.end());
  }

  std::filesystem::path name_;
  std::vector<Entity> entities_;
  std::vector<Chain> chains_;
  Drawing drawing_;
};

}  // namespace

Drawing parse_dxf(const std::string& bytes, const std::filesystem::path& name) {
  return Reader(bytes, name).run();
}

double metres(const std::string& unit) {
  static const std::map<std::string, double> units = {
      {"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 0.0254}, {"ft", 0.3048}};
  const auto found = units.find(unit);
  return found == units.end() ? 0.0 : found->second;
}

}  // namespace wheeltap::io
