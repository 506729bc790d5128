// Valid and invalid update cases: messages with file, place, value and allowed values; exit code
// 65.
#include "apps/cases/update_case.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json two_storey_case() {
  return json::parse(R"({
    "kind": "update",
    "structure": {"chain": {"masses": [2.0, 1.0], "links": [
      {"between": [0, 1], "stiffness": "k1"}, {"between": [1, 2], "stiffness": "k2"}]}},
    "parameters": {"k1": {"log_normal": [7.2, 0.3]}, "k2": {"log_normal": [6.8, 0.3]}},
    "data": {"frequencies": [2.8, 6.7], "cov": 0.01,
             "sensors": [{"mass": 1}, {"node": "mass 2"}], "shapes": [[0.5, 1.0], [1.0, -0.9]],
             "shape_sd": 0.02}})");
}

UpdateCaseFile parsed_update(const json& text) {
  return parse_update_case({.path = "case.json", .json = Json::parse(text.dump())});
}

/// The case with a value at a place; null removes the place.
json with(const char* place, const json& value) {
  json text = two_storey_case();
  const json::json_pointer at(place);
  if (value.is_null()) {
    text[at.parent_pointer()].erase(at.back());
  } else {
    text[at] = value;
  }
  return text;
}

void expect_refused(const json& text, const std::string& place, const std::string& words) {
  try {
    static_cast<void>(parsed_update(text));
    FAIL() << "not refused: " << place;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    EXPECT_THAT(failure.what(), HasSubstr("case.json: " + place + ":"));
    EXPECT_THAT(failure.what(), HasSubstr(words));
    EXPECT_THAT(failure.what(), testing::Not(HasSubstr("\n")));
  }
}

TEST(UpdateCase, IsReadAsItStands) {
  const auto update = parsed_update(two_storey_case()).update;
  ASSERT_EQ(update.data.modes(), 2);
  EXPECT_NEAR(update.data.covariance(1, 1), 0.067 * 0.067, 1e-12);
  EXPECT_EQ(update.data.sensors[1].name, "mass 2, x");
  EXPECT_EQ(update.data.shapes(1, 1), -0.9);
  EXPECT_NEAR(update.data.shape_covariances[0](1, 1), 4e-4, 1e-15);
  EXPECT_EQ(update.structure->parameters.size(), 2u);
}

TEST(UpdateCase, ScattersMayBeUnknown) {
  json text = with("/data/cov", {{"log_uniform", {1e-4, 1e-1}}});
  text["data"]["shape_sd"] = {{"log_uniform", {1e-3, 0.3}}};
  text["data"]["discrepancy"] = {{"cov", {{"half_normal", 0.05}}}, {"shape", 0.01}};
  const auto data = parsed_update(text).update.data;
  EXPECT_TRUE(data.cov_prior && data.shape_sd_prior && data.discrepancy.prior);
  EXPECT_EQ(data.shape_discrepancy.value, 0.01);
}

TEST(UpdateCase, ModesMayBeDoubtedWhereTheyHaveShapes) {
  EXPECT_EQ(parsed_update(with("/data/doubt", 0.05)).update.data.doubt, 0.05);
  json alone = with("/data/doubt", 0.05);
  for (const char* key : {"shapes", "shape_sd", "sensors"}) alone["data"].erase(key);
  expect_refused(alone, "/data/doubt", "needs mode shapes");
}

TEST(UpdateCase, ATruthStandsInForData) {
  json text = with("/data/frequencies", nullptr);
  text["data"].erase("shapes");
  text["truth"] = {{"parameters", {{"k1", 1300}, {"k2", 900}}}, {"modes", 2}, {"shape_sd", 0.05}};
  const auto update = parsed_update(text).update;
  EXPECT_TRUE(update.data.simulated);
  EXPECT_EQ(update.data.shapes.rows(), 2);
  // The stated uncertainty is that of the data, independent of the added noise.
  EXPECT_NEAR(std::sqrt(update.data.covariance(0, 0)) / update.data.frequencies_hz[0], 0.01, 1e-12);
  EXPECT_NEAR(update.data.shape_covariances[0](0, 0), 4e-4, 1e-15);
}

TEST(UpdateCase, WhatDoesNotGoTogetherIsRefused) {
  expect_refused(with("/data/cov", nullptr), "/data/cov",
                 "give the uncertainty of the frequencies");
  expect_refused(with("/data/shape_sd", nullptr), "/data/shape_sd",
                 "give the uncertainty of the shapes");
  expect_refused(with("/data/sensors", nullptr), "/data/sensors", "one number per sensor");
  expect_refused(with("/data/shapes/1", {1.0}), "/data/shapes/1",
                 "must have one number per sensor");
  expect_refused(with("/data/shapes/1", {0.0, 0.0}), "/data/shapes/1", "only zeros");
  expect_refused(with("/data/shapes/1", {1.0, json()}), "/data/shapes/1", "one number only");
  expect_refused(with("/data/shapes", {{0.5, 1.0}}), "/data/shapes", "one shape per frequency");
  expect_refused(with("/data/sd", {0.1, 0.1}), "/data", "give only one of");
  expect_refused(with("/data/sensors/0", {{"mass", 3}}), "/data/sensors/0/mass",
                 "there are 2 masses");
  expect_refused(with("/data/sensors/0", {{"dof", 1}}), "/data/sensors/0/dof", "matrices");
  expect_refused(with("/data/sensors/0", {{"direction", "x"}}), "/data/sensors/0",
                 "must have one of");
  expect_refused(with("/data/sensors/1/node", "mas 2"), "/data/sensors/1/node", "did you mean");
  expect_refused(with("/data/predict", 1), "/data/predict", "at most 2");
  expect_refused(with("/parameters/cov", {{"half_normal", 1.0}}), "/parameters/cov",
                 "reserved name");
  json empty = with("/data/frequencies", nullptr);
  empty["data"].erase("shapes");
  expect_refused(empty, "/data", "no data");
}

TEST(UpdateCase, CovariancesThatAreNoneAreRefused) {
  json text = with("/data/cov", nullptr);
  text["data"]["covariance"] = {{1e-4, 2e-4}, {2e-4, 1e-4}};
  expect_refused(text, "/data/covariance", "not positive definite");
  text["data"]["covariance"] = {{1e-4, 2e-5}, {1e-5, 1e-4}};
  expect_refused(text, "/data/covariance/1/0", "not symmetric");
  text["data"]["covariance"] = {{1e-4}};
  expect_refused(text, "/data/covariance", "must be 2 x 2");
  expect_refused(with("/data/shape_sd", 0), "/data/shape_sd", "");
  text = with("/data/shape_sd", nullptr);
  text["data"]["shape_covariance"] = {{{1e-4, 0}, {0, 0}}, {{1e-4, 0}, {0, 1e-4}}};
  expect_refused(text, "/data/shape_covariance/0", "not positive definite");
}

TEST(UpdateCase, WithoutShapesFrequenciesStandInOrder) {
  json text = with("/data/shapes", nullptr);
  text["data"].erase("shape_sd");
  text["data"]["frequencies"] = {6.7, 2.8};
  expect_refused(text, "/data/frequencies/1", "must increase");
}

}  // namespace
}  // namespace wheeltap::apps
