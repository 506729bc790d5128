#include "fem/beam/self_stress.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "beams.hpp"
#include "fem/beam/full_spectrum.hpp"

namespace wheeltap::fem {
namespace {

/// I - Σ c_j c_jᵀ / λ_j from its definition.
Eigen::MatrixXd by_modes(const Beam& beam) {
  const FullSpectrum s = full_spectrum(beam);
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(2 * beam.elements, 2 * beam.elements);
  for (Eigen::Index j = s.rigid_body_modes; j < s.eigenvalues.size(); ++j)
    p -= s.strains.col(j) * s.strains.col(j).transpose() / static_cast<double>(s.eigenvalues[j]);
  return p;
}

TEST(SelfStress, ProjectorComplementsTheModes) {
  std::vector<std::pair<Beam, Eigen::Index>> cases;
  const Eigen::Index redundant[] = {0, 0, 2, 1, 0};
  for (std::size_t i = 0; i < std::size(kNamedSupports); ++i)
    cases.emplace_back(slender_beam(kNamedSupports[i], 12), redundant[i]);
  Beam springs = slender_beam("free-free", 12);
  springs.supports = {{.at = 0.0, .stiffness = 1e4},
                      {.at = 0.37, .stiffness = {}},
                      {.at = 0.37, .stiffness = {}},  // held twice: no stress
                      {.at = 0.7, .rotation = true, .stiffness = 3e3},
                      {.at = 1.0, .deflection = false, .rotation = true, .stiffness = {}}};
  cases.emplace_back(springs, 3);
  cases.emplace_back(thick_beam("clamped-clamped", 0.3, 7), 2);
  for (const auto& [beam, count] : cases) {
    const Eigen::MatrixXd q = self_stresses(beam);
    EXPECT_EQ(q.cols(), count);
    EXPECT_LT((q * q.transpose() - by_modes(beam)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

}  // namespace
}  // namespace wheeltap::fem
