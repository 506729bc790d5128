#include "fem/sturm_certificate.hpp"

#include <gtest/gtest.h>

#include "beams.hpp"
#include "fem/modal_analysis.hpp"

namespace wheeltap::fem {
namespace {

TEST(SturmCertificate, NoticesAnyMissedMode) {
  const Beam beam = slender_beam("free-free");
  const Assembly<double> a = assemble<double>(beam, {});
  const Eigen::VectorXd all = modal_analysis(beam, {}, {.modes = 14}).eigenvalues;
  EXPECT_TRUE(nothing_missed(a, all, 12));
  for (Eigen::Index missed = 0; missed < 12; ++missed) {
    Eigen::VectorXd rest(13);
    rest << all.head(missed), all.tail(13 - missed);
    EXPECT_FALSE(nothing_missed(a, rest, 12)) << missed;
  }
}

TEST(SturmCertificate, IsNotGivenWithoutAGap) {
  Beam beam = slender_beam("clamped-clamped", 20);
  beam.supports.push_back({.at = 0.5, .rotation = true, .stiffness = {}});  // pairs of equal modes
  const Assembly<double> a = assemble<double>(beam, {});
  const Eigen::VectorXd all = modal_analysis(beam, {}, {.modes = 6}).eigenvalues;
  EXPECT_FALSE(nothing_missed(a, all.head(4), 3));
  EXPECT_TRUE(nothing_missed(a, all.head(5), 3));
}

}  // namespace
}  // namespace wheeltap::fem
