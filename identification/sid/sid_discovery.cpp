#include "identification/sid/sid_discovery.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

#include "dynamics/link_tension.hpp"
#include "identification/invalid_input.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Law;
using dynamics::LawInfo;
using dynamics::Link;
using dynamics::Side;
using Role = SidChannel::Role;

constexpr double kBand = 0.99;     // share of the displacement's power
constexpr double kCrest = 3.0;     // peak factor of a motion without measured displacement
constexpr double kRunaway = 30.0;  // bound, relative to the record, that no posterior draw reaches
constexpr double kStop = 10.0;     // prior scale of a stop's stiffness relative to that of its link
constexpr double kYieldSpread = 1.0;  // sd of ln yield extension

const LawInfo& info_of(const Law& law) {
  return dynamics::law_infos()[static_cast<std::size_t>(law.kind)];
}

std::string suffix(const Law& law, const Link& link, bool several) {
  std::string out;
  if (info_of(law).one_sided && law.side == Side::closing) out += " closing";
  if (several) out += " " + std::to_string(link.a) + "-" + std::to_string(link.b);
  return out;
}

// ---- motion of links ----------------------------------------------------------------------

// RMS motion of a mass or link, relative to the base; unknown values are 0.
struct Motion {
  double displacement = 0.0, velocity = 0.0, acceleration = 0.0;  // RMS
  double highest = 0.0, lowest = 0.0;                             // extremes of the displacement
  double band_hz = 0.0;

  [[nodiscard]] bool known() const { return displacement > 0.0; }
};

struct Series {
  dynamics::Quantity quantity = dynamics::Quantity::displacement;
  std::vector<double> samples = {};  // SI
};

// Every `stride`-th sample in SI units. Raw values if the scale is unknown; if the offset is
// unknown, the mean is removed.
std::vector<double> discovery_in_si(const dynamics::Signal& signal, std::size_t stride = 1) {
  std::vector<double> out;
  const double scale = signal.scale.is_constant() ? signal.scale.value : 1.0;
  const double offset = signal.offset.is_constant() ? signal.offset.value : 0.0;
  for (std::size_t n = 0; n < signal.samples.size(); n += stride) {
    out.push_back(scale * signal.samples[n] + offset);
  }
  if (!signal.offset.is_constant()) signals::detrend(out, 0);
  return out;
}

Motion motion_of_series(const Series& series, double rate_hz) {
  Motion out;
  std::vector<double> samples = series.samples;
  const auto n = static_cast<double>(samples.size());
  double sum = 0.0;
  for (const double x : samples) sum += x;
  const bool displacement = series.quantity == dynamics::Quantity::displacement;
  const double mean = displacement ? sum / n : 0.0;
  signals::detrend(samples, 0);
  const auto spectrum =
      signals::welch(samples, rate_hz, {.segment = static_cast<int>(samples.size())});
  // Omit the lowest frequencies: integration amplifies the remaining trend there.
  const std::size_t first = displacement ? 1 : 2;
  const int order = static_cast<int>(series.quantity);
  const double step = spectrum.frequencies_hz.size() > 1 ? spectrum.frequencies_hz[1] : 0.0;
  std::vector<std::array<double, 3>> power(spectrum.density.size());
  double all = 0.0;
  for (std::size_t i = first; i < power.size(); ++i) {
    const double omega = 2.0 * std::numbers::pi * spectrum.frequencies_hz[i];
    for (int k = 0; k < 3; ++k) {
      power[i][static_cast<std::size_t>(k)] =
          spectrum.density[i] * step * std::pow(omega, 2 * (k - order));
    }
    all += power[i][0];
  }
  std::array<double, 3> sums{};
  for (std::size_t i = first; i < power.size() && sums[0] < kBand * all; ++i) {
    for (std::size_t k = 0; k < 3; ++k) sums[k] += power[i][k];
    out.band_hz = spectrum.frequencies_hz[i];
  }
  out.displacement = std::hypot(std::sqrt(sums[0]), mean);
  out.velocity = std::sqrt(sums[1]);
  out.acceleration = std::sqrt(sums[2]);
  if (displacement) {
    const auto [low, high] = std::ranges::minmax(series.samples);
    out.highest = high, out.lowest = low;
  } else {
    out.highest = kCrest * out.displacement, out.lowest = -out.highest;
  }
  return out;
}

