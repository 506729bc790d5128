// The elements of a MATLAB file of version 5, read without libmatio.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// An object of a class, which libmatio cannot read: for example "T" of the class "table".
struct MatlabObject {
  std::string name, class_name;
};

struct MatlabElements {
  std::size_t count = 0;  ///< number of variables, objects included
  std::vector<MatlabObject> objects = {};
};

/// Lists the variables of the file and checks that each is complete. A header of 128 bytes precedes
/// the elements. Each element has a type and a number of bytes, 4 bytes each, and that many bytes
/// (MathWorks, MAT-File Format, chapter 1); a compressed one holds a zlib stream with its checksum
/// (RFC 1950). For files of other versions, the result is empty. This check is necessary because
/// libmatio ignores checksums and silently stops at the first variable that it cannot read. Throws
/// FileError (corrupt) if an element is truncated or its checksum is wrong.
[[nodiscard]] MatlabElements whole_matlab_elements(const std::filesystem::path& path);

}  // namespace wheeltap::io
