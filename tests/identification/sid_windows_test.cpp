#include "identification/sid/findings/sid_windows.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;

/// A damped oscillator with unknown stiffness, damping and noise, 2000 samples, 8 windows. The
/// truth has a cubic spring, the model does not.
SidCase windowed_case(double k3, std::uint64_t seed = 3) {
  SidCase out = small_sid_case();
  out.parameters = {{"k", inference::LogUniform{5.0, 500.0}},
                    {"c", inference::LogUniform{0.05, 20.0}},
                    {"sigma", inference::LogUniform{1e-4, 1.0}},
                    {"k3", inference::Uniform{-1.0, 1e4}}};
  for (SidModel& model : out.models) {
    model.chain.links[0].damping = Coefficient::of_parameter(1);
    model.noise = {Coefficient::of_parameter(2)};
  }
  out.models[1].chain.links[0].laws = {
      dynamics::make_law<dynamics::laws::Cubic>({Coefficient::of_parameter(3)})};
  out.truth->theta = {50.0, 1.0, 0.01, k3};
  out.truth->noise = {0.01};
  out.truth->samples = 2000;
  out.truth->seed = seed;
  out = simulated(std::move(out));
  out.models.pop_back();
  out.models[0].parameters = out.parameters_of(out.models[0]);
  out.windows = 8;
  return out;
}

const std::vector<double> kTruth = {50.0, 1.0, 0.01};

TEST(SidWindows, PartitionTheScoredSamples) {
  SidCase c;
  c.begin = 100, c.end = 203, c.windows = 4;
  EXPECT_THAT(window_bounds(c), testing::ElementsAre(std::pair(100, 125), std::pair(125, 151),
                                                     std::pair(151, 177), std::pair(177, 203)));
}

// Each window's likelihood is its part of the whole's, with upsampled excitation and lead-in.
TEST(SidWindows, LikelihoodsAreThePartsOfTheWhole) {
  for (const bool upsampled : {false, true}) {
    SidCase c = small_sid_case();
    c = simulated(std::move(c),
                  {.samples = std::pair(40, 200), .lead_in = 40, .band_limited = upsampled});
    c.windows = 3;
    const auto whole = make_sid_problem(c);
    double sum = 0.0;
    for (const auto& [first, last] : window_bounds(c)) {
      const auto part = make_sid_problem(window_case(c, first, last));
      EXPECT_EQ(part->misfits[1].samples(), last - first);
      sum += log_likelihood(*part, 1, {48.0, 900.0});
    }
    const double all = log_likelihood(*whole, 1, {48.0, 900.0});
    EXPECT_NEAR(sum, all, 1e-9 * std::abs(all));
  }
}

// For a correct model, windows scatter as their intervals state.
TEST(SidWindows, ScatterByTheirErrorsForACorrectModel) {
  const auto problem = make_sid_problem(windowed_case(0.0));
  const ModelWindows w = fit_windows(*problem, 0, kTruth, 2);
  EXPECT_EQ(w.fitted, 8);
  ASSERT_EQ(w.parameters.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(w.parameters[i].has_value());
    const BetweenWindows& b = *w.parameters[i];
    EXPECT_FALSE(b.scatters()) << i;
    ASSERT_TRUE(b.whole.has_value());
    EXPECT_LT(b.whole->q2_5, kTruth[i]);
    EXPECT_GT(b.whole->q97_5, kTruth[i]);
    EXPECT_LT(b.next.q2_5, b.whole->q2_5);
    EXPECT_GT(b.next.q97_5, b.whole->q97_5);
    EXPECT_LT(b.next.sd,
              3.0 * b.sd[3]);  // some 1.2 of it, plus the uncertainty from only eight windows
    EXPECT_EQ(b.value.size(), 8U);
  }
  EXPECT_THAT(window_remarks(*problem, 0, w), testing::IsEmpty());
}

// For a model that lacks a term, they scatter more, which is reported.
TEST(SidWindows, ScatterMoreForAModelThatLacksATerm) {
  const auto problem = make_sid_problem(windowed_case(300.0));
  const ModelWindows w = fit_windows(*problem, 0, std::vector{60.0, 1.0, 0.03}, 2);
  ASSERT_TRUE(w.parameters[0].has_value());
  EXPECT_TRUE(w.parameters[0]->scatters());
  const auto remarks = window_remarks(*problem, 0, w);
  ASSERT_FALSE(remarks.empty());
  const auto& scatter = std::get<remark::ScatterBetweenWindows>(remarks[0]);
  EXPECT_EQ(scatter.windows, 8);
  EXPECT_EQ(scatter.parameters[0].name, "k");
}

TEST(SidWindows, DoNotDependOnThreads) {
  const auto problem = make_sid_problem(windowed_case(300.0));
  const ModelWindows one = fit_windows(*problem, 0, kTruth, 1);
  const ModelWindows three = fit_windows(*problem, 0, kTruth, 3);
  EXPECT_EQ(one.parameters[1]->next.q95, three.parameters[1]->next.q95);
}

// Windows of several records count together: each record has the requested number, or one if none
// is requested.
TEST(SidWindows, OfSeveralRecordsCountTogether) {
  SidCase c = windowed_case(0.0, 3);
  c.further = {windowed_case(0.0, 4), windowed_case(0.0, 5)};
  for (SidCase* record : {&c, &c.further[0], &c.further[1]}) record->windows = 0;
  c.further[0].number = 2, c.further[1].number = 3;
  infer_initial(c.further[0], c.further[0].models[0]);
  c.parameters = c.further[0].parameters;
  c.unite();
  const auto problem = make_sid_problem(std::move(c));
  std::vector<double> start = kTruth;
  start.insert(start.end(), {0.0, 0.0});
  const ModelWindows w = fit_windows(*problem, 0, start, 2);
  EXPECT_EQ(w.windows, 3);
  ASSERT_EQ(w.parameters.size(), 5U);
  EXPECT_EQ(w.parameters[0]->value.size(), 3U);
  EXPECT_FALSE(w.parameters[4].has_value());  // the initial state of one record
}

// The state at the record's start is not a property of the structure.
TEST(SidWindows, LeaveTheInitialStateOut) {
  SidCase c = windowed_case(0.0);
  infer_initial(c, c.models[0]);
  c.models[0].parameters = c.parameters_of(c.models[0]);
  const auto problem = make_sid_problem(std::move(c));
  std::vector<double> start = kTruth;
  start.insert(start.end(), {0.0, 0.0});
  const ModelWindows w = fit_windows(*problem, 0, start, 2);
  ASSERT_EQ(w.parameters.size(), 5U);
  EXPECT_TRUE(w.parameters[0].has_value());
  EXPECT_FALSE(w.parameters[3].has_value());
  EXPECT_FALSE(w.parameters[4].has_value());
}

}  // namespace
}  // namespace wheeltap::identification
