// Any bytes are a matrix of the Matrix Market, or a FileError.
#include "fuzz.hpp"
#include "io/matlab/sparse_matrix.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  try {
    (void)io::parse_matrix_market(fuzz::text_of(data, size), "fuzzed.mtx");
  } catch (const io::FileError&) {
  }
  return 0;
}
