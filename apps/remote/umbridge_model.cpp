#include "apps/remote/umbridge_model.hpp"

#ifdef WHEELTAP_WITH_HTTP
#include <httplib.h>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numeric>
#include <thread>

#include "apps/json_text.hpp"
#include "apps/words.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;
using Kind = OutsideModelError::Kind;

bool knows_http() {
#ifdef WHEELTAP_WITH_HTTP
  return true;
#else
  return false;
#endif
}

#ifndef WHEELTAP_WITH_HTTP

std::unique_ptr<OutsideModel> umbridge_model(const UmbridgeSpec& spec, int /*inputs*/,
                                             int /*outputs*/) {
  throw OutsideModelError(Kind::unreachable,
                          spec.url +
                              ": this wheeltap was built without cpp-httplib and cannot use "
                              "servers");
}

#else

namespace {

constexpr double kFirstPause = 0.25, kLongestPause = 30.0;  // seconds between two attempts
constexpr std::size_t kLongest = 200;                       // characters of a response in messages

/// The beginning of a server's response, for error messages.
std::string beginning(const std::string& words) {
  return words.size() > kLongest ? words.substr(0, kLongest) + "..." : words;
}

std::string sizes_in_words(const std::vector<int>& sizes) {
  return Json(sizes).dump();
}

class UmbridgeModel final : public OutsideModel {
 public:
  UmbridgeModel(UmbridgeSpec spec, int inputs, int outputs) : spec_(std::move(spec)) {
    const auto path = spec_.url.find('/', std::string("http://").size());
    host_ = spec_.url.substr(0, path);
    if (path != std::string::npos) path_ = spec_.url.substr(path);
    while (path_.ends_with('/')) path_.pop_back();
    choose();
    input_sizes_ = sizes("InputSizes", "inputSizes", "inputs", inputs);
    output_sizes_ = sizes("OutputSizes", "outputSizes", "outputs", outputs);
  }

  [[nodiscard]] int inputs() const override { return sum(input_sizes_); }
  [[nodiscard]] int outputs() const override { return sum(output_sizes_); }

  void evaluate(std::span<const double> x, std::span<double> y) override {
    const Json answer =
        ask("Evaluate",
            {{"name", spec_.model}, {"input", blocks(x, input_sizes_)}, {"config", spec_.config}});
    const std::string where = at("Evaluate");
    const Json& output = field(answer, "output", where);
    if (!output.is_array() || output.size() != output_sizes_.size())
      wrong(where, "answered with " + std::to_string(output.size()) + " vectors at " + text(x) +
                       ", must be " + std::to_string(output_sizes_.size()));
    std::size_t next = 0;
    for (std::size_t b = 0; b < output_sizes_.size(); ++b) {
      numbers(output[b], y.subspan(next, static_cast<std::size_t>(output_sizes_[b])), where, x);
      next += static_cast<std::size_t>(output_sizes_[b]);
    }
  }

  // The protocol has one request per pair of an output vector and an input vector.
  bool gradient(std::span<const double> x, std::span<const double> sensitivity,
                std::span<double> slope) override {
    if (!has_gradient_) return false;
    const Json parts = blocks(sensitivity, output_sizes_);
    std::size_t next = 0;
    for (std::size_t in = 0; in < input_sizes_.size(); ++in) {
      const auto width = static_cast<std::size_t>(input_sizes_[in]);
      const auto here = slope.subspan(next, width);
      std::ranges::fill(here, 0.0);
      std::vector<double> part(width);
      for (std::size_t out = 0; out < output_sizes_.size(); ++out) {
        const Json answer = ask("Gradient", {{"name", spec_.model},
                                             {"outWrt", out},
                                             {"inWrt", in},
                                             {"input", blocks(x, input_sizes_)},
                                             {"sens", parts[out]},
                                             {"config", spec_.config}});
        numbers(field(answer, "output", at("Gradient")), part, at("Gradient"), x);
        for (std::size_t i = 0; i < width; ++i) here[i] += part[i];
      }
      next += width;
    }
    return true;
  }

