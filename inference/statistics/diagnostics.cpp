#include "inference/statistics/diagnostics.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <span>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

/// Half chains, one after the other: `sequences` half chains of `length` draws. A chain with an odd
/// number of draws loses its middle draw.
struct Split {
  std::size_t sequences = 0, length = 0;
  std::vector<double> values;
  bool valid = true;  ///< long enough and free of NaN

  [[nodiscard]] std::span<const double> operator[](std::size_t i) const {
    return {values.data() + i * length, length};
  }
};

Split split(const ChainsOf& draws) {
  if (draws.empty()) throw std::invalid_argument("draws: 0 chains, must be at least 1");
  const std::size_t n = draws.front().size();
  for (const auto& chain : draws)
    if (chain.size() != n)
      throw std::invalid_argument("draws: chains of " + std::to_string(n) + " and " +
                                  std::to_string(chain.size()) + " draws, must be equally long");
  Split s{2 * draws.size(), n / 2, {}, n >= 4};
  s.values.reserve(s.sequences * s.length);
  for (const auto& chain : draws) {
    const auto half = static_cast<std::ptrdiff_t>(n / 2);
    s.values.insert(s.values.end(), chain.begin(), chain.begin() + half);
    s.values.insert(s.values.end(), chain.end() - half, chain.end());
  }
  for (const double x : s.values) s.valid = s.valid && !std::isnan(x);
  return s;
}

struct Entry {
  double value;
  std::uint32_t index;
};

// Ascending order by least-significant-digit radix sort, which is faster than a comparison sort.
std::vector<Entry> sorted(std::span<const double> values) {
  constexpr int kBits = 11;
  constexpr std::uint64_t kMask = (1U << kBits) - 1;
  struct Keyed {
    std::uint64_t key;
    std::uint32_t index;
  };
  const std::size_t n = values.size();
  std::vector<Keyed> from(n), to(n);
  std::array<std::vector<std::uint32_t>, 6> counts;
  counts.fill(std::vector<std::uint32_t>(kMask + 1, 0));
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
  for (std::size_t i = 0; i < n; ++i) {
    // Doubles with flipped negative numbers sort like integers; + 0.0 makes -0 and 0 equal.
    const auto bits = std::bit_cast<std::uint64_t>(values[i] + 0.0);
    const std::uint64_t key = (bits & kSign) != 0 ? ~bits : bits | kSign;
    from[i] = {key, static_cast<std::uint32_t>(i)};
    for (std::size_t d = 0; d < 6; ++d) ++counts[d][(key >> (kBits * d)) & kMask];
  }
  for (std::size_t d = 0; d < 6; ++d) {
    auto& count = counts[d];
    if (std::ranges::find(count, n) != count.end()) continue;  // all values have the same digit
    std::uint32_t offset = 0;
    for (auto& c : count) offset += std::exchange(c, offset);
    for (const Keyed& k : from) to[count[(k.key >> (kBits * d)) & kMask]++] = k;
    from.swap(to);
  }
  std::vector<Entry> result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = {values[from[i].index], from[i].index};
  return result;
}

double quantile(const std::vector<Entry>& ascending, double p) {
  const double position = p * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const double a = ascending[below].value;
  const double b = ascending[std::min(below + 1, ascending.size() - 1)].value;
  const double fraction = position - std::floor(position);
  return a == b ? a : a + fraction * (b - a);
}

// |x - median| in ascending order. Both sides of the median are monotone and only need merging.
std::vector<Entry> folded(const std::vector<Entry>& ascending) {
  const double median = quantile(ascending, 0.5);
  std::vector<Entry> result;
  result.reserve(ascending.size());
  std::size_t up = ascending.size() / 2, down = up;
  const auto distance = [&](std::size_t i) {
    const double d = std::fabs(ascending[i].value - median);
    return std::isnan(d) ? 0.0 : d;  // both are infinite
  };
  while (result.size() < ascending.size()) {
    const bool take_up = down == 0 || (up < ascending.size() && distance(up) <= distance(down - 1));
    const std::size_t i = take_up ? up++ : --down;
    result.push_back({distance(i), ascending[i].index});
  }
  return result;
}

