// Any bytes are a table of delimited text, or a FileError.
#include "io/tables/delimited_text.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  try {
    (void)io::parse_delimited_text(fuzz::text_of(data, size), "fuzzed.csv", {});
  } catch (const io::FileError&) {
  }
  return 0;
}