 private:
  static int sum(const std::vector<int>& sizes) {
    return std::accumulate(sizes.begin(), sizes.end(), 0);
  }
  static std::string text(std::span<const double> x) {
    return Json(std::vector<double>(x.begin(), x.end())).dump();
  }
  static Json blocks(std::span<const double> x, const std::vector<int>& sizes) {
    Json out = Json::array();
    for (const int size : sizes) {
      const auto part = x.first(static_cast<std::size_t>(size));
      out.push_back(std::vector<double>(part.begin(), part.end()));
      x = x.subspan(part.size());
    }
    return out;
  }
  [[nodiscard]] std::string at(const std::string& endpoint) const {
    return host_ + path_ + "/" + endpoint;
  }
  [[noreturn]] static void wrong(const std::string& where, const std::string& what) {
    throw OutsideModelError(Kind::bad_answer, io::printable(where + ": " + what));
  }
  static const Json& field(const Json& answer, const char* name, const std::string& where) {
    if (!answer.is_object() || !answer.contains(name))
      wrong(where, std::string("answered without \"") + name +
                       "\": is it a server of the UM-Bridge protocol, version 1.0?");
    return answer.at(name);
  }
  static void numbers(const Json& from, std::span<double> to, const std::string& where,
                      std::span<const double> x) {
    if (!from.is_array() || from.size() != to.size())
      wrong(where, "answered with " + std::to_string(from.size()) + " numbers at " + text(x) +
                       ", must be " + std::to_string(to.size()));
    for (std::size_t i = 0; i < to.size(); ++i) {
      // JSON has no NaN, but Python writes NaN and other programs write null.
      if (!from[i].is_number() || !std::isfinite(from[i].get<double>()))
        wrong(where, "answered with " +
                         from[i].dump(-1, ' ', false, Json::error_handler_t::replace) + " at " +
                         text(x) + ", number " + std::to_string(i + 1) +
                         ": must be a finite number");
      to[i] = from[i].get<double>();
    }
  }

  void choose() {
    const Json info = ask("Info", {});
    const Json& version = field(info, "protocolVersion", at("Info"));
    if (!version.is_number() || version.get<double>() < 1.0 || version.get<double>() >= 2.0)
      wrong(at("Info"), "uses version " + version.dump() + " of the protocol, must be 1.0");
    const Json& models = field(info, "models", at("Info"));
    std::vector<std::string> names;
    for (const Json& name : models)
      if (name.is_string()) names.push_back(name.get<std::string>());
    const auto has = [&](const std::string& name) {
      return std::ranges::find(names, name) != names.end();
    };
    if (spec_.model.empty() && names.size() == 1) spec_.model = names[0];
    if (spec_.model.empty() && has("forward")) spec_.model = "forward";
    if (spec_.model.empty() || !has(spec_.model))
      wrong(at("Info"), (spec_.model.empty() ? "offers several models"
                                             : "offers no model \"" + spec_.model + "\"") +
                            std::string(" (it has: ") + beginning(listed(names)) +
                            "); name one with \"model\" in the predictor");
    const Json about = ask("ModelInfo", {{"name", spec_.model}});
    const Json& support = field(about, "support", at("ModelInfo"));
    if (!support.is_object() || !support.value("Evaluate", false))
      wrong(at("ModelInfo"), "states that \"" + spec_.model + "\" cannot be evaluated");
    has_gradient_ = support.value("Gradient", false);
  }

  std::vector<int> sizes(const char* endpoint, const char* name, const char* what, int wanted) {
    const Json answer = ask(endpoint, {{"name", spec_.model}, {"config", spec_.config}});
    const Json& list = field(answer, name, at(endpoint));
    std::vector<int> out;
    constexpr std::int64_t kMost = 1'000'000;
    std::int64_t all = 0;
    for (const Json& size : list) {
      if (!size.is_number_integer() || size.get<std::int64_t>() < 0 ||
          size.get<std::int64_t>() > kMost || (all += size.get<std::int64_t>()) > kMost)
        wrong(at(endpoint), "answered " + beginning(list.dump()) +
                                ", must be whole numbers with a sum of at most 1 million");
      out.push_back(size.get<int>());
    }
    if (sum(out) != wanted)
      wrong(at(endpoint), "\"" + spec_.model + "\" has " + std::to_string(sum(out)) + " " + what +
                              " " + sizes_in_words(out) + ", the case has " +
                              std::to_string(wanted));
    return out;
  }