// Normal scores Φ⁻¹((rank - 3/8) / (S + 1/4)). Equal values get their average rank.
Split normal_scores(const Split& like, const std::vector<Entry>& ascending) {
  Split scores{like.sequences, like.length, std::vector<double>(ascending.size()), true};
  const auto size = static_cast<double>(ascending.size());
  for (std::size_t i = 0; i < ascending.size();) {
    std::size_t end = i + 1;
    while (end < ascending.size() && ascending[end].value == ascending[i].value) ++end;
    const double rank = 0.5 * static_cast<double>(i + 1 + end);
    const double score = normal_quantile((rank - 0.375) / (size + 0.25));
    for (; i < end; ++i) scores.values[ascending[i].index] = score;
  }
  return scores;
}

// Sums differences from the first value, so that the mean of a constant is exact.
double mean_of(std::span<const double> x) {
  double sum = 0.0;
  for (const double v : x) sum += v - x.front();
  return x.front() + sum / static_cast<double>(x.size());
}

/// Within- and between-sequence variances: W = mean of s², between = variance of the means.
struct Variances {
  double within = 0.0, between = 0.0;
  std::vector<double> means;
};

Variances variances(const Split& s) {
  Variances v;
  for (std::size_t c = 0; c < s.sequences; ++c) {
    const double mean = mean_of(s[c]);
    double sum = 0.0;
    for (const double x : s[c]) sum += (x - mean) * (x - mean);
    v.within += sum / static_cast<double>(s.length - 1);
    v.means.push_back(mean);
  }
  const auto m = static_cast<double>(s.sequences);
  v.within /= m;
  const double grand = mean_of(v.means);
  for (const double mean : v.means) v.between += (mean - grand) * (mean - grand);
  v.between /= m - 1.0;
  return v;
}

double basic_rhat(const Split& s) {
  const Variances v = variances(s);
  if (v.within == 0.0) return v.between == 0.0 ? 1.0 : kInfinity;
  const auto n = static_cast<double>(s.length);
  return std::sqrt((n - 1.0) / n + v.between / v.within);
}

bool constant(const Split& s) {
  return std::ranges::all_of(s.values, [&](double x) { return x == s.values.front(); });
}

/// Autocovariances for each lag, averaged over the sequences. Short lags are computed directly,
/// longer lags by FFT if required.
class Autocovariance {
 public:
  Autocovariance(const Split& s, const std::vector<double>& means)
      : sequences_(s.sequences), length_(s.length), centred_(s.values) {
    for (std::size_t c = 0; c < sequences_; ++c)
      for (std::size_t i = 0; i < length_; ++i) centred_[c * length_ + i] -= means[c];
  }

  /// Returns (1/n) Σ x_i x_{i+t}, averaged over the sequences.
  double operator()(std::size_t lag) {
    while (lag >= known_.size()) {
      if (known_.size() < kDirect)
        extend_directly(std::min<std::size_t>(length_, known_.empty() ? 8 : 2 * known_.size()));
      else
        compute_all();
    }
    return known_[lag];
  }

 private:
  static constexpr std::size_t kDirect = 64;

  void extend_directly(std::size_t lags) {
    constexpr std::size_t kBlock = 2048;  // a block and its shifts stay in the first-level cache
    const std::size_t first = known_.size();
    known_.resize(lags, 0.0);
    using Segment = Eigen::Map<const Eigen::VectorXd>;
    for (std::size_t c = 0; c < sequences_; ++c) {
      const double* x = centred_.data() + c * length_;
      for (std::size_t begin = 0; begin < length_; begin += kBlock)
        for (std::size_t t = first; t < lags && begin + t < length_; ++t) {
          const auto n = static_cast<Eigen::Index>(std::min(kBlock, length_ - t - begin));
          known_[t] += Segment(x + begin, n).dot(Segment(x + begin + t, n));
        }
    }
    for (std::size_t t = first; t < lags; ++t)
      known_[t] /= static_cast<double>(length_) * static_cast<double>(sequences_);
  }

  // Uses the Wiener-Khinchin theorem. One complex transform processes two real sequences, because
  // |Z(f)|² + |Z(-f)|² is twice the sum of their power spectra.
  void compute_all() {
    const std::size_t size = std::bit_ceil(2 * length_);
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> time(size), spectrum(size), power(size, 0.0);
    for (std::size_t c = 0; c < sequences_; c += 2) {  // their number is even
      const double* x = centred_.data() + c * length_;
      for (std::size_t i = 0; i < length_; ++i) time[i] = {x[i], x[length_ + i]};
      fft.fwd(spectrum, time);
      for (std::size_t f = 0; f < size; ++f)
        power[f] += 0.5 * (std::norm(spectrum[f]) + std::norm(spectrum[(size - f) % size]));
    }
    fft.inv(time, power);
    known_.resize(length_);
    const double scale = 1.0 / (static_cast<double>(length_) * static_cast<double>(sequences_));
    for (std::size_t t = 0; t < length_; ++t) known_[t] = time[t].real() * scale;
  }

