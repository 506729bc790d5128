// Evidences for the number and locations of defects, for a test with normally distributed data.
#pragma once

#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "identification/planning/normal_kernels.hpp"

namespace wheeltap::identification::planning {

/// One possible location of a defect, and the change of the whitened data due to a defect at this
/// location.
struct NormalPlace {
  int kind = 0;
  double prior = 1.0;  ///< P(location | one defect of the kind)
  /// Matrix (data values) × (S + 1): change of the mean data by the defect, in standard deviations,
  /// at the quantiles 0, 1/S, …, 1 of the severity's prior. One column if the severity is known.
  Eigen::MatrixXd nodes;
};

/// The interaction of two defects at the typical nodes of their locations. The interaction is the
/// change of the mean data due to both defects together, minus the sum of the changes due to each
/// defect alone.
struct NormalInteraction {
  int a = 0, b = 0;  ///< locations, a < b
  Eigen::VectorXd data;
};

/// Returns the node that represents the direction of a location: the middle one.
[[nodiscard]] constexpr Eigen::Index typical_node(Eigen::Index nodes) {
  return nodes > 2 ? nodes / 2 : nodes - 1;
}

/// Number of defects of each kind (at most two in total), and the prior probability of these
/// numbers.
struct NormalModel {
  std::vector<int> counts;
  double prior = 0.0;
};

/// A test whose data y - y₀ have unit covariance. Their mean is 0 (intact), Δ_a(s) (one defect) or
///
///   Δ_a(s) + Δ_b(t) + u_a(s) u_b(t) I_ab
///
/// (two defects at locations a ≠ b). u_a(s) is the component of Δ_a(s) along the typical node of
/// location a, scaled to 1 at this node; I_ab is the interaction. p ~ U(0, 1) is the prior
/// cumulative probability of severity s; Δ_a is linear between nodes. Then
///
///   p(y | a) = Σ over segments ∫ N(y; Δ_a(p), I) dp,
///
/// Each integrand is normal in p, so the integral has a closed form, which is exact for a piecewise
/// linear Δ_a. For two defects, the integrand uses the slopes at the best-fitting (p, q). The
/// integral over p is computed by quadrature, and the integral over q in closed form. NormalTest
/// ignores two defects at one location. The sum over pairs (a, b) has `pairs` terms: the pairs with
/// the largest approximate weights, and a systematic sample of the other pairs (Fearnhead &
/// Clifford 2003, J. R. Stat. Soc. B 65:887).
class NormalTest {
 public:
  /// Throws std::invalid_argument if a model has more than two defects, no model is the
  /// intact structure, locations have different numbers of data, or a kind has no
  /// location.
  NormalTest(std::vector<NormalPlace> places, std::vector<NormalModel> models, int pairs = 96,
             const std::vector<NormalInteraction>& interactions = {});

  struct Pair {
    int a = 0, b = 0;         ///< locations; a < b if both are of one kind
    double log_weight = 0.0;  ///< ln [p(y, a, b | model) / p(y | intact)], with sampling weight
  };
  /// The evidences for one data vector, divided by the evidence of the intact structure.
  struct Answer {
    std::vector<double> log_models;        ///< ln p(y | model) / p(y | intact)
    std::vector<double> log_places;        ///< ln p(y | one defect at the location) / p(y | intact)
    std::vector<std::vector<Pair>> pairs;  ///< pairs of each model; empty for models of fewer than
                                           ///< two defects
    double log_all = 0.0;                  ///< ln p(y) / p(y | intact)
    /// ln P(at least one defect | y) / P(none | y)
    double log_odds = 0.0;
  };

  /// Input of `answer`: pointers to the data of one test, and to the scalar products of the data
  /// with all nodes.
  struct Measured {
    const double* data = nullptr;
    const double* products = nullptr;
  };
  /// Scalar products of the columns of `data` with all nodes.
  [[nodiscard]] Eigen::MatrixXd products(const Eigen::MatrixXd& data) const;
  /// Computes the evidences for one test; reuses the memory of `out`.
  void answer(const Measured& measured, Answer& out) const;
  /// ln p(y | a, b) / p(y | intact) for two defects.
  [[nodiscard]] double log_pair(const Measured& measured, int a, int b) const;
  /// ln P(a, b | two defects of their kinds).
  [[nodiscard]] double log_pair_prior(int model, int a, int b) const;

