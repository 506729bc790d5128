#include "apps/whole_number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wheeltap::apps {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

TEST(WholeNumber, ReadsOneHoweverItIsWritten) {
  EXPECT_EQ(whole_number("5", 0, 10), 5);
  EXPECT_EQ(whole_number("-3", -5, 10), -3);
  EXPECT_EQ(whole_number("5.0", 0, 10), 5);
  EXPECT_EQ(whole_number("1e6", 0, 2'000'000), 1'000'000);
  EXPECT_EQ(whole_number("9223372036854775807", 0, kMost), kMost);
  EXPECT_EQ(whole_number(5.0, 0, 10), 5);
}

// Fault: numbers out of range overflowed: --seed -1, --part 4294967297/4294967298.
TEST(WholeNumber, IsNoneWhereItWouldWrap) {
  for (const char* text : {"-1", "11", "4294967297", "9223372036854775808", "18446744073709551615",
                           "1e30", "-1e30", "1e400"}) {
    EXPECT_FALSE(whole_number(text, 0, 10)) << text;
    EXPECT_FALSE(whole_number(text, 0, 1)) << text;
  }
  EXPECT_FALSE(whole_number("9223372036854775808", 0, kMost));
}

TEST(WholeNumber, IsNoneWhereItIsSomethingElse) {
  for (const char* text : {"", " 5", "5 ", "+5", "5x", "5.5", "five", "0x5", "nan", "inf", "-"}) {
    EXPECT_FALSE(whole_number(text, -kMost, kMost)) << text;
  }
  EXPECT_FALSE(whole_number(std::nan(""), 0, 10));
  EXPECT_FALSE(whole_number(2.5, 0, 10));
}

}  // namespace
}  // namespace wheeltap::apps
