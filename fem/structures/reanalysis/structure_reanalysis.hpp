// Frequencies of a structure with a few defects from the modes of the intact one, exactly.
#pragma once

#include <memory>
#include <span>

#include "fem/structures/defects/structure_change.hpp"

namespace wheeltap::fem {

/// As `Reanalysis` does for a beam: with the columns of C spanning the changes, eigenvalues are the
/// roots of a small secular problem, which the same kernels evaluate and whose inertia counts them.
///
/// A softening is a column Bᵀv with Γ = 1 - q; a spring a column with Γ = -k. An added mass is
/// Γ⁻¹ = 1/(λ μ): a mass μ that floats freely beside the structure, a mode at λ = 0 whose motion is
/// 1/√μ, and is linked rigidly to r; so it costs a column and a pole, and the count still holds. A
/// lost mass is a floating one that counts with the other sign.
///
/// All modes of the mesh are kept up to `kAllModes` of them. Frequencies are right to 1e-9
/// relative (2000 random sets a structure,
/// tests/fem/structures/structure_reanalysis_sets_test.cpp).
///
/// Beyond, the lowest p modes are kept, and what the others yield along the changes is matched up
/// to λ³ by two further modes a column (`ResidualModes`). Frequencies are then those of a
/// constrained structure, not below the true ones, and a count in S less what the others may add at
/// most bounds how far above. Where that bound exceeds 1e-6 the changed structure is solved in
/// full; shapes stay those of the constrained one.
///
/// Any number of threads may use one, each with a workspace of its own.
class StructureReanalysis {
 public:
  class Workspace;

  static constexpr int kAllModes = 1500;
  /// At most, for what the modes that are not kept yield along changes [bytes]: four vectors of the
  /// structure's size for each strain or motion asked for, the longest unasked forgotten first.
  static constexpr std::size_t kResidualMemory = std::size_t{2} << 30;
  /// How many of its modes a structure with that many keeps where `wanted` are asked for.
  [[nodiscard]] static int kept_modes(int available, int wanted) {
    return available > kAllModes ? 3 * wanted + 40 : available;
  }

  /// `modes`: how many of the lowest frequencies may be asked for, rigid-body ones included; `kept`
  /// of the modes are kept, 0 for `kept_modes`. Throws as `structure_modes`;
  /// std::invalid_argument where a mode may be missing among those kept.
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

  /// Where `solve` writes; what is empty is not computed. Row-major, a row a mode.
  struct Results {
    std::span<double> frequencies_hz;  ///< n <= modes() lowest, ascending
    /// n × motions: mass-normalised shapes of the changed structure at these motions.
    std::span<double> shapes = {};
    std::span<const SparseRow> motions = {};
    std::span<double> bounds_hz = {};  ///< n: no frequency is further off
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
