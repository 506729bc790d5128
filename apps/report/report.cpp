#include "apps/report/report.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "apps/failure.hpp"
#include "apps/json_text.hpp"
#include "apps/report/assets.hpp"
#include "apps/report/digest.hpp"
#include "apps/report/modal_page.hpp"
#include "apps/report/monitor_page.hpp"
#include "apps/report/plan_page.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/text/answer.hpp"
#include "base/start_program.hpp"
#include "dynamics/laws.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/read_apart.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

using io::FileError;
namespace fs = std::filesystem;

bool is_modal(const Report& summary) {
  return summary.at("wheeltap").is_object() &&
         summary.at("wheeltap").value("command", Report()) == "modal";
}

/// The page of identified modes; such a run has no posterior.
std::string modes_page(const fs::path& directory, const Report& summary) {
  static_cast<void>(sealed_file(directory, "modes.json", summary));
  const ModesFile modes = read_modes_file(directory / "modes.json");
  try {
    return modal_page(summary, modes);
  } catch (const std::logic_error& error) {
    throw FileError(FileError::Kind::foreign, directory / "summary.json",
                    std::string("is not the summary of a wheeltap run: ") + error.what());
  }
}

bool is_monitor(const Report& summary) {
  return summary.at("wheeltap").is_object() &&
         summary.at("wheeltap").value("command", Report()) == "monitor";
}

/// The page of a monitoring run, from its summary, series.csv and, if it exists, charts.csv.
std::string series_page(const fs::path& directory, const Report& summary) {
  const auto table = sealed_file(directory, "series.csv", summary);
  if (!table) throw FileError(FileError::Kind::missing, directory / "series.csv", "no such file");
  std::optional<std::string> charts;
  if (summary.at("files").contains("charts.csv"))
    charts = sealed_file(directory, "charts.csv", summary);
  try {
    std::optional<io::Columns> compared;
    if (charts) compared = io::parse_delimited_text(*charts, directory / "charts.csv");
    return monitor_page(summary, io::parse_delimited_text(*table, directory / "series.csv"),
                        compared);
  } catch (const std::logic_error& error) {
    throw FileError(FileError::Kind::foreign, directory / "summary.json",
                    std::string("does not have the format of a run's results: ") + error.what());
  }
}

bool is_plan(const Report& summary) {
  return summary.at("wheeltap").is_object() &&
         summary.at("wheeltap").value("command", Report()) == "plan";
}

/// The page of a plan, from its summary.
std::string design_page(const fs::path& directory, const Report& summary) {
  try {
    return plan_page(summary);
  } catch (const std::logic_error& error) {
    throw FileError(FileError::Kind::foreign, directory / "summary.json",
                    std::string("does not have the format of a plan's results: ") + error.what());
  }
}

/// True if the page needs no scripts.
bool is_plain(const Report& summary) {
  return is_modal(summary) || is_monitor(summary) || is_plan(summary);
}

Report read_summary(const fs::path& directory) {
  const fs::path path = directory / "summary.json";
  const std::string text = io::read_bytes(path);
  Report summary;
  try {
    summary = parse_json<Report>(path, text);
  } catch (const Failure& failure) {
    throw FileError(FileError::Kind::corrupt, path,
                    std::string("is truncated or not JSON: ") + failure.what());
  }
  const auto lacks = [&](const std::string& what) {
    throw FileError(FileError::Kind::foreign, path,
                    "has no " + what + ": not the summary of a wheeltap run");
  };
  // Charts have one bin per element. Beams of valid cases have far fewer elements.
  constexpr double kMostElements = 1e5;
  const bool sweep = summary.is_object() && summary.contains("sweep");
  const auto need = [&](const std::string& key, Report::value_t type) {
    if (!summary.is_object() || !summary.contains(key)) lacks('"' + key + '"');
    if (summary[key].type() != type || summary[key].empty()) lacks("usable \"" + key + '"');
  };
  using enum Report::value_t;
  need("wheeltap", object);
  if (!summary.at("wheeltap").contains("case")) lacks("\"wheeltap\".\"case\"");
  if (is_plain(summary)) {
    need("diagnostics", object);
    return summary;
  }
  if (sweep) {
    need("sweep", object);
    if (const auto rows = summary["sweep"].find("rows");
        rows == summary["sweep"].end() || !rows->is_array() || rows->empty()) {
      lacks("\"rows\" of a sweep");
    }
    return summary;
  }
  need("models", array);
  need("diagnostics", object);
  if (!summary.contains("parameters") || !summary.at("parameters").is_object()) {
    lacks("usable \"parameters\"");
  }
  for (const auto& [model, table] : summary.at("parameters").items()) {
    if (!table.is_object()) lacks("table of parameters of \"" + model + '"');
  }
  for (const auto& model : summary.at("models")) {
    if (!model.is_object() || !model.contains("name") || !model.at("name").is_string() ||
        !model.contains("probability") || !model.at("probability").is_number()) {
      lacks("name and probability of a model");
    }
  }
  if (summary.at("wheeltap").value("command", "") == "damage") {
    const bool beam = !summary.contains("structure");
    need(beam ? "beam" : "structure", object);
    need("damage", object);
    const double elements = beam ? summary["beam"].value("elements", 1.0) : 1.0;
    if (!(elements >= 1.0 && elements <= kMostElements)) lacks("number of elements of a beam");
    need("kinds", array);
  }
  return summary;
}

