// Any bytes are a drawing of an outline, DXF or a table of corners, or a FileError.
#include "fuzz.hpp"
#include "io/drawings/dxf.hpp"
#include "io/drawings/outline_file.hpp"
#include "io/file_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const std::string bytes = fuzz::text_of(data, size);
  try {
    (void)io::parse_dxf(bytes, "fuzzed.dxf");
  } catch (const io::FileError&) {
  }
  try {
    (void)io::parse_outline_table(bytes, "fuzzed.csv");
  } catch (const io::FileError&) {
  }
  return 0;
}
