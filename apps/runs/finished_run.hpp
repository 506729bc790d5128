// A run of whichever command that is finished, and not written anywhere yet.
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

/// Refers to nothing that it does not keep alive.
struct FinishedRun {
  Report summary;   ///< but for what RunFiles::keep adds
  std::string run;  ///< run_id
  std::shared_ptr<const inference::Posterior> posterior;
  std::function<void(std::ostream&, bool colour)> print;  ///< what it says at a terminal
  io::FillNetcdf draws;                                   ///< posterior.nc
  std::function<std::vector<DrawColumn>()> columns;       ///< its group `posterior`

  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool converged() const;
  /// What its draws take, about.
  [[nodiscard]] std::size_t bytes_of_draws() const;
};

/// Keeps it in its folder, prints it, says where it is, and removes the checkpoint of a run that
/// was not stopped. Throws io::FileError.
void deliver(const FinishedRun& run, RunFiles& files, const std::filesystem::path& folder,
             CheckpointFile& checkpoint);

}  // namespace wheeltap::apps
