// Any bytes are a strong-motion record, or a FileError.
#include "io/formats/strong_motion.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  for (const auto parse : {io::parse_peer, io::parse_csmip}) try {
      (void)parse(fuzz::text_of(data, size), "fuzzed", {});
    } catch (const io::FileError&) {
    }
  return 0;
}
