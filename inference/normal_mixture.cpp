#include "inference/normal_mixture.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

#include "inference/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLanes = 8;
constexpr std::size_t kMaxComponents = 512;

// Components lie side by side in groups of eight, so that one instruction serves several. A group
// of a packed mixture holds, eight numbers each,
//   c;  b_1, A_11;  b_2, A_21, A_22;  …   with  A = L⁻¹,  b = L⁻¹ μ,
// and component k's log density is c_k - ½ |A_k z - b_k|².
std::size_t group_stride(std::size_t d) {
  return kLanes * (1 + d + d * (d + 1) / 2);
}

std::size_t groups_of(std::size_t components) {
  return (components + kLanes - 1) / kLanes;
}

#if defined(__GNUC__) && defined(__x86_64__)
#define WHEELTAP_INLINE [[gnu::always_inline]] inline
#else
#define WHEELTAP_INLINE inline
#endif

// GCC's and Clang's vectors: eight doubles, in however many registers the processor needs.
using Lanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;
using Bits [[gnu::vector_size(kLanes * sizeof(double))]] = long long;

WHEELTAP_INLINE void load(Lanes& v, const double* p) {
  std::memcpy(&v, p, sizeof v);
}
WHEELTAP_INLINE void store(double* p, const Lanes& v) {
  std::memcpy(p, &v, sizeof v);
}

// |A z - b|² of one group.
WHEELTAP_INLINE void quadratic_form(const double* group, const double* z, std::size_t d,
                                    Lanes& result) {
  const double* p = group + kLanes;
  result = Lanes{};
  for (std::size_t i = 0; i < d; ++i) {
    Lanes y, a;
    load(y, p);
    y = -y;
    p += kLanes;
    for (std::size_t j = 0; j <= i; ++j, p += kLanes) {
      load(a, p);
      y += a * z[j];
    }
    result += y * y;
  }
}

// e^x for x <= 0, to 1e-15 relative; 0 below -700. x = n ln 2 + r with |r| <= ½ ln 2, and the
// Taylor series in r, whose first dropped term is 2e-16.
WHEELTAP_INLINE void exponential(Lanes& x) {
  constexpr double kMagic =
      0x1.8p52;  // adding it rounds to an integer, which the low bits then hold
  const Lanes floor = Lanes{} - 700.0;
  const auto tiny = x < floor;
  x = tiny ? floor : x;
  const Lanes shifted = x * 1.4426950408889634 + kMagic;
  const Lanes n = shifted - kMagic;
  const Lanes r = (x - n * 0x1.62e42fefa3800p-1) - n * 0x1.ef35793c76730p-45;
  Lanes sum = Lanes{} + 1.0 / 479001600.0;
  constexpr std::array<double, 12> kInverseFactorials = {
      1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
      1.0 / 120.0,      1.0 / 24.0,      1.0 / 6.0,      0.5,           1.0,          1.0};
  for (const double c : kInverseFactorials) sum = sum * r + c;
  Bits bits, exponent;
  std::memcpy(&bits, &sum, sizeof bits);
  std::memcpy(&exponent, &shifted, sizeof exponent);
  bits += exponent << 52;
  std::memcpy(&sum, &bits, sizeof sum);
  x = tiny ? Lanes{} : sum;
}

WHEELTAP_INLINE double largest(const Lanes& v) {
  double m = v[0];
  for (std::size_t l = 1; l < kLanes; ++l) m = v[l] > m ? v[l] : m;
  return m;
}

WHEELTAP_INLINE double total(const Lanes& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

// values_k = c_k - ½ |A_k z - b_k|²; returns the largest.
WHEELTAP_INLINE double log_components(const double* packed, std::size_t groups, std::size_t stride,
                                      const double* z, std::size_t d, double* values) {
  Lanes top = Lanes{} - kInfinity;
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes q, c;
    quadratic_form(packed + g * stride, z, d, q);
    load(c, packed + g * stride);
    c -= 0.5 * q;
    store(values + g * kLanes, c);
    top = c > top ? c : top;
  }
  return largest(top);
}