// Sentences on models whose probability does not come from draws.
Report told(const Report& models, const std::string& before) {
  Report out = Report::array();
  for (const auto& model : models) {
    const auto text = model.value("told", std::string());
    if (!text.empty())
      out.push_back(before + model.at("name").get<std::string>() + ": " + text + ".");
  }
  return out;
}

// The coefficients of every force law: {"contact": [{"name": "stiffness", "unit": "N/m"}, …], …}.
Report laws() {
  Report out = Report::object();
  for (const dynamics::LawInfo& law : dynamics::law_infos()) {
    Report& list = out[std::string(law.name)] = Report::array();
    for (int i = 0; i < law.size(); ++i) {
      const auto& coefficient = law.coefficients[static_cast<std::size_t>(i)];
      list.push_back(
          {{"name", std::string(coefficient.name)}, {"unit", std::string(coefficient.unit)}});
    }
  }
  return out;
}

// The data of the scripts: the summary, the digest of the draws, and the answer.
Report content(const Report& summary, const Answer& said, const io::NetcdfReader* draws) {
  Report out = {{"summary", summary}, {"answer", json(said)}};
  if (summary.contains("sweep")) {  // the runs of a sweep store no draws
    const auto path = summary.at("sweep").at("path").get<std::string>();
    out["told"] = Report::array();
    for (const auto& row : summary.at("sweep").at("rows")) {
      for (auto& text : told(row.at("models"), path + " = " + row.at("value").dump() + ", ")) {
        out["told"].push_back(std::move(text));
      }
    }
    return out;
  }
  out["told"] = told(summary.at("models"), "");
  if (summary.at("wheeltap").value("command", "") == "sid") out["laws"] = laws();
  out["resolution"] = summary.at("diagnostics").value("resolution_words", "");
  out["draws"] = draws != nullptr ? digest(*draws, summary) : Report::object();
  return out;
}

/// Opens posterior.nc of the run; null if the run has none.
std::unique_ptr<const io::NetcdfReader> stored_draws(const fs::path& directory,
                                                     const Report& summary) {
  if (summary.contains("sweep") || !is_sealed(directory, "posterior.nc", summary)) return nullptr;
  const fs::path path = directory / "posterior.nc";
  if (!summary.contains("files"))  // the summary has no checksums
    io::check_apart(path, [&] { (void)digest(*read_posterior(path, path), summary); });
  return read_posterior(path, path);
}

// Text as HTML, without line breaks between numbers and their units.
std::string prose(const std::string& text) {
  std::string out = html_text(text);
  for (const std::string sign : {"&lt; ", "&gt; "}) {
    for (std::size_t at = 0; (at = out.find(sign, at)) != std::string::npos; at += sign.size()) {
      out.replace(at + sign.size() - 1, 1, "&nbsp;");
    }
  }
  for (const std::string unit : {" %", " m "}) {
    for (std::size_t at = 0; (at = out.find(unit, at)) != std::string::npos; at += 6) {
      out.replace(at, 1, "&nbsp;");
    }
  }
  // Insert word joiners to prevent a line break within "4.6e-6".
  for (std::size_t at = 1; (at = out.find("e-", at)) != std::string::npos; at += 2) {
    const auto digit = [&](std::size_t i) {
      return i < out.size() && std::isdigit(static_cast<unsigned char>(out[i])) != 0;
    };
    if (digit(at - 1) && digit(at + 2)) out.replace(at, 2, "e\u2060-\u2060");
  }
  return out;
}

// `text` with each {{key}} replaced, in one pass: inserted values are not searched for keys.
std::string fill_page(std::string_view text,
                      const std::vector<std::pair<std::string_view, std::string_view>>& values) {
  std::string out;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find("{{", at);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find("}}", open);
    const std::string_view key = text.substr(open + 2, close - open - 2);
    out += text.substr(at, open - at);
    for (const auto& [name, value] : values) {
      if (name == key) out += value;
    }
    at = close + 2;
  }
  return out += text.substr(at);
}

/// Calls work(), which reads a summary that a user may have edited; converts JSON errors to
/// io::FileError (foreign).
template <class Work>
auto trusting(const fs::path& directory, const Work& work) {
  try {
    return work();
  } catch (const nlohmann::json::exception& error) {
    throw FileError(FileError::Kind::foreign, directory / "summary.json",
                    std::string("is not the summary of a wheeltap run: ") + error.what());
  }
}

std::string title_of(const Report& summary) {
  const std::string title =
      summary.value("title", summary.at("wheeltap").at("case").value("title", ""));
  return title.empty() ? "Untitled run" : title;
}

}  // namespace