  std::size_t sequences_, length_;
  std::vector<double> centred_;
  std::vector<double> known_;
};

// N / (1 + 2 Σ ρ_t), where Geyer's initial positive sequence of pairs (ρ_2j + ρ_2j+1 > 0) truncates
// the sum of correlations, made monotone (Vehtari et al. 2021, section 3.2).
double basic_ess(const Split& s) {
  const auto n = static_cast<double>(s.length);
  const double draws = n * static_cast<double>(s.sequences);
  if (constant(s)) return draws;
  const Variances v = variances(s);
  const double total = (n - 1.0) / n * v.within + v.between;  // var⁺
  if (!std::isfinite(total)) return kNaN;
  Autocovariance autocovariance(s, v.means);
  const auto correlation = [&](std::size_t t) {
    return 1.0 - (v.within - autocovariance(t) * n / (n - 1.0)) / total;
  };
  double sum = 0.0;        // sum over the pairs
  double last_even = 0.0;  // last even correlation, for antithetic chains
  double previous = kInfinity;
  for (std::size_t t = 0; t + 1 < s.length; t += 2) {
    const double even = t == 0 ? 1.0 : correlation(t);
    const double pair = even + correlation(t + 1);
    last_even = even > 0.0 ? even : 0.0;
    if (!(pair > 0.0)) break;
    previous = std::min(previous, pair);
    sum += previous;
    last_even = 0.0;
  }
  const double tau = std::max(-1.0 + 2.0 * sum + last_even, 1.0 / std::log10(draws));
  return draws / tau;
}

double tail_ess(const Split& s, const std::vector<Entry>& ascending) {
  double smallest = kInfinity;
  for (const double p : {0.05, 0.95}) {
    const double cut = quantile(ascending, p);
    Split indicator = s;
    for (double& x : indicator.values) x = x <= cut ? 1.0 : 0.0;
    smallest = std::min(smallest, basic_ess(indicator));
  }
  return smallest;
}

double mcse(const Split& s, double ess) {
  if (constant(s)) return 0.0;
  const double mean = mean_of(s.values);
  double sum = 0.0;
  for (const double x : s.values) sum += (x - mean) * (x - mean);
  return std::sqrt(sum / static_cast<double>(s.values.size() - 1) / ess);
}

// The stationary vector of a stochastic matrix by state reduction (Grassmann, Taksar & Heyman
// 1985): without subtraction, and thus without cancellation even for slow chains.
Eigen::VectorXd stationary_vector(Eigen::MatrixXd p) {
  const Eigen::Index n = p.rows();
  for (Eigen::Index k = n - 1; k > 0; --k) {
    const double leaving = p.row(k).head(k).sum();
    p.col(k).head(k) /= leaving;
    p.topLeftCorner(k, k).noalias() += p.col(k).head(k) * p.row(k).head(k);
  }
  Eigen::VectorXd pi(n);
  pi[0] = 1.0;
  for (Eigen::Index k = 1; k < n; ++k) pi[k] = pi.head(k).dot(p.col(k).head(k));
  return pi / pi.sum();
}

}  // namespace

Convergence convergence(const ChainsOf& draws) {
  const Split s = split(draws);
  if (!s.valid) return {kNaN, kNaN, kNaN, kNaN, kNaN};
  const std::vector<Entry> ascending = sorted(s.values);
  const Split bulk = normal_scores(s, ascending);
  Convergence result{};
  result.rhat = std::max(basic_rhat(bulk), basic_rhat(normal_scores(s, folded(ascending))));
  result.ess_bulk = basic_ess(bulk);
  result.ess_tail = tail_ess(s, ascending);
  result.ess_mean = basic_ess(s);
  result.mcse_mean = mcse(s, result.ess_mean);
  return result;
}

double rhat(const ChainsOf& draws) {
  const Split s = split(draws);
  if (!s.valid) return kNaN;
  const std::vector<Entry> ascending = sorted(s.values);
  return std::max(basic_rhat(normal_scores(s, ascending)),
                  basic_rhat(normal_scores(s, folded(ascending))));
}

double ess_bulk(const ChainsOf& draws) {
  const Split s = split(draws);
  return s.valid ? basic_ess(normal_scores(s, sorted(s.values))) : kNaN;
}