WHEELTAP_INLINE double log_density_body(const double* packed, std::size_t groups,
                                        std::size_t stride, const double* z, std::size_t d) {
  std::array<double, kMaxComponents> values;
  const double top = log_components(packed, groups, stride, z, d, values.data());
  if (top == -kInfinity) return top;
  Lanes sum = Lanes{};
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes v;
    load(v, values.data() + g * kLanes);
    v -= top;
    exponential(v);
    sum += v;
  }
  return top + std::log(total(sum));
}

WHEELTAP_INLINE void quadratic_forms_body(const double* packed, std::size_t groups,
                                          std::size_t stride, const double* z, std::size_t d,
                                          double* values) {
  for (std::size_t g = 0; g < groups; ++g) {
    Lanes q;
    quadratic_form(packed + g * stride, z, d, q);
    store(values + g * kLanes, q);
  }
}

// One pass of EM over the samples. A group of `moments` holds, eight numbers each,
//   Σ w r;  Σ r;  Σ w r e_1, Σ w r e_1 e_1;  Σ w r e_2, Σ w r e_2 e_1, Σ w r e_2 e_2;  …
// with responsibilities r and deviations e = z - μ from the *current* means, which keeps the
// moments of a narrow component free of cancellation. Returns Σ w ln q.
struct Samples {
  std::size_t n, d;
  const double* z;       // n × d, row-major
  const double* weight;  // n
};

WHEELTAP_INLINE double em_pass_body(const double* packed, const double* means, std::size_t groups,
                                    std::size_t stride, const Samples& s, double* moments) {
  std::array<double, kMaxComponents> values;
  const std::size_t moment_stride = stride + kLanes;
  double log_likelihood = 0.0;
  for (std::size_t i = 0; i < s.n; ++i) {
    const double* z = s.z + i * s.d;
    const double top = log_components(packed, groups, stride, z, s.d, values.data());
    Lanes sum = Lanes{};
    for (std::size_t g = 0; g < groups; ++g) {
      Lanes v;
      load(v, values.data() + g * kLanes);
      v -= top;
      exponential(v);
      store(values.data() + g * kLanes, v);
      sum += v;
    }
    const double all = total(sum);
    log_likelihood += s.weight[i] * (top + std::log(all));
    for (std::size_t g = 0; g < groups; ++g) {
      Lanes r, m, a;
      load(r, values.data() + g * kLanes);
      r *= 1.0 / all;
      if (largest(r) < 1e-12) continue;
      double* p = moments + g * moment_stride;
      const double* mean = means + g * kLanes * s.d;
      const Lanes wr = r * s.weight[i];
      load(a, p);
      store(p, a + wr);
      load(a, p + kLanes);
      store(p + kLanes, a + r);
      p += 2 * kLanes;
      for (std::size_t u = 0; u < s.d; ++u) {
        load(m, mean + u * kLanes);
        const Lanes e = wr * (z[u] - m);
        load(a, p);
        store(p, a + e);
        p += kLanes;
        for (std::size_t v = 0; v <= u; ++v, p += kLanes) {
          load(m, mean + v * kLanes);
          load(a, p);
          store(p, a + e * (z[v] - m));
        }
      }
    }
  }
  return log_likelihood;
}

// One copy of each kernel for each instruction set, chosen once at run time.
struct Kernels {
  double (*log_density)(const double*, std::size_t, std::size_t, const double*, std::size_t);
  void (*quadratic_forms)(const double*, std::size_t, std::size_t, const double*, std::size_t,
                          double*);
  double (*em_pass)(const double*, const double*, std::size_t, std::size_t, const Samples&,
                    double*);
};

