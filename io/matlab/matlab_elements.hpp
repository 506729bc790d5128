// What a MATLAB file of version 5 is made of, read without libmatio.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::io {

/// An object of a class, which libmatio cannot read: "T" of the class "table".
struct MatlabObject {
  std::string name, class_name;
};

struct MatlabElements {
  std::size_t count = 0;  ///< variables, objects among them
  std::vector<MatlabObject> objects = {};
};

/// The variables that the file holds, each of which is whole: after a header of 128 bytes follow
/// elements of a type and a number of bytes, 4 bytes each, and that many bytes (MathWorks, MAT-File
/// Format, chapter 1), of a compressed one a zlib stream with its checksum (RFC 1950). None of
/// another version. libmatio ends at the first variable that it cannot read, as at the end of the
/// file, and asks for no checksum. Throws FileError (corrupt) where an element is cut off, or its
/// checksum is wrong.
[[nodiscard]] MatlabElements whole_matlab_elements(const std::filesystem::path& path);

}  // namespace wheeltap::io
