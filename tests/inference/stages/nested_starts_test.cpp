#include "inference/exploration/nested_starts.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/random.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::inference {
namespace {

// Subsets of a, b, c in addition to a common parameter k.
ModelSpace subsets() {
  return ModelSpace::of_models({{"k", Normal{0.0, 1.0}},
                                {"a", Normal{0.0, 1.0}},
                                {"b", Normal{0.0, 1.0}},
                                {"c", Normal{0.0, 1.0}}},
                               {{"k + a + b", 1.0, {"k", "a", "b"}},
                                {"k", 1.0, {"k"}},
                                {"k + b", 1.0, {"k", "b"}},
                                {"k + a", 1.0, {"k", "a"}},
                                {"k + c", 1.0, {"k", "c"}}});
}

ModelExploration with_mode(std::vector<double> z, double log_mass) {
  ModelExploration out;
  Mode& mode = out.modes.emplace_back();
  mode.z = std::move(z);
  mode.log_mass = log_mass;
  return out;
}

TEST(NestedStarts, OrderModelsByDimension) {
  EXPECT_THAT(by_dimension(subsets()), testing::ElementsAre(1, 2, 3, 4, 0));
}

TEST(NestedStarts, ListIsNestedIfOneModelIsInAll) {
  EXPECT_TRUE(is_nested(subsets()));
  EXPECT_FALSE(is_nested(ModelSpace::of_models({{"a", Normal{0.0, 1.0}}, {"b", Normal{0.0, 1.0}}},
                                               {{"a", 1.0, {"a"}}, {"b", 1.0, {"b"}}})));
}

TEST(NestedStarts, UseTheBestModesOfTheLargestNestedModels) {
  const ModelSpace space = subsets();
  std::vector<ModelExploration> found(5);
  found[1] = with_mode({0.1}, 0.0);
  found[2] = with_mode({0.2, 1.2}, -5.0);
  found[3] = with_mode({0.3, 1.3}, -1.0);
  found[4] = with_mode({0.4, 1.4}, 9.0);  // not nested in the first
  const auto starts = nested_starts(space, 0, found, 3);
  ASSERT_EQ(starts.size(), 6U);
  EXPECT_EQ(nested_starts(space, 0, found, 1).size(), 2U);
  EXPECT_EQ(starts[0], (std::vector<double>{0.3, 1.3, 0.0}));
  EXPECT_EQ(starts[1], (std::vector<double>{0.3, 1.3, -1.5}));
  EXPECT_EQ(starts[2], (std::vector<double>{0.2, 0.0, 1.2}));
  EXPECT_EQ(starts[4], (std::vector<double>{0.1, 0.0, 0.0}));
  EXPECT_TRUE(nested_starts(space, 1, found, 3).empty());
}

// y = A sin(k t) + Σ terms: two climbs from the prior of k rarely end at its narrow peak, and
// without it no term improves the fit.
class Tone : public Likelihood {
 public:
  explicit Tone(const ModelSpace& space) {
    for (const Model& model : space.models()) {
      used_.emplace_back(model.parameters.begin() + 1, model.parameters.end());
    }
    base::Random random(7, 0, 0, base::Purpose::test);
    for (int n = 0; n < kSamples; ++n) {
      y_.push_back(std::sin(kTrue * n) + 0.3 * shape(2, n) - 0.2 * shape(5, n) +
                   kNoise * random.normal());
    }
  }
  double log_likelihood(int m, std::span<const double> x) override {
    double sum = 0.0;
    for (int n = 0; n < kSamples; ++n) {
      double r = y_[static_cast<std::size_t>(n)] - std::sin(x[0] * n);
      const auto& used = used_[static_cast<std::size_t>(m)];
      for (std::size_t i = 0; i < used.size(); ++i) r -= x[i + 1] * shape(used[i], n);
      sum += r * r;
    }
    return -0.5 * sum / (kNoise * kNoise);
  }
  static constexpr double kTrue = 1.1;

 private:
  static constexpr int kSamples = 120;
  static constexpr double kNoise = 0.1;
  static double shape(int term, int n) { return std::cos(0.07 * term * term * n + term); }
  std::vector<std::vector<int>> used_;
  std::vector<double> y_;
};

Problem tones() {
  std::vector<Parameter> parameters = {{"k", Uniform{0.2, 2.5}}};
  std::vector<ModelSpace::ListedModel> models;
  for (int t = 1; t <= 6; ++t) parameters.push_back({"t" + std::to_string(t), Normal{0.0, 1.0}});
  for (unsigned subset = 0; subset < 64; ++subset) {
    ModelSpace::ListedModel model{"s" + std::to_string(subset), 1.0, {"k"}};
    for (unsigned t = 1; t <= 6; ++t)
      if ((subset >> (t - 1) & 1U) != 0) model.parameters.push_back("t" + std::to_string(t));
    models.push_back(std::move(model));
  }
  const ModelSpace space = ModelSpace::of_models(parameters, models);
  return {.space = space, .likelihood = [space] { return std::make_unique<Tone>(space); }};
}

// Of 64 models, the run visits the most probable one; its terms are certain.
TEST(NestedStarts, FindTheSubsetWhoseMaskingParameterIsHardToFind) {
  Options options;
  options.warmup = 4000;
  options.draws = 1000;
  const Posterior posterior = reversible_jump(tones(), options);
  std::vector<double> inclusion(7, 0.0);
  double all = 0.0;
  for (const Chain& chain : posterior.chains)
    for (const int m : chain.model) {
      for (std::size_t t = 1; t <= 6; ++t) inclusion[t] += (m >> (t - 1)) & 1;
      all += 1.0;
    }
  EXPECT_GT(inclusion[2] / all, 0.99);
  EXPECT_GT(inclusion[5] / all, 0.99);
  for (const std::size_t t : {1U, 3U, 4U, 6U}) EXPECT_LT(inclusion[t] / all, 0.3) << t;
}

}  // namespace
}  // namespace wheeltap::inference