#define WHEELTAP_KERNELS(NAME, ATTRIBUTE)                                                        \
  ATTRIBUTE double log_density_##NAME(const double* packed, std::size_t groups,                  \
                                      std::size_t stride, const double* z, std::size_t d) {      \
    return log_density_body(packed, groups, stride, z, d);                                       \
  }                                                                                              \
  ATTRIBUTE void quadratic_forms_##NAME(const double* packed, std::size_t groups,                \
                                        std::size_t stride, const double* z, std::size_t d,      \
                                        double* values) {                                        \
    quadratic_forms_body(packed, groups, stride, z, d, values);                                  \
  }                                                                                              \
  ATTRIBUTE double em_pass_##NAME(const double* packed, const double* means, std::size_t groups, \
                                  std::size_t stride, const Samples& s, double* moments) {       \
    return em_pass_body(packed, means, groups, stride, s, moments);                              \
  }                                                                                              \
  constexpr Kernels kKernels_##NAME{log_density_##NAME, quadratic_forms_##NAME, em_pass_##NAME};

WHEELTAP_KERNELS(baseline, )
#if defined(__GNUC__) && defined(__x86_64__)
WHEELTAP_KERNELS(avx2, [[gnu::target("avx2,fma")]])
WHEELTAP_KERNELS(avx512, [[gnu::target("avx512f,avx512dq,fma")]])
#endif

const Kernels& kernels() {
  static const Kernels chosen = [] {
#if defined(__GNUC__) && defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
      return kKernels_avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return kKernels_avx2;
#endif
    return kKernels_baseline;
  }();
  return chosen;
}

double log_sum_diagonal(const Eigen::MatrixXd& factor) {
  return factor.diagonal().array().log().sum();
}

std::vector<double> pack(const std::vector<NormalMixture::Component>& components, double nu) {
  const auto d = components.front().mean.size();
  const auto dimension = static_cast<std::size_t>(d);
  const std::size_t stride = group_stride(dimension);
  const auto half = 0.5 * static_cast<double>(d);
  const double normaliser = std::isinf(nu) ? -2.0 * half * kLogSqrt2Pi
                                           : std::lgamma(0.5 * nu + half) - std::lgamma(0.5 * nu) -
                                                 half * std::log(nu * M_PI);
  std::vector<double> packed(groups_of(components.size()) * stride, 0.0);
  for (std::size_t k = 0; k < groups_of(components.size()) * kLanes; ++k) {
    double* p = packed.data() + (k / kLanes) * stride + k % kLanes;
    if (k >= components.size()) {
      *p = -kInfinity;  // a lane without a component
      continue;
    }
    const auto& c = components[k];
    *p = std::log(c.weight) + normaliser - log_sum_diagonal(c.factor);
    const Eigen::MatrixXd inverse =
        c.factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(d, d));
    const Eigen::VectorXd b = inverse * c.mean;
    for (Eigen::Index i = 0; i < d; ++i) {
      *(p += kLanes) = b[i];
      for (Eigen::Index j = 0; j <= i; ++j) *(p += kLanes) = inverse(i, j);
    }
  }
  return packed;
}

// ---- fitting ----

struct Cluster {
  double weight = 0.0;
  double members = 0.0;  // distinct samples, by responsibility
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

class Fitter {
  static constexpr Eigen::Index kOnTheWay = 3000;

 public:
  Fitter(const Eigen::MatrixXd& samples, const NormalMixture::FitOptions& options,
         base::Random& random)
      : options_(options), random_(random), d_(samples.cols()) {
    merge_repeated(samples);
    mean_ = z_.transpose() * weight_ / weight_.sum();
    const RowMatrix centred = z_.rowwise() - mean_.transpose();
    covariance_ = centred.transpose() * weight_.asDiagonal() * centred / weight_.sum();
    // Keeps a parameter that did not move at all from having no width.
    floor_ = 1e-12 * covariance_.diagonal().array() + 1e-20;
  }

