// Representation of a structure with parameters by a base structure, scale factors and a few
// low-rank changes.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/modes/parametric_structure.hpp"

namespace wheeltap::fem {

/// With the scale factors s of the stiffness and m of the mass of the whole structure, strain
/// vectors b and displacement vectors r,
///
///   K(θ) = s(θ) (K₀ + Σ_c (q_c(θ) / s(θ) - 1) b_c b_cᵀ),
///   M(θ) = m(θ) (M₀ + Σ_i μ_i(θ) / m(θ) r_i r_iᵀ).
///
/// A reanalysis of the base structure (K₀, M₀) therefore gives the modes at any θ. The sums are a
/// `StructureChange`. Eigenvalues are multiplied by s/m, and mass-normalised shapes by 1/√m. For
/// example, Young's modulus and density of all members are scale factors. A spring adds one strain
/// vector, and a point mass adds one displacement vector per direction. s and m, all q_c and all
/// μ_i are affine in θ, and the decomposition is exact within 1e-9.
class ScaledStructure {
 public:
  /// Largest total number of vectors b_c and r_i. For more vectors, other methods are faster.
  static constexpr int kMostColumns = 16;

  /// Returns std::nullopt if the family does not have this form or needs more than kMostColumns.
  /// `samples` holds values of θ, for example draws from the prior. Throws the exceptions of
  /// `ParametricStructure`.
  [[nodiscard]] static std::optional<ScaledStructure> of(
      StructureFamily family, std::span<const std::vector<double>> samples);

  [[nodiscard]] const std::shared_ptr<const Discretisation>& base() const { return base_; }
  /// The parameters θ of the base structure. At these parameters, each point mass has its smallest
  /// value among all samples.
  [[nodiscard]] const std::vector<double>& base_parameters() const { return origin_; }
  /// Total number of vectors b_c and r_i; 0: only the scale factors depend on θ.
  [[nodiscard]] int columns() const { return static_cast<int>(strains_.size() + masses_.size()); }

  struct Scales {
    double stiffness = 1.0, mass = 1.0;  ///< s, m
  };
  /// The scale factors at θ; empty if one of them is not positive.
  [[nodiscard]] std::optional<Scales> scales(std::span<const double> theta) const;

  enum class Outcome {
    possible,
    impossible,   ///< no valid structure exists at θ
    unsupported,  ///< a crack or partial reduction acts on a strain that depends on θ
  };
  /// Converts `change` from a change of the structure at θ to the corresponding change of the base
  /// structure (K₀, M₀).
  Outcome transform(std::span<const double> theta, const Scales& scales,
                    StructureChange& change) const;

 private:
  /// An affine function of θ: 1 + slopes · (θ - θ₀); for masses, slopes · (θ - θ₀).
  using Slopes = std::vector<double>;
  struct ChangedStrain {
    int strain = 0;  // index among the strains of `base_`
    Slopes slopes = {};
  };
  struct ChangedMass {
    SparseRow motion = {};
    Slopes slopes = {};
  };

  [[nodiscard]] bool take_stiffness(const ParametricStructure& structure);
  [[nodiscard]] bool take_mass(const ParametricStructure& structure);
  void add_mass(SparseRow motion, std::size_t parameter, double slope);
  [[nodiscard]] double change(const Slopes& slopes, std::span<const double> theta) const;

  std::vector<double> origin_;
  std::shared_ptr<const Discretisation> base_;
  Slopes stiffness_, mass_;
  std::vector<ChangedStrain> strains_;
  std::vector<ChangedMass> masses_;
};

}  // namespace wheeltap::fem
