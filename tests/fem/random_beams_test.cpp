// Compares frequencies of random beams with an independent reference in 113 bits. No mode may be
// missed, and no frequency may differ from that of its mesh by more than 1e-9 or the library's own
// bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>
#include <vector>

#include "beams.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/beam/reanalysis.hpp"
#include "quad_reference.hpp"

namespace wheeltap::fem {
namespace {

constexpr double kAgreement = 1e-9;

struct Case {
  Beam beam;
  Defects defects;
  int modes;
};

class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}

  Case beam() {
    const double length = log_uniform(1e-3, 1e3);
    const int elements = static_cast<int>(log_uniform(1.0, 151.0));
    Beam beam{.length = length,
              .elements = elements,
              .supports = {},
              .material = {.young = log_uniform(1e9, 4e11),
                           .poisson = uniform(0.0, 0.45),
                           .density = log_uniform(300.0, 2e4)},
              .section = {}};
    const double height = chance(0.3) ? 0.006 : length * log_uniform(1e-4, 0.5);
    beam.section = section(Rectangle{.width = height * log_uniform(0.2, 5.0), .height = height},
                           beam.material.poisson);
    const auto which = static_cast<std::size_t>(uniform(0.0, 7.0));
    if (which < std::size(kNamedSupports)) {
      beam.supports = named_supports(kNamedSupports[which], length);
    } else {  // overhanging, on springs, off the nodes
      std::vector<double> used;
      for (int i = static_cast<int>(uniform(1.0, 4.0)); i > 0; --i) {
        Support s{.at = apart(used, beam), .rotation = chance(0.2), .stiffness = {}};
        if (chance(0.6)) s.stiffness = spring(beam, s.rotation);
        beam.supports.push_back(s);
      }
    }
    Defects defects;
    for (int i = static_cast<int>(uniform(0.0, 7.0)); i > 0; --i) {
      const auto e = static_cast<int>(uniform(0.0, elements));
      double reduction = uniform(0.0, 0.999);
      if (chance(0.4)) reduction = 1.0 - log_uniform(1e-3, 1.0);
      if (chance(0.15)) reduction = 0.999;
      defects.damages.push_back({(e + uniform(0.01, 0.99)) * beam.element_length(), reduction});
    }
    if (chance(0.35)) {
      std::vector<double> used;
      for (const Support& s : beam.supports) used.push_back(s.at);
      for (int i = static_cast<int>(uniform(1.0, 4.0)); i > 0; --i) {
        SpringSupport s{.location = apart(used, beam), .rotation = chance(0.3)};
        if (chance(0.5)) s.stiffness = spring(beam, s.rotation);
        defects.supports.push_back(s);
      }
    }
    return {.beam = beam, .defects = defects, .modes = 0};
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }

 private:
  /// A place that is not held yet, at a node or between nodes.
  double apart(std::vector<double>& used, const Beam& beam) {
    for (;;) {
      double at = uniform(0.0, beam.length);
      if (chance(0.3)) at = std::round(at / beam.element_length()) * beam.element_length();
      at = std::min(at, beam.length);
      if (std::all_of(used.begin(), used.end(),
                      [&](double x) { return std::abs(x - at) > 0.02 * beam.length; })) {
        used.push_back(at);
        return at;
      }
    }
  }

  double spring(const Beam& beam, bool rotation) {
    const double l = beam.length;
    const double own =
        beam.material.young * beam.section.second_moment / (rotation ? l : l * l * l);
    return own * log_uniform(1e-6, 1e6);
  }

  std::mt19937_64 generator_;
};

std::string describe(const Case& c) {
  std::ostringstream out;
  out.precision(17);
  const Beam& b = c.beam;
  out << "L " << b.length << ", " << b.elements << " elements, E " << b.material.young << ", nu "
      << b.material.poisson << ", rho " << b.material.density << ", A " << b.section.area << ", I "
      << b.section.second_moment << ", modes " << c.modes << "\n";
  for (const Support& s : b.supports)
    out << "  support " << s.at << (s.deflection ? " w" : "") << (s.rotation ? " θ " : " ")
        << s.stiffness.value_or(INFINITY) << "\n";
  for (const Damage& d : c.defects.damages)
    out << "  damage " << d.location << " " << d.reduction << "\n";
  for (const SpringSupport& s : c.defects.supports)
    out << "  added " << s.location << (s.rotation ? " θ " : " w ") << s.stiffness << "\n";
  return out.str();
}

TEST(RandomBeams, AgreeWithAReferenceIn113Bits) {
  const char* chosen = std::getenv("WHEELTAP_LONG_TESTS");
  const bool full = chosen != nullptr && std::string_view(chosen) == "1";
  const int beams = full ? 2000 : 200;
  Draw draw(7);
  int modes_checked = 0, uncertified = 0, beyond = 0;
  for (int i = 0; i < beams; ++i) {
    Case c = draw.beam();
    QuadReference reference(c.beam, c.defects);
    const int free = 2 * c.beam.nodes() - reference.held();
    if (free < 1) continue;
    // The number of modes requested of the intact beam, minus those that added supports remove.
    c.modes = static_cast<int>(draw.log_uniform(1.0, free + 1));
    if (draw.chance(0.1)) c.modes = 1;
    if (draw.chance(0.05)) c.modes = free;

    SCOPED_TRACE("beam " + std::to_string(i) + "\n" + describe(c));
    const Reanalysis reanalysis(c.beam, c.modes);
    auto workspace = reanalysis.make_workspace();
    std::vector<double> f(static_cast<std::size_t>(c.modes));
    reanalysis.frequencies_hz(c.defects.damages, c.defects.supports, workspace, f);
    const Modes modal = modal_analysis(c.beam, c.defects, {.modes = c.modes});
    uncertified += !modal.certified;

    const int rigid = rigid_body_freedom(c.beam, c.defects.supports);
    const int step = full ? 1 : std::max(1, c.modes / 5);
    for (int mode = 0; mode < c.modes;
         mode += mode + step < c.modes || mode + 1 == c.modes ? step : c.modes - 1 - mode) {
      const double first = f[static_cast<std::size_t>(mode)], second = modal.frequencies_hz[mode];
      if (mode < rigid) {
        EXPECT_EQ(first, 0.0);
        EXPECT_EQ(second, 0.0);
        continue;
      }
      ++modes_checked;
      const double stated =
          reanalysis.error_bound(c.defects.damages, c.defects.supports, first, workspace);
      beyond += stated > kAgreement;
      EXPECT_TRUE(reference.holds(mode, first, std::max(kAgreement, stated)))
          << "beam " << i << ", mode " << mode << ": reanalysis " << first << " is off by "
          << reference.error(mode, first) << "\n"
          << describe(c);
      EXPECT_TRUE(reference.holds(mode, second, kAgreement))
          << "beam " << i << ", mode " << mode << ": modal_analysis " << second << " is off by "
          << reference.error(mode, second) << " (" << modal.solver << ")\n"
          << describe(c);
    }
  }
  std::printf(
      "%d beams, %d modes within %.0e; %d beams not certified, %d modes with a wider bound\n",
      beams, modes_checked, kAgreement, uncertified, beyond);
  EXPECT_LT(beyond, modes_checked / 20);
  EXPECT_EQ(uncertified, 0);
}

}  // namespace
}  // namespace wheeltap::fem