  std::vector<NormalMixture::Component> run() {
    const auto distinct = static_cast<double>(z_.rows());
    if (distinct < 2.0 * static_cast<double>(d_ + 1)) {
      Cluster one{1.0, distinct, mean_, covariance_};
      one.covariance.diagonal().array() += 1e-4;
      return components({one});
    }
    int most = std::max(1, static_cast<int>(distinct / (2.0 * parameters_of_one())));
    // Twice as many centres as components, since k-means++ may well put two into one mode.
    most = std::min(most, 2 * options_.max_components);
    std::vector<Cluster> clusters = initial(most), best;
    double best_score = kInfinity;
    // The number of components is chosen on a part of the samples, as if they were all: the way
    // through all numbers costs more than the fit itself.
    const Eigen::Index part = std::max<Eigen::Index>(kOnTheWay, 200 * (d_ + 1));
    const bool thinned = z_.rows() > 2 * part;
    if (thinned) thin(part);
    for (;;) {
      const double log_likelihood =
          thinned ? expectation_maximisation(clusters, 4, 1e-4, thinned_z_, thinned_weight_)
                  : expectation_maximisation(clusters, 4, 1e-4, z_, weight_);
      const double score = criterion(clusters.size(), log_likelihood);
      if (score < best_score &&
          clusters.size() <= static_cast<std::size_t>(options_.max_components)) {
        best_score = score;
        best = clusters;
      }
      if (clusters.size() == 1) break;
      merge_closest(clusters);
    }
    expectation_maximisation(best, options_.max_iterations, options_.tolerance, z_, weight_);
    widen(best);
    return components(best);
  }

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  [[nodiscard]] double parameters_of_one() const {
    const auto d = static_cast<double>(d_);
    return 1.0 + d + 0.5 * d * (d + 1.0);
  }

  // Distinct rows, weighted so that their mean weight is 1.
  void merge_repeated(const Eigen::MatrixXd& samples) {
    const RowMatrix rows = samples;
    std::vector<Eigen::Index> order(static_cast<std::size_t>(rows.rows()));
    std::iota(order.begin(), order.end(), 0);
    const auto row = [&](Eigen::Index i) {
      return std::span<const double>(rows.data() + i * d_, static_cast<std::size_t>(d_));
    };
    std::ranges::sort(order, [&](Eigen::Index a, Eigen::Index b) {
      return std::ranges::lexicographical_compare(row(a), row(b));
    });
    std::vector<Eigen::Index> first;
    std::vector<double> count;
    for (const Eigen::Index i : order) {
      if (!first.empty() && std::ranges::equal(row(first.back()), row(i))) {
        count.back() += 1.0;
      } else {
        first.push_back(i);
        count.push_back(1.0);
      }
    }
    z_.resize(static_cast<Eigen::Index>(first.size()), d_);
    weight_.resize(z_.rows());
    for (Eigen::Index i = 0; i < z_.rows(); ++i) {
      z_.row(i) = rows.row(first[static_cast<std::size_t>(i)]);
      weight_[i] = count[static_cast<std::size_t>(i)] * static_cast<double>(z_.rows()) /
                   static_cast<double>(rows.rows());
    }
  }

  // The rows are sorted: every so many of them is a stratified part. Weights add up to those of
  // all.
  void thin(Eigen::Index n) {
    thinned_z_.resize(n, d_);
    thinned_weight_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index row = i * z_.rows() / n;
      thinned_z_.row(i) = z_.row(row);
      thinned_weight_[i] = weight_[row];
    }
    thinned_weight_ *= weight_.sum() / thinned_weight_.sum();
  }

