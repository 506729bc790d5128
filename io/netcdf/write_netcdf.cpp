#include "io/netcdf/write_netcdf.hpp"

#include <string>

#include "io/netcdf/netcdf_writer.hpp"
#include "io/read_apart.hpp"

namespace wheeltap::io {

namespace {

/// HDF5 does not report why it cannot write; writing the next part of the file gives the reason.
void throw_write_error(AtomicFile& to) {
  constexpr std::size_t kPiece = 1 << 16;
  to.append(std::string(kPiece, '\0'));
}

/// Returns false if no child can be started.
bool write_on_disk(AtomicFile& to, const FillNetcdf& fill) {
  bool written = false;
  to.lend([&](const std::filesystem::path& file) {
    written = write_apart(to.path(), [&] {
      NetcdfWriter writer(to.path(), file);
      fill(writer);
      writer.finish();
    });
  });
  return written;
}

}  // namespace

void write_netcdf(AtomicFile& to, std::size_t bytes, const FillNetcdf& fill) {
  try {
    if (bytes > kNetcdfInMemory && write_on_disk(to, fill)) return;
  } catch (const FileError&) {
    throw_write_error(to);
    throw;
  }
  NetcdfWriter writer(to.path());
  fill(writer);
  to.write(writer.close());
}

}  // namespace wheeltap::io
