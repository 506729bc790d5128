// A file's bytes.
#pragma once

#include <filesystem>
#include <string>

namespace wheeltap::io {

/// All of them. Throws FileError (missing) where the file is not there, is a folder or cannot be
/// read; errno then holds the reason.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path);

/// At most so many from its beginning. Throws as `read_bytes` does.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t most);

}  // namespace wheeltap::io
