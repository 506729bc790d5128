#include "io/formats/tdms_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file_error.hpp"
#include "io/tables/array_columns.hpp"
#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kLeadIn = 28;
constexpr std::uint32_t kMetadata = 1U << 1U, kNewList = 1U << 2U, kRawData = 1U << 3U,
                        kInterleaved = 1U << 5U, kBigEndian = 1U << 6U, kDaqmx = 1U << 7U;
constexpr std::uint32_t kNoData = 0xFFFFFFFF, kAsBefore = 0, kFormatChanging = 0x1269,
                        kDigitalLine = 0x1369;
constexpr std::uint64_t kNotClosed = 0xFFFFFFFFFFFFFFFF;
constexpr std::uint32_t kString = 0x20, kBoolean = 0x21, kTimeStamp = 0x44;

/// Size of a value in the raw data; 0 for strings and unknown types.
std::size_t size_of(std::uint32_t type) {
  switch (type) {
    case 1:
    case 5:
    case kBoolean:
      return 1;
    case 2:
    case 6:
      return 2;
    case 3:
    case 7:
    case 9:
    case 0x19:
      return 4;
    case 4:
    case 8:
    case 10:
    case 0x1A:
      return 8;
    case kTimeStamp:
      return 16;
    default:
      return 0;
  }
}

struct Layout {
  std::uint32_t type = 0;
  std::uint64_t count = 0;  ///< values per chunk
  std::uint64_t bytes = 0;  ///< bytes per chunk
};

/// Position of a channel's values: `count` values in each of `chunks` chunks.
struct Piece {
  std::uint64_t first = 0, chunks = 0, chunk_step = 0, count = 0, step = 0;
  bool big_endian = false;
};

struct Channel {
  std::string path;
  std::optional<Layout> layout = {};
  std::map<std::string, double> numbers = {};  ///< its numeric properties
  std::map<std::string, std::string> texts = {};
  std::vector<Piece> pieces = {};
  std::uint64_t length = 0;

  [[nodiscard]] double number(const std::string& key, double otherwise) const {
    const auto found = numbers.find(key);
    return found == numbers.end() ? otherwise : found->second;
  }
};

/// "Group" and "Channel" of "/'Group'/'Channel'"; two quotes stand for one.
std::vector<std::string> names_of(std::string_view path) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at + 1 < path.size() && path[at] == '/' && path[at + 1] == '\'';) {
    std::string name;
    for (at += 2; at < path.size(); ++at) {
      if (path[at] != '\'') {
        name += path[at];
      } else if (at + 1 < path.size() && path[at + 1] == '\'') {
        name += path[at++];
      } else {
        break;
      }
    }
    ++at;
    out.push_back(in_utf8(name));
  }
  return out;
}

class TdmsParser {
 public:
  TdmsParser(const std::string& bytes, const std::filesystem::path& name)
      : bytes_(bytes), name_(name) {}

  void parse() {
    if (!std::string_view(bytes_).starts_with("TDSm"))
      throw FileError(FileError::Kind::foreign, name_, "does not begin like a TDMS file");
    for (at_ = 0; at_ < bytes_.size();) segment();
  }

  [[nodiscard]] std::vector<Channel>& channels() { return channels_; }
  [[nodiscard]] bool cut() const { return cut_; }

  [[noreturn]] void corrupt(const std::string& why) const {
    throw FileError(FileError::Kind::corrupt, name_, why);
  }

