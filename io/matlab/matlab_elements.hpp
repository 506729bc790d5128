// The elements of a MATLAB file of version 5, read without libmatio.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// A variable that is an object of a MATLAB class, for example "T" of the class "table". libmatio
/// cannot read objects.
struct MatlabObject {
  std::string name, class_name;
};

struct MatlabElements {
  std::size_t count = 0;  ///< number of variables, objects included
  std::vector<MatlabObject> objects = {};
};

/// Lists the variables of the file and checks that each variable is complete. A header of 128 bytes
/// precedes the elements. Each element consists of a type (4 bytes), the number of data bytes (4
/// bytes) and the data bytes (MathWorks, MAT-File Format, chapter 1). The data of a compressed
/// element are a zlib stream with a checksum (RFC 1950). For a file of another version than 5, the
/// result is empty. The check of each variable is necessary because libmatio ignores checksums and
/// silently stops at the first variable that it cannot read. Throws FileError (corrupt) if an
/// element is truncated or its checksum is wrong.
[[nodiscard]] MatlabElements whole_matlab_elements(const std::filesystem::path& path);

}  // namespace wheeltap::io