  // One persistent connection per thread.
  std::unique_ptr<httplib::Client> take_client() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto client = std::move(idle_.back());
        idle_.pop_back();
        return client;
      }
    }
    auto client = std::make_unique<httplib::Client>(host_);
    const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(
        std::chrono::duration<double>(spec_.patience.timeout_seconds));
    client->set_connection_timeout(
        std::min<std::chrono::microseconds>(whole, std::chrono::seconds(10)));
    client->set_read_timeout(whole);
    client->set_write_timeout(whole);
    client->set_keep_alive(true);
    client->set_tcp_nodelay(true);
    return client;
  }

  /// The error message of a server.
  static std::string complaint(int status, const std::string& body) {
    const Json said = parse_answer(body);
    std::string words;
    if (said.is_object() && said.contains("error") && said["error"].is_object()) {
      const Json& error = said["error"];
      for (const char* key : {"type", "message"})
        if (error.contains(key) && error[key].is_string())
          words += (words.empty() ? "" : ": ") + error[key].get<std::string>();
    } else {
      words = body;
    }
    return "HTTP " + std::to_string(status) + (words.empty() ? "" : ": " + beginning(words));
  }

  Json ask(const std::string& endpoint, const Json& question) {
    const std::string where = at(endpoint);
    httplib::Request request;
    request.method = "GET";
    request.path = path_ + "/" + endpoint;
    std::string asked;
    if (!question.is_null()) {
      request.method = "POST";
      request.body = question.dump();
      request.set_header("Content-Type", "application/json");
      asked = ", to " + request.body;
    }
    std::string trouble;
    auto client = take_client();
    double pause = kFirstPause;
    for (int attempt = 0;; ++attempt) {
      const auto began = std::chrono::steady_clock::now();
      const auto seconds = [began] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      };
      std::string text;
      bool too_long = false, too_slow = false;
      // Limit the size and the time of responses.
      request.content_receiver = [&](const char* data, std::size_t n, auto, auto) {
        too_long = text.size() + n > kLargestAnswer;
        too_slow = seconds() > spec_.patience.timeout_seconds;
        if (too_long || too_slow) return false;
        text.append(data, n);
        return true;
      };
      const auto answer = client->send(request);
      if (too_long)
        wrong(where,
              "answered with more than " + std::to_string(kLargestAnswer) + " bytes" + asked);
      if (answer && answer->status == 200) {
        Json said = parse_answer(text);
        if (said.is_discarded()) {
          const bool nan =
              text.find("NaN") != std::string::npos || text.find("Infinity") != std::string::npos;
          wrong(where,
                (nan ? "answered with numbers that are not finite" : "answered with invalid JSON") +
                    asked + ": " + text.substr(0, kLongest));
        }
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(client));
        return said;
      }
      if (answer && answer->status < 500) wrong(where, complaint(answer->status, text) + asked);
      if (answer) {
        trouble = complaint(answer->status, text);
      } else if (too_slow || (answer.error() == httplib::Error::Read &&
                              seconds() >= 0.95 * spec_.patience.timeout_seconds)) {
        trouble = "no answer in " + significant(spec_.patience.timeout_seconds, 3) +
                  " s (\"timeout\" in the predictor)";
      } else {
        trouble = answer.error() == httplib::Error::Connection
                      ? "no server listens there"
                      : "the connection broke (" + httplib::to_string(answer.error()) + ")";
      }
      if (attempt >= spec_.patience.retries) break;
      std::this_thread::sleep_for(std::chrono::duration<double>(pause));
      pause = std::min(2.0 * pause, kLongestPause);
    }
    const int tries = spec_.patience.retries + 1;
    const std::string times = tries > 1 ? ", " + std::to_string(tries) + " times" : "";
    throw OutsideModelError(Kind::unreachable, io::printable(where + ": " + trouble + times));
  }

  UmbridgeSpec spec_;
  std::string host_, path_;
  std::vector<int> input_sizes_, output_sizes_;
  bool has_gradient_ = false;
  std::mutex mutex_;
  std::vector<std::unique_ptr<httplib::Client> > idle_;
};

}  // namespace

std::unique_ptr<OutsideModel> umbridge_model(const UmbridgeSpec& spec, int inputs, int outputs) {
  return std::make_unique<UmbridgeModel>(spec, inputs, outputs);
}

#endif

}  // namespace wheeltap::apps
