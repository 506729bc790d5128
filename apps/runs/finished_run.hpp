// A finished run of any command, before its files are written.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "apps/draw_columns.hpp"
#include "apps/results/summary.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/run_files.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "io/netcdf/write_netcdf.hpp"

namespace wheeltap::apps {

/// Results of a run. The object owns all data to which it refers.
struct FinishedRun {
  Report summary;   ///< summary.json without the entries that RunFiles::keep adds
  std::string run;  ///< identifier of the run (run_id)
  std::shared_ptr<const inference::Posterior> posterior;
  std::function<void(std::ostream&, bool colour)> print;  ///< prints the terminal text
  io::FillNetcdf draws;                                   ///< function that writes posterior.nc
  /// Columns of the group `posterior` of posterior.nc
  std::function<std::vector<DrawColumn>()> columns;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool converged() const;
  /// Approximate memory of the draws [bytes].
  [[nodiscard]] std::size_t bytes_of_draws() const;
};

/// Writes the files of a run, prints its text and the paths of its files, and removes the
/// checkpoint of a complete run. Throws io::FileError.
void deliver(const FinishedRun& run, RunFiles& files, const std::filesystem::path& folder,
             CheckpointFile& checkpoint);

}  // namespace wheeltap::apps
