#include "apps/json_text.hpp"

#include <gmock/gmock.h>

#include <chrono>

#include "apps/failure.hpp"

namespace wheeltap::apps::json_text_test {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using testing::HasSubstr;

template <class AnyJson = json>
std::string refusal(const std::string& text) {
  try {
    (void)parse_json<AnyJson>("f.json", text);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    return failure.what();
  }
  return "";
}

TEST(JsonText, IsReadWhole) {
  EXPECT_EQ(parse_json<json>("f.json", R"({"a": [1, null, "x"]})")["a"][2], "x");
  EXPECT_EQ(parse_json<ordered_json>("f.json", R"({"b": 1, "a": 2})").begin().key(), "b");
  EXPECT_THAT(refusal("{} {}"), HasSubstr("f.json:1:4: not JSON"));
}

// Fault: recursion over 100 000 nested arrays overflowed the stack.
TEST(JsonText, IsNotFollowedDeeperThanAHundred) {
  const auto nested = [](std::size_t n) { return std::string(n, '[') + std::string(n, ']'); };
  EXPECT_EQ(refusal(nested(kDeepestJson)), "");
  EXPECT_THAT(refusal(nested(kDeepestJson + 1)), HasSubstr("more than 100 deep"));
  EXPECT_THAT(refusal(nested(1'000'000)), HasSubstr("more than 100 deep"));
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("more than 100 deep"));
}

// Fault: each of 200 000 keys was compared with all previous keys, for more than a minute.
TEST(JsonText, FindsTheSecondOfTwoKeysInLinearTime) {
  std::string text = "{";
  for (int i = 0; i < 200'000; ++i) text += "\"k" + std::to_string(i) + "\":1,";
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(refusal(text + "\"last\":1}"), "");
  EXPECT_THAT(refusal(text + "\"k7\":1}"), HasSubstr("the key \"k7\" is used twice"));
  EXPECT_THAT(refusal<ordered_json>(text + "\"last\":1}"), HasSubstr("20000 keys"));
  // It took a minute; now it takes a second, several with a sanitizer.
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

TEST(JsonText, OfManySmallObjectsIsReadInLinearTime) {
  std::string text = "[";
  for (int i = 0; i < 300'000; ++i) text += "{},";
  EXPECT_EQ(refusal(text + "1]"), "");
}

}  // namespace
}  // namespace wheeltap::apps::json_text_test
