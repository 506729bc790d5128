#include "inference/tempering.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

// Possible on 4e-4 of the prior: of 1000 draws none in two cases of three, of 100 000 none with a
// probability of e^-40.
Problem small_corner() {
  return one_model(
      {{"a", Uniform{0.0, 1.0}}, {"b", Uniform{0.0, 1.0}}}, [](int, std::span<const double> x) {
        return x[0] > 0.98 && x[1] > 0.98 ? 0.0 : -std::numeric_limits<double>::infinity();
      });
}

TEST(Tempering, FindsASmallFeasibleRegionInThePrior) {
  const Problem problem = small_corner();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Target target(problem, false);
    EXPECT_NO_THROW(check_models(target, seed));
    Random random(seed, 0, 0, Purpose::test);
    const State state = start_from_prior(target, random);
    EXPECT_EQ(state.log_likelihood, 0.0);
    EXPECT_GT(state.x[0], 0.98);
  }
}

TEST(Tempering, RefusesAModelThatIsNowherePossible) {
  const Problem problem = never();
  Target target(problem, false);
  try {
    check_models(target, 1);
    FAIL() << "no error";
  } catch (const LikelihoodError& error) {
    EXPECT_NE(std::string(error.what()).find("100000 tried"), std::string::npos) << error.what();
  }
  Random random(1, 0, 0, Purpose::test);
  EXPECT_THROW((void)start_from_prior(target, random), LikelihoodError);
}

}  // namespace
}  // namespace wheeltap::inference
