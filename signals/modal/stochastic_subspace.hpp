// Covariance-driven stochastic subspace identification: modes from output covariances, with the
// covariance of all results.
//
//   H = [R_{i+j+1}], i = 0 … p, j = 0 … q - 1,  H = U S Vᵀ,  U₁: the first n left singular vectors;
//   A = U₁↑⁺ U₁↓ (U₁ without its last, without its first block row), C = the first block row of U₁;
//   A ψ = μ ψ, λ = ln μ / Δt, f = |λ| / 2π, ζ = -Re λ / |λ|, φ = C ψ.
// The method is that of Peeters & De Roeck 1999 (MSSP 13:855). The method assumes stationary
// excitation that is white within the band, and white sensor noise. The sensor noise affects only
// the covariance R₀, which the method does not use.
//
// Uncertainty (Reynders, Pintelon & De Roeck 2008, MSSP 22:948; Döhler & Mevel 2013, MSSP 38:346):
// the Hankel matrices H_k of n_b data blocks give T_k = (vec H_k - vec H) / √(n_b (n_b - 1)) and
// cov(vec H) = Σ T_k T_kᵀ. For a result x with the derivative J with respect to vec H, Δx_k = J T_k
// and cov(x) = Σ Δx_k Δx_kᵀ. The derivative of the span of U₁ is computed for the full H, not for H
// truncated to rank n. With P = UᵀΔH V, the element in column i ≤ n and row j > n is
//   (UᵀΔU₁)_{ji} = (s_i P_{ji} + s_j P_{ij}) / (s_i² - s_j²).
// This element does not depend on n. The matrix UᵀΔU₁ is therefore computed once, and each model
// order uses a part of this matrix.
#pragma once

#include <complex>
#include <vector>

#include "base/eigen.hpp"
#include "signals/modal/output_covariances.hpp"

namespace wheeltap::signals {

struct SubspaceOptions {
  double step = 1.0;      ///< Δt [s]
  int columns = 0;        ///< block columns q; 0: half of the lags. p = lags - q, with R_1 …
                          ///< R_{p+q}
  int largest_order = 0;  ///< largest model order; 0: the largest order that H allows
  int threads = 0;
};

/// A mode of one model order, from a conjugate pair of eigenvalues λ, λ*.
struct Pole {
  int order = 0;
  int place = 0;                    ///< index among the eigenvalues of this order
  std::complex<double> eigenvalue;  ///< λ [rad/s], Im λ > 0
  double frequency_hz = 0.0;
  double damping = 0.0;
  Eigen::VectorXcd shape;     ///< one entry per channel, largest entry 1
  double frequency_sd = 0.0;  ///< standard deviation of the frequency [Hz]; NaN if not requested
  double damping_sd = 0.0;
};

/// Poles of one model order, and the change of each result that each data block causes (`…_moves`).
/// If M is the matrix of these changes (results × blocks), the covariance of the results is M Mᵀ.
struct MovedPoles {
  std::vector<Pole> poles;
  Eigen::MatrixXd frequency_moves;  ///< poles × blocks [Hz]
  Eigen::MatrixXd damping_moves;    ///< poles × blocks
  /// One matrix per pole with one column per block: the real parts of the shape, then the imaginary
  /// parts.
  std::vector<Eigen::MatrixXd> shape_moves;
};

/// Limits of frequency and damping ratio of the poles that `StochasticSubspace::poles` returns.
struct PoleWindow {
  double lowest_hz = 0.0, highest_hz = 1e300;
  double lowest_damping = -1.0, highest_damping = 1.0;
};

/// A block Hankel matrix H with its covariance, cov(vec H) = Σ vec(moves_k) vec(moves_k)ᵀ.
struct HankelFactor {
  Eigen::MatrixXd hankel = {};              ///< each block row has one row per sensor
  std::vector<Eigen::MatrixXd> moves = {};  ///< T_k
  Eigen::VectorXd scale = {};               ///< scale factor of each sensor [unit of the sensor]
};

/// Arranges the covariances R_1, R_2, … as a block Hankel matrix with `columns` block columns.
[[nodiscard]] Eigen::MatrixXd block_hankel(const Eigen::MatrixXd& stacked, Eigen::Index channels,
                                           Eigen::Index columns);

class StochasticSubspace {
 public:
  /// Throws std::invalid_argument for a time step <= 0, a number of columns that leaves no block
  /// row, and a model order too large for H.
  StochasticSubspace(const OutputCovariances& covariances, SubspaceOptions options);

  /// Uses a given Hankel matrix, for example that of merged set-ups; `columns` of the options is
  /// not used. Throws std::invalid_argument in the same cases as the other constructor.
  StochasticSubspace(const HankelFactor& factor, SubspaceOptions options);

  [[nodiscard]] int largest_order() const { return largest_; }
  [[nodiscard]] const Eigen::VectorXd& singular_values() const { return s_; }

  /// Returns the poles of an even model order within the limits `window`, by frequency, with
  /// standard deviations.
  [[nodiscard]] std::vector<Pole> poles(int order, const PoleWindow& window) const;

  /// Returns the poles with the indices `places`, and the change of each pole that each data block
  /// causes.
  [[nodiscard]] MovedPoles moved_poles(int order, const std::vector<int>& places) const;

 private:
  struct Realisation;  // A, C, their eigenvectors and data for derivatives
  [[nodiscard]] Realisation realise(int order) const;
  [[nodiscard]] Pole pole(const Realisation& model, int place) const;

  /// Decomposes H and computes the rotation of its singular vectors for each change of H; `move(k)`
  /// returns change k.
  template <class Move>
  void decompose(const Eigen::MatrixXd& h, const Move& move, const SubspaceOptions& options);

  double step_;
  int channels_, largest_, blocks_;
  Eigen::VectorXd scale_, s_;
  Eigen::MatrixXd u_;      // all left singular vectors
  Eigen::MatrixXd turns_;  // UᵀΔU₁ of all blocks side by side: rows of H × (blocks · largest)
};

/// Computes the modal assurance criterion |φ₁ᴴφ₂|² / (φ₁ᴴφ₁ φ₂ᴴφ₂) (Allemang & Brown 1982).
[[nodiscard]] double modal_assurance(const Eigen::Ref<const Eigen::VectorXcd>& a,
                                     const Eigen::Ref<const Eigen::VectorXcd>& b);

/// Computes the modal phase collinearity (Juang & Pappa 1985), ((λ₁ - λ₂) / (λ₁ + λ₂))², with the
/// eigenvalues λ₁, λ₂ of the covariance of real and imaginary parts about zero. The collinearity is
/// 1 if the entries of the shape lie on a line through 0 in the complex plane, and 0 if the entries
/// have no preferred direction.
[[nodiscard]] double phase_collinearity(const Eigen::Ref<const Eigen::VectorXcd>& shape);

/// Computes the mean phase deviation [rad] of a mode shape (Reynders 2012, section 3.1). This
/// deviation is the mean angle between an entry and the best-fitting line of all entries, weighted
/// by the magnitudes of the entries.
[[nodiscard]] double mean_phase_deviation(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace wheeltap::signals
