// Any bytes are modes, a summary, a sweep's journal or a checkpoint, or give the documented error.
#include "apps/cases/records/modes_file.hpp"
#include "apps/failure.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/sid/sweep_journal.hpp"
#include "fuzz.hpp"
#include "io/file_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const std::string bytes = fuzz::text_of(data, size);
  const std::filesystem::path folder = fuzz::InFile::folder();
  const auto put = [&](const char* name) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  };
  try {
    (void)apps::read_modes_file(put("modes.json"));
  } catch (const apps::Failure&) {
  }
  put("summary.json");
  put("posterior.nc");
  if (const auto summary = apps::stored_summary(folder)) {
    try {
      (void)apps::sealed_file(folder, "posterior.nc", *summary);
    } catch (const io::FileError&) {
    }
  }
  try {
    apps::SweepJournal journal(put("sweep.journal"), "a sweep", true);
    (void)journal.find(1.0);
  } catch (const io::FileError&) {
  }
  put(apps::CheckpointFile::kName);
  apps::CommonOptions common;
  common.resume = true;
  try {
    const apps::CheckpointFile checkpoint(
        folder, {.command = "damage", .options = {}, .case_json = {}, .inputs = {}}, common);
  } catch (const io::FileError&) {
  }
  return 0;
}
