#include "apps/application/app_server.hpp"

#ifdef WHEELTAP_WITH_HTTP

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <semaphore>
#include <string_view>
#include <thread>
#include <utility>

#include "apps/application/app_folder.hpp"
#include "apps/application/page_files.hpp"
#include "apps/application/project_list.hpp"
#include "apps/application/record_view.hpp"
#include "apps/application/run_queue.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/cases/structures/section_case.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/json_text.hpp"
#include "apps/runs/running.hpp"
#include "io/bytes.hpp"
#include "io/drawings/dxf.hpp"
#include "io/fingerprint.hpp"
#include "io/text/text.hpp"

// Include this after Eigen: a system header defines the macro _res, which is a name in Eigen.
#include "apps/remote/bounded_server.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestBody = std::size_t{8} << 20U, kLongestTarget = 4096;
constexpr std::size_t kLargestResult = std::size_t{256} << 20U;
constexpr std::size_t kConnections = 64;
constexpr int kAtWork = 4;  // largest number of requests handled simultaneously
constexpr const char* kJson = "application/json";

// The page runs only scripts from its own files, and shows all content as text.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
// A report is a file of the user: its scripts may neither read data of the application nor open
// connections. "allow-modals" permits the dialog for printing.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-downloads allow-modals; default-src 'none'; style-src "
    "'unsafe-inline'; "
    "script-src 'unsafe-inline' 'unsafe-eval'; img-src data: blob:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

/// An error of a request.
struct Refused {
  int status;
  std::string reason;
};

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Failure(Exit::internal,
                  "app: the operating system provides no random bytes for the token");
  std::string out;
  for (const unsigned char b : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    out += kDigits[b >> 4U];
    out += kDigits[b & 15U];
  }
  return out;
}

/// Compares two tokens in a time that does not depend on the position of the first difference.
bool same_token(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = static_cast<unsigned char>(
        difference | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i])));
  return difference == 0;
}

std::string json_text_of(const Report& json) {
  return json.dump(-1, ' ', false, Report::error_handler_t::replace);
}

