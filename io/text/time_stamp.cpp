#include "io/text/time_stamp.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

char lower_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_letter(char c) {
  return lower_letter(c) >= 'a' && lower_letter(c) <= 'z';
}

/// Reads a text from its beginning.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : rest(text) {}

  bool take(char c) {
    if (!rest.starts_with(c)) return false;
    rest.remove_prefix(1);
    return true;
  }
  bool take_any(std::string_view of, char* which = nullptr) {
    if (rest.empty() || of.find(rest.front()) == std::string_view::npos) return false;
    if (which != nullptr) *which = rest.front();
    rest.remove_prefix(1);
    return true;
  }
  /// Reads this word, ignoring case.
  bool take_word(std::string_view word) {
    if (rest.size() < word.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i)
      if (lower_letter(rest[i]) != word[i]) return false;
    if (rest.size() > word.size() && is_letter(rest[word.size()])) return false;
    rest.remove_prefix(word.size());
    return true;
  }
  void skip_blanks() {
    while (!rest.empty() && (rest.front() == ' ' || rest.front() == '\t')) rest.remove_prefix(1);
  }
  /// Reads a whole number of `least` to `most` digits. Returns -1 if the next characters are not
  /// such a number.
  int number(int least, int most) {
    int value = 0, count = 0;
    while (count < most && static_cast<std::size_t>(count) < rest.size() &&
           is_digit(rest[static_cast<std::size_t>(count)]))
      value = 10 * value + (rest[static_cast<std::size_t>(count++)] - '0');
    if (count < least) return -1;
    rest.remove_prefix(static_cast<std::size_t>(count));
    return value;
  }
  [[nodiscard]] int digits() const {
    int count = 0;
    while (static_cast<std::size_t>(count) < rest.size() &&
           is_digit(rest[static_cast<std::size_t>(count)]))
      ++count;
    return count;
  }
  int month_name() {
    static constexpr std::array<std::string_view, 12> kNames = {
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"};
    // German names that differ from the English ones.
    static constexpr std::array<std::pair<std::string_view, int>, 6> kOthers = {
        {{"m\xC3\xA4r", 3}, {"mrz", 3}, {"mai", 5}, {"okt", 10}, {"dez", 12}, {"m\xE4r", 3}}};
    for (std::size_t m = 0; m < kNames.size(); ++m)
      if (take_letters(kNames[m])) return static_cast<int>(m) + 1;
    for (const auto& [name, month] : kOthers)
      if (take_letters(name)) return month;
    return -1;
  }
  /// Skips a weekday ("Monday", "Mon", "Mo") and a comma or point after it.
  void skip_weekday() {
    const std::string_view before = rest;
    for (const std::string_view day : {"mon", "tue", "wed", "thu", "fri", "sat", "sun", "mo", "di",
                                       "mi", "do", "fr", "sa", "so"}) {
      if (!take_letters(day)) continue;
      const bool marked = take_any(",.");
      if (!marked && !rest.starts_with(' ')) break;
      skip_blanks();
      return;
    }
    rest = before;
  }
  /// Reads a word that begins with `beginning`.
  bool take_letters(std::string_view beginning) {
    if (rest.size() < beginning.size()) return false;
    for (std::size_t i = 0; i < beginning.size(); ++i)
      if (lower_letter(rest[i]) != beginning[i]) return false;
    rest.remove_prefix(beginning.size());
    while (!rest.empty() && is_letter(rest.front())) rest.remove_prefix(1);
    return true;
  }

  std::string_view rest;
};

struct Parts {
  int year = -1, month = -1, day = -1;
  std::int64_t seconds = 0;  ///< since midnight; in a time zone: east of Greenwich
  std::int64_t fraction = 0;
  int decimals = 0;
  std::optional<std::int64_t> zone = {};  ///< seconds east of Greenwich; empty: not stated
};

