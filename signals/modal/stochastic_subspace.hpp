// Covariance-driven stochastic subspace identification: modes from output covariances, with the
// covariance of all results.
//
//   H = [R_{i+j+1}], i = 0 … p, j = 0 … q - 1,  H = U S Vᵀ,  U₁ its first n left singular vectors;
//   A = U₁↑⁺ U₁↓ (without the last, without the first block row), C = the first block row of U₁;
//   A ψ = μ ψ, λ = ln μ / Δt, f = |λ| / 2π, ζ = -Re λ / |λ|, φ = C ψ.
//
// Peeters & De Roeck 1999 (MSSP 13:855). Assumes stationary excitation that is white within the
// band, and white sensor noise. The noise affects only R₀, which is not used.
//
// Uncertainty (Reynders, Pintelon & De Roeck 2008, MSSP 22:948; Döhler & Mevel 2013, MSSP 38:346):
// with H_k of n_b blocks, T_k = (vec H_k - vec H) / √(n_b (n_b - 1)) has Σ T_k T_kᵀ = cov(vec H).
// Δx_k = J T_k, with the derivative J of x to H, has cov(x) = Σ Δx_k Δx_kᵀ. The derivative of the
// span of U₁ is that of the full H and not that of H truncated to rank n. With P = UᵀΔH V, column i
// ≤ n, row j > n,
//   (UᵀΔU₁)_{ji} = (s_i P_{ji} + s_j P_{ij}) / (s_i² - s_j²),
// which does not depend on n. It is therefore computed once, and each order uses a part of the
// result.
#pragma once

#include <complex>
#include <vector>

#include "base/eigen.hpp"
#include "signals/modal/output_covariances.hpp"

namespace wheeltap::signals {

struct SubspaceOptions {
  double step = 1.0;      ///< Δt [s]
  int columns = 0;        ///< q; 0: half of the lags. p = lags - q, with R_1 … R_{p+q}
  int largest_order = 0;  ///< 0: as large as H allows
  int threads = 0;
};

/// One mode of a pair λ, λ* of one order.
struct Pole {
  int order = 0;
  int place = 0;                    ///< index among the eigenvalues of that order
  std::complex<double> eigenvalue;  ///< λ [rad/s], Im λ > 0
  double frequency_hz = 0.0;
  double damping = 0.0;
  Eigen::VectorXcd shape;     ///< by channel, largest entry 1
  double frequency_sd = 0.0;  ///< [Hz]; NaN if not requested
  double damping_sd = 0.0;
};

/// Poles of one order with the change of each by each data block, from which cov(x) = moves ·
/// movesᵀ.
struct MovedPoles {
  std::vector<Pole> poles;
  Eigen::MatrixXd frequency_moves;  ///< poles × blocks [Hz]
  Eigen::MatrixXd damping_moves;    ///< poles × blocks
  /// One per pole: real parts of the shape over imaginary parts, × blocks.
  std::vector<Eigen::MatrixXd> shape_moves;
};

/// Limits within which a pole's uncertainty is computed.
struct PoleWindow {
  double lowest_hz = 0.0, highest_hz = 1e300;
  double lowest_damping = -1.0, highest_damping = 1.0;
};

/// A Hankel matrix with a factor of its covariance, Σ moves_k moves_kᵀ, as vectors.
struct HankelFactor {
  Eigen::MatrixXd hankel = {};              ///< each block row has one row per sensor
  std::vector<Eigen::MatrixXd> moves = {};  ///< T_k
  Eigen::VectorXd scale = {};               ///< one per sensor [its unit]
};

/// The covariances R_1, R_2, … as a block Hankel matrix with `columns` block columns.
[[nodiscard]] Eigen::MatrixXd block_hankel(const Eigen::MatrixXd& stacked, Eigen::Index channels,
                                           Eigen::Index columns);

class StochasticSubspace {
 public:
  /// Throws std::invalid_argument for a step <= 0, too many columns for any row, and an order too
  /// large for H.
  StochasticSubspace(const OutputCovariances& covariances, SubspaceOptions options);

  /// Uses a given Hankel matrix, for example a merged one; `columns` of the options is not used.
  /// Throws std::invalid_argument like the other constructor.
  StochasticSubspace(const HankelFactor& factor, SubspaceOptions options);

  [[nodiscard]] int largest_order() const { return largest_; }
  [[nodiscard]] const Eigen::VectorXd& singular_values() const { return s_; }

  /// The poles of an even order within the window, by frequency, with standard deviations.
  [[nodiscard]] std::vector<Pole> poles(int order, const PoleWindow& window) const;

  /// The poles of an order with these indices, with their changes by each data block.
  [[nodiscard]] MovedPoles moved_poles(int order, const std::vector<int>& places) const;

 private:
  struct Realisation;  // A, C, their eigenvectors and data for derivatives
  [[nodiscard]] Realisation realise(int order) const;
  [[nodiscard]] Pole pole(const Realisation& model, int place) const;

  /// Decomposes H and computes the rotation of its singular vectors for each change of H; `move`
  /// gives the change with a number.
  template <class Move>
  void decompose(const Eigen::MatrixXd& h, const Move& move, const SubspaceOptions& options);

  double step_;
  int channels_, largest_, blocks_;
  Eigen::VectorXd scale_, s_;
  Eigen::MatrixXd u_;      // all left singular vectors
  Eigen::MatrixXd turns_;  // UᵀΔU₁ of all blocks side by side: rows of H × (blocks · largest)
};

/// |φ₁ᴴφ₂|² / (φ₁ᴴφ₁ φ₂ᴴφ₂), the modal assurance criterion (Allemang & Brown 1982).
[[nodiscard]] double modal_assurance(const Eigen::Ref<const Eigen::VectorXcd>& a,
                                     const Eigen::Ref<const Eigen::VectorXcd>& b);

/// Modal phase collinearity (Juang & Pappa 1985): 1 if the entries lie on a line through 0 of the
/// complex plane, 0 if they have no preferred direction. ((λ₁ - λ₂) / (λ₁ + λ₂))², with the
/// eigenvalues of the covariance of real and imaginary parts about zero.
[[nodiscard]] double phase_collinearity(const Eigen::Ref<const Eigen::VectorXcd>& shape);

/// Mean phase deviation [rad] (Reynders 2012, section 3.1): mean angle between an entry and the
/// best-fitting line of all entries, weighted by their magnitudes.
[[nodiscard]] double mean_phase_deviation(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace wheeltap::signals