  template <class T>
  [[nodiscard]] T value(std::uint64_t at, bool big_endian) const {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + at, sizeof(T));
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof(T));
    T out{};
    std::memcpy(&out, raw, sizeof(T));
    return out;
  }

  /// Seconds since 1904 in two parts, so that differences keep their precision.
  [[nodiscard]] std::pair<std::int64_t, double> time(std::uint64_t at, bool big_endian) const {
    const std::uint64_t fraction = at + (big_endian ? 8 : 0), seconds = at + (big_endian ? 0 : 8);
    return {value<std::int64_t>(seconds, big_endian),
            std::ldexp(static_cast<double>(value<std::uint64_t>(fraction, big_endian)), -64)};
  }

  [[nodiscard]] double number(std::uint32_t type, std::uint64_t at, bool big) const {
    switch (type) {
      case 1:
        return value<std::int8_t>(at, big);
      case 2:
        return value<std::int16_t>(at, big);
      case 3:
        return value<std::int32_t>(at, big);
      case 4:
        return static_cast<double>(value<std::int64_t>(at, big));
      case 5:
      case kBoolean:
        return value<std::uint8_t>(at, big);
      case 6:
        return value<std::uint16_t>(at, big);
      case 7:
        return value<std::uint32_t>(at, big);
      case 8:
        return static_cast<double>(value<std::uint64_t>(at, big));
      case 9:
      case 0x19:
        return static_cast<double>(value<float>(at, big));
      default:
        return value<double>(at, big);
    }
  }

  [[nodiscard]] std::vector<double> values(const Channel& channel) const {
    std::vector<double> out;
    out.reserve(channel.length);
    std::optional<std::pair<std::int64_t, double>> first;
    const std::uint32_t type = channel.layout ? channel.layout->type : 0;
    for (const Piece& p : channel.pieces)
      for (std::uint64_t c = 0; c < p.chunks; ++c)
        for (std::uint64_t i = 0; i < p.count; ++i) {
          const std::uint64_t at = p.first + c * p.chunk_step + i * p.step;
          if (type == kTimeStamp) {
            const auto stamp = time(at, p.big_endian);
            if (!first) first = stamp;
            out.push_back(static_cast<double>(stamp.first - first->first) +
                          (stamp.second - first->second));
          } else {
            out.push_back(number(type, at, p.big_endian));
          }
        }
    scale(channel, out);
    return out;
  }

 private:
  template <class T>
  T take() {
    if (end_ - at_ < sizeof(T)) corrupt("is truncated or corrupt within the metadata of a segment");
    at_ += sizeof(T);
    return value<T>(at_ - sizeof(T), big_endian_);
  }
  std::string_view text() {
    const auto length = take<std::uint32_t>();
    if (end_ - at_ < length) corrupt("is truncated or corrupt within the metadata of a segment");
    at_ += length;
    return std::string_view(bytes_).substr(at_ - length, length);
  }

  void segment() {
    end_ = bytes_.size();
    if (end_ - at_ < kLeadIn || std::string_view(bytes_).substr(at_, 4) != "TDSm")
      corrupt("is truncated or corrupt: no segment begins at byte " + std::to_string(at_));
    const auto contents = value<std::uint32_t>(at_ + 4, false);
    big_endian_ = (contents & kBigEndian) != 0;
    auto next = value<std::uint64_t>(at_ + 12, big_endian_);
    const auto raw = value<std::uint64_t>(at_ + 20, big_endian_);
    at_ += kLeadIn;
    const std::uint64_t left = bytes_.size() - at_;
    // A program that was killed while it wrote leaves this mark, and perhaps an incomplete chunk.
    const bool closed = next != kNotClosed;
    if (!closed) next = left;
    if (next > left)
      corrupt("is truncated: a segment has " + std::to_string(next) + " bytes, " +
              std::to_string(left) + " are there");
    if (raw > next) corrupt("is corrupt: raw data begin beyond their segment");
    const std::uint64_t after = at_ + next, data = at_ + raw;
    end_ = data;
    if ((contents & kMetadata) != 0) metadata((contents & kNewList) != 0);
    if ((contents & kDaqmx) != 0) refuse_daqmx();
    if ((contents & kRawData) != 0) raw_data(data, after, (contents & kInterleaved) != 0, closed);
    at_ = after;
  }

  [[noreturn]] void refuse_daqmx() const {
    corrupt(
        "holds raw data of DAQmx, whose scales Wheeltap does not read: write the data to a TDMS "
        "file without DAQmx logging, or export the data as text (.csv or .lvm)");
  }

  void metadata(bool new_list) {
    if (new_list) active_.clear();
    for (auto objects = take<std::uint32_t>(); objects > 0; --objects) {
      const std::string path(text());
      const auto [known, is_new] = index_.try_emplace(path, channels_.size());
      if (is_new) channels_.push_back({.path = path});
      const std::size_t index = known->second;
      layout_of(channels_[index], index);
      for (auto properties = take<std::uint32_t>(); properties > 0; --properties)
        property(channels_[index]);
    }
  }

  void layout_of(Channel& channel, std::size_t index) {
    const auto kind = take<std::uint32_t>();
    std::erase_if(active_, [&](std::size_t i) { return i == index && kind == kNoData; });
    if (kind == kNoData) return;
    if (kind == kFormatChanging || kind == kDigitalLine) refuse_daqmx();
    if (kind == kAsBefore) {
      if (!channel.layout)
        corrupt("is corrupt: a channel refers to a previous layout that does not exist");
    } else {
      Layout layout{.type = take<std::uint32_t>()};
      if (take<std::uint32_t>() != 1) corrupt("is corrupt: raw data have more than one dimension");
      layout.count = take<std::uint64_t>();
      const std::size_t size = size_of(layout.type);
      if (layout.type != kString && size == 0)
        corrupt("channel " + channel.path + " holds values of the type " +
                std::to_string(layout.type) +
                ", which Wheeltap does not read: write the values as doubles");
      if (layout.type == kString)
        layout.bytes = take<std::uint64_t>();
      else if (layout.count > bytes_.size() / size)
        corrupt("is corrupt: " + channel.path + " declares more values than the file can hold");
      else
        layout.bytes = layout.count * size;
      if (channel.layout && channel.layout->type != layout.type && channel.length > 0)
        corrupt("channel " + channel.path + " changes its type: write all values with one type");
      channel.layout = layout;
    }
    if (std::ranges::find(active_, index) == active_.end() && channel.layout->bytes > 0)
      active_.push_back(index);
  }

  void property(Channel& channel) {
    const std::string name(text());
    const auto type = take<std::uint32_t>();
    if (type == kString) {
      channel.texts[name] = in_utf8(text());
      return;
    }
    const std::size_t size = size_of(type);
    if (size == 0 || end_ - at_ < size)
      corrupt("is truncated or corrupt within the property \"" + printable(in_utf8(name)) + "\"");
    if (type != kTimeStamp) channel.numbers[name] = number(type, at_, big_endian_);
    at_ += size;
  }

  void raw_data(std::uint64_t begin, std::uint64_t end, bool interleaved, bool closed) {
    std::uint64_t chunk = 0;
    for (const std::size_t i : active_) {
      const Layout& layout = *channels_[i].layout;
      if (layout.bytes > bytes_.size() - chunk)
        corrupt("is corrupt: a segment declares more values than the file can hold");
      chunk += layout.bytes;
      if (interleaved &&
          (layout.type == kString || layout.count != channels_[active_[0]].layout->count))
        corrupt("is corrupt: interleaved channels of different lengths");
    }
    if (chunk == 0 || begin == end) return;
    std::uint64_t chunks = (end - begin) / chunk;
    if (chunks * chunk != end - begin) {
      if (closed) corrupt("is corrupt: a segment ends within a row of values");
      cut_ = true;
    }
    const std::uint64_t row = interleaved ? chunk / channels_[active_[0]].layout->count : 0;
    std::uint64_t at = begin;
    for (const std::size_t i : active_) {
      Channel& channel = channels_[i];
      const Layout& layout = *channel.layout;
      if (layout.type != kString && chunks > 0) {
        const std::size_t size = size_of(layout.type);
        channel.pieces.push_back({.first = at,
                                  .chunks = chunks,
                                  .chunk_step = chunk,
                                  .count = layout.count,
                                  .step = interleaved ? row : size,
                                  .big_endian = big_endian_});
        at += interleaved ? size : layout.bytes;
      } else {
        at += layout.bytes;
      }
      channel.length += chunks * layout.count;
    }
  }

  /// Applies the scales in the properties. The last scale names the scale that precedes it, etc.
  void scale(const Channel& channel, std::vector<double>& x) const {
    const auto status = channel.texts.find("NI_Scaling_Status");
    const double count = channel.number("NI_Number_Of_Scales", 0.0);
    if (count < 1.0 || (status != channel.texts.end() && status->second == "scaled")) return;
    constexpr double kMostScales = 20.0, kRaw = 4294967295.0;
    double which = count - 1.0;
    std::vector<std::string> order;
    while (which >= 0.0 && which < kMostScales && std::ssize(order) < 20) {
      order.push_back("NI_Scale[" + std::to_string(static_cast<int>(which)) + "]_");
      const auto kind = channel.texts.find(order.back() + "Scale_Type");
      if (kind == channel.texts.end() || (kind->second != "Linear" && kind->second != "Polynomial"))
        corrupt("channel " + channel.path + " has a scale of the type \"" +
                (kind == channel.texts.end() ? "" : printable(kind->second)) +
                "\", which is not read: export the scaled values as text (.csv or .lvm)");
      which = channel.number(order.back() + kind->second + "_Input_Source", kRaw);
    }
    for (std::size_t i = order.size(); i-- > 0;) {
      std::vector<double> coefficients;
      if (channel.texts.at(order[i] + "Scale_Type") == "Linear") {
        coefficients = {channel.number(order[i] + "Linear_Y_Intercept", 0.0),
                        channel.number(order[i] + "Linear_Slope", 1.0)};
      } else {
        const double size = channel.number(order[i] + "Polynomial_Coefficients_Size", 4.0);
        for (int k = 0; k < 100 && k < size; ++k)
          coefficients.push_back(
              channel.number(order[i] + "Polynomial_Coefficients[" + std::to_string(k) + "]", 0.0));
      }
      for (double& value : x) {
        double y = 0.0;
        for (std::size_t k = coefficients.size(); k-- > 0;) y = y * value + coefficients[k];
        value = y;
      }
    }
  }

  const std::string& bytes_;
  const std::filesystem::path& name_;
  std::uint64_t at_ = 0, end_ = 0;
  bool big_endian_ = false, cut_ = false;
  std::vector<Channel> channels_;
  std::map<std::string, std::size_t> index_;
  std::vector<std::size_t> active_;
};

