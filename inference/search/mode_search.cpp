#include "inference/search/mode_search.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "inference/search/climb.hpp"
#include "inference/search/summit.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kSlices = 8;  // slices of a batch, each with its own likelihood object
constexpr long kFirstBatch = 8, kMostBatch = 256;
constexpr long kFirstOfRecord = 2;    // number of climbs in the first batch for a growing record
constexpr long kScreened = 256;       // draws of the prior on a whole record
constexpr int kScreenedClimbs = 4;    // climbs from the most probable of these draws
constexpr double kValley = 2.0;       // smallest depth in ln π between two modes
constexpr double kNegligible = 25.0;  // ln mass below that of the mode with the largest mass
constexpr std::size_t kMostModes = 300, kMostLeftOut = 300;
constexpr long kSearchSamples = 50;  // first length of a growing record
constexpr double kDrawsAMode = 4.0;  // starts per mode as a record grows
constexpr double kFollowed = 30.0;   // number of modes followed as a record grows
constexpr double kFewestFollowed = 6.0;
constexpr std::size_t kThreads = 3;  // lost modes that are followed in small steps
// A record grows by these numbers of time steps.
constexpr long kFirstGrowth = 4, kLeastGrowth = 128;
constexpr std::size_t kSummits = 3;    // modes whose maxima are checked for spikes
constexpr double kSummitShare = 0.01;  // share of the budget for this check
constexpr std::uint64_t kScreenStream = std::uint64_t{1} << 62U;
// Replacement of single components (replace_components).
constexpr std::size_t kReplacedModes = 6;   // highest modes whose components are replaced
constexpr Eigen::Index kReplacements = 64;  // draws of the prior for each component
constexpr int kReplacementClimbs = 2;       // climbs from the most probable of these draws
constexpr int kReplacementRounds = 4;
constexpr double kReplacementShare =
    0.1;  // share of the budget; or as many calls as the climbs took
constexpr std::uint64_t kReplaceStream = std::uint64_t{3} << 61U;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

double laplace_mass(const KnownMode& mode) {
  const Eigen::LLT<Matrix> llt(mode.covariance);
  const Matrix factor = llt.matrixL();
  return mode.value + 0.5 * static_cast<double>(mode.z.size()) * std::log(2.0 * std::numbers::pi) +
         factor.diagonal().array().log().sum();
}

// True if ln π has no valley between a and b.
bool joined(Surface& f, const Vector& a, double value_a, const Vector& b, double value_b) {
  for (const double t : {0.5, 0.25, 0.75})
    if (f(a + t * (b - a)) < std::min(value_a, value_b) - kValley) return false;
  return true;
}

class Search {
 public:
  Search(const Problem& problem, int model, const ModeSearchOptions& options)
      : model_(model),
        options_(options),
        first_batch_(problem.shortened ? kFirstOfRecord : kFirstBatch) {
    for (int s = 0; s < kSlices; ++s)
      surfaces_.push_back(std::make_unique<Surface>(problem, model));
    for (const auto& surface : surfaces_) surface->stop_when(options.stop);
  }

  [[nodiscard]] Eigen::Index dimension() const { return surfaces_.front()->dimension(); }

  // Climbs from draws of the prior.
  void run() {
    const long most = options_.climbs > 0 ? options_.climbs : kMostClimbs;
    long begun = 0;
    for (long batch = first_batch_; begun < most; batch = std::min(2 * batch, kMostBatch)) {
      const long n = std::min(batch, most - begun);
      const long first = begun;
      merge(climb(n, [&](long i, Surface& surface, Vector& z) {
        base::Random random(options_.seed, static_cast<std::uint64_t>(model_),
                            static_cast<std::uint64_t>(first + i), base::Purpose::search);
        surface.draw_prior(random, z);
      }));
      begun += n;
      // Makes as many climbs as without exact derivatives, in less time.
      const double spent = static_cast<double>(evaluations() + saved()) /
                           (options_.effort * static_cast<double>(std::max(options_.budget, 1L)));
      const double share = options_.climbs > 0
                               ? static_cast<double>(begun) / static_cast<double>(most)
                               : std::min(1.0, spent);
      if ((options_.progress && !options_.progress(share)) || stopped()) break;
      if (options_.climbs == 0 && begun >= kFewestClimbs && spent >= 1.0) break;
    }
  }

  void run(const std::vector<std::vector<double>>& starts) {
    merge(climb(
        static_cast<long>(starts.size()),
        [&](long i, Surface&, Vector& z) {
          z = Eigen::Map<const Vector>(starts[static_cast<std::size_t>(i)].data(), z.size());
        },
        options_.fine));
  }

