#include "apps/cases/outside_case.hpp"

#include <algorithm>
#include <regex>
#include <sstream>

#include "apps/nearest.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

const Pointer kPredictor("/predictor");

/// Splits a text at blanks.
std::vector<std::string> words_of(const Json& command) {
  if (command.is_array()) return command.get<std::vector<std::string>>();
  std::vector<std::string> words;
  std::istringstream text(command.get<std::string>());
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

/// Records the program, and each file whose name in the command contains a folder, as input files,
/// because results depend on them. A program in PATH belongs to the system and is not recorded.
void record_program(const CaseFile& file, CommandSpec& spec) {
  constexpr std::string_view kCase = "{case}";
  for (const std::string& word : spec.words) {
    if (word.find('/') == std::string::npos) continue;
    std::string path = word;
    if (const auto at = path.find(kCase); at != std::string::npos)
      path.replace(at, kCase.size(), spec.folder.string());
    for (InputFiles* files : {file.inputs.get(), &spec.files}) files->add(word, spec.folder / path);
  }
}

CommandSpec parse_command(const CaseFile& file, const Json& p) {
  CommandSpec out{.words = words_of(p.at("command")),
                  .numbers = p.value("format", "json") == "numbers",
                  .folder = std::filesystem::absolute(file.path).parent_path()};
  const auto has = [&](const char* word) {
    return std::ranges::any_of(
        out.words, [&](const std::string& w) { return w.find(word) != std::string::npos; });
  };
  for (const char* place : {"{in}", "{out}"})
    if (!has(place))
      file.refuse(kPredictor / "command",
                  std::string("has no ") + place + ", the file of " +
                      (std::string(place) == "{in}" ? "the parameters" : "the predictions"));
  if (out.words[0].find('{') != std::string::npos && !out.words[0].starts_with("{case}"))
    file.refuse(kPredictor / "command", "must begin with a program");
  record_program(file, out);
  return out;
}

/// Returns HOST of http://HOST:PORT/PATH; an IPv6 address loses its brackets.
std::string host_of(const CaseFile& file, const std::string& url) {
  static const std::regex form(
      R"(http://(?:\[([0-9A-Fa-f:.]+)\]|([A-Za-z0-9._-]+))(?::([0-9]{1,5}))?(?:/[^?#@\s]*)?)");
  std::smatch parts;
  if (!std::regex_match(url, parts, form))
    file.refuse(kPredictor / "umbridge",
                "must be the URL of a server, http://HOST:PORT, with or without a path, like "
                "\"http://localhost:4242\"");
  return parts[1].matched ? parts[1].str() : parts[2].str();
}

UmbridgeSpec parse_umbridge(const CaseFile& file, const Json& p) {
  UmbridgeSpec out{.url = p.at("umbridge").get<std::string>(),
                   .model = p.value("model", ""),
                   .config = p.value("config", Json::object())};
  out.host = host_of(file, out.url);
  return out;
}

OutsideEmulatorSpec parse_front(const Json& e) {
  return {.runs = e.value("runs", 0),
          .holdout = e.value("holdout", 0),
          .sobol = e.value("design", "latin-hypercube") == "sobol",
          .emulator_error = e.value("emulator_error", true),
          .seed = e.value("seed", std::uint64_t{1})};
}

void take_order(const CaseFile& file, const std::vector<std::string>& unknowns, OutsideSpec& out) {
  const Pointer where = kPredictor / "inputs";
  out.names = unknowns;
  if (file.json.contains(where)) out.names = file.json.at(where).get<std::vector<std::string>>();
  for (std::size_t i = 0; i < out.names.size(); ++i) {
    const auto found = std::ranges::find(unknowns, out.names[i]);
    if (found == unknowns.end()) {
      file.refuse(where / i, "no parameter has this name" + did_you_mean(out.names[i], unknowns));
    }
    const auto at = static_cast<int>(found - unknowns.begin());
    if (std::ranges::find(out.order, at) != out.order.end())
      file.refuse(where / i, "is listed twice");
    out.order.push_back(at);
  }
  if (out.order.size() != unknowns.size())
    file.refuse(where, "must name every parameter once: " + listed(unknowns));
}

}  // namespace

bool has_outside_model(const CaseFile& file) {
  if (!file.json.contains(kPredictor) || !file.json.at(kPredictor).is_object()) return false;
  const Json& p = file.json.at(kPredictor);
  return p.contains("umbridge") || p.contains("command");
}

OutsideSpec parse_outside(const CaseFile& file, const std::vector<std::string>& unknowns) {
  const Json& p = file.json.at(kPredictor);
  OutsideSpec out;
  if (p.contains("umbridge") && p.contains("command"))
    file.refuse(kPredictor / "command", "replaces \"umbridge\": give only one of the two keys");
  const auto only = [&](const char* with, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (p.contains(key))
        file.refuse(kPredictor / key, std::string("is allowed with \"") + with + "\"");
  };
  if (p.contains("umbridge")) {
    only("command", {"format"});
    out.umbridge = parse_umbridge(file, p);
  } else {
    only("umbridge", {"model", "config"});
    out.command = parse_command(file, p);
  }
  Patience& patience = out.umbridge ? out.umbridge->patience : out.command->patience;
  patience.timeout_seconds = p.value("timeout", patience.timeout_seconds);
  patience.retries = p.value("retries", patience.retries);
  take_order(file, unknowns, out);
  if (p.contains("emulator") && file.json.value("kind", "") == "update")
    out.emulator = parse_front(p.at("emulator"));
  if (p.contains("memory")) out.memory = file.place_of(p.at("memory").get<std::string>());
  return out;
}

std::string in_words(const OutsideSpec& spec) {
  if (spec.umbridge)
    return (spec.umbridge->model.empty() ? "the model" : "\"" + spec.umbridge->model + "\"") +
           std::string(" of ") + spec.umbridge->url;
  std::string text;
  for (const std::string& word : spec.command->words) text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace wheeltap::apps