std::optional<TimeStamp> stamp_of(const Parts& p, bool has_date) {
  TimeStamp out{.has_date = has_date, .decimals = p.decimals, .has_zone = p.zone.has_value()};
  std::int64_t days = 0;
  if (has_date) {
    const std::chrono::year_month_day date{std::chrono::year(p.year),
                                           std::chrono::month(static_cast<unsigned>(p.month)),
                                           std::chrono::day(static_cast<unsigned>(p.day))};
    // Outside these years, the number of nanoseconds does not fit into 64 bits.
    if (!date.ok() || p.year < 1700 || p.year > 2250) return std::nullopt;
    days = std::chrono::sys_days(date).time_since_epoch().count();
  }
  out.nanoseconds = (days * 86400 + p.seconds - p.zone.value_or(0)) * kSecond + p.fraction;
  return out;
}

int full_year(int year, int digits) {
  if (digits > 2) return year;
  return year + (year < 70 ? 2000 : 1900);
}

/// Replaces non-breaking blanks by blanks.
std::string with_plain_blanks(std::string_view text) {
  std::string out(text);
  for (const std::string_view blank : {"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89"})
    for (std::size_t i = 0; (i = out.find(blank)) != std::string::npos;)
      out.replace(i, blank.size(), " ");
  return out;
}

/// Reads the digits of a fraction of a second; uses the first nine.
void read_fraction(Cursor& at, Parts& out) {
  std::int64_t scale = kSecond / 10;
  while (!at.rest.empty() && is_digit(at.rest.front())) {
    out.fraction += scale * (at.rest.front() - '0');
    scale /= 10;
    if (out.decimals < 9) ++out.decimals;
    at.rest.remove_prefix(1);
  }
}

bool read_half_of_day(Cursor& at, int& hours) {
  const std::string_view before = at.rest;
  at.skip_blanks();
  const bool pm = at.take_word("pm") || at.take_word("p.m.");
  const bool am = !pm && (at.take_word("am") || at.take_word("a.m."));
  if (!am && !pm) {
    at.rest = before;
    return true;
  }
  if (hours < 1 || hours > 12) return false;
  hours = hours % 12 + (pm ? 12 : 0);
  return true;
}

bool read_zone(Cursor& at, Parts& out) {
  const std::string_view before = at.rest;
  at.skip_blanks();
  const bool zulu = at.take('Z') || at.take('z');
  const bool named = zulu || at.take_word("utc") || at.take_word("gmt");
  if (named) out.zone = 0;
  char sign = 0;
  if (zulu || !at.take_any("+-", &sign)) {
    if (named) return true;
    // Ignore CET, EDT, JST: the zone is equal for all rows, and only time differences are used.
    std::size_t letters = 0;
    while (letters < at.rest.size() && at.rest[letters] >= 'A' && at.rest[letters] <= 'Z')
      ++letters;
    const bool letters_alone = letters == at.rest.size() && before != at.rest;
    at.rest = letters >= 3 && letters <= 5 && letters_alone ? std::string_view() : before;
    return true;
  }
  const int hours = at.number(named ? 1 : 2, 2);
  int minutes = 0;
  const bool colon = at.take(':');
  if (colon || at.digits() == 2) minutes = at.number(2, 2);
  if (hours < 0 || hours > 15 || minutes < 0 || minutes > 59) return false;
  out.zone = (sign == '-' ? -1 : 1) * (hours * 3600 + minutes * 60);
  return true;
}

bool set_time_of_day(Parts& out, int hours, int minutes, int seconds) {
  if (hours > 24 || minutes > 59 || seconds > 60) return false;
  out.seconds = hours * 3600 + minutes * 60 + seconds;
  return true;
}

