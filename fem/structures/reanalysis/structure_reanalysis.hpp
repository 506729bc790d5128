// Exact frequencies of a structure with a few defects, from the modes of the intact structure.
#pragma once

#include <memory>
#include <span>

#include "fem/structures/defects/structure_change.hpp"

namespace wheeltap::fem {

/// The method is that of `Reanalysis` for beams. If the columns of C span the changes, the
/// eigenvalues are the roots of a small secular problem. The kernels of the beam reanalysis
/// evaluate it, and its inertia counts the eigenvalues.
///
/// A softening is a column Bᵀv with Γ = 1 - q, a spring is one with Γ = -k. An added mass has Γ⁻¹
/// = 1/(λ μ): a mass μ that floats freely beside the structure (a mode at λ = 0 with motion 1/√μ)
/// and is rigidly linked to r. It adds one column and one pole, and the count remains valid. A
/// removed mass is a floating mass with the opposite sign in the count.
///
/// Structures with up to `kAllModes` modes keep all of them. Their frequencies are correct to 1e-9
/// relative (2000 random sets per structure,
/// tests/fem/structures/structure_reanalysis_sets_test.cpp).
///
/// Larger structures keep the lowest p modes. Two further modes per column (`ResidualModes`) match
/// the residual flexibility along the changes up to λ³. The frequencies are those of a constrained
/// structure, so they are not below the true ones. To bound the error, eigenvalues are counted by S
/// minus the largest possible contribution of the omitted modes. If that bound exceeds 1e-6, the
/// changed structure is solved in full. Shapes remain those of the constrained structure.
///
/// Any number of threads may share the object, each with its own workspace.
class StructureReanalysis {
 public:
  class Workspace;

  static constexpr int kAllModes = 1500;
  /// Cache limit for the residual flexibility along changes [bytes]: four vectors of the
  /// structure's size for each requested strain or motion; the least recently used are dropped
  /// first.
  static constexpr std::size_t kResidualMemory = std::size_t{2} << 30;
  /// The number of modes that a structure with this many modes keeps when `wanted` are requested.
  [[nodiscard]] static int kept_modes(int available, int wanted) {
    return available > kAllModes ? 3 * wanted + 40 : available;
  }

  /// `modes`: the largest number of lowest frequencies that can be requested, rigid-body modes
  /// included. `kept`: number of modes to keep, 0 for `kept_modes`. Throws the exceptions of
  /// `structure_modes`, and std::invalid_argument if a mode may be missing among the kept ones.
  StructureReanalysis(std::shared_ptr<const Discretisation> discretisation, int modes,
                      int kept = 0);
  ~StructureReanalysis();
  StructureReanalysis(StructureReanalysis&&) noexcept;
  StructureReanalysis& operator=(StructureReanalysis&&) noexcept;

  [[nodiscard]] Workspace make_workspace() const;
  [[nodiscard]] int modes() const;
  [[nodiscard]] int rigid_body_modes() const;
  [[nodiscard]] std::span<const double> intact_frequencies_hz() const;
  [[nodiscard]] const Discretisation& discretisation() const;

  /// Output of `solve`. Results with an empty span are not computed. Matrices are row-major, with
  /// one row per mode.
  struct Results {
    std::span<double> frequencies_hz;  ///< n <= modes() lowest, ascending
    /// n × motions: components of the mass-normalised shapes of the changed structure.
    std::span<double> shapes = {};
    std::span<const SparseRow> motions = {};
    std::span<double> bounds_hz = {};  ///< n: upper bounds on the errors of the frequencies
  };

  /// Throws std::invalid_argument for q outside (0, 1], k <= 0, or sizes that do not fit;
  /// ImpossibleChange.
  void solve(const StructureChange& change, Workspace& workspace, const Results& results) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Scratch memory of one thread; move-only.
class StructureReanalysis::Workspace {
 public:
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();

 private:
  friend class StructureReanalysis;
  struct Impl;
  explicit Workspace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wheeltap::fem
