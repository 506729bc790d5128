#include "fem/beam/beam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wheeltap::fem {
namespace {

/// Locations closer than this fraction of the length count as equal.
constexpr double kSamePlace = 1e-9;

[[noreturn]] void refuse(const std::string& name, double value, const std::string& allowed) {
  std::ostringstream message;
  message.precision(12);
  message << name << " = " << value << ": " << allowed;
  throw std::invalid_argument(message.str());
}

void require_positive(const std::string& name, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) refuse(name, value, "must be positive and finite");
}

// The solver computes squares and products of these values. Their ratios affect its convergence.
void require_computable(const std::string& name, double value) {
  if (!(value >= 1e-60 && value <= 1e60))
    refuse(name, value, "must be between 1e-60 and 1e60; check the units, which are SI");
}

void require_on_beam(const std::string& name, double x, double length) {
  if (x >= 0.0 && x <= length) return;
  std::ostringstream allowed;
  allowed.precision(12);
  allowed << "must lie on the beam, in [0, " << length << "] m";
  refuse(name, x, allowed.str());
}

}  // namespace

int Beam::element_at(double x) const {
  require_on_beam("location", x, length);
  const double position = x / element_length();
  const double node = std::round(position);
  const bool at_node = std::abs(position - node) * element_length() <= kSamePlace * length;
  return std::min(static_cast<int>(at_node ? node : std::floor(position)), elements - 1);
}

std::vector<Support> named_supports(std::string_view name, double length) {
  const Support pin_left{.at = 0.0, .stiffness = {}};
  const Support pin_right{.at = length, .stiffness = {}};
  const Support clamp_left{.at = 0.0, .rotation = true, .stiffness = {}};
  const Support clamp_right{.at = length, .rotation = true, .stiffness = {}};
  if (name == "simply-supported") return {pin_left, pin_right};
  if (name == "cantilever") return {clamp_left};
  if (name == "clamped-clamped") return {clamp_left, clamp_right};
  if (name == "clamped-pinned") return {clamp_left, pin_right};
  if (name == "free-free") return {};
  throw std::invalid_argument("supports = \"" + std::string(name) +
                              "\": must be simply-supported, cantilever, clamped-clamped, "
                              "clamped-pinned or free-free");
}

bool is_mirror_symmetric(const Beam& beam) {
  // Springs at one place add up, and a rigid support there makes their sum infinite. Two beams are
  // equal if the total stiffness against each motion at each place is equal.
  struct Hold {
    double at;
    bool rotation;
    double stiffness;
  };
  std::vector<Hold> holds;
  for (const Support& s : beam.supports)
    for (const bool rotation : {false, true})
      if (rotation ? s.rotation : s.deflection)
        holds.push_back(
            {s.at, rotation, s.stiffness.value_or(std::numeric_limits<double>::infinity())});
  const double close = kSamePlace * beam.length;
  const auto total = [&](double at, bool rotation) {
    double sum = 0.0;
    for (const Hold& h : holds)
      if (h.rotation == rotation && std::abs(h.at - at) <= close) sum += h.stiffness;
    return sum;
  };
  return std::ranges::all_of(holds, [&](const Hold& h) {
    const double here = total(h.at, h.rotation), there = total(beam.length - h.at, h.rotation);
    return here == there || (std::isfinite(here) && std::abs(here - there) <= 1e-12 * here);
  });
}

void validate(const Beam& beam) {
  require_positive("beam.length", beam.length);
  if (beam.elements < 1) refuse("beam.elements", beam.elements, "must be at least 1");
  require_positive("beam.material.young", beam.material.young);
  const double poisson = beam.material.poisson;
  if (!(poisson > -1.0 && poisson < 0.5))
    refuse("beam.material.poisson", poisson, "must be above -1 and below 0.5");
  require_positive("beam.material.density", beam.material.density);
  require_positive("beam.section.area", beam.section.area);
  require_positive("beam.section.second_moment", beam.section.second_moment);
  require_positive("beam.section.shear_coefficient", beam.section.shear_coefficient);
  const double h = beam.element_length();
  const double shear_modulus = beam.material.young / (2.0 * (1.0 + poisson));
  require_computable("an element's bending stiffness 12 E I / h^3",
                     12.0 * beam.material.young * beam.section.second_moment / (h * h * h));
  require_computable("an element's shear stiffness kappa G A / h",
                     beam.section.shear_coefficient * shear_modulus * beam.section.area / h);
  require_computable("an element's mass density A h",
                     beam.material.density * beam.section.area * h);
  require_computable("an element's length", h);
  for (std::size_t i = 0; i < beam.supports.size(); ++i) {
    const Support& s = beam.supports[i];
    const std::string name = "beam.supports[" + std::to_string(i) + "]";
    require_on_beam(name + ".at", s.at, beam.length);
    if (!s.deflection && !s.rotation)
      throw std::invalid_argument(name + ": must restrain the deflection, the rotation or both");
    if (s.stiffness) {
      require_positive(name + ".stiffness", *s.stiffness);
      require_computable(name + ".stiffness", *s.stiffness);
    }
  }
}

}  // namespace wheeltap::fem
