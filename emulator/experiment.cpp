#include "emulator/experiment.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "emulator/journal.hpp"

namespace wheeltap::emulator {
namespace {

std::string describe(const Design& design, Eigen::Index run) {
  std::ostringstream text;
  text.precision(10);
  text << "run " << run << " (";
  for (std::size_t j = 0; j < design.factors.size(); ++j)
    text << (j ? ", " : "") << design.factors[j].name << " = "
         << design.points(run, static_cast<Eigen::Index>(j));
  text << ")";
  return text.str();
}

/// Converts the names and points of a design to text, byte for byte. Equal texts mean equal
/// designs.
std::string text_of(const Design& design) {
  std::string text;
  for (const Factor& factor : design.factors) text += factor.name + '\n';
  text.append(reinterpret_cast<const char*>(design.points.data()),
              static_cast<std::size_t>(design.points.size()) * sizeof(double));
  return text;
}

// Experiment in progress. Ranks share the journal of rank 0, which gets the runs of other ranks at
// the end of each section.
class Experiment {
 public:
  Experiment(const Design& design, Eigen::Index responses, const ModelFactory& factory,
             const ExperimentOptions& options)
      : design_(design),
        factory_(factory),
        options_(options),
        result_(design.runs(), responses),
        known_(static_cast<std::size_t>(design.runs()), 0) {
    if (!options.journal.empty()) remember();
  }

  RowMatrix run() && {
    const Eigen::Index runs = design_.runs();
    const Eigen::Index sections =
        base::ranks() != nullptr ? std::min<Eigen::Index>(runs, kSections) : 1;
    for (Eigen::Index s = 0; s < sections; ++s) {
      first_ = s * runs / sections;
      last_ = (s + 1) * runs / sections;
      failed_block_ = kNone;
      block_ = std::max<Eigen::Index>(1, (last_ - first_) / kBlocks);
      base::parallel_for(
          static_cast<int>((last_ - first_ + block_ - 1) / block_), options_.threads,
          [this](int block) { make(block); }, base::carriage([this](int block, auto& parcel) {
            const auto [begin, end] = runs_of(block);
            parcel(std::span<double>(result_.row(begin).data(),
                                     static_cast<std::size_t>((end - begin) * result_.cols())));
            if constexpr (std::is_same_v<std::remove_reference_t<decltype(parcel)>, base::Unpacker>)
              take_over(begin, end);
          }));
    }
    return std::move(result_);
  }

 private:
  static constexpr int kSections = 20, kBlocks = 4096, kNone = std::numeric_limits<int>::max();

  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> runs_of(int block) const {
    const Eigen::Index begin = first_ + block * block_;
    return {begin, std::min(begin + block_, last_)};
  }
  [[nodiscard]] std::span<double> response(Eigen::Index run) {
    return {result_.row(run).data(), static_cast<std::size_t>(result_.cols())};
  }

  // Takes over the runs of the journal (with several ranks, of the journal of rank 0).
  void remember() {
    base::Packer packer;
    if (base::is_first_rank()) {
      const std::string identity = options_.identity + '\n' + text_of(design_);
      journal_.emplace(options_.journal, identity, static_cast<std::size_t>(result_.cols()));
      for (const Journal::Entry& entry : journal_->entries()) {
        if (entry.run < 0 || entry.run >= design_.runs())
          throw io::FileError(io::FileError::Kind::corrupt, options_.journal,
                              "holds run " + std::to_string(entry.run) + " of a design of " +
                                  std::to_string(design_.runs()));
        packer(entry.run, entry.response);
      }
    }
    std::string bytes = std::move(packer).bytes();
    if (base::ranks() != nullptr) bytes = base::ranks()->from_first(std::move(bytes));
    for (base::Unpacker unpacker(bytes); !unpacker.empty();) {
      std::int64_t run = 0;
      std::vector<double> values;
      unpacker(run, values);
      auto& known = known_[static_cast<std::size_t>(run)];
      done_ += known != 0 ? 0 : 1;
      known = 1;
      std::ranges::copy(values, result_.row(run).data());
    }
  }

