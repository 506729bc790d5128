#include "io/formats/numpy_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/formats/zip_archive.hpp"
#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

constexpr std::string_view kNumpyMagic("\x93NUMPY", 6);
constexpr std::size_t kMostDimensions = 4;

/// The element type of an array: letter of NumPy, size and byte order.
struct Element {
  char kind =
      'f';  ///< b boolean, i and u integer, f real, c complex, m and M time differences and times
  std::size_t size = 8;
  bool swapped = false;
  double scale = 1.0;  ///< seconds per unit, for types m and M
};

struct NpyArray {
  ArrayShape shape;
  Element element = {};
  std::size_t begin = 0;  ///< position of the array's data
  std::string bytes = {};
  bool imaginary = false;  ///< true for the imaginary part of a complex array
};

/// Exception within this file: the reason why an array has no readable numbers.
struct NoNumbers {
  std::string why;
};

class NumpyHeader {
 public:
  NumpyHeader(std::string_view text, const std::filesystem::path& file, std::string shown)
      : text_(text), file_(file), shown_(std::move(shown)) {}

  [[noreturn]] void corrupt(const std::string& why) const {
    throw FileError(FileError::Kind::corrupt, file_, shown_ + why);
  }

  /// The text after a key of the header, which is a Python dictionary.
  [[nodiscard]] std::string_view value(std::string_view key) const {
    const std::size_t at = text_.find("'" + std::string(key) + "'");
    const std::size_t colon = at == std::string_view::npos ? at : text_.find(':', at);
    const std::size_t from =
        colon == std::string_view::npos ? colon : text_.find_first_not_of(" ", colon + 1);
    if (from == std::string_view::npos)
      corrupt("is corrupt: its header lacks '" + std::string(key) + "'");
    return text_.substr(from);
  }

  [[nodiscard]] std::vector<std::size_t> shape() const {
    std::string_view text = value("shape");
    const std::size_t end = text.find(')');
    if (!text.starts_with('(') || end == std::string_view::npos)
      corrupt("is corrupt: its array shape is not a list");
    text = text.substr(1, end - 1);
    std::vector<std::size_t> out;
    while (true) {
      const std::size_t from = text.find_first_of("0123456789");
      if (from == std::string_view::npos) break;
      std::size_t length = 0;
      const auto [rest, error] =
          std::from_chars(text.data() + from, text.data() + text.size(), length);
      if (error != std::errc()) corrupt("is corrupt: its array shape is out of range");
      out.push_back(length);
      text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
      if (out.size() > kMostDimensions)
        throw NoNumbers{"more than " + std::to_string(kMostDimensions) +
                        " dimensions: save its slices as separate arrays"};
    }
    return out;
  }

  [[nodiscard]] Element element() const {
    const std::string_view text = value("descr");
    if (text.starts_with('['))
      throw NoNumbers{
          "a structured type: save each field as a separate array, "
          "numpy.savez(\"FILE.npz\", **{name: a[name] for name in a.dtype.names})"};
    const std::size_t end = text.find('\'', 1);
    if (!text.starts_with('\'') || end == std::string_view::npos || end < 3)
      corrupt("is corrupt: its 'descr' names no type");
    std::string_view type = text.substr(1, end - 1);
    Element out;
    const char order = type[0];
    constexpr bool kBig = std::endian::native == std::endian::big;
    if (std::string_view("<>=|").find(order) != std::string_view::npos) {
      out.swapped = (order == '>' && !kBig) || (order == '<' && kBig);
      type.remove_prefix(1);
    }
    out.kind = type.empty() ? '?' : type[0];
    if (out.kind == 'O')
      throw NoNumbers{"Python objects: save numbers, numpy.save(\"FILE.npy\", a.astype(float))"};
    if (out.kind == 'U' || out.kind == 'S') throw NoNumbers{"text"};
    const auto [rest, error] =
        std::from_chars(type.data() + 1, type.data() + type.size(), out.size);
    const std::string_view unit(rest, type.data() + type.size());
    const auto is_one_of = [&](std::initializer_list<std::size_t> sizes) {
      return std::ranges::count(sizes, out.size) > 0;
    };
    const bool known =
        error == std::errc() &&
        ((out.kind == 'b' && out.size == 1) || (out.kind == 'f' && is_one_of({2, 4, 8})) ||
         (out.kind == 'c' && is_one_of({8, 16})) ||
         ((out.kind == 'i' || out.kind == 'u') && is_one_of({1, 2, 4, 8})) ||
         ((out.kind == 'm' || out.kind == 'M') && out.size == 8 && set_scale(unit, out)));
    if (!known)
      throw NoNumbers{"of the type '" + printable(in_utf8(text.substr(1, end - 1))) +
                      "': save it as real numbers, a.astype(float)"};
    return out;
  }

