// The likelihood of measured modes (frequencies and shapes), which are matched to computed modes.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/likelihood/shape_density.hpp"
#include "identification/structural/modal_data.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// Parameters of the noise and of the model errors in one state.
struct ModalNoise {
  double cov = 0.0;       ///< measurement sd of f divided by f, if unknown
  double shape_sd = 1.0;  ///< factor that multiplies the shapes' sd, if unknown
  double discrepancy = 0.0, shape_discrepancy = 0.0;
  double mixing = 0.0;                 ///< factor κ of the mixing of shapes, see `mixing_sd`
  double stiffness_discrepancy = 0.0;  ///< the σ of `StiffnessErrors`
  /// Error variance of an emulator [Hz²], one per measured mode; empty: exact.
  std::vector<double> emulator_variance = {};
};

/// The eigenvalue λ [rad²/s²] for which √λ / 2π, in floating point, equals f [Hz] (or a number
/// adjacent to f, if no eigenvalue gives f).
[[nodiscard]] double eigenvalue_of(double frequency_hz);

/// Sd of the coefficient with which the model error δK mixes mode k into mode j. δK changes a
/// frequency by δ = φ_jᵀ δK φ_j / 2λ_j (relative), and mixes φ_k into φ_j by φ_jᵀ δK φ_k / (λ_j -
/// λ_k). Off-diagonal entries φ_jᵀ δK φ_k / √(λ_j λ_k) are assumed κ times as large as diagonal
/// entries. The mixing coefficient is then normal with sd
///
///   τ_jk = κ · 2δ √(λ_j λ_k) / |λ_j - λ_k|,   c_jk = -c_kj.
///
/// The sd is limited to 1, because the first-order expansion is not valid above 1 (Fox & Kapoor
/// 1968, AIAA J. 6:2426). For the entries of a random symmetric matrix, κ = 1/√2.
[[nodiscard]] double mixing_sd(const ModalNoise& noise, double first, double second);

/// The likelihood of measured modes. Let A be the assignment of measured to computed modes:
///
///   ln p(data | θ) = ln N(f_obs; f_A(θ), C) + Σ ln p(ψ_i | φ_A(i)(θ)),
///   C = C_noise + δ² diag(f_obs²) + diag(σ²_emulator),
///   C_noise = C of the data, or cov² diag(f_obs²).
///
/// shape_density.hpp defines the shape densities. With the discrepancy δ, the model error changes
/// each frequency by N(0, (δ f)²). The likelihood is the integral over this model error, so that δ
/// can be inferred from the residuals.
///
/// Matching: without shapes, the i-th frequency belongs to the i-th elastic mode. With shapes, A
/// assigns the measured modes to the `candidates` lowest computed modes. A minimises the total cost
/// of the differences in frequency and shape. The data may therefore omit or reorder modes.
/// Correlations of frequencies do not affect the matching. Only the best matching is used: another
/// matching is nearly as good only if modes are close and similar.
///
/// Mixing (κ > 0): the covariance Σ of a shape includes the mixing of φ_A(i) with every other
/// computed mode by `mixing_sd`. With mixing, close modes (below) are not rotated. Instead, the
/// mixing sd of the closest mode is √(mixing_sd² + τ²).
///
/// Spurious modes: each measured mode may be spurious with probability ε (`ModalData::doubt`). If ε
/// is not 0, frequencies count as uncorrelated and
///
///   p(mode i | θ) = (1 - ε) N(f_i; f_A(i), C_ii) p(ψ_i | φ_A(i)) + ε p₀(f_i) p₀(ψ_i),
///
/// p₀ is uniform over frequencies up to `kBand` times the highest measured frequency, and over all
/// shape directions. If ε is not 0, A may leave measured modes unmatched.
///
/// Close modes: the relative difference (gap) of their eigenvalues is below `kClose`. Their shapes
/// may be rotated in their common plane by α ~ N(0, τ²), τ² = `kMixing`² (1/gap² - 1/kClose²). A
/// relative change of K of about a thousandth causes such a rotation. If more than two modes are
/// close, each mode is rotated with the mode closest to it.
class ModalLikelihood {
 public:
  static constexpr double kClose = 0.05;
  static constexpr double kMixing = 1e-3;
  static constexpr double kBand = 1.5;

  /// Throws std::invalid_argument for inconsistent data; the message names the mode (from 1).
  explicit ModalLikelihood(ModalData data);