/// Reads hh:mm[:ss[.fraction]] [AM|PM] or, without a date, mm:ss.fraction.
bool read_time_of_day(Cursor& at, Parts& out, bool after_date) {
  int hours = at.number(1, 2);
  char between = 0;
  if (hours < 0 || !at.take_any(after_date ? ":.-" : ":", &between)) return false;
  int minutes = at.number(2, 2), seconds = 0;
  if (minutes < 0) return false;
  char mark = 0;
  if (at.take(between)) {
    seconds = at.number(1, 2);
    if (seconds < 0) return false;
    // Some loggers separate milliseconds by a colon.
    if (at.take_any(".,:", &mark)) {
      if (at.digits() == 0) return false;
      read_fraction(at, out);
    }
  } else if (!after_date && at.take_any(".,", &mark)) {
    if (at.digits() == 0) return false;
    seconds = minutes;
    minutes = hours;
    hours = 0;
    read_fraction(at, out);
  } else if (!after_date) {
    const std::string_view before = at.rest;
    at.skip_blanks();
    const bool half = at.take_word("am") || at.take_word("pm");
    at.rest = before;
    if (!half) return false;  // "10:30": hh:mm or mm:ss
  }
  if (!read_half_of_day(at, hours)) return false;
  return set_time_of_day(out, hours, minutes, seconds);
}

/// Reads a time stamp whose form follows from its first digits. The result is empty if the text is
/// not a time stamp.
class StampReader {
 public:
  StampReader(std::string_view text, DayOrder order) : at_(text), order_(order) {}

  StampReading read() {
    at_.skip_blanks();
    at_.skip_weekday();
    if (at_.rest.size() < 5 || (!is_digit(at_.rest.front()) && !is_letter(at_.rest.front())))
      return {};
    const int first_digits = at_.digits();
    if (first_digits <= 2 && at_.rest.size() > static_cast<std::size_t>(first_digits) &&
        at_.rest[static_cast<std::size_t>(first_digits)] == ':') {
      if (!read_time_of_day(at_, parts_, false)) return {};
      return finished(false);
    }
    if (first_digits == 14 || first_digits == 17) return of_digits_alone(first_digits == 17);
    if (first_digits == 8) return after_date_of_digits();
    if (first_digits == 4 && at_.rest.size() > 9 && at_.rest[4] == '-' && at_.rest[8] == 'T') {
      const std::string_view before = at_.rest;
      if (const int day = day_of_year(); day > 0) return on_day_of_year(day);
      at_.rest = before;
    }
    return of_three_parts();
  }

 private:
  StampReading finished(bool has_date) {
    if (!read_zone(at_, parts_)) return {};
    at_.skip_blanks();
    if (!at_.rest.empty()) return {};
    if (!reading_.ambiguous) reading_.stamp = stamp_of(parts_, has_date);
    return reading_;
  }

  /// Reads yyyymmdd.
  void read_date_of_digits() {
    parts_.year = at_.number(4, 4), parts_.month = at_.number(2, 2), parts_.day = at_.number(2, 2);
  }

  /// Reads 20210301100000[.fraction] or 20210301100000123.
  StampReading of_digits_alone(bool with_fraction) {
    read_date_of_digits();
    const int hours = at_.number(2, 2), minutes = at_.number(2, 2), seconds = at_.number(2, 2);
    if (parts_.year < 1900 || parts_.year > 2100) return {};
    if (!set_time_of_day(parts_, hours, minutes, seconds)) return {};
    if (with_fraction || at_.take_any(".,")) read_fraction(at_, parts_);
    return finished(true);
  }

  /// Reads a date like 20210301, with or without a time of day.
  StampReading after_date_of_digits() {
    read_date_of_digits();
    if (!at_.take_any("T_ ")) return {};  // digits alone are a number
    if (at_.digits() == 6 || at_.digits() == 4) {
      const bool with_seconds = at_.digits() == 6;
      const int hours = at_.number(2, 2), minutes = at_.number(2, 2);
      const int seconds = with_seconds ? at_.number(2, 2) : 0;
      if (!set_time_of_day(parts_, hours, minutes, seconds)) return {};
      if (at_.take_any(".,")) read_fraction(at_, parts_);
      return finished(true);
    }
    if (!read_time_of_day(at_, parts_, true)) return {};
    return finished(true);
  }