  // Blocks are started in order, and all blocks before a failed block are completed. The error
  // therefore names the first failed run of the design, independent of timing.
  void make(int block) {
    if (block > failed_block_) return;
    try {
      Model model = take_model();
      const auto [begin, end] = runs_of(block);
      for (Eigen::Index run = begin; run < end; ++run) {
        if (known_[static_cast<std::size_t>(run)] != 0) continue;
        answer(model, run);
        const std::lock_guard lock(mutex_);
        tell(run);
      }
      const std::lock_guard lock(mutex_);
      idle_.push_back(std::move(model));
    } catch (...) {
      for (int now = failed_block_; block < now;) failed_block_.compare_exchange_weak(now, block);
      throw;
    }
  }

  Model take_model() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        Model model = std::move(idle_.back());
        idle_.pop_back();
        return model;
      }
    }
    return factory_();
  }

  void answer(Model& model, Eigen::Index run) {
    try {
      model(design_.point(run), response(run));
      for (std::size_t k = 0; k < response(run).size(); ++k)
        if (!std::isfinite(response(run)[k]))
          throw std::domain_error("response " + std::to_string(k) + " is not finite");
    } catch (const std::exception& error) {
      std::throw_with_nested(RunError(run, describe(design_, run) + " failed: " + error.what()));
    } catch (...) {
      std::throw_with_nested(RunError(run, describe(design_, run) + " failed"));
    }
  }

  void tell(Eigen::Index run) {
    if (journal_) journal_->append(run, response(run));
    ++done_;
    if (options_.progress) options_.progress(done_, design_.runs());
  }

  void take_over(Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index run = begin; run < end; ++run) {
      if (known_[static_cast<std::size_t>(run)] == 0) tell(run);
    }
  }

  const Design& design_;
  const ModelFactory& factory_;
  const ExperimentOptions& options_;
  RowMatrix result_;
  std::vector<char> known_;  // from the journal
  Eigen::Index first_ = 0, last_ = 0, block_ = 1;
  std::atomic<int> failed_block_{kNone};
  std::mutex mutex_;  // guards the following members and the progress callback
  std::optional<Journal> journal_;
  std::vector<Model> idle_;
  Eigen::Index done_ = 0;
};

}  // namespace

RowMatrix run_experiment(const Design& design, Eigen::Index responses, const ModelFactory& factory,
                         const ExperimentOptions& options) {
  const Eigen::Index runs = design.runs();
  if (runs < 1) throw std::invalid_argument("the design of the experiment is empty");
  if (design.points.cols() != static_cast<Eigen::Index>(design.factors.size()))
    throw std::invalid_argument("a design has " + std::to_string(design.points.cols()) +
                                " columns for " + std::to_string(design.factors.size()) +
                                " factors");
  if (responses < 1)
    throw std::invalid_argument("responses = " + std::to_string(responses) + " must be >= 1");
  if (options.threads < 1)
    throw std::invalid_argument("threads = " + std::to_string(options.threads) + " must be >= 1");

  Experiment experiment(design, responses, factory, options);
  return std::move(experiment).run();
}

Design shard(const Design& design, Eigen::Index part, Eigen::Index parts) {
  if (parts < 1 || part < 0 || part >= parts)
    throw std::invalid_argument("part " + std::to_string(part) + " of " + std::to_string(parts) +
                                " parts: must have 0 <= part < parts");
  const Eigen::Index runs = (design.runs() - part + parts - 1) / parts;
  if (runs < 1)
    throw std::invalid_argument("part " + std::to_string(part) + " of " + std::to_string(parts) +
                                " of a design of " + std::to_string(design.runs()) +
                                " runs is empty");
  Design out{.factors = design.factors, .points = RowMatrix(runs, design.points.cols())};
  for (Eigen::Index i = 0; i < runs; ++i) out.points.row(i) = design.points.row(part + i * parts);
  return out;
}

}  // namespace wheeltap::emulator
