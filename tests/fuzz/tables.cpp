// Any bytes are an emulator's table, runs of another program, or frequencies, or a FileError.
#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/failure.hpp"
#include "emulator/runs_csv.hpp"
#include "emulator/table_file.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const std::string bytes = fuzz::text_of(data, size);
  try {
    (void)emulator::parse_table_file(bytes, "fuzzed.wtt");
  } catch (const io::FileError&) {
  }
  try {
    (void)emulator::parse_runs_csv(
        bytes, "fuzzed.csv", {{.name = "x", .unit = "", .levels = {0.0, 1.0}}}, {.name = "f"});
  } catch (const io::FileError&) {
  }
  try {
    (void)apps::parse_frequency_csv(bytes, "fuzzed.csv", {.columns = {}, .row = 1});
  } catch (const apps::Failure&) {
  } catch (const io::FileError&) {
  }
  return 0;
}
