#include "fem/beam/full_spectrum.hpp"

#include "fem/beam/lowest_modes.hpp"

namespace wheeltap::fem {

FullSpectrum full_spectrum(const Beam& beam) {
  using Real = DoubleDouble;
  WidePencil pencil(beam, {});
  const Eigen::Index n = pencil.size();
  FullSpectrum result;
  result.rigid_body_modes = static_cast<int>(pencil.rigid_modes().size());
  result.eigenvalues.resize(n);
  result.shapes.resize(2 * beam.nodes(), n);
  result.strains.resize(2 * beam.elements, n);
  if (n == 0) return result;
  const LowestModes all = lowest_modes(beam, {}, static_cast<int>(n), pencil);

  const TimoshenkoElement<Real> element(beam);
  const auto bending = element.bending(), shear = element.shear();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto shape = pencil.all_dofs(all.modes[static_cast<std::size_t>(i)]);
    result.eigenvalues[i] = static_cast<long double>(all.eigenvalues[static_cast<std::size_t>(i)]);
    for (Eigen::Index dof = 0; dof < shape.size(); ++dof)
      result.shapes(dof, i) = static_cast<long double>(shape[dof]);
    for (int e = 0; e < beam.elements; ++e) {
      const Eigen::Matrix<Real, 4, 1> u = shape.segment<4>(2 * e);
      const bool rigid = i < result.rigid_body_modes;  // rigid motions do not strain elements
      result.strains(2 * e, i) = rigid ? 0.0 : static_cast<double>(bending.dot(u));
      result.strains(2 * e + 1, i) = rigid ? 0.0 : static_cast<double>(shear.dot(u));
    }
  }
  return result;
}

}  // namespace wheeltap::fem