class Motions {
 public:
  explicit Motions(const SidCase& sid_case)
      : case_(sid_case), chain_(sid_case.models.front().chain) {
    const auto masses = static_cast<std::size_t>(chain_.size()) + 1;
    series_.resize(masses);
    motions_.resize(masses);
    sensed_.resize(masses);
    for (std::size_t m = 1; m < masses; ++m) {
      series_[m] = series_of(static_cast<int>(m));
      if (series_[m].samples.empty()) continue;
      sensed_[m] = motion_of_series(series_[m], case_.sample_rate_hz);
      motions_[m] = beside_the_base(static_cast<int>(m), sensed_[m]);
      if (motions_[m].displacement > most_.displacement) most_ = motions_[m];
    }
    if (!most_.known()) {
      throw InvalidInput(InvalidInput::Part::models,
                         "the responses are constant, so the priors of the terms have no scale");
    }
  }

  [[nodiscard]] LinkMotion of(const Link& link) const {
    const Motion motion = between(link);
    return {.extension = motion.displacement,
            .rate = motion.velocity,
            .tension = tension(link),
            .opening = motion.highest > 0.0 ? motion.highest : motion.displacement,
            .closing = motion.lowest < 0.0 ? -motion.lowest : motion.displacement};
  }

 private:
  [[nodiscard]] const SidChannel* sensor_of(int mass) const {
    const SidChannel* best = nullptr;
    for (const SidChannel* channel : case_.responses()) {
      if (channel->mass == mass && (best == nullptr || channel->quantity < best->quantity)) {
        best = channel;
      }
    }
    return best;
  }

  // The signal of the best sensor on a mass, relative to the base if the base has the same
  // quantity.
  [[nodiscard]] Series series_of(int mass) const {
    const SidChannel* best = sensor_of(mass);
    if (best == nullptr) return {};
    Series out{.quantity = best->quantity, .samples = discovery_in_si(best->signal)};
    const bool acceleration = best->quantity == dynamics::Quantity::acceleration;
    const SidChannel* base =
        case_.find(acceleration ? Role::base_acceleration : Role::base_displacement);
    const bool same = acceleration || best->quantity == dynamics::Quantity::displacement;
    if (best->frame == dynamics::Frame::absolute && base != nullptr && same) {
      const auto of_base = discovery_in_si(base->signal, static_cast<std::size_t>(case_.stride));
      for (std::size_t n = 0; n < std::min(of_base.size(), out.samples.size()); ++n) {
        out.samples[n] -= of_base[n];
      }
    }
    return out;
  }

  // Adds the base displacement in quadrature to the motion of a mass whose sensor does not measure
  // it. Quadrature, because their correlation is unknown.
  [[nodiscard]] Motion beside_the_base(int mass, Motion motion) const {
    const SidChannel* base = case_.find(Role::base_displacement);
    const SidChannel* sensor = sensor_of(mass);
    if (base == nullptr || sensor->frame != dynamics::Frame::absolute ||
        sensor->quantity == dynamics::Quantity::displacement) {
      return motion;
    }
    std::vector<double> samples =
        discovery_in_si(base->signal, static_cast<std::size_t>(case_.stride));
    signals::detrend(samples, 0);
    const Motion moved = motion_of_series({.samples = std::move(samples)}, case_.sample_rate_hz);
    motion.displacement = std::hypot(motion.displacement, moved.displacement);
    motion.velocity = std::hypot(motion.velocity, moved.velocity);
    motion.acceleration = std::hypot(motion.acceleration, moved.acceleration);
    const double away = motion.highest;  // symmetric, because no displacement was measured
    motion.highest = away - moved.lowest, motion.lowest = -away - moved.highest;
    motion.band_hz = std::max(motion.band_hz, moved.band_hz);
    return motion;
  }

  [[nodiscard]] const Motion& of_mass(int mass) const {
    const Motion& own = motions_[static_cast<std::size_t>(mass)];
    return mass == 0 || own.known() ? own : most_;
  }

  [[nodiscard]] Motion between(const Link& link) const {
    const Series &a = series_[static_cast<std::size_t>(link.a)],
                 &b = series_[static_cast<std::size_t>(link.b)];
    const bool both = !a.samples.empty() && !b.samples.empty() && a.quantity == b.quantity;
    const bool to_ground =
        (link.a == 0 && !b.samples.empty()) || (link.b == 0 && !a.samples.empty());
    if (both || to_ground) {
      Series e = b.samples.empty() ? a : b;
      for (std::size_t n = 0; both && n < e.samples.size(); ++n) e.samples[n] -= a.samples[n];
      Motion motion = motion_of_series(e, case_.sample_rate_hz);
      if (motion.known() && !both) {
        motion = beside_the_base(link.a == 0 ? link.b : link.a, motion);
        if (link.b == 0) motion.highest = -std::exchange(motion.lowest, -motion.highest);
      }
      if (motion.known()) return motion;
    }
    const Motion &one = of_mass(link.a), &other = of_mass(link.b);
    Motion out = one.displacement > other.displacement ? one : other;
    out.highest = std::max(out.highest, -out.lowest), out.lowest = -out.highest;
    return out;
  }

