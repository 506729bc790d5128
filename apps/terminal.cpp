#include "apps/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numeric>

#include "apps/report/answer.hpp"

namespace wheeltap::apps {
namespace {

constexpr int kWidth = 76;
constexpr double kWorthTelling = 0.05;

struct Style {
  bool colour;
  [[nodiscard]] std::string bold(const std::string& text) const {
    return colour ? "\x1b[1m" + text + "\x1b[0m" : text;
  }
  [[nodiscard]] std::string warn(const std::string& text) const {
    return colour ? "\x1b[33m" + text + "\x1b[0m" : text;
  }
};

// Characters, not bytes, of UTF-8 text.
std::size_t columns(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string pad_right(const std::string& text, std::size_t width) {
  const std::size_t n = columns(text);
  return n < width ? text + std::string(width - n, ' ') : text;
}

std::string pad_left(const std::string& text, std::size_t width) {
  const std::size_t n = columns(text);
  return n < width ? std::string(width - n, ' ') + text : text;
}

std::string repeated(const std::string& glyph, int n) {
  std::string text;
  for (int i = 0; i < n; ++i) text += glyph;
  return text;
}

// A bar of eighths of a character.
std::string bar(double fraction, int width) {
  static const char* parts[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * width * 8));
  return repeated("█", eighths / 8) + parts[eighths % 8];
}

// Text broken at spaces, further lines indented.
void print_wrapped(std::ostream& out, const std::string& text, const std::string& first,
                   const std::string& further) {
  std::string line = first;
  std::size_t used = columns(first);
  bool fresh = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!fresh && used + 1 + columns(word) > static_cast<std::size_t>(kWidth)) {
      out << line << '\n';
      line = further;
      used = columns(further);
      fresh = true;
    }
    line += (fresh ? "" : " ") + word;
    used += columns(word) + (fresh ? 0 : 1);
    fresh = false;
    at = end + 1;
  }
  out << line << '\n';
}

// Rows of cells, the first column left-aligned, all others right-aligned.
void print_table(std::ostream& out, const std::vector<std::vector<std::string>>& rows,
                 const Style& style) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], columns(row[c]));
  }
  bool header = true;
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      line += c == 0 ? pad_right(row[c], widths[c]) : "   " + pad_left(row[c], widths[c]);
    }
    out << (header ? style.bold(line) : line) << '\n';
    header = false;
  }
}

std::string number(const Report& value, int digits) {
  return value.is_number() ? significant(value.get<double>(), digits) : "-";
}

std::string interval(const Report& s, const std::function<std::string(double)>& text) {
  return text(s["q2.5"]) + " to " + text(s["q97.5"]);
}

std::string metres(double x) {
  return fixed(x, 3);
}

// A severity with its unit, from the kind's own report.
std::string severity_text(const Report& kind, double x) {
  if (kind["severity"] == "reduction") return fixed(100.0 * x, 0) + " %";
  return significant(x, 3) + " " + kind["unit"].get<std::string>();
}

// "location[1]" → {"location", "1"}, prefix of the kind kept.
struct Slot {
  std::string base, index;
};
Slot split_label(const std::string& label) {
  const auto bracket = label.find('[');
  if (bracket == std::string::npos) return {label, ""};
  return {label.substr(0, bracket), label.substr(bracket + 1, label.size() - bracket - 2)};
}

const Report* find_kind(const Report& summary, const std::string& label) {
  const auto& kinds = summary["kinds"];
  if (kinds.size() == 1) return &kinds[0];
  for (const auto& kind : kinds) {
    if (label.starts_with(kind["name"].get<std::string>() + " ")) return &kind;
  }
  return nullptr;
}

