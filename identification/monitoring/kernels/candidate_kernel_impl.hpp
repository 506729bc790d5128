// The loops of candidate_kernel.hpp for vectors of WHEELTAP_MONITORING_WIDTH doubles. Each source
// file that includes this header is compiled for one instruction set, without contraction to fused
// multiply-adds, so that results are bitwise equal on every processor.

#include <cstddef>
#include <cstring>

#include "identification/monitoring/kernels/candidate_kernel.hpp"
#include "identification/monitoring/kernels/lane_log.hpp"

namespace wheeltap::identification::monitoring::detail {
namespace {

constexpr int kWidth = WHEELTAP_MONITORING_WIDTH;
using Vec = double __attribute__((vector_size(kWidth * sizeof(double)), may_alias, aligned(8)));
constexpr double kLeastWeight = 1e-280;  // positive, so that a weight can recover
constexpr int kFlushed = 8;              // entries in a product before its logarithm is added

/// The rows of a tile, restricted to one vector of lanes.
struct Lanes {
  double* first;
  Vec& operator[](int row) const {
    return *reinterpret_cast<Vec*>(first + static_cast<std::ptrdiff_t>(row) * kTile);
  }
  [[nodiscard]] Lanes from(int row) const {
    return {first + static_cast<std::ptrdiff_t>(row) * kTile};
  }
};

inline Vec clamped_exp(Vec x) {
  const Vec limit = Vec{} + 700.0;
  x = x < -limit ? -limit : x;
  return base::lanes::exp<Vec>(x > limit ? limit : x);
}

/// Calls body(state, scratch, number of the first lane) for every vector of lanes.
template <class Body>
inline void each(const CandidateTiles& of, Body&& body) {
  const std::ptrdiff_t rows = of.layout.rows(), scratch = of.layout.scratch_rows();
  for (std::ptrdiff_t tile = 0; tile < of.tiles; ++tile)
    for (int lane = 0; lane < kTile; lane += kWidth)
      body(Lanes{of.state + tile * rows * kTile + lane},
           Lanes{of.scratch + tile * scratch * kTile + lane}, tile * kTile + lane);
}

void begin(const CandidateTiles& of, const RowStart& row) {
  const CandidateLayout& at = of.layout;
  const int p = at.features, block = at.block, hypotheses = at.hypotheses();
  const Vec zero{}, one = zero + 1.0;
  each(of, [&](Lanes state, Lanes scratch, std::ptrdiff_t) {
    for (int j = 0; j < p; ++j) {
      const Lanes f = state.from(at.sensitivity() + j * block * p);
      const Lanes fast = f.from((block - 2) * p), slow = f.from((block - 1) * p);
      for (int c = 0; c < p; ++c) {
        fast[c] *= row.fast;
        slow[c] *= row.slow;
      }
      if (row.is_present[j] == 0) continue;
      const Lanes to = scratch.from(at.projected() + j * p);
      for (int c = 0; c < p; ++c) to[c] = zero;
      for (int r = 0; r < block; ++r) {
        const double h = row.h[r];
        if (h == 0.0) continue;
        const Lanes from = f.from(r * p);
        for (int c = 0; c < p; ++c) to[c] += h * from[c];
      }
    }
    const Lanes scales = scratch.from(at.scales()), tails = scratch.from(at.tails()),
                log_ratio = scratch.from(at.log_ratio()), weight = state.from(at.weight());
    Vec most = zero, favourite = zero;
    for (int i = 0; i < hypotheses; ++i) {
      scales[i] = tails[i] = one;
      log_ratio[i] = zero;
      const Vec w = weight[i];
      favourite = w > most ? zero + static_cast<double>(i) : favourite;
      most = w > most ? w : most;
    }
    scratch[at.favourite()] = favourite;
    scratch[at.log_mass()] += log(most);
  });
}

/// Log of the density of the row with the shift, divided by the density without a shift. The inputs
/// are the product of the relative scales and the product of the Student t tails. For Gaussian
/// noise, `tails` is the logarithm of the second product.
template <bool kNormal>
inline Vec log_of(Vec scales, Vec tails, double degrees) {
  if constexpr (kNormal) return -0.5 * log(scales) + tails;
  return (0.5 * degrees) * log(scales) - (0.5 * (degrees + 1.0)) * log(tails);
}

/// Multiplies the products `scales` and `tails` of one hypothesis by the factors of an entry.
template <bool kNormal>
struct EntryTerms {
  double degrees, inverse_scale, inverse_tail, square;
  explicit EntryTerms(const Entry& entry)
      : degrees(entry.degrees),
        inverse_scale(1.0 / entry.s),
        inverse_tail(1.0 / (kNormal ? 1.0 : entry.degrees * entry.s + entry.v * entry.v)),
        square(entry.v * entry.v / entry.s) {}
  void add(Vec v, Vec s, Vec& scales, Vec& tails) const {
    scales *= s * inverse_scale;
    if constexpr (kNormal)
      tails -= 0.5 * (v * v / s - square);
    else
      tails *= (degrees * s + v * v) * inverse_tail;
  }
};

/// Writes the product of a shift's covariance and g to `spread`; returns g' covariance g.
inline Vec spread_of(int p, Lanes covariance, Lanes g, Lanes spread) {
  for (int i = 0, at = 0; i < p; ++i) {
    Vec sum{};
    const Vec gi = g[i];
    for (int k = 0; k < i; ++k, ++at) {
      const Vec c = covariance[at];
      sum += c * g[k];
      spread[k] += c * gi;
    }
    spread[i] = sum + covariance[at++] * gi;
  }
  Vec out{};
  for (int i = 0; i < p; ++i) out += g[i] * spread[i];
  return out;
}

template <bool kNormal>
double score_entry(const CandidateTiles& of, const Entry& entry) {
  const CandidateLayout& at = of.layout;
  const int p = at.features;
  const Vec zero{};
  const EntryTerms<kNormal> terms(entry);
  const double first_tail = kNormal ? 0.0 : 1.0;
  each(of, [&](Lanes state, Lanes scratch, std::ptrdiff_t) {
    const Lanes g = scratch.from(at.direction() + entry.e * p),
                projected = scratch.from(at.projected() + entry.j * p),
                scales = scratch.from(at.scales()), tails = scratch.from(at.tails());
    for (int c = 0; c < p; ++c) g[c] = projected[c];
    g[entry.j] += scratch[at.profile()];
    for (int e = 0; e < entry.e; ++e) {
      const Lanes before = scratch.from(at.direction() + e * p);
      for (int c = 0; c < p; ++c) g[c] -= entry.along[e] * before[c];
    }
    const Vec favourite = scratch[at.favourite()];
    Vec favoured_v = zero + entry.v, favoured_s = zero + entry.s;
    const auto add = [&](int i, Vec v, Vec s) {
      if (kNormal && entry.e == 0) tails[i] = zero;
      terms.add(v, s, scales[i], tails[i]);
      if constexpr (!kNormal) {
        const auto is = favourite == zero + static_cast<double>(i);
        favoured_v = is ? v : favoured_v;
        favoured_s = is ? s : favoured_s;
      }
    };
    for (int size = 0; size < kSizes; ++size) {
      const Vec variance = spread_of(p, state.from(at.covariance() + size * at.half()), g,
                                     scratch.from(at.spread() + size * p));
      const Lanes mean = state.from(at.mean() + size * p);
      Vec v = zero + entry.v;
      for (int c = 0; c < p; ++c) v -= g[c] * mean[c];
      add(size, v, entry.s + variance);
    }
    for (int k = 0; k < p; ++k) {
      const Vec gk = g[k], precision = state[at.precision() + k],
                along = gk * state[at.information() + k], square = gk * gk;
      for (int size = 0; size < kSizes; ++size) {
        const Vec variance = 1.0 / (precision + entry.prior[size * p + k]);
        add((1 + k) * kSizes + size, entry.v - along * variance, entry.s + square * variance);
      }
    }
    if (entry.e % kFlushed == kFlushed - 1) {
      const Lanes log_ratio = scratch.from(at.log_ratio());
      for (int i = 0; i < at.hypotheses(); ++i) {
        log_ratio[i] += log_of<kNormal>(scales[i], tails[i], entry.degrees);
        scales[i] = zero + 1.0;
        tails[i] = zero + first_tail;
      }
    }
    if constexpr (!kNormal) {
      const double nu = entry.degrees;
      const Vec square = favoured_v * favoured_v;
      scratch[at.log_mass()] += log_of<false>(favoured_s * terms.inverse_scale,
                                              (nu * favoured_s + square) * terms.inverse_tail, nu);
      scratch[at.inflation()] =
          base::lanes::max<Vec>(zero + 1.0, (nu + square / favoured_s) * (1.0 / (nu + 1.0)));
    }
  });
  if constexpr (kNormal) return 1.0;
  // One partial sum per lane of a tile, so that the sums do not depend on the width.
  alignas(64) double top = kExcluded, weights[kTile] = {}, sums[kTile] = {};
  each(of, [&](Lanes, Lanes scratch, std::ptrdiff_t) {
    const Vec mass = scratch[at.log_mass()];
    for (int l = 0; l < kWidth; ++l) top = mass[l] > top ? mass[l] : top;
  });
  if (top < 0.5 * kExcluded) return 0.0;
  each(of, [&](Lanes, Lanes scratch, std::ptrdiff_t lane) {
    const Vec weight = clamped_exp(scratch[at.log_mass()] - top);
    const Lanes to{weights + lane % kTile}, sum{sums + lane % kTile};
    to[0] += weight;
    sum[0] += weight * scratch[at.inflation()];
  });
  double weight = 0.0, sum = 0.0;
  for (int l = 0; l < kTile; ++l) {
    weight += weights[l];
    sum += sums[l];
  }
  return sum / weight;
}

double score(const CandidateTiles& of, const Entry& entry) {
  return entry.degrees > 1e300 ? score_entry<true>(of, entry) : score_entry<false>(of, entry);
}

void update(const CandidateTiles& of, const Entry& entry, double inflated) {
  const CandidateLayout& at = of.layout;
  const int p = at.features;
  const double inverse = 1.0 / inflated, scaled = entry.v * inverse;
  each(of, [&](Lanes state, Lanes scratch, std::ptrdiff_t) {
    const Lanes g = scratch.from(at.direction() + entry.e * p),
                precision = state.from(at.precision()), information = state.from(at.information());
    for (int size = 0; size < kSizes; ++size) {
      const Lanes spread = scratch.from(at.spread() + size * p),
                  mean = state.from(at.mean() + size * p),
                  covariance = state.from(at.covariance() + size * at.half());
      Vec total = Vec{} + inflated, v = Vec{} + entry.v;
      for (int c = 0; c < p; ++c) {
        total += g[c] * spread[c];
        v -= g[c] * mean[c];
      }
      const Vec one_over = 1.0 / total, step = v * one_over;
      for (int i = 0, half = 0; i < p; ++i) {
        const Vec si = spread[i], along = si * one_over;
        mean[i] += si * step;
        for (int k = 0; k <= i; ++k, ++half) covariance[half] -= along * spread[k];
      }
    }
    for (int k = 0; k < p; ++k) {
      const Vec gk = g[k];
      precision[k] += gk * gk * inverse;
      information[k] += gk * scaled;
    }
  });
}

void finish(const CandidateTiles& of, int entries, double degrees, const double* gains) {
  const CandidateLayout& at = of.layout;
  const int p = at.features, states = at.states(), hypotheses = at.hypotheses();
  const bool normal = degrees > 1e300;
  each(of, [&](Lanes state, Lanes scratch, std::ptrdiff_t) {
    for (int r = 0; r < states; ++r) {
      const Lanes f = state.from(at.sensitivity() + r * p);
      for (int e = 0; e < entries; ++e) {
        const double gain = gains[static_cast<std::ptrdiff_t>(e) * states + r];
        if (gain == 0.0) continue;
        const Lanes g = scratch.from(at.direction() + e * p);
        for (int c = 0; c < p; ++c) f[c] -= gain * g[c];
      }
    }
    const Lanes scales = scratch.from(at.scales()), tails = scratch.from(at.tails()),
                log_ratio = scratch.from(at.log_ratio());
    Vec most = Vec{} + kExcluded;
    for (int i = 0; i < hypotheses; ++i) {
      if (entries % kFlushed != 0)
        log_ratio[i] += normal ? log_of<true>(scales[i], tails[i], degrees)
                               : log_of<false>(scales[i], tails[i], degrees);
      most = base::lanes::max<Vec>(most, log_ratio[i]);
    }
    scratch[at.log_most()] = most;
  });
}

void weigh(const CandidateTiles& of, double offset, const double* reference) {
  const CandidateLayout& at = of.layout;
  each(of, [&](Lanes state, Lanes scratch, std::ptrdiff_t lane) {
    Vec limit, sum{};
    std::memcpy(&limit, reference + lane, sizeof limit);
    limit -= offset;
    const Lanes weight = state.from(at.weight()), log_ratio = scratch.from(at.log_ratio());
    for (int i = 0; i < at.hypotheses(); ++i) {
      const Vec w = weight[i] * clamped_exp(log_ratio[i] - limit);
      weight[i] = w;
      sum += w;
    }
    scratch[at.total()] = sum;
  });
}

void normalise(const CandidateTiles* draws, int count, const double* totals, double share) {
  const Vec least = Vec{} + kLeastWeight;
  const double kept = 1.0 - share, spread = share / count;
  for (int tile = 0; tile < draws->tiles; ++tile)
    for (int lane = 0; lane < kTile; lane += kWidth) {
      Vec total;
      std::memcpy(&total, totals + tile * kTile + lane, sizeof total);
      const Vec inverse = 1.0 / total;
      const auto weight_of = [&](int m, int i) -> Vec& {
        const CandidateLayout& at = draws[m].layout;
        const Lanes state{draws[m].state + static_cast<std::ptrdiff_t>(tile) * at.rows() * kTile +
                          lane};
        return state[at.weight() + i];
      };
      for (int i = 0; i < draws->layout.hypotheses(); ++i) {
        Vec sum{};
        for (int m = 0; m < count; ++m) sum += weight_of(m, i) *= inverse;
        for (int m = 0; m < count; ++m) {
          Vec& weight = weight_of(m, i);
          weight = base::lanes::max<Vec>(kept * weight + spread * sum, least);
        }
      }
    }
}

}  // namespace

extern const CandidateKernel WHEELTAP_CANDIDATE_KERNEL = {.name = WHEELTAP_MONITORING_NAME,
                                                          .begin = begin,
                                                          .score = score,
                                                          .update = update,
                                                          .finish = finish,
                                                          .weigh = weigh,
                                                          .normalise = normalise};

}  // namespace wheeltap::identification::monitoring::detail