  // Climbs from known modes with one component replaced by draws of its prior. With several
  // components, the basin of the highest mode may hold a small share of the prior (two damages:
  // one of all pairs of members), whereas each of its components is often part of a lower mode.
  void replace_components(const ModelSpace& space) {
    std::vector<ComponentRange> components;
    const Model& model = space[model_];
    for (std::size_t kind = 0; kind < model.counts.size(); ++kind)
      for (int c = 0; c < model.counts[kind]; ++c)
        components.push_back(space.component(model_, static_cast<int>(kind), c));
    if (components.size() < 2) return;
    const long most =
        evaluations() +
        std::max(evaluations(),
                 static_cast<long>(kReplacementShare * static_cast<double>(options_.budget)));
    Surface& f = *surfaces_.front();
    std::vector<Vector> done;
    std::uint64_t number = 0;
    for (int round = 0; round < kReplacementRounds; ++round) {
      std::vector<std::vector<double>> starts;
      for (const std::size_t k : highest_modes(kReplacedModes)) {
        const Vector z = known_[k].z;
        if (std::ranges::any_of(done, [&](const Vector& d) { return d == z; })) continue;
        done.push_back(z);
        for (const ComponentRange& range : components) {
          if (stopped()) return;
          if (evaluations() < most) add_replacements(f, z, range, number++, starts);
        }
      }
      if (starts.empty()) return;
      // These starts are no draws of the prior.
      const auto counts = std::tuple(climbs_, points_, way_);
      run(starts);
      std::tie(climbs_, points_, way_) = counts;
      if (options_.progress && !options_.progress(1.0)) return;
    }
  }

  // Searches much narrower modes at the maxima of the known modes. No valley separates the two
  // modes; both are kept, because each may have probability mass.
  void search_summits() {
    const long each = summit_calls(dimension());
    const double affordable = kSummitShare * static_cast<double>(options_.budget);
    const auto most = std::min<std::size_t>(
        kSummits, static_cast<std::size_t>(affordable / static_cast<double>(each)));
    Surface& f = *surfaces_.front();
    for (const std::size_t k : highest_modes(most)) {
      if (stopped()) return;
      const auto above = above_summit(f, known_[k]);
      if (!above) continue;
      const ClimbEnd end = inference::climb(f, *above, {}, true);
      if (!end.possible || !(end.value > known_[k].value + kAboveSummit)) continue;
      known_.push_back(measure(f, ordered(f, end)));
      hits_.push_back(0);
    }
  }