 private:
  static bool set_scale(std::string_view unit, Element& out) {
    static constexpr std::pair<std::string_view, double> kUnits[] = {
        {"[ns]", 1e-9}, {"[us]", 1e-6},  {"[ms]", 1e-3},   {"[s]", 1.0},
        {"[m]", 60.0},  {"[h]", 3600.0}, {"[D]", 86400.0},
    };
    const auto* found =
        std::ranges::find(kUnits, unit, &std::pair<std::string_view, double>::first);
    if (found == std::end(kUnits)) return false;
    out.scale = found->second;
    return true;
  }

  std::string_view text_;
  const std::filesystem::path& file_;
  std::string shown_;
};

/// Converts a half-precision number (IEEE 754 binary16).
double half(std::uint16_t bits) {
  const int exponent = (bits >> 10U) & 0x1F;
  const int fraction = bits & 0x3FF;
  const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
  if (exponent == 0x1F)
    return fraction == 0 ? sign * std::numeric_limits<double>::infinity()
                         : std::numeric_limits<double>::quiet_NaN();
  return sign *
         (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

template <class T>
T loaded(const char* from, bool swapped) {
  char raw[sizeof(T)];
  std::memcpy(raw, from, sizeof(T));
  if (swapped) std::reverse(raw, raw + sizeof(T));
  T value{};
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

double integer(const char* from, std::size_t size, bool is_signed, bool swapped) {
  switch (size) {
    case 1:
      return is_signed ? loaded<std::int8_t>(from, false) : loaded<std::uint8_t>(from, false);
    case 2:
      return is_signed ? loaded<std::int16_t>(from, swapped) : loaded<std::uint16_t>(from, swapped);
    case 4:
      return is_signed ? loaded<std::int32_t>(from, swapped) : loaded<std::uint32_t>(from, swapped);
    default:
      return is_signed ? static_cast<double>(loaded<std::int64_t>(from, swapped))
                       : static_cast<double>(loaded<std::uint64_t>(from, swapped));
  }
}

/// a - b, exact unless it overflows: a number of nanoseconds since 1970 exceeds 2⁵³.
double difference(std::int64_t a, std::int64_t b) {
  using Limits = std::numeric_limits<std::int64_t>;
  const bool overflows = b < 0 ? a > Limits::max() + b : a < Limits::min() + b;
  return overflows ? static_cast<double>(a) - static_cast<double>(b) : static_cast<double>(a - b);
}

double real(const char* from, std::size_t size, bool swapped) {
  if (size == 2) return half(loaded<std::uint16_t>(from, swapped));
  if (size == 4) return static_cast<double>(loaded<float>(from, swapped));
  return loaded<double>(from, swapped);
}

std::vector<double> values_of(const NpyArray& array) {
  const Element& e = array.element;
  const std::size_t count = array.shape.size();
  std::vector<double> out;
  out.reserve(count);
  constexpr auto kNotATime = std::numeric_limits<std::int64_t>::min();
  std::optional<std::int64_t> first;
  for (std::size_t i = 0; i < count; ++i) {
    const char* from = array.bytes.data() + array.begin + i * e.size;
    if (e.kind == 'f') {
      out.push_back(real(from, e.size, e.swapped));
    } else if (e.kind == 'c') {
      out.push_back(real(from + (array.imaginary ? e.size / 2 : 0), e.size / 2, e.swapped));
    } else if (e.kind == 'm' || e.kind == 'M') {
      const auto ticks = loaded<std::int64_t>(from, e.swapped);
      if (!first && ticks != kNotATime) first = e.kind == 'M' ? ticks : 0;
      out.push_back(ticks == kNotATime ? std::numeric_limits<double>::quiet_NaN()
                                       : e.scale * difference(ticks, *first));
    } else {
      out.push_back(integer(from, e.size, e.kind == 'i', e.swapped));
    }
  }
  return out;
}

/// Throws FileError, and NoNumbers if the array holds no numbers.
NpyArray array_of(std::string bytes, const std::filesystem::path& file, const std::string& name,
                  const std::string& shown) {
  const auto corrupt = [&](const std::string& why) {
    throw FileError(FileError::Kind::corrupt, file, shown + why);
  };
  if (!std::string_view(bytes).starts_with(kNumpyMagic))
    throw FileError(FileError::Kind::foreign, file, shown + "is not a NumPy array (.npy)");
  if (bytes.size() < 12) corrupt("is truncated within its header");
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3)
    corrupt("is of version " + std::to_string(version) + " of the format: 1 to 3 are read");
  std::size_t length = 0;
  for (std::size_t k = version == 1 ? 2 : 4; k-- > 0;)
    length = 256 * length + static_cast<unsigned char>(bytes[8 + k]);
  const std::size_t from = version == 1 ? 10 : 12;
  if (bytes.size() - from < length) corrupt("is truncated within its header");
  const std::string text = bytes.substr(from, length);
  const NumpyHeader header(text, file, shown);
  NpyArray out{.shape = {.name = name}, .begin = from + length};
  out.element = header.element();
  out.shape.shape = header.shape();
  out.shape.row_major = !header.value("fortran_order").starts_with("True");
  const std::size_t held = (bytes.size() - out.begin) / out.element.size;
  if (out.shape.size() > held)
    corrupt("is truncated: " + out.shape.shape_in_words() + " numbers are declared, " +
            std::to_string(held) + " are there");
  if (out.element.kind == 'm' || out.element.kind == 'M') out.shape.unit = "s";
  out.bytes = std::move(bytes);
  return out;
}

Columns table_of(std::vector<NpyArray> arrays, std::vector<std::string> others,
                 const std::filesystem::path& name, const Wanted& wanted,
                 const ArrayLayout& stated) {
  Columns table{.file = name.string(), .others = std::move(others)};
  std::vector<ArrayShape> shapes;
  std::vector<std::pair<std::size_t, bool>> from;  // index of the array; true: imaginary part
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    const bool complex = arrays[i].element.kind == 'c';
    for (int part = 0; part < (complex ? 2 : 1); ++part) {
      shapes.push_back(arrays[i].shape);
      if (complex) shapes.back().name += part == 0 ? ", real" : ", imaginary";
      from.emplace_back(i, part == 1);
    }
  }
  const auto values = [&](std::size_t i) {
    NpyArray& array = arrays[from[i].first];
    array.imaginary = from[i].second;
    return values_of(array);
  };
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].size() == 1) table.scalars[shapes[i].name] = values(i)[0];
  const ChosenColumns chosen = choose_columns(shapes, stated, wanted, table);
  if (table.columns.empty()) {
    std::string there;
    for (const std::string& other : table.others) there += (there.empty() ? ": " : "; ") + other;
    throw FileError(FileError::Kind::corrupt, name,
                    "holds no array with at least two numbers" + there);
  }
  fill_columns(chosen, wanted, values, table);
  return table;
}

}  // namespace

