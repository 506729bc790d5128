#include "identification/sid/sid_discovery.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "identification/invalid_input.hpp"
#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;
using dynamics::Side;
using testing::ElementsAre;

const dynamics::LawInfo& info(std::string_view name) {
  return *std::ranges::find(dynamics::law_infos(), name, &dynamics::LawInfo::name);
}

// One mass of 2 kg on a spring to the ground, with these optional laws; parameter 0 is its
// stiffness.
SidCase asked_about(const std::vector<std::string>& laws, double inclusion = 0.5) {
  SidCase out;
  out.parameters = {{"k", inference::Uniform{0.0, 100.0}}};
  const dynamics::Link link{
      .a = 0, .b = 1, .stiffness = Coefficient::of_parameter(0), .damping = 0.5, .laws = {}};
  out.models = {{.name = "linear", .chain = {.masses = {2.0}, .links = {link}}, .noise = {0.01}}};
  out.discovery.emplace();
  out.discovery->inclusion = inclusion;
  for (const std::string& name : laws) {
    const Coefficient c = out.parameter(name, inference::Normal{0.0, 1.0});
    SidTerm term{.link = 0, .law = dynamics::make_law(name, std::vector<Coefficient>{c})};
    term.name = term_name(term.law, link, false);
    term.by_default = {0};
    out.discovery->terms.push_back(std::move(term));
  }
  return out;
}

// A motion A sin(ωt) as measured by a sensor of this quantity, 1000 samples at 100 Hz.
SidCase moving(SidCase sid_case, dynamics::Quantity quantity, double amplitude, double omega) {
  SidChannel channel{.column = "y", .role = SidChannel::Role::response, .mass = 1};
  channel.quantity = quantity;
  const int order = static_cast<int>(quantity);
  for (int n = 0; n < 1000; ++n) {
    channel.signal.samples.push_back(amplitude * std::pow(omega, order) *
                                     std::sin(omega * n / 100.0 + 0.5 * std::numbers::pi * order));
  }
  sid_case.channels = {channel};
  sid_case.sample_rate_hz = 100.0;
  sid_case.end = 1000;
  return sid_case;
}

TEST(SidDiscovery, EverySubsetIsAModelWithItsPrior) {
  SidCase c = asked_about({"cubic", "quadratic", "coulomb"}, 0.2);
  add_subsets(c);
  ASSERT_EQ(c.models.size(), 8U);
  EXPECT_EQ(c.models[0].name, "linear");
  EXPECT_EQ(c.models[1].name, "linear + cubic");
  EXPECT_EQ(c.models[7].name, "linear + cubic + quadratic + coulomb");
  EXPECT_THAT(c.models[7].terms, ElementsAre(0, 1, 2));
  EXPECT_DOUBLE_EQ(c.models[0].weight, 0.8 * 0.8 * 0.8);
  EXPECT_DOUBLE_EQ(c.models[7].weight, 0.2 * 0.2 * 0.2);
  double inclusion = 0.0, all = 0.0;
  for (const SidModel& model : c.models) {
    EXPECT_EQ(model.chain.links[0].laws.size(), model.terms.size());
    if (std::ranges::count(model.terms, 1) > 0) inclusion += model.weight;
    all += model.weight;
  }
  EXPECT_NEAR(inclusion, 0.2, 1e-15);
  EXPECT_NEAR(all, 1.0, 1e-15);
  // The coefficient of a term is the same parameter in all models.
  EXPECT_EQ(c.parameters_of(c.models[1]), (std::vector<int>{0, 1}));
  EXPECT_EQ(c.parameters_of(c.models[7]), (std::vector<int>{0, 1, 2, 3}));
}

TEST(SidDiscovery, RejectsTooManyTermsOrModels) {
  SidCase two = asked_about({"cubic"});
  two.models.push_back(two.models.front());
  EXPECT_THROW(add_subsets(two), InvalidInput);
  SidCase many = asked_about({"cubic"});
  many.discovery->terms.resize(kMostTerms + 1, many.discovery->terms.front());
  EXPECT_THROW(add_subsets(many), InvalidInput);
}