  // Climbs from the most probable of many draws of the prior. If a model cannot explain the data,
  // its mode for a short record may be far from its mode for the whole record.
  void run_most_probable() {
    Surface& surface = *surfaces_.front();
    Matrix draws(surface.dimension(), kScreened);
    Vector z(surface.dimension());
    for (long i = 0; i < kScreened; ++i) {
      base::Random random(options_.seed, static_cast<std::uint64_t>(model_) | kScreenStream,
                          static_cast<std::uint64_t>(i), base::Purpose::search);
      surface.draw_prior(random, z);
      draws.col(i) = z;
    }
    if (stopped()) return;
    const Vector values = surface.values(draws);
    std::vector<Eigen::Index> order(kScreened);
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](Eigen::Index i) { return values[i]; });
    std::vector<std::vector<double>> starts;
    for (int k = 0; k < kScreenedClimbs; ++k) {
      const auto best = draws.col(order[static_cast<std::size_t>(k)]);
      starts.emplace_back(best.begin(), best.end());
    }
    run(starts);
  }

  // Climbs from the modes of a shorter record, then from draws of the normals about the resulting
  // modes.
  void follow(const std::vector<Mode>& modes, std::uint64_t level) {
    merge(climb(static_cast<long>(modes.size()), [&](long i, Surface&, Vector& z) {
      z = Eigen::Map<const Vector>(modes[static_cast<std::size_t>(i)].z.data(), z.size());
    }));
    std::vector<Matrix> factors;
    for (const Mode& m : modes) factors.push_back(Eigen::LLT<Matrix>(m.covariance).matrixL());
    const long draws = std::max(1L, std::lround(kDrawsAMode * options_.effort));
    merge(climb(static_cast<long>(modes.size()) * draws, [&](long i, Surface&, Vector& z) {
      const auto m = static_cast<std::size_t>(i / draws);
      base::Random random(options_.seed, static_cast<std::uint64_t>(model_) | level << 32U,
                          static_cast<std::uint64_t>(i), base::Purpose::search);
      Vector u(z.size());
      for (double& v : u) v = random.normal();
      z = Eigen::Map<const Vector>(modes[m].z.data(), z.size()) + factors[m] * u;
    }));
  }

  // Adds the modes of another search.
  void take(const std::vector<Mode>& modes) {
    for (const Mode& m : modes) {
      known_.push_back(
          {.z = Eigen::Map<const Vector>(m.z.data(), dimension()),
           .value = m.log_posterior,
           .covariance = m.covariance,
           .precision =
               Eigen::LLT<Matrix>(m.covariance).solve(Matrix::Identity(dimension(), dimension()))});
      hits_.push_back(m.climbs);
    }
  }

  [[nodiscard]] long evaluations() const {
    long sum = 0;
    for (const auto& surface : surfaces_) sum += surface->evaluations();
    return sum;
  }

  [[nodiscard]] long saved() const {
    long sum = 0;
    for (const auto& surface : surfaces_) sum += surface->saved();
    return sum;
  }

  ModeSearch result() {
    ModeSearch out{.modes = {},
                   .climbs = climbs_,
                   .spacing = points_ > 0 ? way_ / static_cast<double>(points_) : 0.0,
                   .likelihood_evaluations = 0};
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const KnownMode& mode = known_[k];
      out.modes.push_back({.z = surfaces_.front()->ordered(mode.z),
                           .log_posterior = mode.value,
                           .covariance = mode.covariance,
                           .log_mass = laplace_mass(mode),
                           .climbs = hits_[k]});
    }
    std::ranges::stable_sort(out.modes, std::ranges::greater{}, &Mode::log_mass);
    std::erase_if(out.modes, [&](const Mode& m) {
      return !(m.log_mass > out.modes.front().log_mass - kNegligible);
    });
    if (!out.modes.empty() && !left_out_.empty()) {
      const double top = out.modes.front().log_mass;
      double kept = 0.0, rest = 0.0;
      for (const Mode& mode : out.modes) kept += std::exp(mode.log_mass - top);
      for (const KnownMode& mode : left_out_) rest += std::exp(laplace_mass(mode) - top);
      out.left_out = static_cast<long>(left_out_.size());
      out.left_out_share = rest / (kept + rest);
    }
    out.likelihood_evaluations = evaluations();
    return out;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> highest_modes(std::size_t most) const {
    std::vector<std::size_t> highest(known_.size());
    std::iota(highest.begin(), highest.end(), std::size_t{0});
    std::ranges::stable_sort(highest, std::ranges::greater{},
                             [&](std::size_t k) { return known_[k].value; });
    highest.resize(std::min(highest.size(), most));
    return highest;
  }

  // Adds z with the component's parameters replaced by the most probable of several draws.
  void add_replacements(Surface& f, const Vector& z, const ComponentRange& range,
                        std::uint64_t number, std::vector<std::vector<double>>& starts) {
    base::Random random(options_.seed, static_cast<std::uint64_t>(model_) | kReplaceStream, number,
                        base::Purpose::search);
    Matrix draws = z.replicate(1, kReplacements);
    for (Eigen::Index i = 0; i < kReplacements; ++i)
      for (std::size_t p = 0; p < range.width; ++p)
        draws(static_cast<Eigen::Index>(range.first + p), i) = random.normal();
    const Vector values = f.values(draws);
    std::vector<Eigen::Index> order(kReplacements);
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](Eigen::Index i) { return values[i]; });
    for (int k = 0; k < kReplacementClimbs; ++k) {
      const auto best = draws.col(order[static_cast<std::size_t>(k)]);
      starts.emplace_back(best.begin(), best.end());
    }
  }

  // Climbs from each start, using the modes known before.
  template <typename Start>
  std::vector<ClimbEnd> climb(long n, Start&& start, bool fine = false) {
    std::vector<ClimbEnd> ends(static_cast<std::size_t>(n));
    base::parallel_for(
        kSlices, options_.threads,
        [&](int s) {
          Surface& surface = *surfaces_[static_cast<std::size_t>(s)];
          Vector z(surface.dimension());
          for (long i = s; i < n && !surface.stopped(); i += kSlices) {
            start(i, surface, z);
            ends[static_cast<std::size_t>(i)] = inference::climb(surface, z, known_, fine);
          }
        },
        base::carriage([&](int s, auto& parcel) {
          surfaces_[static_cast<std::size_t>(s)]->carry(parcel);
          for (long i = s; i < n; i += kSlices) {
            ClimbEnd& end = ends[static_cast<std::size_t>(i)];
            parcel(end.z, end.value, end.inverse_hessian, end.known, end.possible, end.way,
                   end.points);
          }
        }));
    return ends;
  }

  // Adds the ends in the order of the starts, so that the result does not depend on the threads.
  void merge(const std::vector<ClimbEnd>& ends) {
    Surface& f = *surfaces_.front();
    for (const ClimbEnd& end : ends) {
      if (!end.possible) continue;
      ++climbs_;
      way_ += end.way;
      points_ += end.points;
      if (end.known >= 0) {
        ++hits_[static_cast<std::size_t>(end.known)];
        continue;
      }
      const int same = find(f, end);
      if (same >= 0) {
        const auto k = static_cast<std::size_t>(same);
        ++hits_[k];
        if (end.value > known_[k].value + 0.5) known_[k] = measure(f, ordered(f, end));
        continue;
      }
      // A mode far below the best mode must be wide to be relevant, but the prior limits its width.
      double best = -kInfinity;
      for (const KnownMode& k : known_) best = std::max(best, k.value);
      const double slack = kNegligible + 12.0 * static_cast<double>(end.z.size());
      if (end.value < best - slack) continue;
      known_.push_back(measure(f, ordered(f, end)));
      hits_.push_back(1);
    }
    // Deletes the lowest modes if the list is too long; only now, as ends refer to modes by index.
    while (known_.size() > kMostModes) {
      const auto least = std::ranges::min_element(known_, {}, &KnownMode::value) - known_.begin();
      leave_out(known_[static_cast<std::size_t>(least)]);
      known_.erase(known_.begin() + least);
      hits_.erase(hits_.begin() + least);
    }
  }

  // Counts a mode only once, even if it is found again.
  void leave_out(const KnownMode& mode) {
    for (const KnownMode& other : left_out_)
      if (square_distance(other, mode.z) < 1.0) return;
    if (left_out_.size() < kMostLeftOut) left_out_.push_back(mode);
  }

  static ClimbEnd ordered(Surface& f, ClimbEnd end) {
    const std::vector<double> z = f.ordered(end.z);
    const Vector to = Eigen::Map<const Vector>(z.data(), end.z.size());
    if (to != end.z) end.inverse_hessian.resize(0, 0);
    end.z = to;
    return end;
  }

  [[nodiscard]] bool stopped() const { return options_.stop && options_.stop(); }

  int find(Surface& f, const ClimbEnd& end) {
    const ClimbEnd e = ordered(f, end);
    std::vector<std::pair<double, int>> near;
    for (int k = 0; k < static_cast<int>(known_.size()); ++k)
      near.emplace_back(square_distance(known_[static_cast<std::size_t>(k)], e.z), k);
    std::ranges::sort(near);
    for (std::size_t n = 0; n < std::min<std::size_t>(near.size(), 4); ++n) {
      const KnownMode& mode = known_[static_cast<std::size_t>(near[n].second)];
      if (near[n].first < 0.25 && std::fabs(mode.value - e.value) < 0.5) return near[n].second;
      if (joined(f, mode.z, mode.value, e.z, e.value)) return near[n].second;
    }
    return -1;
  }

  int model_;
  const ModeSearchOptions& options_;
  long first_batch_;
  std::vector<std::unique_ptr<Surface>> surfaces_;
  std::vector<KnownMode> known_;
  std::vector<long> hits_;
  std::vector<KnownMode> left_out_;
  long climbs_ = 0, points_ = 0;
  double way_ = 0.0;
};

