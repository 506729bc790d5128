#include "apps/json_text.hpp"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "apps/failure.hpp"
#include "apps/json_syntax.hpp"

namespace wheeltap::apps {
namespace {

// Converts a byte position to line and column, both from 1.
std::pair<std::size_t, std::size_t> line_and_column(std::string_view text, std::size_t byte) {
  const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const std::string_view before = text.substr(0, at);
  const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
  const std::size_t newline = before.rfind('\n');
  return {line, newline == std::string_view::npos ? at + 1 : at - newline};
}

/// Checks a JSON text in linear time, before any JSON values are built.
class Watch : public nlohmann::json_sax<nlohmann::json> {
 public:
  Watch(const std::filesystem::path& path, std::string_view text, std::size_t most_keys)
      : path_(path), text_(text), most_keys_(most_keys) {}

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  // Two equal keys are an error here; JSON parsers would silently keep the last one.
  bool key(string_t& key) override {
    if (!keys_.back().insert(key).second) {
      refuse(": the key \"" + key + "\" is used twice in one object");
    }
    if (keys_.back().size() > most_keys_) {
      refuse(": more than " + std::to_string(most_keys_) + " keys in one object");
    }
    return true;
  }
  bool parse_error(std::size_t at, const std::string&,
                   const nlohmann::detail::exception& error) override {
    if (dynamic_cast<const nlohmann::json::out_of_range*>(&error) != nullptr) {
      refuse(std::string(": a number is too large for double precision: ") + error.what());
    }
    const auto [line, column] = line_and_column(text_, at);
    std::string what = error.what();
    if (const auto from = what.find(": ", what.find("column")); from != std::string::npos) {
      what = what.substr(from + 2);
    }
    refuse(":" + std::to_string(line) + ":" + std::to_string(column) + ": not JSON: " + what +
           syntax_remedy(text_, at > 0 ? at - 1 : 0));
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw Failure(Exit::bad_input, path_.string() + why);
  }
  bool open() {
    if (keys_.size() == kDeepestJson) {
      refuse(": lists and objects are nested more than " + std::to_string(kDeepestJson) + " deep");
    }
    keys_.emplace_back();
    return true;
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  const std::filesystem::path& path_;
  std::string_view text_;
  std::size_t most_keys_;
  std::vector<std::unordered_set<std::string>> keys_;  // keys of every open list and object
};

}  // namespace

template <class AnyJson>
AnyJson parse_json(const std::filesystem::path& path, std::string_view text) {
  constexpr bool kOrdered = std::is_same_v<AnyJson, nlohmann::ordered_json>;
  Watch watch(path, text, kOrdered ? kMostOrderedKeys : text.size());
  (void)nlohmann::json::sax_parse(text, &watch);
  return AnyJson::parse(text);
}

nlohmann::json parse_answer(std::string_view text) {
  using Event = nlohmann::json::parse_event_t;
  bool too_deep = false;
  const auto watch = [&](int depth, Event event, const nlohmann::json&) {
    const bool opens = event == Event::array_start || event == Event::object_start;
    if (opens && depth >= static_cast<int>(kDeepestJson)) too_deep = true;
    return !too_deep;
  };
  nlohmann::json said = nlohmann::json::parse(text, watch, false);
  return too_deep ? nlohmann::json(nlohmann::json::value_t::discarded) : said;
}

template nlohmann::json parse_json(const std::filesystem::path&, std::string_view);
template nlohmann::ordered_json parse_json(const std::filesystem::path&, std::string_view);

}  // namespace wheeltap::apps