double ess_tail(const ChainsOf& draws) {
  const Split s = split(draws);
  return s.valid ? tail_ess(s, sorted(s.values)) : kNaN;
}

double ess_mean(const ChainsOf& draws) {
  const Split s = split(draws);
  return s.valid ? basic_ess(s) : kNaN;
}

double mcse_sd(const ChainsOf& draws) {
  Split s = split(draws);
  if (!s.valid) return kNaN;
  if (constant(s)) return 0.0;
  const double mean = mean_of(s.values);
  for (double& x : s.values) x = (x - mean) * (x - mean);
  return mcse(s, basic_ess(s)) / (2.0 * std::sqrt(mean_of(s.values)));
}

double mcse_mean(const ChainsOf& draws) {
  const Split s = split(draws);
  return s.valid ? mcse(s, basic_ess(s)) : kNaN;
}

double mean(const ChainsOf& draws) {
  double sum = 0.0, n = 0.0;
  for (const auto& chain : draws) {
    for (const double x : chain) sum += x;
    n += static_cast<double>(chain.size());
  }
  return sum / n;
}

ModelProbabilities stationary_model_probabilities(const std::vector<std::vector<int>>& model_chains,
                                                  int models, std::uint64_t seed,
                                                  int posterior_draws) {
  if (posterior_draws < 1)
    throw std::invalid_argument("posterior_draws: " + std::to_string(posterior_draws) +
                                ", must be >= 1");
  ModelProbabilities result;
  result.mean.assign(static_cast<std::size_t>(models), 0.0);
  result.sd = result.mean;
  result.transitions = Eigen::MatrixXd::Zero(models, models);
  std::vector<bool> seen(static_cast<std::size_t>(models), false);
  for (const auto& chain : model_chains)
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (chain[i] < 0 || chain[i] >= models)
        throw std::invalid_argument("model_chains: model " + std::to_string(chain[i]) +
                                    ", must be in [0, " + std::to_string(models) + ")");
      seen[static_cast<std::size_t>(chain[i])] = true;
      if (i > 0) result.transitions(chain[i - 1], chain[i]) += 1.0;
    }
  std::vector<int> visited;
  for (int m = 0; m < models; ++m)
    if (seen[static_cast<std::size_t>(m)]) visited.push_back(m);
  const auto count = static_cast<Eigen::Index>(visited.size());
  if (count == 0) return result;

  const double epsilon = 1.0 / static_cast<double>(count);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(count), squares = sum;
  for (int draw = 0; draw < posterior_draws; ++draw) {
    base::Random random(seed, 0, static_cast<std::uint64_t>(draw), base::Purpose::evidence);
    Eigen::MatrixXd p(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j)
        // The lower limit keeps the matrix irreducible if a variate underflows.
        p(i, j) = std::max(
            1e-290,
            random.gamma(epsilon + result.transitions(visited[static_cast<std::size_t>(i)],
                                                      visited[static_cast<std::size_t>(j)])));
      p.row(i) /= p.row(i).sum();
    }
    const Eigen::ArrayXd pi = stationary_vector(std::move(p)).array();
    sum += pi;
    squares += pi.square();
  }
  const Eigen::ArrayXd mean = sum / posterior_draws;
  const Eigen::ArrayXd variance = (squares / posterior_draws - mean.square()).max(0.0);
  // A Dirichlet distribution of mass S has Σ var = Σ m (1 - m) / (S + 1).
  const double spread = (mean * (1.0 - mean)).sum();
  result.effective_draws =
      count == 1 ? kInfinity
                 : std::max(0.0, spread / variance.sum() - 1.0 - static_cast<double>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto m = static_cast<std::size_t>(visited[static_cast<std::size_t>(i)]);
    result.mean[m] = mean[i];
    result.sd[m] = std::sqrt(variance[i]);
  }
  return result;
}

long round_trips(const std::vector<std::vector<int>>& chains, int lowest, int highest) {
  if (lowest == highest) return 0;
  long trips = 0;
  for (const auto& chain : chains) {
    int last_end = 0;  // last visited end: -1 lowest, +1 highest, 0 none yet
    long crossings = 0;
    for (const int value : chain) {
      const int end = value == lowest ? -1 : (value == highest ? 1 : 0);
      if (end == 0) continue;
      if (last_end == -end) ++crossings;
      last_end = end;
    }
    trips += crossings / 2;
  }
  return trips;
}

}  // namespace wheeltap::inference
