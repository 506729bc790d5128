#include "fem/structures/matrix_structure.hpp"

#include <gtest/gtest.h>

#include <string>

#include "fem/structures/modes/structure_modes.hpp"
#include "tests/fem/refusal.hpp"

namespace wheeltap::fem {
namespace {

MatrixStructure with_mass(const Eigen::MatrixXd& mass) {
  const Eigen::Index n = mass.rows();
  Eigen::MatrixXd k = 2e4 * Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) k(i, i + 1) = k(i + 1, i) = -1e4;
  return {.mass = mass.sparseView(), .parts = {{.name = "all", .stiffness = k.sparseView()}}};
}

Eigen::MatrixXd diagonal(std::initializer_list<double> entries) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(entries.size()),
                                            static_cast<Eigen::Index>(entries.size()));
  Eigen::Index i = 0;
  for (const double x : entries) m(i, i) = x, ++i;
  return m;
}

// Fault: structures with negative masses got certified modes.
TEST(MatrixStructure, NegativeMassesAreRefused) {
  const auto refused = [](const Eigen::MatrixXd& mass, std::initializer_list<std::string> words) {
    expect_refusal([&] { validate(with_mass(mass)); }, words);
  };
  refused(diagonal({2, -1, 2}), {"the mass matrix has a negative mass", "entry (2, 2) = -1"});
  Eigen::MatrixXd m = diagonal({2, 2, 2, 2});
  m(2, 3) = m(3, 2) = 3;
  refused(m, {"not positive semidefinite", "(3, 4) = 3", "(3, 3) = 2", "(4, 4) = 2"});
  m = diagonal({2, 0, 2});
  m(1, 2) = m(2, 1) = 0.1;
  refused(m, {"not positive semidefinite", "(2, 3) = 0.1", "(2, 2) = 0"});
  // All pairs are definite, but the three degrees of freedom together are not.
  m = Eigen::MatrixXd::Identity(5, 5);
  for (int i = 1; i < 4; ++i)
    for (int j = 1; j < 4; ++j)
      if (i != j) m(i, j) = -0.6;
  refused(m, {"not positive semidefinite", "a motion of degree of freedom"});
}

TEST(MatrixStructure, SemidefiniteMassesAreAllowed) {
  validate(with_mass(diagonal({2, 0, 2})));
  validate(with_mass(diagonal({2, -1e-16, 2})));
  Eigen::MatrixXd m = 2.0 * Eigen::MatrixXd::Identity(4, 4);  // consistent mass
  for (int i = 0; i < 3; ++i) m(i, i + 1) = m(i + 1, i) = 0.9;
  validate(with_mass(m));
  // A mass at an arm: rank one in three degrees of freedom with very different units, six digits.
  m = diagonal({1, 0, 0, 0});
  const Eigen::Vector3d arm(1.0, -0.333333, 1.23457e-4);
  m.bottomRightCorner(3, 3) = 7.0 * arm * arm.transpose();
  m(1, 2) = m(2, 1) = -2.33333;
  validate(with_mass(m));
  EXPECT_TRUE(structure_modes(discretise(with_mass(diagonal({2, 0, 2}))), 2).certified);
}

}  // namespace
}  // namespace wheeltap::fem
