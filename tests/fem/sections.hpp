// Outlines for several tests.
#pragma once

#include <cmath>
#include <numbers>

#include "fem/sections/outline.hpp"

namespace wheeltap::fem {

inline Ring rectangle(double y0, double z0, double y1, double z1) {
  return {{y0, z0}, {y1, z0}, {y1, z1}, {y0, z1}};
}

inline Outline of_one(const Ring& outer, double poisson, const std::vector<Ring>& holes = {}) {
  return {{{.outer = outer, .holes = holes, .poisson = poisson}}};
}

/// Web along z, `flange` and `web` between centrelines, all of thickness t; the web's outer face is
/// at y = 0.
inline Ring channel(double flange, double web, double t) {
  const double b = flange + 0.5 * t, h = web + t;
  return {{0, 0}, {b, 0}, {b, t}, {t, t}, {t, h - t}, {b, h - t}, {b, h}, {0, h}};
}

inline Ring angle_section(double short_leg, double long_leg, double t) {
  return {{0, 0}, {short_leg, 0}, {short_leg, t}, {t, t}, {t, long_leg}, {0, long_leg}};
}

/// A strip of thickness t bent to the mean radius r, from angle `first` to `last`.
inline Ring curved_strip(double r, double t, double first, double last, int corners) {
  Ring ring;
  // Chords of equal area, between the inscribed and the circumscribed polygon.
  const double step = (last - first) / corners, stretch = std::sqrt(step / std::sin(step));
  const auto add = [&](double radius, int i) {
    const double angle = first + step * i;
    ring.emplace_back(stretch * radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  };
  for (int i = 0; i <= corners; ++i) add(r + 0.5 * t, i);
  for (int i = corners; i >= 0; --i) add(r - 0.5 * t, i);
  return ring;
}

inline Ring slit_tube(double r, double t, double slit, int corners) {
  const double half = 0.5 * slit / r;
  return curved_strip(r, t, half, 2.0 * std::numbers::pi - half, corners);
}

}  // namespace wheeltap::fem