/// A time axis shared by channels.
struct Clock {
  std::uint64_t length = 0;
  double first = 0.0, step = 0.0;
};

}  // namespace

Columns parse_tdms(std::string bytes, const std::filesystem::path& name, const Wanted& wanted) {
  TdmsParser parser(bytes, name);
  parser.parse();
  Columns out{.file = name.string()};
  if (parser.cut()) out.others.emplace_back("incomplete rows (left out)");
  std::vector<ArrayShape> arrays;
  std::vector<const Channel*> sources;  // null: time
  std::vector<Clock> clocks;
  std::set<std::string> groups;
  for (const Channel& c : parser.channels())
    if (c.length > 0) groups.insert(names_of(c.path).empty() ? "" : names_of(c.path)[0]);
  for (const Channel& c : parser.channels()) {
    if (c.length == 0) continue;
    const std::vector<std::string> names = names_of(c.path);
    const std::string shown = names.size() < 2     ? in_utf8(c.path)
                              : groups.size() == 1 ? names[1]
                                                   : names[0] + "/" + names[1];
    if (c.layout->type == kString) {
      out.others.push_back(shown + " (text)");
      continue;
    }
    const Clock clock{c.length, c.number("wf_start_offset", 0.0), c.number("wf_increment", 0.0)};
    if (clock.step > 0.0 && std::isfinite(clock.step) && c.length > 1) {
      const auto same = std::ranges::find(clocks, c.length, &Clock::length);
      if (same == clocks.end()) {
        clocks.push_back(clock);
        arrays.push_back({.name = "time", .unit = "s", .shape = {c.length}});
        sources.push_back(nullptr);
      } else if (same->step != clock.step || same->first != clock.first) {
        out.others.push_back(shown +
                             " (its time step or offset differs from channels of this length)");
        continue;
      }
    }
    const auto unit = c.texts.find("unit_string");
    ArrayShape array{.name = shown, .shape = {c.length}};
    if (unit != c.texts.end()) array.unit = unit->second;
    if (c.layout->type == kTimeStamp) array.unit = "s";
    if (c.length == 1) out.scalars[shown] = parser.values(c)[0];
    arrays.push_back(std::move(array));
    sources.push_back(&c);
  }
  const ChosenColumns chosen = choose_columns(arrays, {}, wanted, out);
  if (out.columns.empty()) parser.corrupt("has no channel with at least two samples");
  const auto values = [&](std::size_t i) {
    if (sources[i] != nullptr) return parser.values(*sources[i]);
    const auto clock = std::ranges::find(clocks, arrays[i].shape[0], &Clock::length);
    std::vector<double> time;
    for (std::uint64_t n = 0; n < clock->length; ++n)
      time.push_back(clock->first + static_cast<double>(n) * clock->step);
    return time;
  };
  fill_columns(chosen, wanted, values, out);
  return out;
}

}  // namespace wheeltap::io
