#include "apps/running.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>

#include "apps/failure.hpp"
#include "apps/terminal.hpp"

namespace wheeltap::apps {
namespace {

std::atomic<bool> interrupted{false};

// Ctrl-C asks the sampler to stop; a second one ends the program.
class StopOnInterrupt {
 public:
  StopOnInterrupt() {
    previous_ = std::signal(SIGINT, [](int) {
      if (interrupted.exchange(true)) std::_Exit(130);
    });
  }
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;
  ~StopOnInterrupt() { std::signal(SIGINT, previous_); }

 private:
  void (*previous_)(int);
};

// Chains that were stopped early may differ in length.
void cut_to_shortest(inference::Posterior& posterior) {
  std::size_t n = posterior.chains.empty() ? 0 : posterior.chains[0].model.size();
  for (const auto& chain : posterior.chains) n = std::min(n, chain.model.size());
  for (auto& chain : posterior.chains) {
    chain.model.resize(n);
    chain.theta.resize(n * static_cast<std::size_t>(posterior.dimension));
    chain.log_prior.resize(n);
    chain.log_likelihood.resize(n);
    chain.move.resize(n);
    chain.accepted.resize(n);
    if (!chain.prediction.empty()) {
      chain.prediction.resize(n * static_cast<std::size_t>(posterior.predictions));
    }
  }
  posterior.draws = static_cast<int>(n);
}

}  // namespace

std::shared_ptr<spdlog::logger> make_log(bool quiet) {
  auto log = std::make_shared<spdlog::logger>("wheeltap",
                                              std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_pattern("%v");
  log->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  return log;
}

inference::Posterior run_engine(const inference::Problem& problem, inference::Options options,
                                const std::filesystem::path& case_path, bool quiet) {
  ProgressBar bar(quiet);
  const auto began = std::chrono::steady_clock::now();
  options.progress = [&](const inference::Options::Progress& progress) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    // Likelihoods a second, over the run so far.
    std::string detail =
        seconds > 1.0
            ? rounded_count(static_cast<double>(progress.likelihood_evaluations) / seconds) + "/s"
            : std::string();
    for (std::size_t m = 0; m < progress.model_probabilities.size(); ++m) {
      if (m == 0) detail += (detail.empty() ? "P =" : "  P =");
      if (m < 8) detail += " " + fixed(progress.model_probabilities[m], 2);
    }
    bar.show(progress.stage, progress.fraction, detail);
    return !interrupted.load();
  };
  const StopOnInterrupt stop;
  try {
    inference::Posterior posterior = inference::reversible_jump(problem, options);
    bar.clear();
    cut_to_shortest(posterior);
    if (posterior.draws < 100) {
      throw Failure(Exit::interrupted,
                    "stopped before there were 100 draws a chain: nothing to report");
    }
    return posterior;
  } catch (const inference::LikelihoodError& error) {
    bar.clear();
    throw Failure(Exit::bad_input, case_path.string() + ": " + error.what());
  }
}

std::vector<identification::EvidenceMethod> evidence_methods(const std::string& text) {
  using identification::EvidenceMethod;
  std::vector<EvidenceMethod> methods;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, '+');) {
    bool known = false;
    for (const auto method :
         {EvidenceMethod::tmcmc, EvidenceMethod::bridge, EvidenceMethod::laplace}) {
      if (identification::method_name(method) != word) continue;
      methods.push_back(method);
      known = true;
    }
    if (!known) {
      throw Failure(Exit::usage, "--evidence=" + text + ": methods are tmcmc, bridge and laplace");
    }
  }
  return methods;
}

std::vector<identification::MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<identification::EvidenceMethod>& methods,
    std::uint64_t seed, int threads, spdlog::logger& log) {
  for (const auto method : methods) {
    log.info("Evidence of each model by {} ...", identification::method_name(method));
  }
  return identification::compute_evidence(problem, methods, seed, threads);
}

void make_output_folder(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error || !std::filesystem::is_directory(directory)) {
    throw io::FileError(io::FileError::Kind::unwritable, directory,
                        error ? error.message() : "is not a folder");
  }
}

void write_text(const io::AtomicFile& file, const std::string& text) {
  std::ofstream stream(file.temporary(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    throw io::FileError(io::FileError::Kind::unwritable, file.temporary(), "cannot be written");
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  io::AtomicFile file(path);
  write_text(file, text);
  file.commit();
}

}  // namespace wheeltap::apps
