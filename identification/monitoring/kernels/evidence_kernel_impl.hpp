// The loop of evidence_kernel.hpp for vectors of WHEELTAP_MONITORING_WIDTH doubles. Each source
// file that includes this header is compiled for one instruction set, without contraction to fused
// multiply-adds, so that results are bitwise equal on every processor.

#include <cstring>

#include "identification/monitoring/kernels/evidence_kernel.hpp"
#include "identification/monitoring/kernels/lane_log.hpp"

namespace wheeltap::identification::monitoring::detail {
namespace {

constexpr int kWidth = WHEELTAP_MONITORING_WIDTH;
using Vec = double __attribute__((vector_size(kWidth * sizeof(double))));

inline Vec load(const double* from) {
  Vec out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
inline void store(const Vec& value, double* to) {
  std::memcpy(to, &value, sizeof value);
}

/// Processes lanes first … first + kWidth - 1. kColumns: number of terms + 1, or 0 for any number.
template <int kColumns>
void accumulate_lanes(const EvidenceRows& of, int first, const EvidenceSums& sums) {
  constexpr int kRoom = kColumns > 0 ? kColumns : kMostColumns;
  const int columns = kColumns > 0 ? kColumns : of.terms + 1;
  const Vec zero{}, one = zero + 1.0;
  const Vec fast_ratio = load(of.fast_ratio + first), slow_ratio = zero + of.slow_ratio;
  Vec ff = fast_ratio, fs = zero, ss = slow_ratio, product = one, log_scales = zero;
  Vec fast[kRoom], slow[kRoom], white[kRoom], gram[kRoom * (kRoom + 1) / 2];
  for (int i = 0; i < columns; ++i) fast[i] = slow[i] = zero;
  for (int i = 0; i < columns * (columns + 1) / 2; ++i) gram[i] = zero;
  for (int t = 0; t < of.rows; ++t) {
    const double a = of.fast_decay[t], c = of.slow_decay[t];
    const Vec variance = load(of.variance + t * kLanes + first);
    ff = (a * a) * ff + (1.0 - a * a) * fast_ratio;
    ss = (c * c) * ss + (1.0 - c * c) * slow_ratio;
    fs *= a * c;
    const Vec gf = ff + fs, gs = fs + ss;
    const auto present = variance > zero;
    const Vec s = present ? gf + gs + variance : one;
    const Vec inverse = present ? one / s : zero;
    const Vec to_fast = gf * inverse, to_slow = gs * inverse;
    ff -= gf * to_fast;
    fs -= gf * to_slow;
    ss -= gs * to_slow;
    product *= s;
    if (t % 8 == 7) {
      log_scales += log(product);
      product = one;
    }
    const double* row = of.table + static_cast<std::ptrdiff_t>(t) * of.terms;
    for (int i = 0, g = 0; i < columns; ++i) {
      const Vec x = i + 1 < columns ? zero + row[i] : load(of.values + t * kLanes + first);
      const Vec fi = a * fast[i], li = c * slow[i], v = x - fi - li;
      fast[i] = fi + to_fast * v;
      slow[i] = li + to_slow * v;
      white[i] = v;
      const Vec weighted = inverse * v;
      for (int k = 0; k <= i; ++k) gram[g++] += weighted * white[k];
    }
  }
  store(log_scales + log(product), sums.log_scales + first);
  for (int i = 0; i < columns * (columns + 1) / 2; ++i)
    store(gram[i], sums.gram + i * kLanes + first);
}

void accumulate(const EvidenceRows& of, int features, const EvidenceSums& sums) {
  for (int first = 0; first < features; first += kWidth) switch (of.terms + 1) {
      case 2:
        accumulate_lanes<2>(of, first, sums);
        break;
      case 3:
        accumulate_lanes<3>(of, first, sums);
        break;
      case 4:
        accumulate_lanes<4>(of, first, sums);
        break;
      case 5:
        accumulate_lanes<5>(of, first, sums);
        break;
      case 6:
        accumulate_lanes<6>(of, first, sums);
        break;
      case 7:
        accumulate_lanes<7>(of, first, sums);
        break;
      default:
        accumulate_lanes<0>(of, first, sums);
    }
}

}  // namespace

extern const EvidenceKernel WHEELTAP_EVIDENCE_KERNEL = {.name = WHEELTAP_MONITORING_NAME,
                                                        .accumulate = accumulate};

}  // namespace wheeltap::identification::monitoring::detail
