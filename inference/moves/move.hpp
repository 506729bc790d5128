// Moves of a Markov chain: reversible pairs, and the one place where they are accepted or rejected.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// What a kernel may use while it makes one step at inverse temperature `beta`: it leaves
/// prior × likelihood^beta invariant. `adapting` is true in warm-up only.
struct Step {
  Target& target;
  base::Random& random;
  double beta = 1.0;
  bool adapting = false;
};

/// A Markov kernel over (model, z).
class Kernel {
 public:
  struct Outcome {
    bool proposed = false;  ///< false where the kernel does not apply to the state
    bool accepted = false;
    int to_model = 0;  ///< what was proposed
  };
  /// `work` of a step beside the likelihood, in likelihood calls (see kOperationsACall).
  explicit Kernel(std::string name, double work = 0.0) : name_(std::move(name)), work_(work) {}
  virtual ~Kernel() = default;
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  virtual Outcome step(State& state, const Step& step) = 0;
  /// Appends what steps have taught it, and takes it back from the front of `numbers`: a kernel
  /// made anew and given them goes on bit for bit.
  virtual void save(std::vector<double>& /*numbers*/) const {}
  virtual void restore(std::span<const double>& /*numbers*/) {}
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double work() const { return work_; }

 private:
  std::string name_;
  double work_;
};

/// So many multiplications are counted as one likelihood call: some microseconds, what a cheap
/// likelihood takes. Work is counted and never timed, so that every machine makes the same draws.
inline constexpr double kOperationsACall = 1e4;

/// What a kernel did while its worth was learnt.
struct KernelRecord {
  long proposed = 0, accepted = 0;
  long jumps_proposed = 0, jumps_accepted = 0;  ///< between models

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

/// A move is a pair: forward and reverse share one expression, so that they cannot drift apart. It
/// knows the proposal only; prior and likelihood are the sampler's.
class Move {
 public:
  virtual ~Move() = default;

  /// Writes a proposal into `to` (which arrives as a copy of `from`) and returns
  ///
  ///   ln [ q(to → from) / q(from → to) · |J| ]     with respect to dz,
  ///
  /// or nothing where no proposal is possible: the chain then repeats its state. A move whose
  /// reverse density depends on the likelihood's residuals screens `to` itself.
  virtual std::optional<double> propose(const State& from, const Step& step, State& to) = 0;

  /// Called after each of its proposals during warm-up.
  virtual void adapt(double /*acceptance_probability*/, const State& /*reached*/) {}
  /// What `adapt` has learnt; see Kernel::save.
  virtual void save(std::vector<double>& /*numbers*/) const {}
  virtual void restore(std::span<const double>& /*numbers*/) {}
};

/// Accepts a move with probability
///
///   min{1, likelihood ratio^beta · prior ratio · proposal ratio · |J|}       (Green 1995, eq. 7).
///
/// Where the problem has a stand-in ℓ* for the log likelihood ℓ, delayed acceptance (Christen & Fox
/// 2005, Markov chain Monte Carlo using an approximation, section 2): the ratio above with ℓ*
/// decides whether ℓ is computed at all, and the proposal is then accepted with probability
///
///   min{1, exp(beta [ℓ(y) - ℓ*(y) - ℓ(x) + ℓ*(x)])}.
///
/// The first stage is a kernel that leaves prior × exp(beta ℓ*) invariant, so its own ratio is that
/// density's, and the second stage corrects it, whatever the move and the models.
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

/// ln of the ratio of tempered target densities, to over from; -∞ where `to` is impossible, +∞
/// where only `from` is.
[[nodiscard]] double log_target_ratio(const Target& target, double beta, const State& from,
                                      const State& to);
/// The same with the stand-in's log likelihood.
[[nodiscard]] double log_screen_ratio(const Target& target, double beta, const State& from,
                                      const State& to);

/// A fixed mixture of kernels: each step picks one with probability proportional to its weight,
/// whatever the state. A kernel that does not apply leaves the state alone.
class KernelMixture {
 public:
  /// `most`: how many times its weight it may come to have (kernel_efficiencies).
  void add(double weight, std::unique_ptr<Kernel> kernel, double most = 1.0);
  /// Multiplies the weights, one factor > 0 a kernel.
  void reweigh(const std::vector<double>& factors);
  /// Makes one step; returns the index of the kernel used, -1 where there is none.
  int step(State& state, const Step& step, Kernel::Outcome& outcome);
  /// What its kernels have learnt, one after the other.
  [[nodiscard]] std::vector<double> learnt() const;
  /// Takes it back. Throws std::invalid_argument where that is not what these kernels learn.
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

/// What each kernel is worth beside the best other one of its sort, from 0.1 to its `most`: the
/// moves it had accepted, between models where it proposes such, per unit of counted work, a
/// likelihood call a proposal included. Kernels that cost nothing beside their call and may not
/// grow keep their weight, 1, whatever they bring: some are there for what the others miss. So does
/// one of which there is too little to go by.
[[nodiscard]] std::vector<double> kernel_efficiencies(const KernelMixture& kernels,
                                                      const std::vector<KernelRecord>& records);

}  // namespace wheeltap::inference