class Application {
 public:
  Application(const AppProgram& program, const AppOptions& options)
      : program_(program),
        options_(options),
        folder_(options.folder),
        runs_(options.at_once, options.threads) {
    server_.set_pre_routing_handler([this](const auto& request, auto& response) {
      return admit(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                      : httplib::Server::HandlerResponse::Handled;
    });
    server_.Get("/.*", [this](const auto& request, auto& response) { get(request, response); });
    server_.Post("/.*", [this](const auto& request, auto& response, const auto& reader) {
      post(request, response, reader);
    });
  }

  void run() {
    const std::string host = "127.0.0.1";
    port_ = options_.port > 0 ? (server_.bind_to_port(host, options_.port) ? options_.port : -1)
                              : server_.bind_to_any_port(host);
    if (port_ <= 0)
      throw Failure(Exit::cannot_create, "--port: port " + std::to_string(options_.port) +
                                             ": not available: another program uses it");
    std::jthread watch([this](const std::stop_token& done) {
      while (!done.stop_requested() && !(options_.stop && options_.stop()))
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      server_.stop();
    });
    if (options_.ready)
      options_.ready("http://" + host + ":" + std::to_string(port_) + "/" + token_ + "/");
    server_.listen_after_bind();
  }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  [[nodiscard]] bool is_own_host(const std::string& host) const {
    const std::string port = ":" + std::to_string(port_);
    return host == "127.0.0.1" + port || host == "localhost" + port;
  }

  static void answer(Response& response, const Report& json, int status = 200) {
    response.status = status;
    response.set_content(json_text_of(json), kJson);
  }

  static void refuse(Response& response, const Refused& refused) {
    answer(response, {{"error", refused.reason}}, refused.status);
  }

  /// Checks common to all resources. If a check fails, fills in the response and returns false.
  bool admit(const Request& request, Response& response) {
    response.set_header("Content-Security-Policy", kPagePolicy);
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Cross-Origin-Opener-Policy", "same-origin");
    response.set_header("Cache-Control", "no-store");
    try {
      if (request.method != "GET" && request.method != "POST")
        throw Refused{405, "only the methods GET and POST are allowed"};
      if (request.target.size() > kLongestTarget) throw Refused{414, "the URL is too long"};
      // Reject other host names that resolve to this address: a page of another site could use
      // them.
      if (!is_own_host(request.get_header_value("Host")))
        throw Refused{403, "the host must be 127.0.0.1 or localhost"};
      const std::string origin = request.get_header_value("Origin");
      if (request.has_header("Origin") &&
          !(origin.starts_with("http://") && is_own_host(origin.substr(7))))
        throw Refused{403, "the request comes from another origin"};
      const std::string site = request.get_header_value("Sec-Fetch-Site");
      // Reports are exempt, because the request that reloads a report has no origin.
      if (!site.empty() && site != "same-origin" && site != "none" && !is_report(request.path))
        throw Refused{403, "the request comes from another site"};
      if (!is_known(request.path))
        throw Refused{403,
                      "the URL does not contain the token: open the URL that wheeltap app printed"};
      if (request.method == "POST" && request.get_header_value("Content-Type") != kJson)
        throw Refused{415, "the content must be application/json"};
    } catch (const Refused& refused) {
      refuse(response, refused);
      BoundedServer::close_after_answer();
      return false;
    }
    return true;
  }

  [[nodiscard]] static bool begins_with(const std::string& path, const std::string& token) {
    return same_token(std::string_view(path).substr(0, path.find('/', 1)), "/" + token);
  }
  [[nodiscard]] bool is_report(const std::string& path) const {
    return begins_with(path, report_token_);
  }
  [[nodiscard]] bool is_known(const std::string& path) const {
    return begins_with(path, token_) || is_report(path);
  }

  /// Runs `work` if fewer than kAtWork requests are being handled; converts its exceptions to
  /// responses.
  template <class Work>
  void bounded(Response& response, const Work& work) {
    struct Leave {
      std::counting_semaphore<>& of;
      ~Leave() { of.release(); }
    };
    at_work_.acquire();
    const Leave leave{at_work_};
    try {
      work();
    } catch (const Refused& refused) {
      refuse(response, refused);
    } catch (const Failure& failure) {
      refuse(response, {failure.exit() == Exit::no_input ? 404 : 400, failure.what()});
    } catch (const io::FileError& error) {
      refuse(response, {400, error.what()});
    } catch (const std::invalid_argument& error) {
      refuse(response, {400, error.what()});
    } catch (const Json::exception&) {
      refuse(response, {400, "a value of the request is missing or has another type"});
    } catch (const std::exception& error) {
      refuse(response, {500, error.what()});
    }
  }

  [[nodiscard]] fs::path place(const std::string& name) const {
    if (auto path = folder_.place(name)) return *path;
    throw Refused{
        403, io::printable(name) + ": does not name a file inside the folder of the application"};
  }

  // ------------------------------------------------------------------ GET

  void get(const Request& request, Response& response) {
    bounded(response, [&] {
      const auto slash = request.path.find('/', 1);
      if (slash == std::string::npos) throw Refused{404, "the URL must end with /"};
      const std::string rest = request.path.substr(slash + 1);
      if (is_report(request.path)) return get_report(rest, response);
      if (rest.starts_with("api/")) return get_data(rest.substr(4), request, response);
      if (!send_page_file(rest, response)) throw Refused{404, "there is no such page"};
    });
  }

  /// Sends a report as a page that has no access to anything else.
  void get_report(const std::string& name, Response& response) const {
    const fs::path path = place(name);
    if (path.extension() != ".html") throw Refused{403, "this URL serves reports only"};
    response.set_content(io::read_bytes(path, kLargestResult), "text/html; charset=utf-8");
    response.headers.erase("Content-Security-Policy");
    response.set_header("Content-Security-Policy", kReportPolicy);
  }

  static bool send_page_file(const std::string& name, Response& response) {
    for (const PageFile& file : page_files()) {
      if (name != file.name) continue;
      response.set_content(file.text.data(), file.text.size(), std::string(file.type));
      return true;
    }
    return false;
  }

  static std::string parameter(const Request& request, const char* name) {
    if (!request.has_param(name)) throw Refused{400, std::string(name) + ": is missing"};
    return request.get_param_value(name);
  }

  static long number(const Request& request, const char* name, long otherwise) {
    if (!request.has_param(name)) return otherwise;
    const std::string text = request.get_param_value(name);
    long out = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    if (error != std::errc() || end != text.data() + text.size() || out < 0)
      throw Refused{400, std::string(name) + ": must be a whole number"};
    return out;
  }

  /// A positive number; empty if the request lacks this parameter.
  static std::optional<double> positive(const Request& request, const char* name) {
    if (!request.has_param(name)) return {};
    const std::string text = request.get_param_value(name);
    double out = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    if (error != std::errc() || end != text.data() + text.size() || !(out > 0.0 && out < 1e12))
      throw Refused{400, std::string(name) + ": must be a positive number"};
    return out;
  }

  void get_data(const std::string& what, const Request& request, Response& response) {
    if (what == "projects") return answer(response, projects());
    if (what == "runs") return answer(response, {{"runs", runs_.list()}});
    if (what == "schema") return answer(response, Report(schema(parameter(request, "kind"))));
    if (what == "case") return get_case(parameter(request, "name"), response);
    if (what == "result") return get_result(request, response);
    if (what == "checks") return answer(response, records_.checked(source_of(request)));
    if (what == "record" || what == "window" || what == "spectrum")
      return get_record(what, request, response);
    if (what == "outline") return get_outline(request, response);
    throw Refused{404, "there is no such page"};
  }

  [[nodiscard]] Report projects() const {
    Report out = list_projects(folder_, program_.kinds, runs_);
    Report starters = Report::array();
    for (const StarterCase& s : program_.starters)
      starters.push_back({{"kind", s.kind}, {"structure", s.structure}});
    out["starters"] = starters;
    out["kinds"] = program_.kinds;
    out["sampled"] = program_.sampled;
    out["reports"] = "/" + report_token_ + "/";
    return out;
  }

  void get_case(const std::string& name, Response& response) const {
    const fs::path path = place(name);
    const std::string text = io::read_bytes(path, kLargestBody);
    answer(response, {{"name", name},
                      {"text", text},
                      {"version", io::fingerprint(text)},
                      {"result", folder_.name_of(results_of(path))}});
  }

  void get_result(const Request& request, Response& response) const {
    const std::string file =
        request.has_param("file") ? parameter(request, "file") : "summary.json";
    if (file != "summary.json" && file != "poles.json" && file != "modes.json")
      throw Refused{403, "this URL serves summary.json, poles.json and modes.json only"};
    const fs::path path = place(parameter(request, "name") + "/" + file);
    response.set_content(io::read_bytes(path, kLargestResult), kJson);
  }

  /// The file that a request names. The optional parameter "layout" is an object with the keys of a
  /// record that describe the layout of a table.
  [[nodiscard]] RecordSource source_of(const Request& request) const {
    RecordSource out{.path = place(parameter(request, "name"))};
    if (!request.has_param("layout")) return out;
    const Json stated = parse_answer(request.get_param_value("layout"));
    const auto decimal = stated.find("decimal");
    if (!stated.is_object() ||
        (decimal != stated.end() && *decimal != Json(".") && *decimal != Json(",")))
      throw Refused{400, "layout: must be an object with keys of a record"};
    const CaseFile holder{.path = out.path, .json = {{"record", stated}}};
    out.layout = parse_layout(holder, Pointer("/record"));
    out.arrays = parse_array_layout(holder, Pointer("/record"));
    out.resample = stated.value("resample", false);
    if (out.resample && stated.contains("sample_rate"))
      out.sample_rate_hz = stated.at("sample_rate").get<double>();
    out.stated = stated.dump();
    return out;
  }

  void get_record(const std::string& what, const Request& request, Response& response) {
    const auto file = records_.open(source_of(request));
    if (what == "record") return answer(response, record_contents(*file));
    RecordWindow window{.table = static_cast<std::size_t>(number(request, "table", 0)),
                        .begin = number(request, "begin", 0),
                        .end = number(request, "end", 0),
                        .points = number(request, "points", 1000),
                        .sample_rate_hz = positive(request, "rate")};
    const std::string channels =
        request.has_param("channels") ? request.get_param_value("channels") : "0";
    for (std::size_t at = 0; at <= channels.size();) {
      const std::size_t comma = std::min(channels.find(',', at), channels.size());
      std::size_t channel = 0;
      const auto [end, error] =
          std::from_chars(channels.data() + at, channels.data() + comma, channel);
      if (error != std::errc() || end != channels.data() + comma)
        throw Refused{400, "channels: must be whole numbers separated by commas"};
      window.channels.push_back(channel);
      at = comma + 1;
    }
    answer(response,
           what == "window" ? record_window(*file, window) : record_spectrum(*file, window));
  }

  /// The outline of a section from a file beside a case: [{outline: [[y, z], …], holes: […]}, …].
  void get_outline(const Request& request, Response& response) {
    const std::string file = parameter(request, "file");
    CaseFile holder{.path = case_place(parameter(request, "name")), .json = {}};
    static_cast<void>(
        place(folder_.name_of((holder.path.parent_path() / file).lexically_normal())));
    holder.json["section"] = {{"shape", "polygon"}, {"file", file}};
    if (request.has_param("unit")) holder.json["section"]["unit"] = parameter(request, "unit");
    const std::lock_guard lock(checking_);
    Report regions = Report::array();
    for (const fem::Region& region :
         parse_outline(holder, Pointer("/section"), {.poisson = 0.3}).regions) {
      Report holes = Report::array();
      for (const fem::Ring& hole : region.holes) holes.push_back(corners_of(hole));
      regions.push_back({{"outline", corners_of(region.outer)}, {"holes", holes}});
    }
    answer(response, {{"regions", regions}});
  }

  static Report corners_of(const fem::Ring& ring) {
    Report out = Report::array();
    for (const Eigen::Vector2d& corner : ring) out.push_back({corner.x(), corner.y()});
    return out;
  }

  // ----------------------------------------------------------------- POST

  void post(const Request& request, Response& response, const httplib::ContentReader& reader) {
    const auto body = server_.body_of(reader);
    if (!body)
      return refuse(response, {413, "the request is incomplete or has more than " +
                                        std::to_string(kLargestBody) + " bytes"});
    bounded(response, [&] {
      const std::string prefix = "/" + token_ + "/api/";
      if (!request.path.starts_with(prefix)) throw Refused{404, "there is no such page"};
      const Json asked = parse_answer(*body);
      if (!asked.is_object()) throw Refused{400, "the request is not a JSON object"};
      const std::string what = request.path.substr(prefix.size());
      if (what == "check") return check(asked, response);
      if (what == "save") return save(asked, response);
      if (what == "start") return start(asked, response);
      if (what == "copy") return copy(asked, response);
      if (what == "drawing") return store_drawing(asked, response);
      if (what == "run") return run_case(asked, response);
      if (what == "stop")
        return answer(response, {{"stopped", runs_.stop(asked.at("number").get<int>())}});
      throw Refused{404, "there is no such page"};
    });
  }

  /// The path of a case to be written.
  [[nodiscard]] fs::path case_place(const std::string& name) const {
    const fs::path path = place(name);
    if (path.extension() != ".json")
      throw Refused{400, io::printable(name) + ": the name of a case must end with .json"};
    return path;
  }

  [[nodiscard]] std::optional<CasePlace> fault_of(const fs::path& path, const std::string& text) {
    const std::lock_guard lock(
        checking_);  // one check at a time, because a check may read a record
    return program_.check(path, text,
                          [this](const fs::path& input) { return folder_.contains(input); });
  }

  void check(const Json& asked, Response& response) {
    const auto fault = fault_of(case_place(asked.at("name").get<std::string>()),
                                asked.at("text").get<std::string>());
    Report out = {{"valid", !fault}};
    if (fault) {
      out["pointer"] = fault->pointer;
      out["reason"] = fault->reason;
    }
    answer(response, out);
  }

  /// Writes a case. Replaces neither a file of another type nor a case that has changed meanwhile.
  void save(const Json& asked, Response& response) {
    const std::string name = asked.at("name").get<std::string>();
    const std::string text = asked.at("text").get<std::string>();
    const fs::path path = case_place(name);
    const std::lock_guard lock(saving_);
    if (!asked.contains("before") || asked.at("before").is_null()) {
      if (fs::exists(path)) throw Refused{409, io::printable(name) + ": exists already"};
    } else {
      const std::string now = io::read_bytes(path, kLargestBody);
      if (io::fingerprint(now) != asked.at("before").get<std::string>())
        throw Refused{409,
                      io::printable(name) +
                          ": has changed on the disk since you opened it: copy your text, then "
                          "open the case again"};
      if (!parse_answer(now).is_object() || !parse_answer(now).contains("kind"))
        throw Refused{403, io::printable(name) + ": is not a case"};
    }
    make_output_folder(path.parent_path());
    write_text(path, text);
    answer(response, {{"name", name}, {"version", io::fingerprint(text)}});
  }

  void start(const Json& asked, Response& response) {
    const StarterCase starter{.kind = asked.at("kind").get<std::string>(),
                              .structure = asked.at("structure").get<std::string>()};
    const fs::path made = program_.start(starter, place(asked.at("folder").get<std::string>()));
    answer(response, {{"name", folder_.name_of(made)}});
  }

  /// Copies a case within its folder, so that the paths of its input files remain valid.
  void copy(const Json& asked, Response& response) {
    const std::string to = asked.at("to").get<std::string>();
    const fs::path from = case_place(asked.at("name").get<std::string>()), path = case_place(to);
    if (from.parent_path() != path.parent_path())
      throw Refused{400, "a copy must be in the same folder as the original case"};
    const std::string text = io::read_bytes(from, kLargestBody);
    const std::lock_guard lock(saving_);
    if (fs::exists(path)) throw Refused{409, io::printable(to) + ": exists already"};
    write_text(path, text);
    answer(response, {{"name", to}});
  }

  /// Writes a drawing beside a case, if the program can read the drawing.
  void store_drawing(const Json& asked, Response& response) {
    const std::string file = asked.at("file").get<std::string>();
    const std::string text = asked.at("text").get<std::string>();
    const fs::path beside = case_place(asked.at("case").get<std::string>()).parent_path();
    if (fs::path(file).filename() != file || fs::path(file).extension() != ".dxf")
      throw Refused{400, io::printable(file) + ": the name of a drawing must end with .dxf"};
    const fs::path path = place(folder_.name_of(beside / file));
    static_cast<void>(io::parse_dxf(text, file));
    const std::lock_guard lock(saving_);
    if (fs::exists(path)) {
      if (io::read_bytes(path, kLargestBody) != text)
        throw Refused{409, io::printable(file) +
                               ": another file in this folder has this name: rename the drawing"};
    } else {
      write_text(path, text);
    }
    answer(response, {{"file", file}});
  }

  void run_case(const Json& asked, Response& response) {
    const std::string name = asked.at("name").get<std::string>();
    const fs::path path = case_place(name);
    const std::string text = io::read_bytes(path, kLargestBody);
    if (const auto fault = fault_of(path, text))
      throw Refused{400, fault->pointer + ": " + fault->reason};
    RunRequest run{.command = program_.command(text),
                   .case_name = name,
                   .output_name = folder_.name_of(results_of(path)),
                   .case_path = path,
                   .output = results_of(path),
                   .quick = asked.value("quick", false),
                   .resume = asked.value("resume", false)};
    (void)place(run.output_name);  // throws if the results folder is a link out of the folder
    run.samples = std::ranges::find(program_.sampled, run.command) != program_.sampled.end();
    if (!run.samples && (run.quick || run.resume))
      throw Refused{400, "a " + run.command + " case has neither quick runs nor checkpoints"};
    if (run.command == "modal" && asked.contains("seed"))
      throw Refused{400, "a modal case has no seed"};
    if (asked.contains("seed")) run.seed = asked.at("seed").get<std::uint32_t>();
    const auto number = runs_.add(std::move(run));
    if (!number) throw Refused{409, "this case is running or waiting, or the queue is full"};
    answer(response, {{"number", *number}});
  }

  const AppProgram& program_;
  const AppOptions& options_;
  AppFolder folder_;
  const std::string token_ = random_token(), report_token_ = random_token();
  int port_ = 0;
  RunQueue runs_;
  OpenRecords records_;
  std::mutex checking_, saving_;
  std::counting_semaphore<> at_work_{kAtWork};
  BoundedServer server_{{.connections = kConnections, .body = kLargestBody}};
};

}  // namespace

void serve_application(const AppProgram& program, const AppOptions& options) {
  Application(program, options).run();
}

}  // namespace wheeltap::apps

#else

namespace wheeltap::apps {

void serve_application(const AppProgram& /*program*/, const AppOptions& /*options*/) {
  throw Failure(Exit::usage, "app: this wheeltap was built without cpp-httplib");
}

}  // namespace wheeltap::apps

#endif