TEST(SidDiscovery, TermsAndTheirParametersAreNamedAfterTheirLaws) {
  const dynamics::Link link{.a = 1, .b = 2};
  const auto stop = dynamics::make_law<dynamics::laws::Contact>({1.0, 0.1}, Side::closing);
  const auto cubic = dynamics::make_law<dynamics::laws::Cubic>({1.0});
  EXPECT_EQ(term_name(cubic, link, false), "cubic");
  EXPECT_EQ(term_name(stop, link, true), "contact closing 1-2");
  EXPECT_EQ(term_parameter(cubic, 0, link, true), "cubic 1-2");
  EXPECT_EQ(term_parameter(stop, 1, link, false), "contact gap closing");
}

// For a sine all three sensors give the same: RMS A/√2, ωA/√2, and a force m ω² A/√2.
TEST(SidDiscovery, TheMotionDoesNotDependOnTheSensor) {
  const double amplitude = 0.03, omega = 2.0 * std::numbers::pi * 4.0;
  const double rms = amplitude / std::numbers::sqrt2;
  for (const auto quantity : {dynamics::Quantity::displacement, dynamics::Quantity::velocity,
                              dynamics::Quantity::acceleration}) {
    const SidCase c = moving(asked_about({"cubic"}), quantity, amplitude, omega);
    const LinkMotion m = link_motions(c).front();
    EXPECT_NEAR(m.extension, rms, 0.03 * rms);
    EXPECT_NEAR(m.rate, omega * rms, 0.03 * omega * rms);
    EXPECT_NEAR(m.tension, 2.0 * omega * omega * rms, 0.03 * 2.0 * omega * omega * rms);
    const bool measured = quantity == dynamics::Quantity::displacement;
    EXPECT_NEAR(m.opening, measured ? amplitude : 3.0 * rms, 0.03 * amplitude * 3.0);
  }
}

// Broadband noise of a sensor must not determine the scale: its second derivative would be mostly
// noise.
TEST(SidDiscovery, NoiseDoesNotDetermineTheScale) {
  const double amplitude = 0.03, omega = 2.0 * std::numbers::pi * 4.0;
  SidCase c = moving(asked_about({"cubic"}), dynamics::Quantity::displacement, amplitude, omega);
  base::Random random(3, 0, 0, base::Purpose::test);
  for (double& y : c.channels[0].signal.samples) y += 0.02 * amplitude * random.normal();
  const double want = 2.0 * omega * omega * amplitude / std::numbers::sqrt2;
  EXPECT_NEAR(link_motions(c).front().tension, want, 0.05 * want);
}

// A mass so heavy that it does not move, on a moving base: the extension of the link is the base
// motion. Its tension follows from the mass's sensor, not from moving the mass with the base.
TEST(SidDiscovery, AMovingBaseExtendsTheLink) {
  const double amplitude = 0.03, omega = 2.0 * std::numbers::pi * 4.0;
  const double rms = amplitude / std::numbers::sqrt2;
  const double still = 1e-9 * amplitude;
  SidCase c = moving(asked_about({"cubic"}), dynamics::Quantity::acceleration, still, omega);
  SidCase base = moving(asked_about({"cubic"}), dynamics::Quantity::displacement, amplitude, omega);
  base.channels[0].role = SidChannel::Role::base_displacement;
  c.channels.push_back(base.channels[0]);
  const LinkMotion m = link_motions(c).front();
  EXPECT_NEAR(m.extension, rms, 0.03 * rms);
  EXPECT_NEAR(m.rate, omega * rms, 0.03 * omega * rms);
  EXPECT_NEAR(m.opening, amplitude, 0.03 * amplitude);
  EXPECT_NEAR(m.closing, amplitude, 0.03 * amplitude);
  const double force = 2.0 * omega * omega * still / std::numbers::sqrt2;
  EXPECT_NEAR(m.tension, force, 0.03 * force);
}

// The upper of two storeys carries its mass, the lower both masses.
TEST(SidDiscovery, ALinkCarriesTheMassesThatItHoldsToTheGround) {
  const double amplitude = 0.03, omega = 2.0 * std::numbers::pi * 4.0;
  SidCase c = moving(asked_about({"cubic"}), dynamics::Quantity::acceleration, amplitude, omega);
  dynamics::Chain& chain = c.models[0].chain;
  chain.masses = {2.0, 3.0};
  chain.links.push_back({.a = 1, .b = 2, .stiffness = 1.0});
  c.channels.push_back(c.channels[0]);
  c.channels[1].mass = 2;
  const double acceleration = omega * omega * amplitude / std::numbers::sqrt2;
  const double both = std::hypot(2.0, 3.0) * acceleration, upper = 3.0 * acceleration;
  EXPECT_NEAR(link_motions(c)[0].tension, both, 0.03 * both);
  EXPECT_NEAR(link_motions(c)[1].tension, upper, 0.03 * upper);
}

