#include "fem/beam/intact_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/index.hpp"
#include "fem/beam/assembly.hpp"
#include "fem/beam/full_spectrum.hpp"
#include "fem/beam/self_stress.hpp"
#include "fem/secular.hpp"

namespace wheeltap::fem::detail {
namespace {

/// With n added supports, root i is at most intact eigenvalue i + n. Up to this n, S is a short sum
/// over the near modes; for more supports, S is the sum over all modes.
constexpr int kFewSupports = 8;
/// If the elements (not the springs) have more than this share of the strain energy, a mode bends
/// the beam.
constexpr double kBends = 0.1;
/// For a beam with one mode: relative eigenvalue of an artificial second mode. No spring raises the
/// first mode this far.
constexpr double kOutOfReach = 1e30;

}  // namespace

IntactModes::IntactModes(const Beam& intact_beam, int wanted_modes)
    : beam(intact_beam), element((validate(intact_beam), intact_beam)), wanted(wanted_modes) {
  const FullSpectrum spectrum = full_spectrum(beam);
  modes = static_cast<int>(spectrum.eigenvalues.size());
  rigid = spectrum.rigid_body_modes;
  if (wanted < 1 || wanted > modes)
    throw std::invalid_argument("modes = " + std::to_string(wanted) + ": must be between 1 and " +
                                std::to_string(modes) +
                                ", the number of free degrees of freedom of the mesh");
  stride = index(std::max(modes, 2));
  eigenvalues.resize(stride);
  for (int j = 0; j < modes; ++j)
    eigenvalues[index(j)] = static_cast<double>(spectrum.eigenvalues[j]);
  // Defects do not change the artificial second mode.
  if (modes < 2) eigenvalues[1] = kOutOfReach * eigenvalues[0];
  for (int j = 0; j < wanted; ++j)
    frequencies.push_back(std::sqrt(eigenvalues[index(j)]) / (2.0 * std::numbers::pi));

  element_rows.assign(2 * index(beam.elements) * stride, 0.0);
  dof_rows.assign(2 * index(beam.nodes()) * stride, 0.0);
  for (int j = 0; j < modes; ++j) {
    for (Eigen::Index dof = 0; dof < spectrum.shapes.rows(); ++dof)
      dof_rows[index(dof) * stride + index(j)] = static_cast<double>(spectrum.shapes(dof, j));
    for (Eigen::Index row = 0; row < spectrum.strains.rows(); ++row)
      element_rows[index(row) * stride + index(j)] = spectrum.strains(row, j);
  }
  // On soft springs, the lowest modes are nearly rigid. The rounding errors of their contribution
  // to the compliance of a support would exceed the contribution of bending.
  stiff = rigid;
  const auto bends = [&](int j) {
    return spectrum.strains.col(j).squaredNorm() > kBends * eigenvalues[index(j)];
  };
  while (stiff < modes - 1 && !bends(stiff)) ++stiff;
  stiff = std::min(stiff, modes - 1);
  for (int j = 0; j < static_cast<int>(stride); ++j) {
    scales.push_back(eigenvalues[index(j < rigid ? stiff : j)]);
    held_scales.push_back(eigenvalues[index(std::max(j, stiff))]);
    compliances.push_back(1.0 / held_scales.back());
  }
  const Eigen::MatrixXd stresses = fem::self_stresses(beam);
  self_stresses = static_cast<int>(stresses.cols());
  for (Eigen::Index row = 0; row < stresses.rows(); ++row)
    for (Eigen::Index k = 0; k < stresses.cols(); ++k) stress_rows.push_back(stresses(row, k));
  // One root more than requested: it proves the error bound of the last requested root.
  for (const int supports : {0, kFewSupports, modes})
    windows.emplace_back(eigenvalues, modes, std::min(wanted + supports, modes));
}

const Window& IntactModes::window(int supports) const {
  return windows[supports == 0 ? 0 : supports <= kFewSupports ? 1 : 2];
}

double IntactModes::compliance(const double* a, const double* b) const {
  return secular_kernel().weighted_dot(a, b, compliances.data(), static_cast<int>(stride));
}

double IntactModes::motion(double at, bool rotation, double* row) const {
  const MotionRow<double> motion = motion_row(beam, element, at, rotation);
  std::fill_n(row, stride, 0.0);
  double uncancelled = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double coefficient = motion.coefficients[i];
    if (coefficient == 0.0) continue;
    const double* dof = dof_rows.data() + index(motion.first_dof + i) * stride;
    for (std::size_t j = 0; j < stride; ++j) row[j] += coefficient * dof[j];
    uncancelled += coefficient * coefficient * compliance(dof, dof);
  }
  return uncancelled;
}

}  // namespace wheeltap::fem::detail
