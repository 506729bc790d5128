#include "inference/model/model_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wheeltap::inference {
namespace {

ModelSpace damages_and_supports() {
  return ModelSpace::of_components(
      {{"cov", LogUniform{1e-4, 1e-1}}},
      {{"damage", "damages", {{"location", Uniform{0, 1}}, {"reduction", Uniform{0, 0.6}}}},
       {"support", "supports", {{"location", Uniform{0, 1}}}}},
      {{{0, 0}, 1.0}, {{1, 0}, 1.0}, {{2, 1}, 2.0}, {{1, 1}, 4.0}});
}

TEST(ModelSpace, LaysOutOwnParametersThenComponentsKindByKind) {
  const ModelSpace space = damages_and_supports();
  EXPECT_EQ(space[2].name, "2 damages, 1 support");
  EXPECT_EQ(space[2].dimension, 1 + 2 * 2 + 1);
  EXPECT_EQ(space.parameter_name(2, 0), "cov");
  EXPECT_EQ(space.parameter_name(2, 2), "reduction[1]");
  EXPECT_EQ(space.parameter_name(2, 3), "location[2]");
  EXPECT_EQ(space.parameter_name(2, 5), "location[1]");
  EXPECT_DOUBLE_EQ(space.prior(2, 4).upper(), 0.6);
  EXPECT_EQ(space.max_dimension(), 6);
}

TEST(ModelSpace, NormalisesPriorWeights) {
  const ModelSpace space = damages_and_supports();
  double sum = 0.0;
  for (const Model& model : space.models()) sum += std::exp(model.log_prior);
  EXPECT_NEAR(sum, 1.0, 1e-15);
  EXPECT_NEAR(std::exp(space[3].log_prior), 0.5, 1e-15);
}

TEST(ModelSpace, NeighboursDifferByOneComponent) {
  const ModelSpace space = damages_and_supports();
  EXPECT_EQ(space.neighbour(0, 0, +1), 1);
  EXPECT_EQ(space.neighbour(0, 0, -1), -1);
  EXPECT_EQ(space.neighbour(1, 1, +1), 3);
  EXPECT_EQ(space.neighbour(3, 0, +1), 2);
  EXPECT_EQ(space.neighbour(0, 1, +1), -1);
}

TEST(ModelSpace, CanBeCopied) {
  auto original = std::make_unique<ModelSpace>(damages_and_supports());
  const ModelSpace copy = *original;
  original.reset();
  EXPECT_DOUBLE_EQ(copy.prior(1, 2).upper(), 0.6);
}

template <typename Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ModelSpace, ErrorsNameTheFault) {
  const std::vector<Parameter> table{{"k", Uniform{0, 1}}, {"k3", Uniform{0, 1}}};
  const auto make = [&](std::vector<ModelSpace::ListedModel> models) {
    return message_of([&] { (void)ModelSpace::of_models(table, models); });
  };
  EXPECT_NE(make({{"a", 1, {"k", "c"}}, {"b", 1, {"k3"}}}).find("'c'"), std::string::npos);
  EXPECT_NE(make({{"a", 1, {"k"}}}).find("'k3' is used by no model"), std::string::npos);
  EXPECT_NE(make({{"a", 1, {"k", "k3"}}, {"a", 1, {"k"}}}).find("given twice"), std::string::npos);
  EXPECT_NE(make({{"a", -1, {"k", "k3"}}}).find("-1"), std::string::npos);
  EXPECT_NE(make({{"a", 0, {"k", "k3"}}}).find("above 0"), std::string::npos);
  EXPECT_NE(make({{"a", std::nan(""), {"k", "k3"}}}).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace wheeltap::inference