std::string script_safe(const Report& json) {
  // U+FFFD replaces bytes that are not UTF-8.
  const std::string text = json.dump(-1, ' ', false, Report::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '<') {
      out += "\\u003c";
    } else if (text.compare(i, 3, "\xe2\x80\xa8") == 0 || text.compare(i, 3, "\xe2\x80\xa9") == 0) {
      out += text[i + 2] == '\xa8' ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&'    ? "&amp;"
           : c == '<'  ? "&lt;"
           : c == '>'  ? "&gt;"
           : c == '"'  ? "&quot;"
           : c == '\'' ? "&#39;"
                       : std::string(1, c);
  return out;
}

namespace {

std::string page_of(const Report& summary, const io::NetcdfReader* draws) {
  const Answer said = read_answer(summary);
  const std::string data = script_safe(content(summary, said, draws));
  const std::string title = html_text(title_of(summary));
  const std::string caution =
      said.caution.empty() ? "" : "<p class=\"caution\">" + prose(said.caution) + "</p>";
  const std::string detail =
      said.detail.empty() ? "" : "<p class=\"detail\">" + prose(said.detail) + "</p>";
  const std::string headline = prose(said.headline);
  const std::string licences = html_text(std::string(assets::kLicences));
  return fill_page(assets::kTemplate, {{"title", title},
                                       {"caution", caution},
                                       {"misfit", said.misfit ? " misfit" : ""},
                                       {"headline", headline},
                                       {"detail", detail},
                                       {"style", assets::kStyle},
                                       {"data", data},
                                       {"vega", assets::kVega},
                                       {"charts", assets::kCharts},
                                       {"page", assets::kPage},
                                       {"licences", licences}});
}

}  // namespace

std::string report_page(const fs::path& directory, const Report& summary,
                        const io::NetcdfReader* draws) {
  return trusting(directory, [&] { return page_of(summary, draws); });
}

void write_report(const fs::path& directory) {
  io::finish_commit(directory);
  const Report summary = trusting(directory, [&] { return read_summary(directory); });
  const std::string page = trusting(directory, [&] {
    if (is_modal(summary)) return modes_page(directory, summary);
    if (is_monitor(summary)) return series_page(directory, summary);
    if (is_plan(summary)) return design_page(directory, summary);
    return page_of(summary, stored_draws(directory, summary).get());
  });
  io::AtomicFile file(directory / "report.html");
  file.write(page);
  file.commit();
}

namespace {

constexpr const char* kFigureList = "figures.txt";

/// A new private folder; the destructor removes it with its contents.
class Scratch {
 public:
  explicit Scratch(const fs::path& in) {
    std::string name = (in / ".figures-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw FileError(FileError::Kind::unwritable, in, std::generic_category().message(errno));
    folder_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

void make_figures_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_symlink(fs::symlink_status(folder, error)))
    throw FileError(FileError::Kind::unwritable, folder,
                    "is a symbolic link, which Wheeltap does not follow: remove it");
  fs::create_directories(folder, error);
  if (error) throw FileError(FileError::Kind::unwritable, folder, error.message());
}

/// Copies a file; replaces an existing file or symbolic link with this name.
void put_file(const fs::path& from, const fs::path& to) {
  io::AtomicFile file(to);
  file.write(io::read_bytes(from));
  file.commit();
}

}  // namespace

int write_figures(const fs::path& directory) {
  const Report data = trusting(directory, [&] {
    const Report summary = read_summary(directory);
    if (is_plain(summary))
      throw Failure(Exit::usage,
                    "--figures: the figures of this report are SVG in report.html itself");
    return content(summary, {}, stored_draws(directory, summary).get());
  });
  const fs::path folder = directory / "figures";
  const Scratch scratch(directory);
  const fs::path script = scratch.folder() / "script.js";
  std::ofstream file(script, std::ios::binary);
  file << assets::kVega << assets::kCharts << "const run = " << script_safe(data) << ";\n"
       << assets::kFigures;
  file.close();
  const int input = open(script.c_str(), O_RDONLY | O_CLOEXEC);
  const pid_t node = base::start_program({.file = "node",
                                          .words = {"node", "-"},
                                          .directory = scratch.folder().string(),
                                          .input = input,
                                          .output = STDOUT_FILENO,
                                          .error = STDERR_FILENO});
  close(input);
  if (node < 0) throw Failure(Exit::internal, "cannot start a process for node");
  const int status = base::wait_for(node);
  std::ifstream written(scratch.folder() / kFigureList);
  if (status != 0 || !written) {
    throw Failure(Exit::no_input,
                  "figures need Node.js: `node` is missing or could not draw them. Every figure of "
                  "report.html can also be saved from the page.");
  }
  std::vector<std::string> names;
  for (std::string line; std::getline(written, line);) names.push_back(line);
  make_figures_folder(folder);
  for (const std::string& name : names) put_file(scratch.folder() / name, folder / name);
  put_file(scratch.folder() / kFigureList, folder / kFigureList);
  return static_cast<int>(names.size());
}

}  // namespace wheeltap::apps
