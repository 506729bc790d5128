#include "io/formats/formats.hpp"

#include <algorithm>

#include "io/bytes.hpp"
#include "io/formats/labview_file.hpp"
#include "io/formats/numpy_file.hpp"
#include "io/formats/strong_motion.hpp"
#include "io/formats/tdms_file.hpp"
#include "io/formats/workbook_file.hpp"
#include "io/matlab/matlab_file.hpp"
#include "io/netcdf/array_file.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/words.hpp"
#include "io/universal/universal_file.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kBeginning = 512;  // bytes; longer than any `magic`

}  // namespace

std::span<const Format> formats() {
  static const Format list[] = {
      {.name = "delimited text",
       .endings = {".csv", ".tsv", ".txt", ".dat", ".asc", ".data", ".tab", ".prn", ".log",
                   ".ascii", ".out", ""},
       .parse_text = parse_delimited_text},
      {.name = "Excel workbook",
       .endings = {".xlsx", ".xlsm", ".xls"},
       .parse_text = parse_workbook},
      {.name = "MATLAB",
       .endings = {".mat"},
       .magic = {"MATLAB 5.0 MAT-file", "MATLAB 7.3 MAT-file"},
       .read = read_matlab_file},
      {.name = "universal file",
       .endings = {".uff", ".unv", ".uf"},
       .magic = {"    -1"},
       .parse = parse_universal_columns},
      {.name = "LabVIEW",
       .endings = {".lvm"},
       .magic = {"LabVIEW Measurement"},
       .parse = parse_labview},
      {.name = "NetCDF or HDF5",
       .endings = {".nc", ".h5", ".hdf5", ".hdf", ".cdf"},
       .magic = {"\x89HDF\r\n\x1a\n", "CDF\x01", "CDF\x02", "CDF\x05"},
       .read = read_array_file},
      {.name = "NumPy array",
       .endings = {".npy"},
       .magic = {"\x93NUMPY"},
       .parse_arrays = parse_npy},
      {.name = "TDMS", .endings = {".tdms"}, .magic = {"TDSm"}, .parse = parse_tdms},
      {.name = "PEER record", .endings = {".at2", ".vt2", ".dt2"}, .parse = parse_peer},
      {.name = "CSMIP record", .endings = {".v2"}, .parse = parse_csmip},
      {.name = "NumPy archive", .endings = {".npz"}, .parse_arrays = parse_npz},
  };
  return list;
}

const Format& format_of(const std::filesystem::path& path, std::string_view beginning,
                        std::span<const Format> known) {
  for (const Format& format : known)
    for (const std::string_view magic : format.magic)
      if (beginning.starts_with(magic)) return format;
  const std::string ending = lower(path.extension().string());
  for (const Format& format : known)
    if (std::ranges::count(format.endings, ending) > 0) return format;
  std::string list;
  for (const Format& format : known) {
    list += list.empty() ? "" : "; ";
    list += std::string(format.name) + " (";
    for (std::size_t i = 0; i < format.endings.size(); ++i)
      list += (i > 0 ? ", " : "") +
              (format.endings[i].empty() ? "no ending" : std::string(format.endings[i]));
    list += ")";
  }
  throw FileError(FileError::Kind::foreign, path,
                  "unknown file extension '" + ending + "'; the known formats are " + list);
}

Columns read_columns(const std::filesystem::path& path, const Wanted& wanted,
                     std::span<const Format> known, const TextLayout& stated,
                     const ArrayLayout& arrays) {
  const Format& format = format_of(path, first_bytes(path, kBeginning), known);
  if (arrays != ArrayLayout{} && format.read == nullptr && format.parse_arrays == nullptr)
    throw FileError(FileError::Kind::mismatch, path,
                    "is of the format " + std::string(format.name) +
                        ": leave out rows_are_channels, which applies to MATLAB, NumPy, NetCDF and "
                        "HDF5 files only");
  if (!stated.sheet.empty() && format.parse_text != parse_workbook)
    throw FileError(FileError::Kind::mismatch, path,
                    "is of the format " + std::string(format.name) +
                        ": leave out sheet, which applies to Excel workbooks only");
  if (format.parse_text != nullptr)
    return format.parse_text(read_bytes(path), path, wanted, stated);
  if (stated != TextLayout{})
    throw FileError(FileError::Kind::mismatch, path,
                    "is of the format " + std::string(format.name) +
                        ": leave out decimal, separator, skip, header, units_row and time_format, "
                        "which apply to delimited text and Excel workbooks only");
  if (format.read != nullptr) return format.read(path, wanted, arrays);
  if (format.parse_arrays != nullptr)
    return format.parse_arrays(read_bytes(path), path, wanted, arrays);
  return format.parse(read_bytes(path), path, wanted);
}

}  // namespace wheeltap::io
