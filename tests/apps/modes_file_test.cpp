#include "apps/cases/records/modes_file.hpp"
#include "apps/failure.hpp"

#include <gmock/gmock.h>

#include "program.hpp"

namespace wheeltap::apps::modes_file_test {
namespace {

using testing::HasSubstr;

ModesFile some() {
  ModesFile out{.title = "t",
                .sensors = {{.name = "a", .node = "B", .direction = "-x", .reference = true},
                            {.name = "b", .node = "7", .azimuth = 12.5, .elevation = -3.0}},
                .frequencies_hz = Eigen::Vector2d(1.5, 1.0 / 3.0),
                .damping = Eigen::Vector2d(0.01, 0.02)};
  out.covariance = Eigen::MatrixXd::Identity(4, 4) * 1e-7;
  out.covariance(0, 3) = out.covariance(3, 0) = -3e-8 / 7.0;
  out.shapes.resize(2, 2);
  out.shapes << 1.0, std::complex<double>(0.1, -0.2), std::complex<double>(0.3, 0.01), 1.0;
  out.shape_covariance = {Eigen::MatrixXd::Identity(4, 4) * 1e-5, Eigen::MatrixXd::Zero(4, 4)};
  out.doubtful = {false, true};
  return out;
}

// A written file is read back exactly.
TEST(ModesFile, ReadsWhatItWrites) {
  const Workspace where;
  const ModesFile before = some();
  const ModesFile after = read_modes_file(where.write("m.json", modes_json(before).dump()));
  EXPECT_EQ(after.frequencies_hz, before.frequencies_hz);
  EXPECT_EQ(after.damping, before.damping);
  EXPECT_EQ(after.covariance, before.covariance);
  EXPECT_EQ(after.shapes, before.shapes);
  EXPECT_EQ(after.shape_covariance, before.shape_covariance);
  EXPECT_EQ(after.doubtful, before.doubtful);
  ASSERT_EQ(after.sensors.size(), 2U);
  EXPECT_EQ(after.sensors[0].direction, "-x");
  EXPECT_TRUE(after.sensors[0].reference);
  EXPECT_EQ(after.sensors[1].azimuth, 12.5);
}

// Regression: a file without modes, as `wheeltap modal` writes it, ended the program.
TEST(ModesFile, MayHaveNoModes) {
  const Workspace where;
  ModesFile none{.sensors = some().sensors};
  none.frequencies_hz.resize(0);
  none.damping.resize(0);
  none.covariance.resize(0, 0);
  none.shapes.resize(2, 0);
  Report written = modes_json(none);
  written["covariance"] = Report::array();
  const ModesFile read = read_modes_file(where.write("m.json", written.dump()));
  EXPECT_EQ(read.frequencies_hz.size(), 0);
}

TEST(ModesFile, NamesThePlaceOfWhatIsWrong) {
  const Workspace where;
  const auto refused = [&](const char* place, const Report& value) {
    Report json = modes_json(some());
    json[Report::json_pointer(place)] = value;
    try {
      (void)read_modes_file(where.write("m.json", json.dump()));
      ADD_FAILURE() << place;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::bad_input);
      EXPECT_THAT(failure.what(), HasSubstr(place));
    }
  };
  refused("/frequencies_hz/1", "x");
  refused("/damping", {0.01});
  refused("/covariance", {{1.0}});
  refused("/shapes/real/0", {1.0});
  refused("/shape_covariance", 3);
  refused("/sensors/0/azimuth", "north");
}

}  // namespace
}  // namespace wheeltap::apps::modes_file_test
