// Common parts of the fuzzing targets. A target is one function that takes bytes and must return
// for any. It catches the errors that the code under test documents; all else is a finding. The
// preset "fuzz" (scripts/fuzz) builds targets with clang's fuzzer; with other compilers they replay
// stored inputs.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace wheeltap::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// For readers that take a path: one file per process, in /dev/shm if it exists.
class InFile {
 public:
  InFile(const std::string& bytes, const std::string& ending)
      : path_(folder() / ("input" + ending)) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// A folder of this process; removed when it ends.
  static const std::filesystem::path& folder() {
    struct Folder {
      std::filesystem::path path =
          (std::filesystem::exists("/dev/shm") ? std::filesystem::path("/dev/shm")
                                               : std::filesystem::temp_directory_path()) /
          ("wheeltap-fuzz-" + std::to_string(getpid()));
      Folder() { std::filesystem::create_directories(path); }
      ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
      }
    };
    static const Folder folder;
    return folder.path;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace wheeltap::fuzz
