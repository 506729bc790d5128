#include "base/parcel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wheeltap::base {
namespace {

enum class Colour : std::uint8_t { red, green };

struct All {
  double x = 0.0;
  bool yes = false;
  Colour colour = Colour::red;
  std::string text;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  std::vector<std::vector<int>> lists;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
  std::vector<double> part = std::vector<double>(4);

  template <class Parcel>
  void members(Parcel& parcel) {
    parcel(x, yes, colour, text, numbers, texts, lists, matrix, vector,
           std::span(part).subspan(1, 2));
  }
};

All some() {
  All all{.x = -0.0,
          .yes = true,
          .colour = Colour::green,
          .text = std::string("a\0b", 3),
          .numbers = {1.0, std::numeric_limits<double>::infinity()},
          .texts = {"", "two"},
          .lists = {{}, {1, 2, 3}},
          .matrix = {},
          .vector = {}};
  all.matrix = Eigen::MatrixXd::Random(2, 3);
  all.vector = Eigen::VectorXd::Random(5);
  all.part = {1, 2, 3, 4};
  return all;
}

std::string packed(All all) {
  Packer parcel;
  all.members(parcel);
  return std::move(parcel).bytes();
}

TEST(Parcel, RestoresPackedValues) {
  All there = some(), here;
  const std::string bytes = packed(there);
  Unpacker parcel(bytes);
  here.members(parcel);
  EXPECT_TRUE(parcel.empty());
  EXPECT_TRUE(std::signbit(here.x));
  EXPECT_TRUE(here.yes);
  EXPECT_EQ(here.colour, Colour::green);
  EXPECT_EQ(here.text, there.text);
  EXPECT_EQ(here.numbers, there.numbers);
  EXPECT_EQ(here.texts, there.texts);
  EXPECT_EQ(here.lists, there.lists);
  EXPECT_EQ(here.matrix, there.matrix);
  EXPECT_EQ(here.vector, there.vector);
  EXPECT_EQ(here.part, (std::vector<double>{0, 2, 3, 0}));  // a span: only its own numbers
  EXPECT_EQ(packed(here).size(), bytes.size());
}

TEST(Parcel, RejectsTruncatedBytes) {
  const std::string bytes = packed(some());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    All here;
    Unpacker parcel(std::string_view(bytes).substr(0, n));
    EXPECT_THROW(here.members(parcel), std::logic_error) << n;
  }
}

}  // namespace
}  // namespace wheeltap::base