  // k-means++ centres in whitened coordinates, a few of Lloyd's iterations, and the clusters'
  // moments.
  std::vector<Cluster> initial(int most) {
    const Eigen::MatrixXd factor = cholesky(covariance_);
    const Eigen::MatrixXd white = factor.triangularView<Eigen::Lower>().solve(
        (z_.rowwise() - mean_.transpose()).transpose());  // d × n
    const Eigen::Index n = white.cols();
    Eigen::MatrixXd centres(d_, most);
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(n, kInfinity);
    int found = 0;
    for (; found < most; ++found) {
      const Eigen::VectorXd chance = found == 0 ? weight_ : weight_.cwiseProduct(distance);
      double u = random_.uniform() * chance.sum();
      if (!(u > 0.0)) break;
      Eigen::Index pick = 0;
      while (pick + 1 < n && (u -= chance[pick]) > 0.0) ++pick;
      centres.col(found) = white.col(pick);
      distance = distance.cwiseMin(
          (white.colwise() - centres.col(found)).colwise().squaredNorm().transpose());
    }
    std::vector<Eigen::Index> label(static_cast<std::size_t>(n), 0);
    for (int iteration = 0; iteration < 8; ++iteration) {
      Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(d_, found);
      Eigen::VectorXd mass = Eigen::VectorXd::Zero(found);
      const Eigen::VectorXd half = 0.5 * centres.leftCols(found).colwise().squaredNorm();
      for (Eigen::Index i = 0; i < n; ++i) {
        Eigen::Index& nearest = label[static_cast<std::size_t>(i)];
        (centres.leftCols(found).transpose() * white.col(i) - half).maxCoeff(&nearest);
        sums.col(nearest) += weight_[i] * white.col(i);
        mass[nearest] += weight_[i];
      }
      for (int k = 0; k < found; ++k)
        if (mass[k] > 0.0) centres.col(k) = sums.col(k) / mass[k];
    }
    std::vector<Cluster> clusters(static_cast<std::size_t>(found));
    for (Cluster& c : clusters) {
      c.mean = Eigen::VectorXd::Zero(d_);
      c.covariance = Eigen::MatrixXd::Zero(d_, d_);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      Cluster& c = clusters[static_cast<std::size_t>(label[static_cast<std::size_t>(i)])];
      c.weight += weight_[i];
      c.members += 1.0;
      c.mean += weight_[i] * z_.row(i).transpose();
    }
    for (Cluster& c : clusters)
      if (c.weight > 0.0) c.mean /= c.weight;
    for (Eigen::Index i = 0; i < n; ++i) {
      Cluster& c = clusters[static_cast<std::size_t>(label[static_cast<std::size_t>(i)])];
      const Eigen::VectorXd e = z_.row(i).transpose() - c.mean;
      c.covariance += weight_[i] / c.weight * e * e.transpose();
    }
    drop_starved(clusters);
    return clusters;
  }

  // Drops clusters with too few distinct samples to have a covariance; theirs go to the others at
  // the next iteration.
  void drop_starved(std::vector<Cluster>& clusters) const {
    const double least = 2.0 * static_cast<double>(d_ + 1);
    std::vector<Cluster> kept;
    for (const Cluster& c : clusters)
      if (c.members >= least && c.weight > 0.0) kept.push_back(c);
    if (kept.empty()) kept.push_back({1.0, static_cast<double>(z_.rows()), mean_, covariance_});
    double sum = 0.0;
    for (const Cluster& c : kept) sum += c.weight;
    for (Cluster& c : kept) {
      c.weight /= sum;
      c.covariance.diagonal() += floor_;
    }
    clusters = std::move(kept);
  }

  // A covariance estimated from N points fits those points too well: for a *new* point the expected
  // quadratic form is d N / (N - d - 2), up to terms of order 1/N. Widening by that factor commutes
  // with any linear map, unlike shrinkage to a diagonal, and so spares narrow ridges.
  void widen(std::vector<Cluster>& clusters) const {
    for (Cluster& c : clusters)
      c.covariance *=
          c.members / (c.members - std::min(static_cast<double>(d_) + 2.0, 0.7 * c.members));
  }

  static Eigen::MatrixXd cholesky(const Eigen::MatrixXd& covariance) {
    Eigen::MatrixXd regular = covariance;
    for (double jitter = 1e-14;; jitter *= 100.0) {
      const Eigen::LLT<Eigen::MatrixXd> llt(regular);
      Eigen::MatrixXd factor = llt.matrixL();
      if (llt.info() == Eigen::Success && (factor.diagonal().array() > 0.0).all()) return factor;
      regular = covariance;
      regular.diagonal() *= 1.0 + jitter;
      regular.diagonal().array() += 1e-300;
    }
  }

