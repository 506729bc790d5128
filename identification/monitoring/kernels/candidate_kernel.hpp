// The loops over candidate onsets of one parameter draw (candidate_bank.hpp), with one candidate in
// each SIMD lane.
//
// The loops are compiled for several SIMD widths, so this header must not include library code
// (base/simd.hpp). The results do not depend on the SIMD width.
//
// Candidates are stored in tiles of kTile. A tile is a list of rows of kTile numbers; the layout
// gives the first row of each quantity. Covariances hold the lower triangle, row by row. If one
// feature shifts alone, its shift has the precision q = 1/(prior variance) + `precision` and the
// mean `information`/q. The sums `precision` and `information` are common to all prior sizes.
// Weights (not their logarithms) are stored at the index hypothesis · kSizes + size. In hypothesis
// 0, all features shift; in hypothesis 1 + j, only feature j shifts.
#pragma once

namespace wheeltap::identification::monitoring::detail {

inline constexpr int kTile = 8;              ///< candidates in a tile
inline constexpr int kSizes = 3;             ///< number of prior sizes of a shift
inline constexpr double kExcluded = -1e300;  ///< log mass of lanes that are not used

struct CandidateLayout {
  int features, block;
  [[nodiscard]] int states() const { return features * block; }
  [[nodiscard]] int hypotheses() const { return (1 + features) * kSizes; }
  [[nodiscard]] int half() const { return features * (features + 1) / 2; }
  // First rows of a tile:
  [[nodiscard]] int sensitivity() const { return 0; }             ///< [state p + feature]
  [[nodiscard]] int mean() const { return states() * features; }  ///< [size p + feature]
  [[nodiscard]] int covariance() const { return mean() + kSizes * features; }
  [[nodiscard]] int precision() const { return covariance() + kSizes * half(); }
  [[nodiscard]] int information() const { return precision() + features; }
  [[nodiscard]] int weight() const { return information() + features; }
  [[nodiscard]] int rows() const { return weight() + hypotheses(); }
  // First rows of a tile of scratch memory:
  [[nodiscard]] int profile() const { return 0; }   ///< r(t - τ), set by the caller
  [[nodiscard]] int log_mass() const { return 1; }  ///< set by the caller
  [[nodiscard]] int favourite() const { return 2; }
  [[nodiscard]] int inflation() const { return 3; }
  [[nodiscard]] int log_most() const { return 4; }  ///< largest log ratio of the hypotheses
  [[nodiscard]] int total() const { return 5; }     ///< see `weigh`
  [[nodiscard]] int projected() const { return 6; }
  [[nodiscard]] int direction() const { return projected() + features * features; }
  [[nodiscard]] int spread() const { return direction() + features * features; }
  [[nodiscard]] int scales() const { return spread() + kSizes * features; }
  [[nodiscard]] int tails() const { return scales() + hypotheses(); }
  [[nodiscard]] int log_ratio() const { return tails() + hypotheses(); }
  [[nodiscard]] int scratch_rows() const { return log_ratio() + hypotheses(); }
};

/// The tiles of one draw.
struct CandidateTiles {
  CandidateLayout layout;
  int tiles;
  double* state;    ///< tiles x layout.rows() x kTile
  double* scratch;  ///< tiles x layout.scratch_rows() x kTile
};

struct RowStart {
  const double* h;         ///< observation vector of every feature
  double fast, slow;       ///< decays of both drifts since the previous row
  const char* is_present;  ///< p
};

/// The entry of feature j in a row; e is its index among the present entries of the row.
struct Entry {
  int j, e;
  double v, s;          ///< innovation without a shift, and its variance
  double degrees;       ///< degrees of freedom of Student's t; infinity: Gaussian
  const double* along;  ///< h'k_i of feature j for the gains k_i of the e earlier entries
  const double* prior;  ///< inverse prior variances (kSizes x p)
};

struct CandidateKernel {
  const char* name;
  /// Multiplies the drift sensitivities by the decays, projects them on h, resets the densities.
  void (*begin)(const CandidateTiles& tiles, const RowStart& row);
  /// Multiplies the density of the row under every hypothesis by the density of an entry. Densities
  /// are relative to the density without a shift. Returns the mean noise inflation of the
  /// candidates' most probable hypotheses, weighted by the candidates' posterior masses; 0 if all
  /// candidates are excluded.
  double (*score)(const CandidateTiles& tiles, const Entry& entry);
  /// Conditions shifts on the entry of the last call of `score`, with the variance `inflated`.
  void (*update)(const CandidateTiles& tiles, const Entry& entry, double inflated);
  /// Updates the sensitivities with the gains of the entries (states x `entries`, entry by entry).
  void (*finish)(const CandidateTiles& tiles, int entries, double degrees, const double* gains);
  /// Multiplies the weights by exp(log ratio + offset - reference); `reference` is tiles x kTile.
  void (*weigh)(const CandidateTiles& tiles, double offset, const double* reference);
  /// Divides the weights of all draws by `totals` (tiles x kTile) and redistributes `share` evenly
  /// between the draws.
  void (*normalise)(const CandidateTiles* draws, int count, const double* totals, double share);
};

extern const CandidateKernel kBaselineCandidates;
#ifdef WHEELTAP_X86_KERNELS
extern const CandidateKernel kAvx2Candidates;
extern const CandidateKernel kAvx512Candidates;
#endif

}  // namespace wheeltap::identification::monitoring::detail
