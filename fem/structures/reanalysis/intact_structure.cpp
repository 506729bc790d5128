#include "fem/structures/reanalysis/intact_structure.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"

namespace wheeltap::fem::detail {
namespace {

using Eigen::Index;

/// I - B K⁻¹ Bᵀ: the self-stress states of the structure; 0 if it is statically determinate. Rigid
/// motions cause no strain, so any restraint against them may be used.
Eigen::MatrixXd self_stress_projector(const Discretisation& d) {
  using Real = long double;
  using Sparse = Eigen::SparseMatrix<Real>;
  const Index n = d.size(), rows = static_cast<Index>(d.strains.size());
  const std::vector<char> held = d.holding_dofs();
  std::vector<Eigen::Triplet<Real>> entries;
  const auto add = [&](Index i, Index j, Real value) {
    if (!held[index(i)] && !held[index(j)])
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (const Strain& s : d.strains)
    for (std::size_t i = 0; i < s.row.dofs.size(); ++i)
      for (std::size_t j = 0; j < s.row.dofs.size(); ++j)
        add(s.row.dofs[i], s.row.dofs[j],
            static_cast<Real>(s.factor) * s.row.coefficients[i] * s.row.coefficients[j]);
  for (int k = 0; k < d.rest.outerSize(); ++k)
    for (Discretisation::Sparse::InnerIterator it(d.rest, k); it; ++it)
      add(it.row(), it.col(), static_cast<Real>(it.value()));
  for (Index i = 0; i < n; ++i)
    if (held[index(i)]) entries.emplace_back(static_cast<int>(i), static_cast<int>(i), Real{1});
  Sparse k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Sparse> ldlt(k);
  Eigen::MatrixXd out(rows, rows);
  Eigen::Matrix<Real, Eigen::Dynamic, 1> load(n);
  for (Index a = 0; a < rows; ++a) {
    load.setZero();
    const SparseRow& from = d.strains[index(a)].row;
    for (std::size_t i = 0; i < from.dofs.size(); ++i)
      if (!held[index(from.dofs[i])]) load[from.dofs[i]] = from.coefficients[i];
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> u = ldlt.solve(load);
    for (Index b = 0; b < rows; ++b) {
      const SparseRow& to = d.strains[index(b)].row;
      Real sum = 0;
      for (std::size_t i = 0; i < to.dofs.size(); ++i)
        if (!held[index(to.dofs[i])]) sum += to.coefficients[i] * u[to.dofs[i]];
      out(b, a) = static_cast<double>((a == b ? Real{1} : Real{0}) - sum);
    }
  }
  return 0.5 * (out + out.transpose());
}

}  // namespace

void IntactStructure::motion(const SparseRow& row, double* out) const {
  std::fill_n(out, stride, 0.0);
  for (std::size_t i = 0; i < row.dofs.size(); ++i) {
    const double* from = dof_rows.data() + index(row.dofs[i]) * stride;
    for (std::size_t j = 0; j < stride; ++j) out[j] += row.coefficients[i] * from[j];
  }
}

/// The lowest modes and one further mode, which gives the lowest eigenvalue of the others.
StructureSpectrum IntactStructure::kept_spectrum(int kept) {
  const StructureModes low = structure_modes(*discretisation, kept + 1);
  if (!low.certified)
    throw std::invalid_argument(
        "its lowest " + std::to_string(kept + 1) +
        " eigenvalues could not be separated: a mode may be missing among them");
  next = low.eigenvalues[kept];
  const Eigen::MatrixXd shapes = low.shapes.leftCols(kept);
  residual = std::make_unique<const ResidualFlexibility>(
      discretisation, shapes, low.eigenvalues.head(kept), StructureReanalysis::kResidualMemory);
  return {.eigenvalues = low.eigenvalues.head(kept),
          .shapes = shapes.cast<long double>(),
          .rigid_body_modes = low.rigid_body_modes};
}

IntactStructure::IntactStructure(std::shared_ptr<const Discretisation> given, int wanted_modes,
                                 int kept_modes)
    : discretisation(std::move(given)), wanted(wanted_modes) {
  const Discretisation& d = *discretisation;
  const auto available = static_cast<int>(mode_count(d));
  if (wanted < 1 || wanted > available)
    throw std::invalid_argument("modes = " + std::to_string(wanted) + ": must be between 1 and " +
                                std::to_string(available) +
                                ", the free degrees of freedom that have mass");
  const int kept = kept_modes > 0 ? std::max(kept_modes, wanted)
                                  : StructureReanalysis::kept_modes(available, wanted);
  const StructureSpectrum spectrum =
      kept < available ? kept_spectrum(kept)
                       : structure_spectrum(d, std::min(available, 3 * wanted + 20));
  massive = static_cast<int>(spectrum.eigenvalues.size());
  modes = massive + static_cast<int>(spectrum.massless.cols());
  if (massive < wanted)
    throw std::invalid_argument(
        "modes = " + std::to_string(wanted) + ": only " + std::to_string(massive) +
        " of its eigenvalues can be separated in double precision; its masses or stiffnesses "
        "differ by too many powers of ten");
  rigid = spectrum.rigid_body_modes;
  stride = index(std::max(modes, 2));
  const double first_elastic = spectrum.eigenvalues[std::min(rigid, massive - 1)];
  eigenvalues.assign(stride, kStaticOnly * (first_elastic > 0.0 ? first_elastic : 1.0));
  for (int j = 0; j < massive; ++j) eigenvalues[index(j)] = spectrum.eigenvalues[j];
  const int elastic = std::min(rigid, modes - 1);
  for (std::size_t j = 0; j < stride; ++j) {
    scales.push_back(eigenvalues[std::max(j, index(elastic))]);
    compliances.push_back(1.0 / scales.back());
  }
  for (int j = 0; j < wanted; ++j)
    frequencies.push_back(std::sqrt(eigenvalues[index(j)]) / (2.0 * std::numbers::pi));
  dof_rows.assign(index(d.size()) * stride, 0.0);
  strain_rows.assign(d.strains.size() * stride, 0.0);
  for (int j = 0; j < modes; ++j) {
    Eigen::Matrix<long double, Eigen::Dynamic, 1> shape;
    if (j < massive)
      shape = spectrum.shapes.col(j);
    else  // so that its static part is ψ ψᵀ
      shape = std::sqrt(static_cast<long double>(eigenvalues[index(j)])) *
              spectrum.massless.col(j - massive);
    for (Index i = 0; i < d.size(); ++i)
      dof_rows[index(i) * stride + index(j)] = static_cast<double>(shape[i]);
    if (j < rigid) continue;  // rigid motions cause no strain
    for (std::size_t r = 0; r < d.strains.size(); ++r) {
      const SparseRow& row = d.strains[r].row;
      long double sum = 0;
      for (std::size_t i = 0; i < row.dofs.size(); ++i)
        sum += row.coefficients[i] * shape[row.dofs[i]];
      strain_rows[r * stride + index(j)] = static_cast<double>(sum);
    }
  }
  if (!residual) self_stresses = self_stress_projector(d);
  compressed = std::ranges::any_of(d.strains, [](const Strain& s) { return s.factor < 0.0; });
  for (const int lifting : kLifting)
    windows.emplace_back(eigenvalues, modes, residual ? modes : std::min(wanted + lifting, modes));
  windows.emplace_back(eigenvalues, modes, modes);
}

}  // namespace wheeltap::fem::detail