  static std::vector<NormalMixture::Component> components(const std::vector<Cluster>& clusters) {
    std::vector<NormalMixture::Component> result;
    for (const Cluster& c : clusters) result.push_back({c.weight, c.mean, cholesky(c.covariance)});
    return result;
  }

  // Returns Σ w ln q of the last but one parameters.
  double expectation_maximisation(std::vector<Cluster>& clusters, int iterations, double tolerance,
                                  const RowMatrix& z, const Eigen::VectorXd& weight) const {
    const auto d = static_cast<std::size_t>(d_);
    const Samples samples{static_cast<std::size_t>(z.rows()), d, z.data(), weight.data()};
    const std::size_t stride = group_stride(d);
    double previous = -kInfinity;
    for (int iteration = 0;; ++iteration) {
      const std::size_t groups = groups_of(clusters.size());
      const std::vector<double> packed = pack(components(clusters), kInfinity);
      std::vector<double> means(groups * kLanes * d, 0.0);
      for (std::size_t k = 0; k < clusters.size(); ++k)
        for (std::size_t i = 0; i < d; ++i)
          means[((k / kLanes) * d + i) * kLanes + k % kLanes] =
              clusters[k].mean[static_cast<Eigen::Index>(i)];
      std::vector<double> moments(groups * (stride + kLanes), 0.0);
      const double log_likelihood =
          kernels().em_pass(packed.data(), means.data(), groups, stride, samples, moments.data());
      // Against the mean gain a sample, which is what the criterion weighs.
      if (iteration >= iterations ||
          std::fabs(log_likelihood - previous) < tolerance * static_cast<double>(samples.n))
        return log_likelihood;
      previous = log_likelihood;
      for (std::size_t k = 0; k < clusters.size(); ++k) {
        const double* p = moments.data() + (k / kLanes) * (stride + kLanes) + k % kLanes;
        Cluster& c = clusters[k];
        c.weight = *p;
        c.members = *(p += kLanes);
        if (!(c.weight > 0.0)) continue;
        Eigen::VectorXd shift(d_);
        for (Eigen::Index i = 0; i < d_; ++i) {
          shift[i] = *(p += kLanes) / c.weight;
          for (Eigen::Index j = 0; j <= i; ++j)
            c.covariance(i, j) = c.covariance(j, i) = *(p += kLanes) / c.weight;
        }
        c.covariance -= shift * shift.transpose();
        c.mean += shift;
      }
      drop_starved(clusters);
    }
  }

  [[nodiscard]] double criterion(std::size_t components, double log_likelihood) const {
    const double parameters = static_cast<double>(components) * parameters_of_one() - 1.0;
    const double price = options_.criterion == NormalMixture::Criterion::bic
                             ? 0.5 * std::log(static_cast<double>(z_.rows()))
                             : 1.0;
    return price * parameters - log_likelihood;
  }

