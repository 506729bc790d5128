// Any bytes are a MATLAB file, of records or matrices, or a FileError.
#include "io/matlab/matlab_file.hpp"

#include "fuzz.hpp"
#include "io/matlab/sparse_matrix.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const fuzz::InFile file(fuzz::text_of(data, size), ".mat");
  try {
    (void)io::read_matlab_file(file.path(), {});
  } catch (const io::FileError&) {
  }
  try {
    (void)io::read_sparse_matrix(file.path(), "K");
  } catch (const io::FileError&) {
  }
  return 0;
}
