// Any bytes are a NetCDF or HDF5 record, or a FileError.
#include "io/netcdf/array_file.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const fuzz::InFile file(fuzz::text_of(data, size), ".nc");
  try {
    (void)io::read_array_file(file.path(), {});
  } catch (const io::FileError&) {
  }
  return 0;
}