  /// The match of one measured mode.
  struct Match {
    int computed = 0;           ///< 0-based index of the elastic mode
    double frequency_hz = 0.0;  ///< computed
    std::optional<ShapeDensity::Comparison> shape = {};
    double spurious = 0.0;        ///< probability that the mode is spurious, given θ
    double log_likelihood = 0.0;  ///< log likelihood of this mode, if modes may be spurious
  };
  struct Score {
    double log_likelihood = 0.0;
    double chi_square = 0.0;  ///< χ² of all modes that are more probably real than spurious
    int freedoms = 0;         ///< degrees of freedom of `chi_square`
    std::vector<Match> matches;
  };
  [[nodiscard]] Score score(const fem::ParametricModes::Modes& modes,
                            const ModalNoise& noise) const;
  /// For uncorrelated frequencies without shapes, adds ln p to `log_density` and appends the
  /// computed frequencies to `frequencies_hz`; faster than `score`. Other data: returns false.
  bool add_density_of_frequencies(const fem::ParametricModes::Modes& modes, const ModalNoise& noise,
                                  double& log_density, std::vector<double>& frequencies_hz) const;
  /// Input of StiffnessErrors for one measured shape: the comparison without stiffness errors, the
  /// residual in units of the noise, and its sensitivity to each stiffness error, m × errors. The
  /// sd of the rotation of close modes is treated as mixing.
  struct ShapeErrors {
    ShapeDensity::Comparison without;
    Eigen::VectorXd residual;
    Eigen::MatrixXd sensitivities;
  };
  [[nodiscard]] ShapeErrors shape_errors(const fem::ParametricModes::Modes& modes, int mode,
                                         Eigen::Index computed, const ModalNoise& noise) const;
  /// Computes ∂ ln p/∂θ_j for the current matching, from the derivatives `slopes` of the modes. For
  /// shapes that may be rotated or mixed, uses finite differences in the direction of `slopes`.
  void slope(const fem::ParametricModes::Modes& modes, const fem::ParametricModes::Slopes& slopes,
             const ModalNoise& noise, std::span<double> out) const;
  /// The Gauss-Newton approximation of -∂² ln p/∂θ², from the first derivatives of frequencies and
  /// shapes, for the current matching. The sd of the rotation of close modes is treated as mixing.
  [[nodiscard]] Eigen::MatrixXd information(const fem::ParametricModes::Modes& modes,
                                            const fem::ParametricModes::Slopes& slopes,
                                            const ModalNoise& noise) const;
  /// ∂ ln p/∂f of each computed mode for the current matching, if no shapes were measured.
  [[nodiscard]] std::vector<double> pulls(const fem::ParametricModes::Modes& modes,
                                          const ModalNoise& noise) const;

  /// The covariance C.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;
  [[nodiscard]] const ModalData& data() const { return data_; }
  /// Number of measured values, minus one for each shape, because the scale of a shape is
  /// arbitrary.
  [[nodiscard]] int measured() const;
  [[nodiscard]] const std::optional<ShapeDensity>& shape(int mode) const {
    return shapes_[static_cast<std::size_t>(mode)];
  }
  /// Number of modes to compute: measured modes, additional candidates and modes to be predicted;
  /// at most `available`.
  [[nodiscard]] int candidates(int available) const;

 private:
  [[nodiscard]] Eigen::VectorXd pulls(const fem::ParametricModes::Modes& modes,
                                      const std::vector<int>& matched,
                                      const Eigen::MatrixXd& covariance) const;
  [[nodiscard]] Eigen::VectorXd entries(const Eigen::MatrixXd& shapes, int mode,
                                        Eigen::Index computed) const;
  [[nodiscard]] ShapeDensity::Comparison compare(const fem::ParametricModes::Modes& modes, int mode,
                                                 Eigen::Index computed,
                                                 const ModalNoise& noise) const;
  /// Modes that may be mixed into a computed mode, at the measured entries of a shape.
  [[nodiscard]] ShapeDensity::Mixing mixing_of(const fem::ParametricModes::Modes& modes, int mode,
                                               Eigen::Index computed,
                                               const ModalNoise& noise) const;
  /// The probability that each measured mode is not spurious, given θ.
  [[nodiscard]] Eigen::VectorXd real(const fem::ParametricModes::Modes& modes,
                                     const ModalNoise& noise) const;
  [[nodiscard]] std::vector<int> match(const fem::ParametricModes::Modes& modes,
                                       const Eigen::MatrixXd& covariance,
                                       const ModalNoise& noise) const;
  /// ln(ε p₀(f) p₀(ψ)) of a measured mode.
  [[nodiscard]] double log_spurious(int mode) const;
  [[nodiscard]] Score score_with_doubt(const fem::ParametricModes::Modes& modes,
                                       const ModalNoise& noise) const;

  ModalData data_;
  bool numbered_ = false;  // true: frequencies only, uncorrelated and never spurious
  std::vector<int> with_frequency_;
  std::vector<std::vector<int>> entries_;  // measured sensors of each shape
  std::vector<std::optional<ShapeDensity>> shapes_;
};

}  // namespace wheeltap::identification
