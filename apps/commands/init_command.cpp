#include "apps/commands/init_command.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include "apps/cases/monitoring/monitor_simulation.hpp"
#include "apps/cases/sid_case.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/cases/syntax/schema_lists.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/failure.hpp"
#include "apps/nearest.hpp"
#include "apps/results/summary.hpp"
#include "apps/runs/running.hpp"
#include "apps/schema_texts.hpp"
#include "apps/starter_texts.hpp"
#include "identification/sid/sid_simulation.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

std::string starter(const std::string& name) {
  for (const auto& [file, text] : kStarterTexts) {
    if (file == name) return std::string(text);
  }
  return {};
}

// The kinds with a starter case, from the names of the starter files.
std::vector<std::string> starter_kinds() {
  std::vector<std::string> kinds;
  for (const auto& [file, text] : kStarterTexts) {
    const std::string name(file.substr(0, file.find('.')));
    if (file == name + ".json") kinds.push_back(name);
  }
  return kinds;
}

// The structures, other than a beam, for which a kind has a starter.
std::vector<std::string> starter_structures(const std::string& kind) {
  std::vector<std::string> structures;
  for (const auto& [file, text] : kStarterTexts) {
    if (!file.starts_with(kind + ".") || !file.ends_with(".md") || file == kind + ".md") continue;
    structures.emplace_back(file.substr(kind.size() + 1, file.size() - kind.size() - 4));
  }
  return structures;
}

std::string bounds(const Report& rule) {
  std::string text;
  const auto add = [&](const char* key, const char* sign) {
    if (rule.contains(key)) text += (text.empty() ? "" : ", ") + (sign + rule[key].dump());
  };
  add("minimum", "≥ ");
  add("exclusiveMinimum", "> ");
  add("maximum", "≤ ");
  add("exclusiveMaximum", "< ");
  return text;
}

std::string rule_in_words(const Report& rule) {
  std::string text = rule.value("description", std::string());
  if (rule.contains("enum")) {
    std::string list;
    for (const Report& one : rule["enum"]) list += (list.empty() ? "" : ", ") + one.dump();
    // Do not repeat the choices if the description already names them.
    if (text.find(rule["enum"][0].dump()) == std::string::npos) {
      text += (text.empty() ? "" : ": ") + list;
    }
  }
  if (text.empty()) {
    const Report type = rule.value("type", Report("anything"));
    for (const Report& one : type.is_array() ? type : Report::array({type})) {
      text += (text.empty() ? "" : " or ") + one.get<std::string>();
    }
  }
  const std::string limits = bounds(rule);
  return limits.empty() ? text : text + " (" + limits + ")";
}

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    text.replace(at, 1, "\\|");
  }
  return text;
}

