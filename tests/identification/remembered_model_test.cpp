#include "identification/emulation/remembered_model.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::identification {
namespace {

using test::TemporaryDirectory;
using testing::HasSubstr;

/// y = (x_0 + x_1, x_0 x_1), for the first `last` calls; then it fails.
class Sums final : public OutsideModel {
 public:
  explicit Sums(int last = 1'000'000) : left_(last) {}
  [[nodiscard]] int inputs() const override { return 2; }
  [[nodiscard]] int outputs() const override { return 2; }
  void evaluate(std::span<const double> x, std::span<double> y) override {
    ++calls;
    if (left_-- <= 0) throw OutsideModelError(OutsideModelError::Kind::unreachable, "gone");
    y[0] = x[0] + x[1];
    y[1] = x[0] * x[1];
  }
  int calls = 0;

 private:
  int left_;
};

std::vector<double> ask(RememberedModel& model, std::vector<double> x) {
  std::vector<double> y(2);
  model.evaluate(x, y);
  return y;
}

TEST(RememberedModel, EvaluatesAPointOnce) {
  const auto sums = std::make_shared<Sums>();
  RememberedModel model(sums, {}, "");
  EXPECT_EQ(ask(model, {0.1, 0.2}), (std::vector<double>{0.1 + 0.2, 0.1 * 0.2}));
  EXPECT_EQ(ask(model, {0.1, 0.2}), (std::vector<double>{0.1 + 0.2, 0.1 * 0.2}));
  static_cast<void>(ask(model, {0.1, std::nextafter(0.2, 1.0)}));  // another point
  EXPECT_EQ(sums->calls, 2);
  EXPECT_EQ(model.asked(), 2);
}

TEST(RememberedModel, AnotherRunLoadsTheAnswers) {
  const TemporaryDirectory folder;
  const auto path = folder / "answers";
  {
    RememberedModel model(std::make_shared<Sums>(), path, "sums");
    for (int i = 0; i < 20; ++i) static_cast<void>(ask(model, {0.1 * i, 1.0 / 3.0}));
  }
  // As after a run killed while writing: the last record is truncated and is computed again.
  const auto size = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, size - 3);
  const auto sums = std::make_shared<Sums>();
  RememberedModel model(sums, path, "sums");
  EXPECT_EQ(model.remembered(), 19);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(ask(model, {0.1 * i, 1.0 / 3.0}),
              (std::vector<double>{0.1 * i + 1.0 / 3.0, 0.1 * i * (1.0 / 3.0)}));
  EXPECT_EQ(sums->calls, 1);
  EXPECT_EQ(std::filesystem::file_size(path), size);
  EXPECT_THROW(RememberedModel(sums, path, "others"), io::FileError);
}

TEST(RememberedModel, AFailureIsFinalAndNamesTheKeptAnswers) {
  const TemporaryDirectory folder;
  const auto sums = std::make_shared<Sums>(3);
  RememberedModel model(sums, folder / "answers", "sums");
  for (int i = 0; i < 3; ++i) static_cast<void>(ask(model, {1.0, 1.0 * i}));
  for (int again = 0; again < 2; ++again) {
    try {
      static_cast<void>(ask(model, {2.0, 2.0}));
      FAIL() << "the model is gone";
    } catch (const OutsideModelError& error) {
      EXPECT_EQ(error.kind(), OutsideModelError::Kind::unreachable);
      EXPECT_THAT(error.what(), HasSubstr("gone; 3 results are stored in "));
    }
  }
  EXPECT_EQ(sums->calls, 4);  // not called again
  EXPECT_EQ(ask(model, {1.0, 2.0}), (std::vector<double>{3.0, 2.0}));
}

}  // namespace
}  // namespace wheeltap::identification