  // Runnalls' bound on the Kullback-Leibler loss of merging i and j while keeping their moments:
  // ½ [(w_i + w_j) ln|P_ij| - w_i ln|P_i| - w_j ln|P_j|].
  void merge_closest(std::vector<Cluster>& clusters) const {
    std::vector<double> log_det;
    for (const Cluster& c : clusters)
      log_det.push_back(2.0 * log_sum_diagonal(cholesky(c.covariance)));
    double least = kInfinity;
    std::size_t into = 0, from = 1;
    Cluster best;
    for (std::size_t i = 0; i < clusters.size(); ++i)
      for (std::size_t j = i + 1; j < clusters.size(); ++j) {
        const Cluster &a = clusters[i], &b = clusters[j];
        Cluster merged;
        merged.weight = a.weight + b.weight;
        merged.members = a.members + b.members;
        const double share = a.weight / merged.weight;
        merged.mean = share * a.mean + (1.0 - share) * b.mean;
        const Eigen::VectorXd e = a.mean - b.mean;
        merged.covariance = share * a.covariance + (1.0 - share) * b.covariance +
                            share * (1.0 - share) * e * e.transpose();
        const double loss = merged.weight * 2.0 * log_sum_diagonal(cholesky(merged.covariance)) -
                            a.weight * log_det[i] - b.weight * log_det[j];
        if (loss < least) {
          least = loss;
          into = i;
          from = j;
          best = std::move(merged);
        }
      }
    clusters[into] = std::move(best);
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(from));
  }

  const NormalMixture::FitOptions& options_;
  base::Random& random_;
  Eigen::Index d_;
  RowMatrix z_, thinned_z_;
  Eigen::VectorXd weight_, thinned_weight_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd floor_;
};

}  // namespace

NormalMixture::NormalMixture(std::vector<Component> components, double degrees_of_freedom)
    : nu_(degrees_of_freedom), components_(std::move(components)) {
  if (components_.empty() || components_.size() > kMaxComponents)
    throw std::invalid_argument("normal mixture: " + std::to_string(components_.size()) +
                                " components, must be 1 to " + std::to_string(kMaxComponents));
  if (!(nu_ > 0.0))
    throw std::invalid_argument("normal mixture: degrees of freedom = " + std::to_string(nu_) +
                                ", must be > 0");
  const Eigen::Index d = components_.front().mean.size();
  dimension_ = static_cast<int>(d);
  double sum = 0.0;
  for (const Component& c : components_) {
    if (d == 0 || c.mean.size() != d || c.factor.rows() != d || c.factor.cols() != d)
      throw std::invalid_argument("normal mixture: a component of dimension " +
                                  std::to_string(c.mean.size()) + ", must be " + std::to_string(d) +
                                  " and at least 1");
    if (!(c.weight > 0.0 && std::isfinite(c.weight)))
      throw std::invalid_argument("normal mixture: weight = " + std::to_string(c.weight) +
                                  ", must be > 0 and finite");
    if (!c.mean.allFinite() || !c.factor.allFinite() || !(c.factor.diagonal().array() > 0.0).all())
      throw std::invalid_argument(
          "normal mixture: means and factors must be finite, factors with a positive diagonal");
    sum += c.weight;
  }
  double running = 0.0;
  for (Component& c : components_) {
    c.weight /= sum;
    cumulative_.push_back(running += c.weight);
  }
  packed_ = pack(components_, nu_);
}

NormalMixture NormalMixture::standard(int dimension, double sd) {
  return NormalMixture({{1.0, Eigen::VectorXd::Zero(dimension),
                         sd * Eigen::MatrixXd::Identity(dimension, dimension)}});
}

NormalMixture NormalMixture::fit(const Eigen::MatrixXd& samples, base::Random& random) {
  return fit(samples, FitOptions{}, random);
}

NormalMixture NormalMixture::fit(const Eigen::MatrixXd& samples, const FitOptions& options,
                                 base::Random& random) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("normal mixture fit: " + what);
  };
  if (samples.rows() < 1 || samples.cols() < 1) refuse("no samples");
  if (!samples.allFinite()) refuse("a sample is not finite");
  if (options.max_components < 1 || 2 * options.max_components > static_cast<int>(kMaxComponents))
    refuse("max_components = " + std::to_string(options.max_components) + ", must be 1 to " +
           std::to_string(kMaxComponents / 2));
  if (!(options.defensive_weight >= 0.0 && options.defensive_weight < 1.0))
    refuse("defensive_weight = " + std::to_string(options.defensive_weight) +
           ", must be in [0, 1)");
  if (!(options.defensive_sd > 0.0))
    refuse("defensive_sd = " + std::to_string(options.defensive_sd) + ", must be > 0");
  std::vector<Component> components = Fitter(samples, options, random).run();
  if (options.defensive_weight > 0.0) {
    for (Component& c : components) c.weight *= 1.0 - options.defensive_weight;
    const Eigen::Index d = samples.cols();
    components.push_back({options.defensive_weight, Eigen::VectorXd::Zero(d),
                          options.defensive_sd * Eigen::MatrixXd::Identity(d, d)});
  }
  return NormalMixture(std::move(components), options.degrees_of_freedom);
}