class KeyTable {
 public:
  explicit KeyTable(Report root) : root_(std::move(root)) { walk(root_, ""); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  [[nodiscard]] const Report& resolve(const Report& rule) const {
    if (!rule.contains("$ref")) return rule;
    return resolve(root_.at(Report::json_pointer(rule["$ref"].get<std::string>().substr(1))));
  }
  [[nodiscard]] bool is_prior(const Report& rule) const {
    return &rule == &root_.at("definitions").at("prior");
  }
  void row(const std::string& path, bool required, const Report& rule) {
    // If a list of objects may replace one object, list its keys only once.
    std::string bare = path;
    for (std::size_t at = 0; (at = bare.find("[]")) != std::string::npos;) bare.erase(at, 2);
    if (!seen_.insert(bare).second) return;
    const std::string words = is_prior(rule) ? "a prior" : rule_in_words(rule);
    text_ += "| `" + path + "` | " + (required ? "yes" : "") + " | " + cell(words) + " |\n";
  }
  void walk(const Report& reference, const std::string& path) {
    const Report& rule = resolve(reference);
    // Priors are explained above the table; recursive rules are listed once.
    if (is_prior(rule) || !walking_.insert(&rule).second) return;
    walk_into(rule, path);
    walking_.erase(&rule);
  }
  void walk_into(const Report& rule, const std::string& path) {
    for (const Report& one : rule.value("anyOf", Report::array())) walk(one, path);
    const Report required = rule.value("required", Report::array());
    const std::string stem = path.empty() ? "" : path + ".";
    if (rule.contains("properties")) {
      for (const auto& [key, value] : rule["properties"].items()) {
        row(stem + key, std::ranges::find(required, Report(key)) != required.end(), resolve(value));
        walk(value, stem + key);
      }
    }
    if (rule.contains("additionalProperties") && rule["additionalProperties"].is_object()) {
      row(stem + "NAME", false, resolve(rule["additionalProperties"]));
    }
    if (rule.contains("items")) walk(rule["items"], path + "[]");
  }

  Report root_;
  std::set<std::string> seen_;
  std::set<const Report*> walking_;
  std::string text_;
};

// A schema whose keys have the order of the schema file.
Report ordered_schema(const std::string& kind) {
  static_cast<void>(schema(kind));  // throws for other names
  const auto find = [](std::string_view wanted) {
    Report found;
    for (const auto& [name, text] : kSchemaTexts)
      if (name == wanted) found = Report::parse(text);
    return found;
  };
  Report found = find(kind);
  const Report own = found["definitions"];
  for (const std::string& other : definitions_of(kind))
    found["definitions"].update(find(other)["definitions"]);
  found["definitions"].update(own);
  fill_lists(found);
  add_laws(found);
  add_residual_models(found);
  add_defects(found);
  return found;
}

/// Simulates the record that a starter case names. For a sid case, the truth replaces the record's
/// file. Otherwise the truth is a complete sid case, and the record omits the forces.
std::string simulated(const std::string& kind, CaseFile file, Json truth) {
  const bool whole = truth.contains("kind");
  if (whole) {
    file.json = std::move(truth);
  } else {
    file.json["truth"] = std::move(truth);
    file.json["record"].erase("file");
    std::erase_if(file.json["record"]["channels"].get_ref<Json::array_t&>(),
                  [](const Json& channel) { return channel["role"] == "time"; });
  }
  const SidCaseFile parsed = parse_sid_case(std::move(file), SidNeeds::truth);
  signals::Record record = identification::simulate_record(parsed.sid, parsed.sid.truth->seed);
  if (whole)
    std::erase_if(record.columns, [](const io::Column& c) { return c.name.starts_with("force"); });
  return signals::record_csv(record,
                             "simulated by wheeltap init " + kind + ": put your record here");
}

}  // namespace

std::string describe_keys(const std::string& kind) {
  const Report rules = ordered_schema(kind);
  return "## Every key\n\n`[]` stands for each element of a list. A needed key must be given if "
         "its object is given. A prior is " +
         rules["definitions"]["prior"]["description"].get<std::string>().substr(9) +
         ".\n\n| key | needed | meaning |\n|---|---|---|\n" + KeyTable(rules).text() +
         "\n`wheeltap schema " + kind + "` prints these keys as a JSON Schema.\n";
}

namespace {

/// The schema of a starter case. A plan is a damage case of a structure.
std::string schema_of(const std::string& kind, bool beam) {
  return kind == "plan" || !beam ? "structure" : kind;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> starter_cases() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const std::string& kind : starter_kinds()) {
    out.emplace_back(kind, "beam");
    for (const std::string& structure : starter_structures(kind)) out.emplace_back(kind, structure);
  }
  return out;
}