// True if the mode of a shorter record was lost, that is if it predicts the added samples far worse
// than the earlier samples. The limit follows from Gaussian residuals and a margin in nats.
bool lost(const ModeSearch& before, long n, const ModeSearch& after, long grown) {
  if (after.modes.empty()) return true;
  const double was = before.modes.front().log_posterior;
  const auto all = static_cast<double>(n), more = static_cast<double>(grown - n);
  const double chance = 6.0 * std::sqrt(more * (1.0 + more / all));
  return after.modes.front().log_posterior < was + was * more / all - kNegligible - chance;
}

// Follows the best modes of n samples to a longer record, in steps that are as small as necessary.
// If the motion nearly leaves a potential well, or hits a stop, the mode for n samples does not
// predict the next n samples. Climbs from this mode then do not find the mode for 2 n samples.
std::vector<std::vector<double>> followed_closely(const Problem& problem, int model,
                                                  ModeSearchOptions options, ModeSearch found,
                                                  long n, long to, long& evaluations) {
  options.fine = true;
  const auto places = [](const ModeSearch& search) {
    std::vector<std::vector<double>> out;
    for (const Mode& mode : search.modes) out.push_back(mode.z);
    out.resize(std::min(out.size(), kThreads));
    return out;
  };
  for (long step = std::max(1L, n / kFirstGrowth); n < to;) {
    if (options.progress && !options.progress(1.0)) return {};
    if (options.stop && options.stop()) return {};
    const long next = std::min(n + step, to);
    const auto part = next < problem.samples ? problem.shortened(next) : nullptr;
    Search search(part ? *part : problem, model, options);
    search.run(places(found));
    ModeSearch grown = search.result();
    evaluations += grown.likelihood_evaluations;
    if (!lost(found, n, grown, next)) {
      found = std::move(grown);
      n = next;
    } else if (step > n / kLeastGrowth && step > 1) {
      step /= 2;
    } else {
      return {};  // the model probably does not explain the record
    }
  }
  return places(found);
}

}  // namespace