  [[nodiscard]] const std::vector<NormalPlace>& places() const { return places_; }
  [[nodiscard]] const std::vector<NormalModel>& models() const { return models_; }
  [[nodiscard]] Eigen::Index data() const { return nodes_.rows(); }
  /// Index of the model without defects.
  [[nodiscard]] int intact() const { return intact_; }

  /// The nodes of a location lie approximately on the curve c v + α c (c - τ) w. v is the typical
  /// direction, and c the component along v. w is the unit vector normal to v along which the nodes
  /// deviate most. w is a sum of the nodes with weights `of_nodes` (zero for a straight line). A
  /// node deviates from the straight line by at most c · slope, and from the curve by at most c ·
  /// rest.
  struct Bend {
    Eigen::VectorXd of_nodes;
    double slope = 0.0, alpha = 0.0, tau = 0.0, rest = 0.0;
  };

 private:
  struct PairList;
  struct Position;

  [[nodiscard]] std::shared_ptr<const PairList> list_pairs(const std::vector<int>& kinds) const;
  /// Scalar products of all sensitivity vectors v and curvature vectors w (`bends_`): 2 columns per
  /// damage location.
  [[nodiscard]] Eigen::MatrixXd directions_gram() const;
  void set_interactions(const std::vector<NormalInteraction>& interactions);
  [[nodiscard]] double log_place(const double* products, int a) const;
  [[nodiscard]] double interaction_product(const float* data, Eigen::Index column) const;
  [[nodiscard]] Position position(const double* products, int place, double p) const;
  /// Quadratic approximation of the exponent of a pair about its best severities. The unit of the
  /// coordinates is a segment.
  struct Fit {
    Quadratic q;
    Rectangle r;
    std::array<double, 2> best;
    double log_area;
    [[nodiscard]] double log_evidence() const { return log_integral(q, r, best) - log_area; }
    [[nodiscard]] double exponent() const { return value_at(q, best); }
  };
  [[nodiscard]] Fit fit_pair(const double* products, int a, int b, double mixed) const;
  /// The data as input of interaction_product, padded with zeros.
  [[nodiscard]] const float* single_precision(const Measured& measured) const;
  struct Screened;
  void screen(const Measured& measured, const PairList& list, const float* data,
              Screened& out) const;
  void fit_curved(const PairList& list, float square, Screened& out) const;
  void fit_uncertain(const Measured& measured, const PairList& list, const float* data,
                     Screened& out) const;
  void add_pairs(const Measured& measured, const PairList& list, std::vector<Pair>& out) const;

  std::vector<NormalPlace> places_;
  std::vector<NormalModel> models_;
  int intact_ = -1;
  std::size_t most_pairs_;
  Eigen::MatrixXd nodes_;                               // nodes of all locations, data × nodes
  std::vector<double> tiles_;                           // `nodes_` in tiles, for products_with_tile
  Eigen::MatrixXd gram_;                                // scalar products of all pairs of nodes
  std::vector<Eigen::Index> first_;                     // first node of each location, and the end
  std::vector<double> squares_;                         // |node|²
  std::vector<double> next_products_;                   // node · next node of the location
  std::vector<Eigen::Index> typical_;                   // typical node of each location
  std::vector<double> typical_norm_;                    // norm of the typical node; 0: no effect
  std::vector<std::vector<double>> along_;              // nodes projected on the typical node
  std::vector<Bend> bends_;                             // per location
  std::vector<std::shared_ptr<const PairList>> pairs_;  // per model; may be null
  /// Size: data values (padded with zeros) × interacting pairs; single precision for speed
  Eigen::MatrixXf interactions_;
  Eigen::MatrixXi column_of_;                   // per pair of locations; -1: no interaction
  std::vector<double> interaction_square_;      // per column: |I|²
  std::vector<std::size_t> interaction_first_;  // per column: its start in interaction_nodes_
  std::vector<double> interaction_nodes_;       // I · nodes of location a, then of location b
};

}  // namespace wheeltap::identification::planning