  /// Reads a day of the year like 2021-060T, up to the time of day. Returns 0 for any other text.
  int day_of_year() {
    parts_.year = at_.number(4, 4);
    at_.take('-');
    const int day = at_.number(3, 3);
    return day >= 1 && day <= 366 && at_.take('T') ? day : 0;
  }
  StampReading on_day_of_year(int day) {
    parts_.month = parts_.day = 1;
    if (!read_time_of_day(at_, parts_, true)) return {};
    parts_.seconds += std::int64_t{86400} * (day - 1);
    return finished(true);
  }

  /// Reads a date of three parts, separated by the same mark.
  StampReading of_three_parts() {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!read_part(i)) return {};
      if (i == 2) break;
      if (!read_mark(i)) return {};
      if (i == 1 && named_ == 0 && at_.digits() <= 2) return with_year_last();
    }
    if (!order_parts() || !read_time_after_date()) return {};
    return finished(true);
  }
  bool read_part(std::size_t i) {
    digits_[i] = at_.digits();
    if (digits_[i] == 0) {
      if (named_ >= 0 || i == 2) return false;
      value_[i] = at_.month_name();
      named_ = static_cast<int>(i);
    } else {
      if (digits_[i] == 3 || digits_[i] > 4) return false;
      value_[i] = at_.number(1, 4);
    }
    return value_[i] >= 0;
  }
  /// Reads the mark after part i of a date.
  bool read_mark(std::size_t i) {
    char here = 0;
    if (!at_.take_any(named_ >= 0 ? "-/. ," : (i == 0 ? "-/. " : "-/."), &here)) return false;
    if (i > 0 && here != mark_ && named_ < 0) return false;
    mark_ = here;
    if (mark_ == '.' || mark_ == ',' || named_ >= 0) at_.skip_blanks();
    return true;
  }
  /// Reads the text after the day of a stamp like "Mar 1 10:00:00 2021", the format of the C
  /// library.
  StampReading with_year_last() {
    at_.skip_blanks();
    if (!read_time_of_day(at_, parts_, false)) return {};
    at_.skip_blanks();
    if (at_.digits() != 4) return {};
    parts_.year = at_.number(4, 4), parts_.month = value_[0], parts_.day = value_[1];
    return finished(true);
  }
  /// Assigns year, month and day to the three parts.
  bool order_parts() {
    if (digits_[0] == 4) {
      put(0, 1, 2);
    } else if (digits_[2] == 0 || digits_[2] == 3 || (digits_[2] != 2 && digits_[2] != 4)) {
      return false;
    } else if (named_ >= 0) {
      put(2, static_cast<std::size_t>(named_), named_ == 0 ? 1 : 0);
    } else {
      if (value_[0] > 12) reading_.order = DayOrder::day_first;
      if (value_[1] > 12) reading_.order = DayOrder::month_first;
      DayOrder used = order_ != DayOrder::unknown ? order_ : reading_.order;
      // 3.1.2021 always means 3 January.
      if (used == DayOrder::unknown && mark_ == '.') used = DayOrder::day_first;
      reading_.ambiguous = used == DayOrder::unknown;
      used == DayOrder::month_first ? put(2, 0, 1) : put(2, 1, 0);
    }
    return true;
  }
  void put(std::size_t year, std::size_t month, std::size_t day) {
    parts_.year = full_year(value_[year], digits_[year]);
    parts_.month = value_[month];
    parts_.day = value_[day];
  }
  /// Reads the time of day after a date; the time of day may be absent.
  bool read_time_after_date() {
    const std::string_view before = at_.rest;
    if (at_.take_any("T_,;") || at_.rest.starts_with(' ') || at_.rest.starts_with('-')) {
      if (at_.rest.starts_with('-')) at_.rest.remove_prefix(1);
      at_.skip_blanks();
      if (!at_.rest.empty() && is_digit(at_.rest.front()))
        return read_time_of_day(at_, parts_, true);
      at_.rest = before;
    }
    return true;
  }

  Cursor at_;
  DayOrder order_;
  Parts parts_;
  StampReading reading_;
  // For a date of three parts: the numbers, their digits, the index of the part that is the name of
  // a month (-1: none), and the mark between them.
  std::array<int, 3> value_{}, digits_{};
  int named_ = -1;
  char mark_ = 0;
};

}  // namespace

