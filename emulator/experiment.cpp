#include "emulator/experiment.hpp"

#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

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

/// Names and points, byte for byte: two designs with the same text are the same.
std::string text_of(const Design& design) {
  std::string text;
  for (const Factor& factor : design.factors) text += factor.name + '\n';
  text.append(reinterpret_cast<const char*>(design.points.data()),
              static_cast<std::size_t>(design.points.size()) * sizeof(double));
  return text;
}

}  // namespace

RowMatrix run_experiment(const Design& design, Eigen::Index responses, const ModelFactory& factory,
                         const ExperimentOptions& options) {
  const Eigen::Index runs = design.runs();
  if (runs < 1) throw std::invalid_argument("an experiment on an empty design");
  if (design.points.cols() != static_cast<Eigen::Index>(design.factors.size()))
    throw std::invalid_argument("a design with " + std::to_string(design.points.cols()) +
                                " columns for " + std::to_string(design.factors.size()) +
                                " factors");
  if (responses < 1)
    throw std::invalid_argument("responses = " + std::to_string(responses) + " must be >= 1");
  if (options.threads < 1)
    throw std::invalid_argument("threads = " + std::to_string(options.threads) + " must be >= 1");

  RowMatrix result(runs, responses);
  std::atomic<Eigen::Index> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;  // guards what follows and the progress callback
  Eigen::Index done = 0;
  std::vector<char> remembered(static_cast<std::size_t>(runs), 0);
  std::optional<Journal> journal;
  if (!options.journal.empty()) {
    journal.emplace(options.journal, options.identity + '\n' + text_of(design),
                    static_cast<std::size_t>(responses));
    for (const Journal::Entry& entry : journal->entries()) {
      if (entry.run < 0 || entry.run >= runs)
        throw io::FileError(
            io::FileError::Kind::corrupt, options.journal,
            "holds run " + std::to_string(entry.run) + " of a design of " + std::to_string(runs));
      auto& seen = remembered[static_cast<std::size_t>(entry.run)];
      done += seen ? 0 : 1;
      seen = 1;
      std::copy(entry.response.begin(), entry.response.end(), result.row(entry.run).data());
    }
  }
  Eigen::Index failed_run = std::numeric_limits<Eigen::Index>::max();
  std::exception_ptr failure;

  // Runs are handed out in order and every run handed out is finished, so the first failing run of
  // the design is always among those seen, whatever the threads' timing.
  const auto fail = [&](Eigen::Index run) {
    failed = true;
    const std::lock_guard lock(mutex);
    if (run < failed_run) {
      failed_run = run;
      failure = std::current_exception();
    }
  };
  const auto work = [&] {
    Model model;
    try {
      model = factory();
    } catch (...) {
      fail(-1);
      return;
    }
    while (!failed) {
      const Eigen::Index run = next++;
      if (run >= runs) return;
      if (remembered[static_cast<std::size_t>(run)]) continue;
      try {
        const std::span<double> response(result.row(run).data(),
                                         static_cast<std::size_t>(responses));
        model(design.point(run), response);
        for (std::size_t k = 0; k < response.size(); ++k)
          if (!std::isfinite(response[k]))
            throw std::domain_error("response " + std::to_string(k) + " is not finite");
        const std::lock_guard lock(mutex);
        if (journal) journal->append(run, response);
        ++done;
        if (options.progress) options.progress(done, runs);
      } catch (...) {
        fail(run);
      }
    }
  };

  {
    std::vector<std::jthread> crew;
    for (Eigen::Index t = 1; t < std::min<Eigen::Index>(options.threads, runs); ++t)
      crew.emplace_back(work);
    work();
  }
  if (failure) {
    if (failed_run < 0) std::rethrow_exception(failure);
    try {
      std::rethrow_exception(failure);
    } catch (const io::FileError&) {
      throw;  // the journal's, not the model's
    } catch (const std::exception& error) {
      std::throw_with_nested(
          RunError(failed_run, describe(design, failed_run) + " failed: " + error.what()));
    } catch (...) {
      std::throw_with_nested(RunError(failed_run, describe(design, failed_run) + " failed"));
    }
  }
  return result;
}

Design shard(const Design& design, Eigen::Index part, Eigen::Index parts) {
  if (parts < 1 || part < 0 || part >= parts)
    throw std::invalid_argument("part " + std::to_string(part) + " of " + std::to_string(parts) +
                                " parts: 0 <= part < parts is needed");
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