// A shaker table as the base, 10⁶ times as heavy, and the force that moves it.
TEST(SidDiscovery, AFloatingLinkCarriesTheLoadOfItsLighterEnd) {
  const double amplitude = 0.03, omega = 2.0 * std::numbers::pi * 4.0;
  SidCase c = moving(asked_about({"cubic"}), dynamics::Quantity::velocity, amplitude, omega);
  dynamics::Chain& chain = c.models[0].chain;
  chain.masses = {2e6, 2.0};
  chain.links[0].a = 1, chain.links[0].b = 2;
  c.channels[0].mass = 2;
  SidChannel force = c.channels[0];
  force.role = SidChannel::Role::force, force.mass = 1;
  force.signal.scale = 2e6;
  c.channels.push_back(force);
  const double want = 2.0 * omega * omega * amplitude / std::numbers::sqrt2;
  EXPECT_NEAR(link_motions(c).front().tension, want, 0.03 * want);
}

TEST(SidDiscovery, RejectsAConstantRecord) {
  const SidCase c = moving(asked_about({"cubic"}), dynamics::Quantity::displacement, 0.0, 1.0);
  EXPECT_THROW(static_cast<void>(link_motions(c)), InvalidInput);
}

// At the RMS motion, a term at its scale has the RMS tension of the link.
TEST(SidDiscovery, DefaultPriorsAreScaledByTheMotion) {
  const LinkMotion m{
      .extension = 0.02, .rate = 0.5, .tension = 3.0, .opening = 0.05, .closing = 0.07};
  const auto family = [&]<class F>(F, std::string_view law, std::size_t c, Side side) {
    return std::get<F>(default_prior(info(law), c, side, m).family());
  };
  const auto open = Side::opening;
  EXPECT_DOUBLE_EQ(family(inference::Normal{}, "cubic", 0, open).sd, 3.0 / std::pow(0.02, 3));
  EXPECT_DOUBLE_EQ(family(inference::Normal{}, "quintic", 0, open).sd, 3.0 / std::pow(0.02, 5));
  EXPECT_DOUBLE_EQ(family(inference::Normal{}, "bilinear", 0, open).sd, 3.0 / 0.02);
  EXPECT_DOUBLE_EQ(family(inference::HalfNormal{}, "coulomb", 0, open).sd, 3.0);
  EXPECT_DOUBLE_EQ(family(inference::HalfNormal{}, "quadratic_damping", 0, open).sd,
                   3.0 / (0.5 * 0.5));
  EXPECT_DOUBLE_EQ(family(inference::HalfNormal{}, "bouc_wen", 0, open).sd, 3.0 / 0.02);
  EXPECT_DOUBLE_EQ(family(inference::LogNormal{}, "bouc_wen", 1, open).mu, std::log(0.02));
  EXPECT_DOUBLE_EQ(family(inference::HalfNormal{}, "contact", 0, open).sd, 30.0 / 0.02);
  EXPECT_DOUBLE_EQ(family(inference::Uniform{}, "contact", 1, open).upper, 0.05);
  EXPECT_DOUBLE_EQ(family(inference::Uniform{}, "contact", 1, Side::closing).upper, 0.07);
  EXPECT_THROW(static_cast<void>(default_prior(info("bouc_wen"), 3, open, m)),
               std::invalid_argument);
}

// Every law of the list has a default prior for its required coefficients.
TEST(SidDiscovery, EveryLawHasDefaultPriors) {
  const LinkMotion m{
      .extension = 0.02, .rate = 0.5, .tension = 3.0, .opening = 0.05, .closing = 0.05};
  for (const dynamics::LawInfo& law : dynamics::law_infos()) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(law.size()); ++c) {
      if (!law.coefficients[c].required()) continue;
      EXPECT_NO_THROW(static_cast<void>(default_prior(law, c, Side::opening, m))) << law.name;
    }
  }
}

}  // namespace
}  // namespace wheeltap::identification
