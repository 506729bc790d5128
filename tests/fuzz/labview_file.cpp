// Any bytes are a measurement file of LabVIEW, or a FileError.
#include "io/formats/labview_file.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  try {
    (void)io::parse_labview(fuzz::text_of(data, size), "fuzzed.lvm", {});
  } catch (const io::FileError&) {
  }
  return 0;
}
