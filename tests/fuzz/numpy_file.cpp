// Any bytes are a NumPy array, an archive of them, or a FileError.
#include "io/formats/numpy_file.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  for (const auto parse : {io::parse_npy, io::parse_npz}) try {
      (void)parse(fuzz::text_of(data, size), "fuzzed.npy", {}, {});
    } catch (const io::FileError&) {
    }
  return 0;
}
