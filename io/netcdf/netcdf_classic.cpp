#include "io/netcdf/netcdf_classic.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace wheeltap::io {
namespace {

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > kMost / b ? kMost : a * b;
}
std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  return a > kMost - b ? kMost : a + b;
}

struct Variable {
  bool of_records = false;
  std::uint64_t bytes = 0;  ///< size of all values, or of one record
  std::uint64_t begin = 0;
};

/// Reads a header, number by number; good() is false after the end of the file or an invalid value.
class Header {
 public:
  explicit Header(std::istream& file) : file_(file) {
    char magic[4] = {};
    file_.read(magic, 4);
    good_ = file_.good() && magic[0] == 'C' && magic[1] == 'D' && magic[2] == 'F' &&
            (magic[3] == 1 || magic[3] == 2 || magic[3] == 5);
    version_ = magic[3];
  }
  [[nodiscard]] bool good() const { return good_; }

  /// A number of type NON_NEG of the format: 4 bytes, or 8 bytes in CDF-5.
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }
  std::uint64_t offset() { return number(version_ == 1 ? 4 : 8); }
  [[nodiscard]] std::uint64_t streaming() const {
    return version_ == 5 ? kMost : std::uint64_t{0xffffffff};
  }

  std::vector<std::uint64_t> dimensions() {
    std::vector<std::uint64_t> out;
    for (std::uint64_t n = list(10); good_ && n > 0; --n) {
      name();
      out.push_back(count());
    }
    return out;
  }
  void attributes() {
    for (std::uint64_t n = list(12); good_ && n > 0; --n) {
      name();
      const std::uint64_t size = size_of(number(4));
      skip(product(size, count()));
    }
  }
  std::vector<Variable> variables(const std::vector<std::uint64_t>& dimensions) {
    std::vector<Variable> out;
    for (std::uint64_t n = list(11); good_ && n > 0; --n) {
      name();
      Variable v{.bytes = 1};
      const std::uint64_t rank = count();
      for (std::uint64_t d = 0; good_ && d < rank; ++d) {
        const std::uint64_t dimension = count();
        if (dimension >= dimensions.size()) good_ = false;
        if (!good_) break;
        const std::uint64_t length = dimensions[dimension];
        if (d == 0 && length == 0)
          v.of_records = true;
        else
          v.bytes = product(v.bytes, length);
      }
      attributes();
      v.bytes = product(v.bytes, size_of(number(4)));
      (void)count();  // skip vsize, which overflows for large variables
      v.begin = offset();
      out.push_back(v);
    }
    return out;
  }

 private:
  std::uint64_t number(int bytes) {
    std::uint64_t n = 0;
    for (int i = 0; i < bytes; ++i) n = n << 8U | static_cast<unsigned char>(file_.get());
    good_ = good_ && file_.good();
    return n;
  }
  /// The number of entries in a list that begins with `tag`; 0 if the list is absent.
  std::uint64_t list(std::uint64_t tag) {
    const std::uint64_t found = number(4), n = count();
    if (found != tag && (found != 0 || n != 0)) good_ = false;
    return good_ ? n : 0;
  }
  void name() { skip(count()); }
  /// Skips bytes, padded to a multiple of four.
  void skip(std::uint64_t bytes) {
    constexpr std::uint64_t kMostSkipped = 1U << 31U;
    if (bytes > kMostSkipped) good_ = false;
    if (good_) file_.ignore(static_cast<std::streamsize>((bytes + 3) / 4 * 4));
    good_ = good_ && file_.good();
  }
  std::uint64_t size_of(std::uint64_t type) {
    constexpr std::uint64_t kSizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    if (type == 0 || type >= std::size(kSizes)) good_ = false;
    return good_ ? kSizes[type] : 0;
  }

  std::istream& file_;
  bool good_ = false;
  int version_ = 0;
};

}  // namespace

std::optional<std::uintmax_t> netcdf_classic_size(std::istream& file) {
  Header header(file);
  if (!header.good()) return 0;  // a file of another format
  const std::uint64_t records = header.count();
  const std::vector<std::uint64_t> dimensions = header.dimensions();
  header.attributes();
  const std::vector<Variable> variables = header.variables(dimensions);
  if (!header.good() || records == header.streaming()) return std::nullopt;
  const auto of_records =
      std::ranges::count_if(variables, [](const Variable& v) { return v.of_records; });
  std::uint64_t record = 0;  // bytes per record; a single record variable is not padded
  for (const Variable& v : variables)
    if (v.of_records)
      record = sum(record, of_records == 1 ? v.bytes : product(sum(v.bytes, 3) / 4, 4));
  std::uint64_t size = 0;
  for (const Variable& v : variables) {
    if (v.bytes == 0) continue;
    if (!v.of_records)
      size = std::max(size, sum(v.begin, v.bytes));
    else if (records > 0)
      size = std::max(size, sum(sum(v.begin, product(records - 1, record)), v.bytes));
  }
  return size;
}

}  // namespace wheeltap::io