ModeSearch search_modes(const Problem& problem, int model, const ModeSearchOptions& options) {
  if (problem.space[model].dimension == 0) return {};
  if (!problem.shortened || problem.samples <= kSearchSamples) {
    Search search(problem, model, options);
    search.run(options.starts);
    search.run();
    search.replace_components(problem.space);
    if (options.climbs == 0 || options.climbs >= kFewestClimbs) search.search_summits();
    ModeSearch found = search.result();
    found.climbs -= std::min(found.climbs, static_cast<long>(options.starts.size()));
    return found;
  }
  std::shared_ptr<const Problem> part = problem.shortened(kSearchSamples);
  ModeSearch found;
  {
    Search first(*part, model, options);
    first.run();
    found = first.result();
  }
  const long climbs = found.climbs;
  const double spacing = found.spacing;
  long evaluations = found.likelihood_evaluations;
  std::uint64_t level = 1;
  const auto followed =
      static_cast<std::size_t>(std::max(kFewestFollowed, kFollowed * options.effort));
  for (long n = kSearchSamples; n < problem.samples && !found.modes.empty(); ++level) {
    const long before = n;
    n = std::min(2 * n, problem.samples);
    if (found.modes.size() > followed) found.modes.resize(followed);
    if (n < problem.samples) part = problem.shortened(n);
    Search next(n < problem.samples ? *part : problem, model, options);
    next.follow(found.modes, level);
    if (n == problem.samples) {
      next.run(options.starts);
      next.run_most_probable();
    }
    if (ModeSearch grown = next.result(); lost(found, before, grown, n)) {
      next.run(followed_closely(problem, model, options, std::move(found), before, n, evaluations));
      found = next.result();
    } else {
      found = std::move(grown);
    }
    evaluations += found.likelihood_evaluations;
    if ((options.progress && !options.progress(1.0)) || (options.stop && options.stop())) break;
  }
  // All of the few climbs from the prior may begin at impossible points; then uses other starts.
  if (found.modes.empty() && !options.starts.empty()) {
    Search whole(problem, model, options);
    whole.run(options.starts);
    found = whole.result();
    evaluations += found.likelihood_evaluations;
  }
  found.climbs = climbs;
  found.spacing = spacing;
  found.likelihood_evaluations = evaluations;
  return found;
}

void extend_search(const Problem& problem, int model, const ModeSearchOptions& options,
                   ModeSearch& found) {
  if (problem.space[model].dimension == 0 || options.starts.empty()) return;
  Search search(problem, model, options);
  search.take(found.modes);
  search.run(options.starts);
  ModeSearch more = search.result();
  if (more.left_out > 0) {
    found.left_out += more.left_out;
    found.left_out_share = std::max(found.left_out_share, more.left_out_share);
  }
  found.modes = std::move(more.modes);
  found.likelihood_evaluations += more.likelihood_evaluations;
}

double search_resolution(double of_wide_modes, double spacing, double width) {
  if (!(width > 0.0)) return 1.0;
  return std::min(1.0, of_wide_modes * std::max(1.0, spacing / width));
}

double search_resolution(long climbs) {
  return climbs < 1 ? 1.0 : -std::expm1(std::log(0.01) / static_cast<double>(climbs));
}

}  // namespace wheeltap::inference