  // Tension of a link, RMS [N]: the load on the part of the chain that the link connects to the
  // ground. A chain without ground has two such parts; the smaller load is more accurate, because
  // force and inertia nearly cancel on a heavy part. In a loop: the larger load of the link's ends.
  [[nodiscard]] double tension(const Link& link) const {
    const auto load_of = [this](const std::vector<int>& part) {
      double squares = 0.0;
      for (const int mass : part) squares += std::pow(load(mass), 2.0);
      return std::sqrt(squares);
    };
    const std::vector<int> a = held_without(link, link.a), b = held_without(link, link.b);
    const bool a_stands = std::ranges::count(a, 0) > 0, b_stands = std::ranges::count(b, 0) > 0;
    if (std::ranges::count(a, link.b) > 0) return std::max(load(link.a), load(link.b));
    if (a_stands) return load_of(b);
    if (b_stands) return load_of(a);
    return std::min(load_of(a), load_of(b));
  }

  // Masses connected to `mass` by other links, including `mass`; 0 is the ground.
  [[nodiscard]] std::vector<int> held_without(const Link& link, int mass) const {
    std::vector<int> out = {mass};
    for (std::size_t next = 0; next < out.size(); ++next) {
      for (const Link& other : chain_.links) {
        if (std::minmax(other.a, other.b) == std::minmax(link.a, link.b)) continue;
        if (other.a != out[next] && other.b != out[next]) continue;
        const int end = other.a == out[next] ? other.b : other.a;
        if (std::ranges::count(out, end) == 0) out.push_back(end);
      }
    }
    return out;
  }

  // RMS load on a mass [N]: inertia force and excitation, added in quadrature.
  [[nodiscard]] double load(int mass) const {
    if (mass == 0) return 0.0;
    const Motion& sensed = sensed_[static_cast<std::size_t>(mass)];
    const Motion& motion = sensed.known() ? sensed : of_mass(mass);
    std::vector<double> median;
    for (const auto& p : case_.parameters) median.push_back(p.prior.from_standard_normal(0.0));
    const double m = chain_.masses[static_cast<std::size_t>(mass - 1)].at(median);
    double squares = std::pow(m * motion.acceleration, 2.0);
    for (const SidChannel& channel : case_.channels) {
      const bool on_it = channel.role == Role::force && channel.mass == mass;
      const bool of_base = channel.role == Role::base_acceleration;
      if (!on_it && !of_base) continue;
      const double factor = of_base ? m : 1.0;
      squares += std::pow(factor * rms_within(channel, motion.band_hz), 2.0);
    }
    return std::sqrt(squares);
  }

  [[nodiscard]] double rms_within(const SidChannel& channel, double band_hz) const {
    std::vector<double> samples =
        discovery_in_si(channel.signal, static_cast<std::size_t>(case_.stride));
    signals::detrend(samples, 0);
    const auto spectrum = signals::welch(samples, case_.sample_rate_hz,
                                         {.segment = static_cast<int>(samples.size())});
    double power = 0.0;
    for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
      if (spectrum.frequencies_hz[i] <= band_hz) power += spectrum.density[i];
    }
    return std::sqrt(power * spectrum.frequencies_hz[1]);
  }

  const SidCase& case_;
  const dynamics::Chain& chain_;
  std::vector<Series> series_;   // one per mass, from the ground on
  std::vector<Motion> motions_;  // motion relative to the base
  std::vector<Motion> sensed_;   // motion as measured by the sensor
  Motion most_;
};

// ---- priors -----------------------------------------------------------------------------------

// True if a law resists motion: it has memory, or a tension at zero extension.
bool resists(const LawInfo& info) {
  if (info.memory) return true;
  std::vector<dynamics::Coefficient> ones;
  for (int i = 0; i < info.size(); ++i) {
    const auto& c = info.coefficients[static_cast<std::size_t>(i)];
    ones.emplace_back(c.required() ? 1.0 : c.otherwise);
  }
  const Link link{.laws = {dynamics::make_law(info.name, ones)}};
  return dynamics::tension(link, {}, 0.0, 1.0) != 0.0;
}

}  // namespace