StampReading read_stamp(std::string_view text, DayOrder order) {
  std::string plain;
  if (text.find_first_of("\xC2\xE2") != std::string_view::npos) {
    plain = with_plain_blanks(text);
    text = plain;
  }
  return StampReader(text, order).read();
}

std::optional<TimeStamp> read_stamp(std::string_view text, const std::string& pattern) {
  Cursor at(text);
  Parts out;
  int hours = 0, minutes = 0, seconds = 0;
  bool has_date = false, half = false, pm = false;
  at.skip_blanks();
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const char c = pattern[i];
    if (c == ' ') {
      at.skip_blanks();
      continue;
    }
    if (c != '%') {
      if (!at.take(c)) return std::nullopt;
      continue;
    }
    if (++i == pattern.size()) return std::nullopt;
    const auto number = [&](int least, int most, int lowest, int highest, int& into) {
      into = at.number(least, most);
      return into >= lowest && into <= highest;
    };
    bool fine = true;
    switch (pattern[i]) {
      case 'Y':
        fine = number(4, 4, 0, 9999, out.year), has_date = true;
        break;
      case 'y':
        fine = number(2, 2, 0, 99, out.year), has_date = true;
        out.year = full_year(out.year, 2);
        break;
      case 'm':
        fine = number(1, 2, 1, 12, out.month);
        break;
      case 'b':
      case 'B':
        out.month = at.month_name();
        fine = out.month > 0;
        break;
      case 'd':
        fine = number(1, 2, 1, 31, out.day);
        break;
      case 'H':
        fine = number(1, 2, 0, 24, hours);
        break;
      case 'I':
        fine = number(1, 2, 1, 12, hours);
        break;
      case 'M':
        fine = number(1, 2, 0, 59, minutes);
        break;
      case 'S': {
        fine = number(1, 2, 0, 60, seconds);
        const bool fraction_follows = pattern.find("%f", i) != std::string::npos;
        if (fine && !fraction_follows && at.take_any(".,")) read_fraction(at, out);
        break;
      }
      case 'f':
        fine = at.digits() > 0;
        read_fraction(at, out);
        break;
      case 'p':
        half = true;
        pm = at.take_word("pm");
        fine = pm || at.take_word("am");
        break;
      case 'z':
        fine = read_zone(at, out);
        break;
      case '%':
        fine = at.take('%');
        break;
      default:
        return std::nullopt;
    }
    if (!fine) return std::nullopt;
  }
  at.skip_blanks();
  if (!at.rest.empty()) return std::nullopt;
  if (half) hours = hours % 12 + (pm ? 12 : 0);
  out.seconds = hours * 3600 + minutes * 60 + seconds;
  return stamp_of(out, has_date);
}