// One line a defect, from the plain or the folded parameter table of a model.
void print_defects(std::ostream& out, const Report& summary, const Report& table, bool folded,
                   const Style& style) {
  const double length = summary["beam"]["length"];
  std::vector<std::vector<std::string>> rows;
  std::string severity_heading;
  for (const auto& [label, s] : table.items()) {
    const Slot slot = split_label(label);
    if (slot.index.empty() || !slot.base.ends_with("location")) continue;
    const Report* kind = find_kind(summary, label);
    const std::string name = kind != nullptr ? (*kind)["name"].get<std::string>() : "defect";
    const double at = s["q50"];
    std::vector<std::string> row = {name + " " + slot.index, metres(at) + " m"};
    if (folded) row.push_back(metres(length - at) + " m");
    row.push_back(interval(s, metres) + " m");
    if (kind != nullptr && (*kind)["severity"].is_string()) {
      const std::string severity = (*kind)["severity"];
      const std::string prefix = slot.base.substr(0, slot.base.size() - 8);
      for (const std::string& key :
           {prefix + severity + "[" + slot.index + "]", severity + "[" + slot.index + "]"}) {
        if (!table.contains(key)) continue;
        const auto text = [&](double x) { return severity_text(*kind, x); };
        row.push_back(text(table[key]["q50"]));
        row.push_back(interval(table[key], text));
        const std::string heading = severity == "reduction" ? "stiffness lost" : severity;
        severity_heading =
            severity_heading.empty() || severity_heading == heading ? heading : "severity";
        break;
      }
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return;
  std::vector<std::string> header = {"", "location"};
  if (folded) header.emplace_back("or its mirror");
  header.emplace_back("95 % interval");
  if (!severity_heading.empty()) {
    header.push_back(severity_heading);
    header.emplace_back("95 % interval");
  }
  rows.insert(rows.begin(), header);
  print_table(out, rows, style);
}

// One bar a model.
void print_models(std::ostream& out, const Report& models) {
  std::size_t widest = 0;
  for (const auto& m : models) widest = std::max(widest, columns(m["name"]));
  for (const auto& m : models) {
    const double p = m["probability"];
    const bool known = m["mcse"].is_number();
    // Beside "< 0.1 %" an error of 1e-24 % would only puzzle; the line below has the number.
    const bool with_error = known && !(m.value("basis", std::string()) == "evidence" && p < 0.001);
    out << "  " << pad_right(m["name"], widest) << "  " << pad_left(known ? percent(p) : "?", 8)
        << (with_error
                ? " ± " + pad_right(significant(100.0 * m["mcse"].get<double>(), 2) + " %", 9)
                : std::string(12, ' '))
        << ' ' << bar(p, 30) << '\n';
    if (const std::string told = told_by_evidence(m); !told.empty()) {
      print_wrapped(out, told, "    ", "    ");
    }
  }
  out << "  (± is the Monte Carlo error of this run; a priori";
  for (std::size_t i = 0; i < models.size(); ++i) {
    out << (i > 0 ? ", " : " ") << percent(models[i]["prior"]);
  }
  out << ")\n";
}

// Warnings, cost and convergence; `what` the models count.
void print_closing(std::ostream& out, const Report& summary, const std::string& what,
                   const Style& style) {
  const auto& diagnosed = summary["diagnostics"];
  const auto& warnings = diagnosed["warnings"];
  if (!warnings.empty()) out << '\n' << style.bold("What to keep in mind") << '\n';
  for (const auto& w : warnings) {
    print_wrapped(out, w.get<std::string>(), style.warn("! "), "  ");
  }

  const auto& cost = summary["cost"];
  out << '\n'
      << cost["chains"] << (cost["chains"] == 1 ? " chain of " : " chains of ")
      << cost["draws_a_chain"] << " draws in " << significant(cost["wall_seconds"], 2)
      << " s; effective sample size of the " << what << ' '
      << (diagnosed["ess_model"].is_number() ? rounded_count(diagnosed["ess_model"]) : "-")
      << ", largest R-hat "
      << (diagnosed["rhat_max"].is_number() ? fixed(diagnosed["rhat_max"], 4) : "-") << ".\n";
  if (const std::string resolution = resolution_in_words(diagnosed); !resolution.empty()) {
    print_wrapped(out, "Resolution: " + resolution + " (--search).", "", "  ");
  }
  const Report ladder = diagnosed.value("ladder", Report::object());
  if (ladder.value("while_drawing", false)) {
    out << "The draws were tempered: " << ladder["round_trips"]
        << " round trips between prior and posterior.\n";
  }
  out << (diagnosed["converged"].get<bool>()
              ? "Converged."
              : style.warn(diagnosed.value("not_established", Report::array()).size() > 1
                               ? "NOT CONVERGED: see the first points above."
                               : "NOT CONVERGED: see the first point above."))
      << '\n';
}

// The answer in two sentences, before any number.
void print_answer(std::ostream& out, const Report& summary, const Style& style) {
  const Answer said = answer(summary);
  out << '\n';
  if (!said.caution.empty()) print_wrapped(out, said.caution, style.warn("! "), "  ");
  print_wrapped(out, said.headline, "", "");
  if (!said.detail.empty()) print_wrapped(out, said.detail, "", "");
}

std::string support_glyph(const Report& s) {
  const bool deflection = s["deflection"], rotation = s["rotation"];
  if (!s["stiffness"].is_string()) return "≀";
  if (deflection && rotation) return "█";
  return deflection ? "▲" : "◆";
}

void print_evidence(std::ostream& out, const Report& summary, const Style& style) {
  if (!summary.contains("evidence")) return;
  for (const auto& [method, rows] : summary["evidence"].items()) {
    out << '\n' << style.bold("Evidence by " + method) << '\n';
    std::vector<std::vector<std::string>> table = {{"model", "ln Z", "±", "P(model)", "±"}};
    for (const auto& row : rows) {
      table.push_back(
          {row["model"],
           row["log_evidence"].is_number() ? fixed(row["log_evidence"], 3) : std::string("-"),
           number(row["standard_error"], 2), number(row["probability"], 4),
           number(row["probability_error"], 2)});
    }
    print_table(out, table, style);
  }
}

}  // namespace

bool colour_wanted() {
  return isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
}

std::string draw_beam(const Report& beam, const std::vector<double>& inclusion, int width) {
  static const char* levels[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const double length = beam["length"];
  const auto n = static_cast<int>(inclusion.size());
  std::vector<double> density(static_cast<std::size_t>(width));
  // Each element spreads its expected number evenly over the columns it covers.
  for (int e = 0; e < n; ++e) {
    const double from = static_cast<double>(e) * width / n, to = (e + 1.0) * width / n;
    for (int c = static_cast<int>(from); c < width && c < to; ++c) {
      const double overlap = std::min(to, c + 1.0) - std::max(from, static_cast<double>(c));
      density[static_cast<std::size_t>(c)] +=
          inclusion[static_cast<std::size_t>(e)] * overlap / (to - from);
    }
  }
  const double peak = *std::ranges::max_element(density);
  std::string top, supports;
  std::vector<std::string> feet(static_cast<std::size_t>(width), " ");
  for (const double d : density) {
    const double share = peak > 0.0 ? d / peak : 0.0;
    const int level = share > 0.01 ? std::clamp(static_cast<int>(std::ceil(share * 8.0)), 1, 8) : 0;
    top += levels[level];
  }
  for (const auto& s : beam["supports"]) {
    const double at = s["at"].get<double>() / length * (width - 1);
    feet[static_cast<std::size_t>(std::lround(at))] = support_glyph(s);
  }
  for (const auto& f : feet) supports += f;
  std::string scale(static_cast<std::size_t>(width), ' ');
  std::string text = "  " + top + "\n  " + repeated("━", width) + "\n  " + supports + "\n  ";
  const std::string left = "0", middle = significant(0.5 * length, 3),
                    right = significant(length, 4) + " m";
  const auto w = static_cast<std::size_t>(width);
  std::string labels = left;
  labels = pad_right(labels, w / 2 - middle.size() / 2) + middle;
  labels = pad_right(labels, w - right.size()) + right;
  return text + labels + "\n";
}

void print_emulator(std::ostream& out, const Report& emulator, bool colour, bool in_full) {
  const Style style{colour};
  for (const auto& [count, table] : emulator["counts"].items()) {
    const std::string damages = count + (count == "1" ? " damage" : " damages");
    std::string worst;
    if (table.contains("worst")) {
      const auto& w = table["worst"];
      worst = "RMSE up to " + number(w["rmse_to_noise"], 2) + " of the noise (mode " +
              w["mode"].dump() + "), single errors up to " + number(w["largest_to_noise"], 2);
    }
    if (!in_full) {
      print_wrapped(out,
                    "Emulator for " + damages + ": " + table["kind"].get<std::string>() + " (" +
                        table["runs"].dump() + " FE runs)" + (worst.empty() ? "" : "; " + worst) +
                        ".",
                    "", "  ");
      continue;
    }
    out << "\nEmulator for " << damages << " (" << table["runs"] << " FE runs), "
        << table["kind"].get<std::string>() << "; error on fresh FE runs:\n";
    const bool one_out = table["modes"][0].contains("leave_one_out");
    std::vector<std::vector<std::string>> rows = {{"mode", "RMSE [Hz]", "largest [Hz]",
                                                   "RMSE / effect", "Q2", "noise sd [Hz]",
                                                   "RMSE / noise", "z rms"}};
    if (one_out) rows[0].emplace_back("left one out [Hz]");
    for (const auto& m : table["modes"]) {
      const bool noisy = m["noise"].is_number();
      rows.push_back(
          {m["mode"].dump(), number(m["rmse"], 3), number(m["max_error"], 3),
           number(m["relative_rmse"], 2), number(m["q2"], 3), number(m["noise"], 3),
           noisy ? significant(m["rmse"].get<double>() / m["noise"].get<double>(), 2)
                 : std::string("-"),
           m.contains("standardised") ? number(m["standardised"]["rms"], 2) : std::string("-")});
      if (one_out) rows.back().push_back(number(m["leave_one_out"], 3));
    }
    print_table(out, rows, style);
    if (!worst.empty()) out << "  " << worst << ".\n";
    if (table["warning"].is_string()) {
      print_wrapped(out, table["warning"].get<std::string>(), style.warn("! "), "  ");
    }
  }
}

// What predicted, and how far that can be trusted.
void print_predictor(std::ostream& out, const Report& summary, const Style& style) {
  if (!summary.contains("emulator")) return;
  const auto& e = summary["emulator"];
  out << '\n' << style.bold("Predictor") << '\n';
  print_emulator(out, e, false, false);
  const auto& calls = e["full_model_calls"];
  if (e["exact"].get<bool>()) {
    print_wrapped(out,
                  "It screened proposals only: the posterior is the FE solution's. The FE was "
                  "called " +
                      rounded_count(calls["likelihood"]) + " times, the emulator " +
                      rounded_count(summary["cost"]["likelihood_evaluations"]) + " times.",
                  "", "  ");
    return;
  }
  print_wrapped(
      out,
      std::string("Its error is ") +
          (e["error_in_likelihood"].get<bool>() ? "part of" : "NOT part of") + " the likelihood" +
          (summary["data"].contains("discrepancy_cov")
               ? ", and so is a discrepancy of " +
                     significant(100.0 * summary["data"]["discrepancy_cov"].get<double>(), 3) + " %"
               : std::string()) +
          ".",
      "", "  ");
  if (!e.contains("check")) return;
  const auto& check = e["check"];
  const auto& at = check["error_to_noise"][check["worst_mode"].get<std::size_t>() - 1];
  print_wrapped(out,
                "Check of " + check["draws"].dump() + " draws with the FE solution: error up to " +
                    number(at["rms"], 2) + " of the noise (mode " + check["worst_mode"].dump() +
                    "), weights as good as " + percent(check["effective_share"]) +
                    " of the draws. " +
                    (check["moved"].get<bool>() ? "The emulator moved the answer: see below."
                                                : "The emulator did not move the answer."),
                "", "  ");
}

void print_damage(std::ostream& out, const Report& summary, bool colour) {
  const Style style{colour};
  const auto& models = summary["models"];
  out << '\n' << style.bold(summary["title"].get<std::string>()) << '\n';
  out << "Data: " << summary["data"]["origin"].get<std::string>() << '\n';
  print_answer(out, summary, style);

  const bool several = summary["kinds"].size() > 1;
  out << '\n'
      << style.bold(several ? "What is there?"
                            : "How many " + summary["kinds"][0]["plural"].get<std::string>() + "?")
      << '\n';
  print_models(out, models);

  const bool folded = summary["damage"].contains("folded");
  for (const auto& m : models) {
    const std::string name = m["name"];
    const double p = m["probability"];
    if (p < kWorthTelling || !summary["parameters"].contains(name)) continue;
    const Report& table = folded && summary["damage"]["folded"].contains(name)
                              ? summary["damage"]["folded"][name]
                              : summary["parameters"][name];
    bool has_defects = false;
    for (const auto& [label, ignored] : table.items()) {
      has_defects = has_defects || label.find('[') != std::string::npos;
    }
    if (!has_defects) continue;
    out << '\n' << style.bold("If " + name) << " (" << percent(p) << ")\n";
    print_defects(out, summary, table, folded, style);
  }
  for (const auto& m : models) {
    const std::string name = m["name"];
    if (m["probability"].get<double>() < kWorthTelling || !summary["parameters"].contains(name)) {
      continue;
    }
    const auto& table = summary["parameters"][name];
    if (table.contains("cov")) {
      const auto& s = table["cov"];
      out << "\nNoise (coefficient of variation) if " << name << ": " << number(s["q50"], 3)
          << ", 95 % " << interval(s, [](double x) { return significant(x, 3); }) << '\n';
    }
  }

  print_evidence(out, summary, style);
  print_predictor(out, summary, style);

  if (summary["data"]["simulated"].get<bool>()) {
    std::string truth;
    for (const auto& kind : summary["kinds"]) {
      for (const auto& t : kind["truth"]) {
        truth += (truth.empty() ? "" : "; ") + kind["name"].get<std::string>() + " at " +
                 metres(t["location"]) + " m";
        if (t.contains("reduction")) truth += ", " + severity_text(kind, t["reduction"]);
      }
    }
    out << "\nTruth that the data were simulated from: " << (truth.empty() ? "nothing" : truth)
        << ".\n";
  }

  const auto draw = [&](const Report& by_element, const std::string& plural) {
    const auto inclusion = by_element["overall"].get<std::vector<double>>();
    const double expected = std::accumulate(inclusion.begin(), inclusion.end(), 0.0);
    out << '\n'
        << style.bold("Where along the beam are the " + plural + "?") << " (expected number "
        << significant(expected, 3) << "; tallest bar "
        << percent(*std::ranges::max_element(inclusion)) << " in one element)\n";
    out << draw_beam(summary["beam"], inclusion, kWidth - 4);
  };
  for (const auto& kind : summary["kinds"]) {
    const auto& by_element = summary["damage"]["inclusion_by_element"];
    draw(several ? by_element[kind["name"].get<std::string>()] : by_element, kind["plural"]);
  }

  print_closing(out, summary, "count", style);
}

void print_sid(std::ostream& out, const Report& summary, bool colour) {
  const Style style{colour};
  out << '\n' << style.bold(summary["title"].get<std::string>()) << '\n';
  const auto& data = summary["data"];
  out << "Data: " << data["origin"].get<std::string>() << "; samples " << data["samples"][0]
      << " to " << data["samples"][1] << " at " << number(data["sample_rate"], 6) << " Hz\n";
  print_answer(out, summary, style);
  out << '\n' << style.bold("Which model?") << '\n';
  print_models(out, summary["models"]);
  for (const auto& b : summary["log_bayes_factors"]) {
    out << "  ln Bayes factor of " << b["model"].get<std::string>() << " against "
        << b["against"].get<std::string>() << ": ";
    if (b["log_bayes_factor"].is_number()) {
      out << fixed(b["log_bayes_factor"], 2)
          << (b["mcse"].is_number() ? " ± " + significant(b["mcse"], 2) : std::string())
          << (b.value("basis", "draws") == "evidence" ? " (by their evidences)" : "") << '\n';
    } else {
      out << "not known (never drawn, and of no known evidence: "
          << b["never_visited"].get<std::string>() << ")\n";
    }
  }
  print_evidence(out, summary, style);
  for (const auto& m : summary["models"]) {
    const std::string name = m["name"];
    const double p = m["probability"];
    if (p < kWorthTelling || !summary["parameters"].contains(name)) continue;
    out << '\n' << style.bold("If " + name) << " (" << percent(p) << ")\n";
    std::vector<std::vector<std::string>> rows = {{"parameter", "mean", "sd", "95 % interval"}};
    for (const auto& [label, s] : summary["parameters"][name].items()) {
      const double width = s["q97.5"].get<double>() - s["q2.5"].get<double>();
      rows.push_back({label, resolved(s["mean"], width), number(s["sd"], 2),
                      interval(s, [&](double x) { return resolved(x, width); })});
    }
    if (rows.size() > 1) print_table(out, rows, style);
    rows = {{"response", "MSE", "NRMSE", "R2", "white?"}};
    for (const auto& f : summary["fit"].value(name, Report::array())) {
      const auto& white = f["whiteness"];
      rows.push_back({f["channel"], number(f["mse"], 3),
                      f["nrmse"].is_number() ? fixed(100.0 * f["nrmse"].get<double>(), 2) + " %"
                                             : std::string("-"),
                      f["r2"].is_number() ? fixed(f["r2"], 5) : std::string("-"),
                      white.is_object() ? (white["white"].get<bool>() ? "yes, p " : "NO, p ") +
                                              number(white["p_value"], 2)
                                        : std::string("-")});
    }
    if (rows.size() > 1) print_table(out, rows, style);
  }
  const auto& predictive = summary["predictive"];
  out << "\nThe " << percent(predictive["level"]) << " predictive band holds ";
  bool first = true;
  for (const auto& row : predictive["channels"]) {
    out << (first ? "" : ", ") << fixed(100.0 * row["coverage"].get<double>(), 1) << " % of "
        << row["channel"].get<std::string>();
    first = false;
  }
  out << ".\n";
  print_closing(out, summary, "model", style);
}

namespace {

// The first `width` characters of UTF-8 text.
std::string cut(const std::string& text, std::size_t width) {
  std::size_t used = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts = (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80;
    if (starts && used++ == width) return text.substr(0, i);
  }
  return text;
}

std::string duration(double seconds) {
  if (seconds < 100.0) return fixed(seconds, 0) + " s";
  return seconds < 6000.0 ? fixed(seconds / 60.0, 0) + " min" : fixed(seconds / 3600.0, 1) + " h";
}

// Columns of the terminal on standard error; a line that is longer could not be overwritten.
std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressBar::ProgressBar(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO) != 0) {}

void ProgressBar::show(const std::string& stage, double fraction, const std::string& detail) {
  if (!visible_) return;
  const auto now = std::chrono::steady_clock::now();
  if (stage != stage_) stage_ = stage, began_ = now, last_ = {};
  if (now - last_ < std::chrono::milliseconds(80)) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - began_).count();
  std::string left;
  if (fraction > 0.005 && seconds > 1.0) {
    left = "  " + duration(seconds * (1.0 - fraction) / fraction) + " left";
  }
  const std::string line = pad_right(stage, 12) + " " + pad_right(bar(fraction, 20), 20) + " " +
                           pad_left(fixed(100.0 * fraction, 0), 3) + " %" + left +
                           (detail.empty() ? "" : "  " + detail);
  std::fprintf(stderr, "\r\x1b[K%s", cut(line, terminal_width() - 1).c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (drawn_) std::fprintf(stderr, "\r\x1b[K");
  drawn_ = false;
}

}  // namespace wheeltap::apps
