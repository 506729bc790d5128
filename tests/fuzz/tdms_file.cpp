// Any bytes are a TDMS file, or a FileError.
#include "io/formats/tdms_file.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  try {
    (void)io::parse_tdms(fuzz::text_of(data, size), "fuzzed.tdms", {});
  } catch (const io::FileError&) {
  }
  return 0;
}
