#include "apps/application/project_list.hpp"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/failure.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/formats/formats.hpp"
#include "io/text/text.hpp"
#include "io/text/words.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestListed = std::uintmax_t{4} << 20U;    // bytes of a case
constexpr std::uintmax_t kLargestSummary = std::uintmax_t{64} << 20U;  // bytes of a summary
struct FoundFiles {
  std::vector<fs::path> json = {}, records = {}, drawings = {}, results = {};
  bool truncated = false;
};

/// The JSON object in a file; empty if the file is unreadable, too long, or not a JSON object.
std::optional<Json> object_in(const fs::path& path, std::uintmax_t largest) {
  try {
    Json json = Json::parse(io::read_bytes(path, largest), nullptr, false);
    if (json.is_object()) return json;
  } catch (const io::FileError&) {  // an unreadable file is not a case
  }
  return {};
}

bool is_record(const fs::path& path) {
  const std::string ending = io::lower(path.extension().string());
  return !ending.empty() && std::ranges::any_of(io::formats(), [&](const io::Format& format) {
    return std::ranges::find(format.endings, ending) != format.endings.end();
  });
}

FoundFiles visit(const fs::path& root) {
  FoundFiles out;
  std::error_code error;
  int entries = 0;
  fs::recursive_directory_iterator at(root, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    if (++entries > kMostEntries) {
      out.truncated = true;
      break;
    }
    const fs::path& path = at->path();
    const std::string name = path.filename().string();
    // AppFolder::place() rejects these names.
    const bool is_rejected = name.starts_with('.') || name.find('\\') != std::string::npos;
    if (is_rejected || at.depth() >= kDeepestFolder) {
      at.disable_recursion_pending();
      if (is_rejected) continue;
    }
    std::error_code ignored;
    if (at->is_symlink(ignored) || !at->is_regular_file(ignored) || io::first_unprintable(name))
      continue;
    if (name == "summary.json")
      out.results.push_back(path.parent_path());
    else if (path.extension() == ".json")
      out.json.push_back(path);
    else if (path.extension() == ".dxf")
      out.drawings.push_back(path);
    else if (is_record(path))
      out.records.push_back(path);
  }
  for (auto* list : {&out.json, &out.records, &out.drawings, &out.results})
    std::ranges::sort(*list);
  return out;
}

/// The properties of a result that the list shows.
struct Result {
  fs::path path;
  Json used_case = {};
  Report shown = {};
  std::string state = "done";
};

std::optional<Result> read_result(const AppFolder& folder, const fs::path& path) {
  const auto summary = object_in(path / "summary.json", kLargestSummary);
  const Pointer about("/wheeltap");
  if (!summary || !summary->contains(about) || !summary->at(about).is_object()) return {};
  const Json& run = summary->at(about);
  const auto text = [](const Json& value) {
    return value.is_string() ? io::printable(value.get_ref<const std::string&>()) : std::string();
  };
  Result out{.path = path, .used_case = run.value("case", Json())};
  const Pointer converged("/diagnostics/converged"), alarm("/monitor/alarm"),
      headline("/answer/headline");
  if (summary->contains(converged))
    out.state = summary->at(converged) == true ? "converged" : "not-converged";
  if (summary->contains(alarm) && summary->at(alarm) == true) out.state = "alarm";
  std::string answer;
  if (summary->contains(headline)) answer = text(summary->at(headline));
  const Json all = summary->value("answer", Json());
  if (answer.empty() && all.is_array() && !all.empty()) answer = text(all[0]);
  std::error_code error;
  out.shown = {
      {"name", folder.name_of(path)},
      {"command", text(run.value("command", Json()))},
      {"title", out.used_case.is_object() ? text(out.used_case.value("title", Json())) : ""},
      {"state", out.state},
      {"answer", answer},
      {"report", fs::exists(path / "report.html", error)}};
  return out;
}

bool satisfies_schema(const fs::path& path, const Json& json, const std::string& kind) {
  try {
    CaseFile file{.path = path, .json = json};
    const bool structure = kind == "damage" && json.contains("structure");
    validate_against_schema(file, structure ? "structure" : kind);
    return true;
  } catch (const Failure&) {
    return false;
  }
}

std::string state_of(const fs::path& path, const Json& json, const std::string& kind,
                     const Result* result, const RunQueue& runs) {
  const fs::path output = results_of(path);
  std::error_code error;
  if (runs.is_busy(output)) return "running";
  if (!satisfies_schema(path, json, kind)) return "draft";
  if (fs::exists(output / CheckpointFile::kName, error)) return "interrupted";
  if (result == nullptr) return "ready";
  return result->used_case == json ? result->state : "changed";
}

}  // namespace

fs::path results_of(const fs::path& case_path) {
  return case_path.parent_path() / (case_path.stem().string() + "-results");
}

Report list_projects(const AppFolder& folder, const std::vector<std::string>& kinds,
                     const RunQueue& runs) {
  const FoundFiles found = visit(folder.root());
  std::vector<Result> results;
  for (const fs::path& path : found.results)
    if (auto result = read_result(folder, path)) results.push_back(std::move(*result));
  Report cases = Report::array();
  for (const fs::path& path : found.json) {
    const auto json = object_in(path, kLargestListed);
    if (!json || !json->contains("kind")) continue;
    const auto kind =
        std::ranges::find_if(kinds, [&](const auto& k) { return json->at("kind") == k; });
    if (kind == kinds.end()) continue;
    const Result* own = nullptr;
    for (const Result& result : results)
      if (result.path == results_of(path) || (own == nullptr && result.used_case == *json))
        own = &result;
    const Json title = json->value("title", Json());
    cases.push_back({{"name", folder.name_of(path)},
                     {"kind", *kind},
                     {"title", title.is_string() ? io::printable(title.get<std::string>()) : ""},
                     {"state", state_of(path, *json, *kind, own, runs)},
                     {"result", own != nullptr ? Report(folder.name_of(own->path)) : Report()}});
  }
  Report shown = Report::array(), records = Report::array();
  for (const Result& result : results) shown.push_back(result.shown);
  for (const fs::path& path : found.records) {
    const bool of_run = std::ranges::any_of(
        results, [&](const Result& result) { return result.path == path.parent_path(); });
    std::error_code error;
    if (!of_run)
      records.push_back({{"name", folder.name_of(path)}, {"bytes", fs::file_size(path, error)}});
  }
  Report drawings = Report::array();
  for (const fs::path& path : found.drawings) drawings.push_back({{"name", folder.name_of(path)}});
  return {{"folder", io::printable(folder.root().string())},
          {"truncated", found.truncated},
          {"cases", cases},
          {"results", shown},
          {"records", records},
          {"drawings", drawings}};
}

}  // namespace wheeltap::apps
