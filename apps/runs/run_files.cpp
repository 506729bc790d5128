#include "apps/runs/run_files.hpp"

#include <algorithm>
#include <iostream>
#include <vector>

#include "apps/report/report.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/running.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

using io::AtomicFile;
using io::FileError;

// Bytes; every summary is shorter.
constexpr std::size_t kRoom = 1 << 20;

std::filesystem::path made(std::filesystem::path folder) {
  outlive_readers();
  claim_output_folder(folder);
  io::finish_commit(folder);
  return folder;
}

std::string dumped(const Report& summary) {
  return summary.dump(1) + "\n";
}

}  // namespace

inference::Options engine_options(const CommonOptions& common, const SamplingOptions& options) {
  inference::Options engine;
  engine.seed = common.seed.value_or(1);
  engine.chains = options.chains;
  engine.threads = common.threads;
  engine.warmup = options.warmup;
  engine.draws = options.draws;
  engine.prior_only = options.prior_only;
  engine.searches = options.searches;
  engine.quick = options.quick;
  return engine;
}

Report options_report(const SamplingOptions& options) {
  return {{"chains", options.chains},
          {"warmup", options.warmup},
          {"draws", options.draws},
          {"search", options.searches},
          {"prior_only", options.prior_only},
          {"evidence", options.evidence},
          {"quick", options.quick}};
}

RunFiles::RunFiles(std::filesystem::path folder)
    : folder_(made(std::move(folder))),
      earlier_(std::filesystem::exists(folder_ / "summary.json")),
      posterior_(folder_ / "posterior.nc"),
      summary_(folder_ / "summary.json", kRoom),
      text_(folder_ / "summary.txt"),
      report_(folder_ / "report.html") {}

std::optional<FileError> RunFiles::keep(Report summary, const std::string& text,
                                        const std::string& run, const WriteDraws& draws) {
  summary["wheeltap"]["run"] = run;
  summary["files"] = {{"posterior.nc", nullptr},
                      // No checksum: the wall times in the text differ between equal runs.
                      {"summary.txt", {{"lines", std::ranges::count(text, '\n')}}}};
  std::filesystem::path where = folder_ / "posterior.nc";
  try {
    draws(*posterior_);
    posterior_->flush();
    summary["files"]["posterior.nc"] = seal_of_file(posterior_->temporary());
    where = folder_;
    summary_.write(dumped(summary));
    text_.write(text);
    std::string page;
    posterior_->lend([&](const std::filesystem::path& file) {
      const auto stored = read_posterior(file, folder_ / "posterior.nc");
      page = report_page(folder_, summary, stored.get());
    });
    report_.write(page);
    AtomicFile* const files[] = {&*posterior_, &text_, &report_, &summary_};
    io::commit_together(files);
    return {};
  } catch (const FileError& error) {
    if (error.path().is_absolute() || error.path().has_parent_path()) where = error.path();
    const std::string kept = keep_without_draws(summary, text, error.reason());
    return FileError(FileError::Kind::unwritable, where, error.reason() + "; " + kept);
  }
}

// Writes all files except posterior.nc; returns a description of the written files.
std::string RunFiles::keep_without_draws(Report& summary, const std::string& text,
                                         const std::string& reason) {
  if (std::filesystem::exists(folder_ / io::kCommitNote)) {
    return "all files of this run are written, but do not have their final names yet: run wheeltap "
           "report " +
           folder_.string();
  }
  posterior_.reset();  // frees disk space
  summary["files"]["posterior.nc"] = nullptr;
  if (Report& warnings = summary["diagnostics"]["warnings"]; warnings.is_array()) {
    warnings.insert(warnings.begin(), "The draws could not be written (posterior.nc: " + reason +
                                          "): the numbers use all draws, but the figures of draws "
                                          "are missing.");
  }
  try {
    if (earlier_) {
      const auto path = folder_ / "summary.unkept.json";
      AtomicFile unkept(path);
      unkept.write(dumped(summary));
      unkept.commit();
      return "the earlier run in " + folder_.string() +
             " is unchanged, the numbers of this run are in " + path.string();
    }
    summary_.write(dumped(summary));
    summary_.commit();
  } catch (const FileError&) {
    return "no file of this run could be written";
  }
  std::string kept = "summary.json";
  const auto also = [&](AtomicFile& file, const std::function<std::string()>& bytes) {
    try {
      file.write(bytes());
      file.commit();
      kept += ", " + file.path().filename().string();
    } catch (const FileError&) {
    }
  };
  also(text_, [&] { return text; });
  also(report_, [&] { return report_page(folder_, summary, nullptr); });
  return "the draws are lost, the other results are in " + kept;
}

void print_finished(const std::filesystem::path& folder, const std::string& text,
                    spdlog::logger& log) {
  CheckpointFile::discard(folder);
  log.info("{} holds a finished run of this case; nothing is run again.",
           io::printable(folder.string()));
  std::cout << text;
  print_results(folder, true);  // the text already has the convergence
}

void print_results(const std::filesystem::path& folder, bool converged) {
  const auto shown = [&](const char* name) { return io::printable((folder / name).string()); };
  std::cout << "Results: " << shown("summary.json") << " (numbers), " << shown("posterior.nc")
            << " (every draw), " << shown("report.html") << " (figures)\n";
  if (!converged) std::cout << "NOT CONVERGED: do not trust these numbers yet.\n";
}

}  // namespace wheeltap::apps