std::string stamp_pattern(std::string_view text, DayOrder order) {
  const bool month_first =
      order == DayOrder::month_first ||
      (order == DayOrder::unknown && read_stamp(text).order == DayOrder::month_first);
  std::vector<std::string> dates = {"%Y-%m-%d", "%Y/%m/%d", "%Y.%m.%d", "%d.%m.%Y", "%d.%m.%y",
                                    "%d-%b-%Y", "%d-%b-%y", "%d %b %Y", "%Y%m%d",   ""};
  for (const char* mark : {"/", "-"})
    for (const char* year : {"%Y", "%y"})
      dates.push_back(std::string(month_first ? "%m" : "%d") + mark + (month_first ? "%d" : "%m") +
                      mark + year);
  for (const std::string& date : dates)
    for (const char* between : {" ", "T", "_", ", ", ""})
      for (const char* time :
           {"%H:%M:%S", "%I:%M:%S %p", "%H:%M:%S:%f", "%H:%M", "%H%M%S", "%M:%S", ""})
        for (const char* zone : {"", "%z"}) {
          std::string pattern = date + between + time + zone;
          if (read_stamp(text, pattern)) return pattern;
        }
  return {};
}

std::optional<TimeFormat> parse_time_format(std::string_view text) {
  if (text == "day-first") return TimeFormat{.order = DayOrder::day_first};
  if (text == "month-first") return TimeFormat{.order = DayOrder::month_first};
  if (text == "iso" || text == "iso-8601" || text == "ISO 8601") return TimeFormat{};
  std::string pattern;
  if (text.find('%') != std::string_view::npos) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '%') continue;
      if (++i == text.size() ||
          std::string_view("YymbBdHIMSfpz%").find(text[i]) == std::string_view::npos)
        return std::nullopt;
    }
    return TimeFormat{.pattern = std::string(text)};
  }
  // The letters have the meaning as in spreadsheets and MATLAB: MM is a month, mm are minutes.
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    std::size_t end = i;
    while (end < text.size() && text[end] == c) ++end;
    const std::size_t count = end - i;
    i = end;
    if (c == 'y' || c == 'Y') {
      pattern += count > 2 ? "%Y" : "%y";
    } else if (c == 'M') {
      pattern += count > 2 ? "%b" : "%m";
    } else if (c == 'd' || c == 'D') {
      pattern += "%d";
    } else if (c == 'H' || c == 'h') {
      pattern += c == 'h' && (text.find('a') != std::string_view::npos ||
                              text.find("tt") != std::string_view::npos)
                     ? "%I"
                     : "%H";
    } else if (c == 'm') {
      pattern += "%M";
    } else if (c == 's' || (c == 'S' && !pattern.ends_with("%S") && !pattern.ends_with("%S.") &&
                            !pattern.ends_with("%S,"))) {
      pattern += "%S";
    } else if (c == 'S' || c == 'f' || c == 'F') {
      pattern += "%f";
    } else if (c == 'a' || c == 't') {
      pattern += "%p";
    } else if (c == 'T' || c == '\'') {
      pattern += c == 'T' ? "T" : "";
    } else if (is_letter(c)) {
      return std::nullopt;
    } else {
      pattern += std::string(count, c);
    }
  }
  if (pattern.find('%') == std::string::npos) return std::nullopt;
  return TimeFormat{.pattern = pattern};
}

std::string text_of(const TimeStamp& stamp) {
  std::int64_t seconds = stamp.nanoseconds / kSecond, rest = stamp.nanoseconds % kSecond;
  if (rest < 0) rest += kSecond, --seconds;
  std::int64_t days = seconds / 86400, of_day = seconds % 86400;
  if (of_day < 0) of_day += 86400, --days;
  std::string out;
  char text[64];
  if (stamp.has_date) {
    const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(days))};
    std::snprintf(text, sizeof text, "%04d-%02u-%02u ", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
    out = text;
  }
  std::snprintf(text, sizeof text, "%02d:%02d:%02d", static_cast<int>(of_day / 3600),
                static_cast<int>(of_day / 60 % 60), static_cast<int>(of_day % 60));
  out += text;
  if (stamp.decimals > 0) {
    std::snprintf(text, sizeof text, ".%09d", static_cast<int>(rest));
    out += std::string(text).substr(0, static_cast<std::size_t>(stamp.decimals) + 1);
  }
  return out;
}

}  // namespace wheeltap::io
