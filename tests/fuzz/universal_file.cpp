// Any bytes are a universal file or give a FileError; writing and reading a file preserves it.
#include "io/universal/universal_file.hpp"

#include <cstdlib>

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  try {
    const io::UniversalFile file =
        io::parse_universal_file(fuzz::text_of(data, size), "fuzzed.uff");
    // Datasets of other numbers are not written.
    if (file.functions.empty() && file.nodes.empty() && file.shapes.empty()) return 0;
    const io::UniversalFile again =
        io::parse_universal_file(io::universal_text(file), "written.uff");
    if (again.functions.size() != file.functions.size() ||
        again.nodes.size() != file.nodes.size() || again.shapes.size() != file.shapes.size())
      std::abort();
    (void)io::universal_columns(file, "fuzzed.uff");
  } catch (const io::FileError& error) {
    // The content that was read can be written, and the new file can be read.
    if (error.path() == "written.uff") std::abort();
  }
  return 0;
}
