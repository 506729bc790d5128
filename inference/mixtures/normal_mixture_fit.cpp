// NormalMixture::fit: expectation-maximisation, and the number of components.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/mixtures/packed_mixture.hpp"

namespace wheeltap::inference {
namespace {

using packed::group_stride;
using packed::groups_of;
using packed::kLanes;
using packed::kMaxComponents;
using packed::log_sum_diagonal;
using packed::pack;
using packed::routines;

struct Cluster {
  double weight = 0.0;
  double members = 0.0;  // number of distinct samples, by responsibility
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

class Fitter {
  static constexpr Eigen::Index kOnTheWay = 3000;
  // Above this number, a tenth of the components is merged between two maximisations, because the
  // number need not be exact.
  static constexpr std::size_t kOneByOne = 40;

 public:
  Fitter(const Eigen::MatrixXd& samples, const NormalMixture::FitOptions& options,
         base::Random& random)
      : options_(options), random_(random), d_(samples.cols()) {
    merge_repeated(samples);
    mean_ = z_.transpose() * weight_ / weight_.sum();
    const RowMatrix centred = z_.rowwise() - mean_.transpose();
    covariance_ = centred.transpose() * weight_.asDiagonal() * centred / weight_.sum();
    // Gives a constant parameter a positive width.
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
    // Twice as many centres as components, because k-means++ may put two centres into one mode.
    most = std::min(most, 2 * options_.max_components);
    std::vector<Cluster> clusters = initial(most), best;
    double best_score = kInfinity;
    // A subset of the samples selects the number of components; it has the total weight of all
    // samples. The search over all numbers takes longer than the fit.
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
      const std::size_t fewer = clusters.size() <= kOneByOne ? 1 : clusters.size() / 10;
      for (std::size_t i = 0; i < fewer; ++i) merge_closest(clusters);
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

  // Replaces equal rows by one row. The weights of the rows have a mean of 1.
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

  // Keeps equally spaced rows. The rows are sorted, so these rows form a stratified subset. The sum
  // of the weights does not change.
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

  // Deletes clusters with too few distinct samples for a covariance. The next iteration assigns
  // their samples to other clusters.
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

  // A covariance estimated from N points fits these points too well: for a *new* point the expected
  // quadratic form is d N / (N - d - 2), up to terms of order 1/N. Multiplication by this factor
  // commutes with any linear map, unlike shrinkage to a diagonal, and thus preserves narrow ridges.
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

  // Returns Σ w ln q for the parameters of the last iteration but one.
  double expectation_maximisation(std::vector<Cluster>& clusters, int iterations, double tolerance,
                                  const RowMatrix& z, const Eigen::VectorXd& weight) const {
    const auto d = static_cast<std::size_t>(d_);
    const packed::Samples samples{static_cast<std::size_t>(z.rows()), d, z.data(), weight.data()};
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
          routines().em_pass(packed.data(), means.data(), groups, stride, samples, moments.data());
      // The tolerance is that of the mean log density per sample, as in the criterion.
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

}  // namespace wheeltap::inference
