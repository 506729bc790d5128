// A finished run, owned by a Python object.
#pragma once

#include <string>
#include <vector>

#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_watch.hpp"
#include "python/job.hpp"

namespace wheeltap::python {

struct Run {
  apps::FinishedRun finished;
  std::vector<std::string> lines = {};  ///< notes and warnings issued during the run
};

/// Passes the progress of a run to a job, and stops the run when the job is stopped.
class JobWatch : public apps::RunWatch {
 public:
  explicit JobWatch(Job& job) : job_(job) {}

  inference::Posterior sample(const inference::Problem& problem,
                              inference::Options options) override;
  void show(const char* stage, double fraction, const std::string& detail) override;
  void note(const std::string& line) override { lines_.push_back(line); }
  void warn(const std::string& line) override { lines_.push_back(line); }
  [[nodiscard]] bool stopped() const override { return job_.stopped(); }

  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  Job& job_;
  std::vector<std::string> lines_;
};

}  // namespace wheeltap::python