std::vector<fs::path> write_starter(const std::string& kind, const std::string& structure,
                                    const fs::path& folder) {
  const auto kinds = starter_kinds();
  if (std::ranges::find(kinds, kind) == kinds.end()) {
    std::string list;
    for (const auto& name : kinds) list += (list.empty() ? "" : ", ") + name;
    const std::string meant = nearest(kind, kinds);
    throw Failure(Exit::usage, "no starter case with the name \"" + kind + "\"" +
                                   (meant.empty() ? "" : "; did you mean \"" + meant + "\"?") +
                                   " (there are: " + list + ")");
  }
  // Damage cases have several starters: with a beam, and with other structures.
  const bool beam = structure == "beam";
  const auto structures = starter_structures(kind);
  if (!beam && std::ranges::find(structures, structure) == structures.end())
    throw Failure(Exit::usage, "--structure " + structure + ": a " + kind +
                                   " case starts from beam" +
                                   (structures.empty() ? "" : ", " + listed(structures)));
  struct File {
    fs::path path;
    std::string text;
  };
  const std::string stem = beam ? kind : kind + "." + structure;
  const std::string text = starter(stem + ".json");
  std::vector<File> files = {{(folder / (kind + ".json")).lexically_normal(), text},
                             {(folder / (kind + ".md")).lexically_normal(),
                              starter(stem + ".md") + "\n" + describe_keys(schema_of(kind, beam))}};
  // Files in a folder that the case names: KIND.STRUCTURE.FOLDER.NAME.
  for (const auto& [name, content] : kStarterTexts)
    if (!beam && name.starts_with(stem + ".") && name != stem + ".json" && name != stem + ".md") {
      const std::string rest(name.substr(stem.size() + 1));
      const auto dot = rest.find('.');
      files.push_back({(folder / rest.substr(0, dot) / rest.substr(dot + 1)).lexically_normal(),
                       std::string(content)});
    }
  if (const std::string truth = starter(kind + ".truth.json"); !truth.empty()) {
    const std::string record = Json::parse(text)["record"]["file"].get<std::string>();
    files.push_back({(folder / record).lexically_normal(),
                     simulated(kind, {.path = folder / (kind + ".json"), .json = Json::parse(text)},
                               Json::parse(truth))});
  }
  if (kind == "monitor")
    files.push_back(
        {(folder / Json::parse(text)["series"]["file"].get<std::string>()).lexically_normal(),
         simulated_series_csv(1)});
  for (const File& file : files) {
    std::error_code ignored;
    if (fs::exists(file.path, ignored)) {
      throw Failure(
          Exit::cannot_create,
          file.path.string() +
              ": exists already; init does not overwrite files. Choose another folder with -o");
    }
  }
  make_output_folder(folder);
  // Write all files or none: a case does not run without its record.
  std::vector<std::unique_ptr<io::AtomicFile>> written;
  for (const File& file : files) {
    if (file.path.has_parent_path()) make_output_folder(file.path.parent_path());
    written.push_back(std::make_unique<io::AtomicFile>(file.path));
    written.back()->write(file.text);
    written.back()->flush();
  }
  std::vector<fs::path> named;
  try {
    for (const auto& file : written) {
      named.push_back(file->path());
      file->commit();
    }
  } catch (const io::FileError&) {
    std::error_code ignored;
    for (const fs::path& path : named) fs::remove(path, ignored);
    throw;
  }
  return named;
}

void run_init(const std::string& kind, const std::string& structure, const fs::path& folder) {
  const std::vector<fs::path> files = write_starter(kind, structure, folder);
  std::cout << "Written:\n";
  const auto shown = [](const std::filesystem::path& path) { return io::printable(path.string()); };
  for (const fs::path& file : files) std::cout << "  " << shown(file) << '\n';
  std::cout << "Run the case:\n  wheeltap ";
  std::cout << kind << ' ' << shown(files[0]) << " -o "
            << shown((folder / "results").lexically_normal());
  std::cout << "\nThen adapt it: " << shown(files[1]) << " explains every key.\n";
}

Command init_command() {
  struct Starter {
    std::string kind, structure = "beam";
    std::filesystem::path folder = ".";
  };
  const auto starter = std::make_shared<Starter>();
  return {.name = "init",
          .summary = "write a starter case and a description of every key",
          .add_options =
              [starter](CommandOptions& options) {
                CLI::App& app = options.app();
                app.add_option("KIND", starter->kind,
                               "kind of case: damage, sid, update, modal, monitor or plan")
                    ->required();
                app.add_option(
                    "--structure", starter->structure,
                    "structure of a damage case: beam (default), frame, building or matrices");
                app.add_option("-o,--output", starter->folder,
                               "folder for the files (default: the current folder)")
                    ->type_name("FOLDER");
              },
          .run =
              [starter](const Invocation&) {
                run_init(starter->kind, starter->structure, starter->folder);
              }};
}

}  // namespace wheeltap::apps