Columns parse_npy(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                  const ArrayLayout& stated) {
  try {
    std::vector<NpyArray> arrays;
    arrays.push_back(array_of(std::move(bytes), name, in_utf8(name.stem().string()), ""));
    return table_of(std::move(arrays), {}, name, wanted, stated);
  } catch (const NoNumbers& fault) {
    throw FileError(FileError::Kind::corrupt, name, "holds no numbers: it is " + fault.why);
  }
}

Columns parse_npz(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                  const ArrayLayout& stated) {
  const ZipArchive archive(bytes, name);
  std::vector<NpyArray> arrays;
  std::vector<std::string> others;
  std::uint64_t left = kLargestFile;  // total for all arrays
  for (const ZipMember& member : archive.members()) {
    constexpr std::string_view kEnding = ".npy";
    if (!member.name.ends_with(kEnding)) continue;
    const std::string array = in_utf8(member.name.substr(0, member.name.size() - kEnding.size()));
    try {
      std::string unpacked = archive.read(member, left);
      left -= unpacked.size();
      arrays.push_back(array_of(std::move(unpacked), name, array, "\"" + printable(array) + "\" "));
    } catch (const NoNumbers& fault) {
      others.push_back(array + " (" + fault.why + ")");
    }
  }
  if (arrays.empty() && others.empty())
    throw FileError(FileError::Kind::foreign, name, "is a ZIP archive without NumPy arrays (.npy)");
  return table_of(std::move(arrays), std::move(others), name, wanted, stated);
}

}  // namespace wheeltap::io
