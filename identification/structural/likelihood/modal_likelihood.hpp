// The likelihood of measured modes: frequencies and shapes, matched to the computed ones.
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

/// The scatters of one state.
struct ModalNoise {
  double cov = 0.0;       ///< of frequencies, where it is unknown
  double shape_sd = 1.0;  ///< multiplies the shapes' sd, where it is unknown
  double discrepancy = 0.0, shape_discrepancy = 0.0;
  double mixing = 0.0;                 ///< κ, of `mixing_sd`
  double stiffness_discrepancy = 0.0;  ///< σ of `StiffnessErrors`
  /// Of what an emulator gets wrong [Hz²], one a measured mode; empty: it is exact.
  std::vector<double> emulator_variance = {};
};

/// The eigenvalue [rad²/s²] whose frequency, √λ / 2π in floating point, is f [Hz] to the last bit
/// (or next to it, where none is).
[[nodiscard]] double eigenvalue_of(double frequency_hz);

/// What the model leaves out of K, δK, moves a frequency by δ = φ_jᵀ δK φ_j / 2λ_j, relative, and
/// mixes φ_k into φ_j by φ_jᵀ δK φ_k / (λ_j - λ_k). With entries φ_jᵀ δK φ_k / √(λ_j λ_k) off the
/// diagonal κ times as large as those on it, this is normal with sd
///
///   τ_jk = κ · 2δ √(λ_j λ_k) / |λ_j - λ_k|,   c_jk = -c_kj,
///
/// at most 1, where first order ends (Fox & Kapoor 1968, AIAA J. 6:2426, for the expansion). For
/// entries of a random symmetric matrix κ = 1/√2.
[[nodiscard]] double mixing_sd(const ModalNoise& noise, double first, double second);

/// With A the matching of measured to computed modes,
///
///   ln p(data | θ) = ln N(f_obs; f_A(θ), C) + Σ ln p(ψ_i | φ_A(i)(θ)),
///   C = C_noise + δ² diag(f_obs²) + diag(σ²_emulator),
///   C_noise = C of the data, or cov² diag(f_obs²),
///
/// shapes' densities as in shape_density.hpp, δ the discrepancy: what the model leaves out moves
/// each frequency by N(0, (δ f)²), which is integrated out, so that δ may be inferred from the
/// residuals.
///
/// Where no shape was measured, the i-th frequency is the i-th elastic mode. Where some were, A is
/// the assignment of least cost among the `candidates` lowest modes, of frequencies and shapes
/// together: modes may be missing from the data, or stand in another order; correlations of
/// frequencies count once A is known. It takes the best matching for the true one: where another
/// comes near, modes are close and both are alike.
///
/// With mixing (κ > 0) a shape's Σ has φ_A(i) mixed with every other computed mode by `mixing_sd`;
/// that takes the place of the turn, whose τ is added to that of the closest.
///
/// Where the data may hold modes that are none of the structure's, each with probability ε
/// (`ModalData::doubt`), frequencies' correlations are left out and
///
///   p(mode i | θ) = (1 - ε) N(f_i; f_A(i), C_ii) p(ψ_i | φ_A(i)) + ε p₀(f_i) p₀(ψ_i),
///
/// p₀ uniform over frequencies up to `kBand` times the highest measured, and over all lines. Beside
/// the computed modes A then has "none" to offer to each.
///
/// Modes whose eigenvalues are closer than `kClose` may have turned in their common plane by
/// α ~ N(0, τ²), τ² = `kMixing`² (1/gap² - 1/kClose²), gap relative: what a change of K by a
/// thousandth does to them. Of more than two such modes, each with the closest.
class ModalLikelihood {
 public:
  static constexpr double kClose = 0.05;
  static constexpr double kMixing = 1e-3;
  static constexpr double kBand = 1.5;

  /// Throws std::invalid_argument for data that do not fit together, naming the mode (from 1).
  explicit ModalLikelihood(ModalData data);

  /// Of one mode, as matched.
  struct Match {
    int computed = 0;           ///< 0-based, of the elastic modes
    double frequency_hz = 0.0;  ///< computed
    std::optional<ShapeDensity::Comparison> shape = {};
    double spurious = 0.0;        ///< P that it is none of the structure's, given θ
    double log_likelihood = 0.0;  ///< of this mode alone, where modes are doubted
  };
  struct Score {
    double log_likelihood = 0.0;
    double chi_square = 0.0;  ///< of frequencies and shapes; more likely spurious ones left out
    int freedoms = 0;         ///< numbers that it is of
    std::vector<Match> matches;
  };
  [[nodiscard]] Score score(const fem::ParametricModes::Modes& modes,
                            const ModalNoise& noise) const;
  /// What a measured shape has to say of errors of pieces: the comparison without these, the
  /// residual in units of the noise, and how it moves with each piece's error, m × pieces. Close
  /// modes are mixed as they may turn.
  struct ShapeErrors {
    ShapeDensity::Comparison without;
    Eigen::VectorXd residual;
    Eigen::MatrixXd sensitivities;
  };
  [[nodiscard]] ShapeErrors shape_errors(const fem::ParametricModes::Modes& modes, int mode,
                                         Eigen::Index computed, const ModalNoise& noise) const;
  /// ∂ ln p/∂θ_j at a given matching. False where modes may have turned or mixed.
  [[nodiscard]] bool slope(const fem::ParametricModes::Modes& modes,
                           const fem::ParametricModes::Slopes& slopes, const ModalNoise& noise,
                           std::span<double> out) const;
  /// ∂ ln p/∂f of each computed mode at a given matching, where no shape was measured.
  [[nodiscard]] std::vector<double> pulls(const fem::ParametricModes::Modes& modes,
                                          const ModalNoise& noise) const;

  /// C, and its part of a mode.
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const;
  [[nodiscard]] const ModalData& data() const { return data_; }
  /// Numbers measured, scales not counted.
  [[nodiscard]] int measured() const;
  [[nodiscard]] const std::optional<ShapeDensity>& shape(int mode) const {
    return shapes_[static_cast<std::size_t>(mode)];
  }
  /// Modes that must be computed: those measured, further ones that they may be, and those to be
  /// foretold; at most `available`.
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
  [[nodiscard]] std::vector<int> match(const fem::ParametricModes::Modes& modes,
                                       const Eigen::MatrixXd& covariance,
                                       const ModalNoise& noise) const;
  /// ln ε p₀(f) p₀(ψ) of a mode.
  [[nodiscard]] double log_spurious(int mode) const;
  [[nodiscard]] Score score_with_doubt(const fem::ParametricModes::Modes& modes,
                                       const ModalNoise& noise) const;

  ModalData data_;
  std::vector<int> with_frequency_;
  std::vector<std::vector<int>> entries_;  // sensors of each shape
  std::vector<std::optional<ShapeDensity>> shapes_;
};

}  // namespace wheeltap::identification