double NormalMixture::log_density(std::span<const double> z) const {
  const auto d = static_cast<std::size_t>(dimension_);
  if (std::isinf(nu_)) {
    const double value = kernels().log_density(packed_.data(), groups_of(components_.size()),
                                               group_stride(d), z.data(), d);
    return std::isnan(value) ? -kInfinity : value;
  }
  std::array<double, kMaxComponents> values;
  const std::span<double> used(values.data(), components_.size());
  component_log_densities(z, used);
  const double top = std::ranges::max(used);
  if (!(top > -kInfinity)) return -kInfinity;
  double sum = 0.0;
  for (const double v : used) sum += std::exp(v - top);
  return top + std::log(sum);
}

void NormalMixture::component_log_densities(std::span<const double> z,
                                            std::span<double> out) const {
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t stride = group_stride(d);
  std::array<double, kMaxComponents> forms;
  kernels().quadratic_forms(packed_.data(), groups_of(components_.size()), stride, z.data(), d,
                            forms.data());
  for (std::size_t k = 0; k < components_.size(); ++k) {
    const double c = packed_[(k / kLanes) * stride + k % kLanes];
    const double value = std::isinf(nu_)
                             ? c - 0.5 * forms[k]
                             : c - 0.5 * (nu_ + dimension_) * std::log1p(forms[k] / nu_);
    out[k] = std::isnan(value) ? -kInfinity : value;
  }
}

int NormalMixture::sample_component(base::Random& random) const {
  const double u = random.uniform();
  const auto k = std::ranges::upper_bound(cumulative_, u) - cumulative_.begin();
  return std::min(static_cast<int>(k), size() - 1);
}

void NormalMixture::sample(base::Random& random, std::span<double> out) const {
  const Component& c = (*this)[sample_component(random)];
  const auto d = static_cast<std::size_t>(dimension_);
  std::array<double, 64> small;
  std::vector<double> large;
  double* normal = small.data();
  if (d > small.size()) {
    large.resize(d);
    normal = large.data();
  }
  for (std::size_t i = 0; i < d; ++i) normal[i] = random.normal();
  const double stretch = std::isinf(nu_) ? 1.0 : std::sqrt(0.5 * nu_ / random.gamma(0.5 * nu_));
  for (std::size_t i = 0; i < d; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= i; ++j)
      sum += c.factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * normal[j];
    out[i] = c.mean[static_cast<Eigen::Index>(i)] + stretch * sum;
  }
}

void NormalMixture::standardise(int k, std::span<const double> z, std::span<double> u) const {
  const Component& c = (*this)[k];
  for (Eigen::Index i = 0; i < dimension_; ++i) {
    double rest = z[static_cast<std::size_t>(i)] - c.mean[i];
    for (Eigen::Index j = 0; j < i; ++j) rest -= c.factor(i, j) * u[static_cast<std::size_t>(j)];
    u[static_cast<std::size_t>(i)] = rest / c.factor(i, i);
  }
}

void NormalMixture::unstandardise(int k, std::span<const double> u, std::span<double> z) const {
  const Component& c = (*this)[k];
  for (Eigen::Index i = 0; i < dimension_; ++i) {
    double sum = c.mean[i];
    for (Eigen::Index j = 0; j <= i; ++j) sum += c.factor(i, j) * u[static_cast<std::size_t>(j)];
    z[static_cast<std::size_t>(i)] = sum;
  }
}

double NormalMixture::log_determinant(int k) const {
  return log_sum_diagonal((*this)[k].factor);
}

}  // namespace wheeltap::inference
