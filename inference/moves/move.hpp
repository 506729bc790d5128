// Moves of a Markov chain: reversible pairs of proposals, and their acceptance.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Context of one kernel step at inverse temperature `beta`, which leaves prior × likelihood^beta
/// invariant. `adapting` is true in warm-up only.
struct Step {
  Target& target;
  base::Random& random;
  double beta = 1.0;
  bool adapting = false;
};

/// A Markov kernel over the states (model, z).
class Kernel {
 public:
  struct Outcome {
    bool proposed = false;  ///< false if the kernel does not apply to the state
    bool accepted = false;
    int to_model = 0;  ///< the proposed model
  };
  /// `work` is the run time of a step without its likelihood evaluations, expressed as a number of
  /// likelihood evaluations (see kOperationsACall).
  explicit Kernel(std::string name, double work = 0.0) : name_(std::move(name)), work_(work) {}
  virtual ~Kernel() = default;
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  virtual Outcome step(State& state, const Step& step) = 0;
  /// `save` appends the adaptation state to `numbers`. `restore` reads the adaptation state from
  /// the front of `numbers` and removes it. A new kernel with the restored state continues bit for
  /// bit.
  virtual void save(std::vector<double>& /*numbers*/) const {}
  virtual void restore(std::span<const double>& /*numbers*/) {}
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double work() const { return work_; }

 private:
  std::string name_;
  double work_;
};

/// Number of multiplications that count as one likelihood evaluation. This number of
/// multiplications takes a few microseconds, as long as one evaluation of a cheap likelihood. Work
/// is counted in operations instead of seconds, so that draws are the same on every machine.
inline constexpr double kOperationsACall = 1e4;

/// Statistics of a kernel, for the estimate of its efficiency.
struct KernelRecord {
  long proposed = 0, accepted = 0;
  long jumps_proposed = 0, jumps_accepted = 0;  ///< numbers of jumps between models

  void add(const Kernel::Outcome& outcome, bool jump) {
    if (!outcome.proposed) return;
    ++proposed;
    accepted += outcome.accepted ? 1 : 0;
    jumps_proposed += jump ? 1 : 0;
    jumps_accepted += jump && outcome.accepted ? 1 : 0;
  }
  KernelRecord& operator+=(const KernelRecord& other) {
    proposed += other.proposed;
    accepted += other.accepted;
    jumps_proposed += other.jumps_proposed;
    jumps_accepted += other.jumps_accepted;
    return *this;
  }
};

/// A move is a reversible pair of proposals: one expression gives the forward and the reverse
/// density. A move defines only the proposal; the sampler adds prior and likelihood.
class Move {
 public:
  virtual ~Move() = default;

  /// Writes a proposal into `to` (initially a copy of `from`) and returns
  ///
  ///   ln [ q(to → from) / q(from → to) · |J| ]     with respect to dz,
  ///
  /// or std::nullopt if no proposal is possible; the chain then repeats its state. A move whose
  /// reverse density depends on the residuals of the likelihood must call Target::screen for `to`.
  virtual std::optional<double> propose(const State& from, const Step& step, State& to) = 0;

  /// Adapts the move; called after each proposal of this move during warm-up.
  virtual void adapt(double /*acceptance_probability*/, const State& /*reached*/) {}
  /// Saves the state of `adapt`; see Kernel::save.
  virtual void save(std::vector<double>& /*numbers*/) const {}
  virtual void restore(std::span<const double>& /*numbers*/) {}
};

/// Accepts a move with probability
///
///   min{1, likelihood ratio^beta · prior ratio · proposal ratio · |J|}       (Green 1995, eq. 7).
///
/// If the problem has an approximation ℓ* of the log likelihood ℓ, acceptance is delayed (Christen
/// & Fox 2005, Markov chain Monte Carlo using an approximation, section 2). The first stage accepts
/// the proposal with the probability above, computed with ℓ* instead of ℓ. If so, ℓ is computed,
/// and the second stage accepts the proposal with probability
///
///   min{1, exp(beta [ℓ(y) - ℓ*(y) - ℓ(x) + ℓ*(x)])}.
///
/// The first stage leaves prior × exp(beta ℓ*) invariant, and the second stage corrects
/// this distribution to the posterior, for every move and model.
class MetropolisHastings : public Kernel {
 public:
  MetropolisHastings(std::string name, std::unique_ptr<Move> move, double work = 0.0)
      : Kernel(std::move(name), work), move_(std::move(move)) {}
  Outcome step(State& state, const Step& step) override;
  void save(std::vector<double>& numbers) const override { move_->save(numbers); }
  void restore(std::span<const double>& numbers) override { move_->restore(numbers); }

 private:
  std::unique_ptr<Move> move_;
  State proposal_;
};

/// ln of the ratio of the tempered target density at `to` to that at `from`. The result is -∞ if
/// the density at `to` is zero, and +∞ if only the density at `from` is zero.
[[nodiscard]] double log_target_ratio(const Target& target, double beta, const State& from,
                                      const State& to);
/// ln of the ratio of the tempered target densities, with the approximate log likelihood.
[[nodiscard]] double log_screen_ratio(const Target& target, double beta, const State& from,
                                      const State& to);

/// A fixed mixture of kernels. Each step selects one kernel with a probability that is proportional
/// to its weight and independent of the state. A kernel that is not applicable leaves the state
/// unchanged.
class KernelMixture {
 public:
  /// Adds a kernel. `most` is the largest factor by which the weight of this kernel may increase
  /// (kernel_efficiencies).
  void add(double weight, std::unique_ptr<Kernel> kernel, double most = 1.0);
  /// Multiplies the weight of each kernel by its factor > 0.
  void reweigh(const std::vector<double>& factors);
  /// Makes one step and returns the index of the selected kernel, or -1 if the mixture is empty.
  int step(State& state, const Step& step, Kernel::Outcome& outcome);
  /// Adaptation states of all kernels, one after the other.
  [[nodiscard]] std::vector<double> learnt() const;
  /// Restores the adaptation states of all kernels. Throws std::invalid_argument if the length of
  /// `learnt` does not match the kernels.
  void restore(std::span<const double> learnt);
  [[nodiscard]] int size() const { return static_cast<int>(kernels_.size()); }
  [[nodiscard]] const Kernel& operator[](int i) const {
    return *kernels_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double most(int i) const { return most_[static_cast<std::size_t>(i)]; }

 private:
  std::vector<std::unique_ptr<Kernel>> kernels_;
  std::vector<double> cumulative_, most_;
};

/// Efficiency of each kernel relative to the best other kernel of its type, limited to the range
/// from 0.1 to `most`. The efficiency is the number of accepted moves divided by the work. The work
/// of a proposal is one likelihood evaluation plus the additional work `work()` of the kernel. For
/// kernels that propose jumps between models, only accepted jumps count. The efficiency is set to 1
/// for kernels without additional work whose `most` is 1, because some of them reach states that no
/// other kernel reaches. Kernels with too few proposals for an estimate also have the efficiency 1.
[[nodiscard]] std::vector<double> kernel_efficiencies(const KernelMixture& kernels,
                                                      const std::vector<KernelRecord>& records);

}  // namespace wheeltap::inference