std::string term_name(const Law& law, const Link& link, bool several) {
  return std::string(info_of(law).name) + suffix(law, link, several);
}

std::string term_parameter(const Law& law, std::size_t coefficient, const Link& link,
                           bool several) {
  const LawInfo& info = info_of(law);
  std::string name(info.name);
  if (info.size() > 1) name += " " + std::string(info.coefficients[coefficient].name);
  return name + suffix(law, link, several);
}

void add_subsets(SidCase& sid_case) {
  const SidDiscovery& asked = *sid_case.discovery;
  const std::size_t n = asked.terms.size();
  if (sid_case.models.size() != 1) {
    throw InvalidInput(InvalidInput::Part::models,
                       "must be one model, to which Wheeltap adds the terms, not " +
                           std::to_string(sid_case.models.size()));
  }
  if (n > kMostTerms) {
    throw InvalidInput(InvalidInput::Part::models,
                       std::to_string(n) + " terms have " + std::to_string(1UL << n) +
                           " subsets; at most " + std::to_string(kMostTerms) + " terms (" +
                           std::to_string(1UL << kMostTerms) + " models) are possible");
  }
  std::vector<unsigned long> subsets(1UL << n);
  for (std::size_t s = 0; s < subsets.size(); ++s) subsets[s] = s;
  // Subsets with fewer terms first; subsets of equal size in the order of the case.
  std::ranges::stable_sort(subsets, {}, [](unsigned long s) { return std::popcount(s); });
  const SidModel base = sid_case.models.front();
  sid_case.models.clear();
  for (const unsigned long subset : subsets) {
    SidModel model = base;
    const int with = std::popcount(subset);
    model.weight = std::pow(asked.inclusion, with) *
                   std::pow(1.0 - asked.inclusion, static_cast<int>(n) - with);
    for (std::size_t t = 0; t < n; ++t) {
      if ((subset >> t & 1U) == 0) continue;
      const SidTerm& term = asked.terms[t];
      model.terms.push_back(static_cast<int>(t));
      model.name += " + " + term.name;
      model.chain.links[static_cast<std::size_t>(term.link)].laws.push_back(term.law);
    }
    sid_case.models.push_back(std::move(model));
  }
}

std::vector<LinkMotion> link_motions(const SidCase& sid_case) {
  const Motions motions(sid_case);
  std::vector<LinkMotion> out;
  for (const Link& link : sid_case.models.front().chain.links) out.push_back(motions.of(link));
  return out;
}

inference::Prior default_prior(const LawInfo& law, std::size_t coefficient, Side side,
                               const LinkMotion& motion) {
  const dynamics::LawCoefficient& c = law.coefficients[coefficient];
  const bool stop = law.one_sided && law.size() > 1;
  if (c.role.kind == dynamics::LawRole::Kind::extension) {
    if (!stop) return inference::LogNormal{std::log(motion.extension), kYieldSpread};
    return inference::Uniform{0.0, side == Side::opening ? motion.opening : motion.closing};
  }
  if (c.role.kind != dynamics::LawRole::Kind::factor) {
    throw std::invalid_argument(std::string(law.name) + "'s " + std::string(c.name) + " [" +
                                std::string(c.unit) +
                                "] has no default prior: give it a number, or a prior under "
                                "\"parameters\"");
  }
  const double scale =
      motion.tension / (std::pow(motion.extension, c.role.p) * std::pow(motion.rate, c.role.q));
  if (stop) return inference::HalfNormal{kStop * scale};
  if (resists(law)) return inference::HalfNormal{scale};
  return inference::Normal{0.0, scale};
}

double runaway_bound(const SidCase& sid_case) {
  double reach = 0.0;
  for (const LinkMotion& m : link_motions(sid_case)) reach += std::max(m.opening, m.closing);
  return std::min(sid_case.integration.displacement_bound, kRunaway * reach);
}

void set_term_priors(SidCase& sid_case) {
  SidDiscovery& asked = *sid_case.discovery;
  asked.motions = link_motions(sid_case);
  sid_case.integration.displacement_bound = runaway_bound(sid_case);
  for (const SidTerm& term : asked.terms) {
    for (const std::size_t c : term.by_default) {
      const int p = term.law.coefficients[c].parameter;
      sid_case.parameters[static_cast<std::size_t>(p)].prior = default_prior(
          info_of(term.law), c, term.law.side, asked.motions[static_cast<std::size_t>(term.link)]);
    }
  }
}

}  // namespace wheeltap::identification
