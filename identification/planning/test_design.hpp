// The data of one design of a test: noise, whitening and simulated measurements.
#pragma once

#include <vector>

#include "identification/planning/normal_test.hpp"
#include "identification/planning/planned_structure.hpp"

namespace wheeltap::identification::planning {

/// A test design: the sensors that measure shapes (fewer than two: only frequencies are measured),
/// and the index of the added mass of a second test configuration (-1: no second configuration). In
/// the second configuration, only frequencies are measured.
struct TestDesign {
  std::vector<int> sensors = {};
  int mass = -1;

  bool operator==(const TestDesign&) const = default;
};

/// The uncertainty of identified modes in a record of length T. The coefficient of variation of a
/// frequency is either given, or follows from the formula for long records (Au 2017, Operational
/// Modal Analysis, section 16.1):
///
///   cov(f)² = ζ / (2π f T) + discrepancy².
///
/// The sd of shape entries refers to shapes whose largest entry over all candidate sensors is 1.
/// This sd is given for T = `reference_seconds`, and is proportional to 1/√T.
struct TestNoise {
  double seconds = 600.0;
  double damping = 0.01;
  double cov = 0.0;  ///< if > 0, `cov` replaces the formula
  double discrepancy = 0.0;
  double shape_sd = 0.02;
  double reference_seconds = 600.0;
  /// Values for each measured mode, which replace `cov` and `shape_sd`; the last value applies to
  /// all further modes. Empty: `cov` and `shape_sd` apply to all modes.
  std::vector<double> covs = {}, shape_sds = {};

  /// True if the case gives the coefficients of variation of the frequencies.
  [[nodiscard]] bool has_cov() const { return cov > 0.0 || !covs.empty(); }
  [[nodiscard]] double frequency_cov(double frequency_hz, int mode) const;
  [[nodiscard]] double shape_sd_now(int mode) const;
};

/// Standard normal numbers of one simulated test, the same for every design.
struct TestNumbers {
  Eigen::VectorXd frequencies, with_mass;  ///< one value per mode
  Eigen::VectorXd turns;   ///< per mode: rotation angle towards a close mode, divided by its sd τ
  Eigen::MatrixXd shapes;  ///< candidates × modes

  [[nodiscard]] static TestNumbers draw(const PlannedStructure& structure, std::uint64_t seed,
                                        std::uint64_t test);
};

/// Converts modes to whitened data relative to the intact structure. Frequencies: (ln f - ln f₀) /
/// cov. Shapes: κ (û - û₀) with the unit vector û = φ_S / |φ_S| at the sensors S, with the sign of
/// û₀, and κ = |φ₀| / (sd M), M = max |φ₀| over all candidates. For small angles, |κ (û - û')|² is
/// the χ² of ShapeDensity. Model errors may rotate a shape towards a close mode, with the sd τ of
/// the angle. In the direction of this rotation, the data are divided by √(1 + (κ τ |w|)²). Here, w
/// is the component of the close mode's shape that is normal to û₀, divided by |φ₀|.
///
/// Unknown coefficients add J z to the data, z ~ N(0, I). The columns of J are computed from the
/// differences between the data for z = 1 and for z = -1. With this prior of z, the data have the
/// covariance I + J Jᵀ. The last step multiplies the data by (I + J Jᵀ)^(-1/2).
class TestData {
 public:
  TestData(const PlannedStructure& structure, const TestNoise& noise, TestDesign design);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] const TestDesign& design() const { return design_; }
  /// Writes the mean of the data of a test with these modes to `out`.
  void mean(const TestModes& modes, Eigen::Ref<Eigen::VectorXd> out) const;
  /// Change of the expected data caused by the unknown coefficients; linear in their coordinates z.
  [[nodiscard]] Eigen::VectorXd unknown_effect(const Eigen::VectorXd& z) const;
  /// Writes the simulated data of a test with these modes to `out`.
  void measured(const TestModes& modes, const TestNumbers& numbers,
                Eigen::Ref<Eigen::VectorXd> out) const;
  /// The measured shape (sensors) of a mode; its largest entry over all candidates is 1 before
  /// noise is added.
  [[nodiscard]] Eigen::VectorXd measured_shape(const TestModes& modes, const TestNumbers& numbers,
                                               int mode) const;
  /// True if the data contain the shape of the mode: the mode is not close to another mode, and its
  /// shape is nonzero at one sensor or more.
  [[nodiscard]] bool has_shape(int mode) const;
  [[nodiscard]] bool with_shapes() const { return design_.sensors.size() >= 2; }

 private:
  struct Shape {
    int mode = 0;
    Eigen::Index first = 0;  // index of the mode's first datum
    double kappa = 0.0;
    Eigen::VectorXd unit;    // û₀
    Eigen::VectorXd turned;  // unit vector along w; empty: no close mode
    double shrink = 1.0;     // factor by which the data in this direction are multiplied
  };
  void take_shapes();
  void whiten_unknowns();
  void whiten(Eigen::Ref<Eigen::VectorXd> out) const;
  void frequencies(const TestModes& modes, Eigen::Ref<Eigen::VectorXd> out) const;
  void place(const Shape& shape, const Eigen::VectorXd& measured,
             Eigen::Ref<Eigen::VectorXd> out) const;

  const PlannedStructure& structure_;
  TestDesign design_;
  Eigen::VectorXd shape_sd_, cov_;  // per mode
  std::vector<Shape> shapes_;
  Eigen::MatrixXd effects_;     // first J, then (I + J Jᵀ)^(-1/2) J
  Eigen::MatrixXd directions_;  // eigenvectors of J Jᵀ with positive eigenvalues λ
  Eigen::VectorXd reductions_;  // 1 - 1/√(1 + λ)
  Eigen::Index size_ = 0;
};

/// Predicted modes for a defect at every location, at the quantiles 0, 1/S, …, 1 of the prior of
/// the severity.
struct PlacePredictions {
  std::vector<std::vector<TestModes>> modes;    ///< modes for each location and each quantile
  std::vector<std::vector<double>> severities;  ///< severity per location and quantile
  /// Two defects with severities at the middle quantiles, for every possible pair of locations.
  struct Pair {
    int a = 0, b = 0;  ///< locations, a < b
    TestModes modes;
  };
  std::vector<Pair> pairs = {};
};

/// Predicts the modes in parallel. `segments` is S, for unknown severities. If the structure is
/// impossible at a quantile of the severity, the prediction at the next lower quantile is used.
[[nodiscard]] PlacePredictions predict_places(const PlannedStructure& structure, int segments,
                                              int threads);

/// The models for all defect counts of the case, with at most two defects in total.
[[nodiscard]] std::vector<NormalModel> count_models(const std::vector<DefectKind>& kinds);

/// Makes the NormalTest of a design.
[[nodiscard]] NormalTest make_normal_test(const PlannedStructure& structure,
                                          const PlacePredictions& predictions,
                                          const TestData& data);

}  // namespace wheeltap::identification::planning
