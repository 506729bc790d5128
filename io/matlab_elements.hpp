// What a MATLAB file of version 5 is made of, read without libmatio.
#pragma once

#include <cstddef>
#include <filesystem>

namespace wheeltap::io {

/// How many variables the file holds, each of which is whole: after a header of 128 bytes follow
/// elements of a type and a number of bytes, 4 bytes each, and that many bytes (MathWorks, MAT-File
/// Format, chapter 1), of a compressed one a zlib stream with its checksum (RFC 1950). 0 of another
/// version. libmatio ends at the first variable that it cannot read, as at the end of the file, and
/// asks for no checksum. Throws FileError (corrupt) where an element is cut off, or its checksum is
/// wrong.
[[nodiscard]] std::size_t whole_matlab_elements(const std::filesystem::path& path);

}  // namespace wheeltap::io
