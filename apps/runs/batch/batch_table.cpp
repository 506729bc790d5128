#include "apps/runs/batch/batch_table.hpp"

#include <algorithm>
#include <limits>

#include "apps/results/stored_run.hpp"
#include "apps/words.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

/// Makes a cell safe: spreadsheets evaluate cells with these first characters as formulas, and
/// names and messages may come from untrusted sources.
std::string inert(const std::string& cell) {
  constexpr std::string_view kFormula = "=+-@\t\r";
  const bool formula = !cell.empty() && kFormula.find(cell[0]) != std::string_view::npos;
  return formula && !io::parse_number(cell) ? "'" + cell : cell;
}

std::string csv_quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string text = "\"";
  for (const char c : cell) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

const Report* entry_at(const Report& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const Report* entry_at(const Report& object, const char* first, const char* second) {
  const Report* inner = entry_at(object, first);
  return inner ? entry_at(*inner, second) : nullptr;
}

std::optional<double> cell_number(const Report* value) {
  if (value == nullptr || !value->is_number()) return {};
  return value->get<double>();
}

std::optional<bool> truth(const Report* value) {
  if (value == nullptr || !value->is_boolean()) return {};
  return value->get<bool>();
}

void take_models(const Report& models, BatchRow& row) {
  if (!models.is_array()) return;
  double most = -std::numeric_limits<double>::infinity();
  for (const Report& model : models) {
    const auto p = cell_number(entry_at(model, "probability"));
    const Report* name = entry_at(model, "name");
    if (!p || !(*p > most) || name == nullptr || !name->is_string()) continue;
    most = *p;
    row.model = name->get<std::string>();
    row.probability = most;
  }
}

/// Fills the columns for a modal identification: "7 modes (1 doubtful)".
void take_mode_columns(const Report& modes, BatchRow& row) {
  if (!modes.is_array()) return;
  const auto doubtful = std::ranges::count_if(modes, [](const Report& mode) {
    const Report* doubts = entry_at(mode, "doubts");
    return doubts != nullptr && !doubts->empty();
  });
  row.model = std::to_string(modes.size()) + (modes.size() == 1 ? " mode" : " modes");
  if (doubtful > 0) row.model += " (" + std::to_string(doubtful) + " doubtful)";
}

void take_sweep(const Report& rows, BatchRow& row) {
  if (!rows.is_array()) return;
  row.seconds = 0.0;
  row.converged = true;
  for (const Report& one : rows) {
    row.seconds += cell_number(entry_at(one, "cost", "wall_seconds")).value_or(0.0);
    if (!truth(entry_at(one, "converged")).value_or(false)) row.converged = false;
  }
}

}  // namespace

void take_from_summary(const std::filesystem::path& folder, BatchRow& row) {
  const std::optional<Report> summary = stored_summary(folder);
  if (!summary) return;
  if (const Report* rows = entry_at(*summary, "sweep", "rows")) return take_sweep(*rows, row);
  if (const Report* models = entry_at(*summary, "models")) take_models(*models, row);
  if (const Report* modes = entry_at(*summary, "modes")) take_mode_columns(*modes, row);
  row.converged = truth(entry_at(*summary, "diagnostics", "converged"));
  row.seconds = cell_number(entry_at(*summary, "cost", "wall_seconds")).value_or(row.seconds);
}

bool stopped_early(const std::filesystem::path& folder) {
  const std::optional<Report> summary = stored_summary(folder);
  return summary && truth(entry_at(*summary, "diagnostics", "stopped_early")).value_or(false);
}

std::string batch_csv(const std::vector<std::optional<BatchRow>>& rows) {
  std::string text = "case,kind,exit,model,probability,converged,wall_seconds,folder,error,path\n";
  for (const auto& row : rows) {
    if (!row) continue;
    const std::string converged = row->converged ? (*row->converged ? "1" : "0") : "";
    const std::string probability = row->probability ? significant(*row->probability, 8) : "";
    const std::string cells[] = {row->name,   row->kind, std::to_string(row->exit),    row->model,
                                 probability, converged, significant(row->seconds, 4), row->name,
                                 row->error,  row->path};
    const char* between = "";
    for (const std::string& cell : cells) {
      text += between + csv_quoted(inert(cell));
      between = ",";
    }
    text += '\n';
  }
  return text;
}

std::string batch_json(const std::vector<std::optional<BatchRow>>& rows) {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? Report() : Report(text);
  };
  Report list = Report::array();
  for (const auto& row : rows) {
    if (!row) continue;
    list.push_back({{"case", row->name},
                    {"kind", text_or_null(row->kind)},
                    {"exit", row->exit},
                    {"model", text_or_null(row->model)},
                    {"probability", row->probability ? Report(*row->probability) : Report()},
                    {"converged", row->converged ? Report(*row->converged) : Report()},
                    {"wall_seconds", row->seconds},
                    {"folder", row->name},
                    {"error", text_or_null(row->error)}});
  }
  return list.dump(1, ' ', false, Report::error_handler_t::replace);
}

std::string batch_line(const BatchRow& row, std::size_t done, std::size_t all) {
  const std::string total = std::to_string(all);
  std::string count = std::to_string(done);
  count.insert(0, total.size() - std::min(count.size(), total.size()), ' ');
  std::string text = "[" + count + "/" + total + "] " + io::printable(row.name) + "  ";
  if (row.exit != 0) return text + "FAILED (" + std::to_string(row.exit) + "): " + row.error;
  if (row.probability)
    text += io::printable(row.model) + ", " + probability_is(*row.probability) + "  ";
  else if (!row.model.empty())
    text += io::printable(row.model) + "  ";
  if (row.converged) text += *row.converged ? "converged  " : "NOT CONVERGED  ";
  return text + duration(row.seconds);
}

}  // namespace wheeltap::apps
