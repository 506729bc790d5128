#include "apps/results/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>
#include <string_view>

#include "apps/run_options.hpp"
#include "apps/text/verdict_words.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

bool colour_wanted() {
  return isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
}

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

std::string bar(double fraction, int width) {
  static const char* parts[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * width * 8));
  return repeated("█", eighths / 8) + parts[eighths % 8];
}

void Page::wrapped(const std::string& text, const std::string& first,
                   const std::string& further) const {
  std::string line = first;
  std::size_t used = columns(first);
  bool at_start = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!at_start && used + 1 + columns(word) > static_cast<std::size_t>(kTerminalWidth)) {
      out << line << '\n';
      line = further;
      used = columns(further);
      at_start = true;
    }
    line += (at_start ? "" : " ") + word;
    used += columns(word) + (at_start ? 0 : 1);
    at_start = false;
    at = end + 1;
  }
  out << line << '\n';
}

void Page::table(const std::vector<std::vector<std::string>>& rows) const {
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
    out << (header ? bold(line) : line) << '\n';
    header = false;
  }
}

void Page::heading(const std::string& text) const {
  out << '\n' << bold(text) << '\n';
}

std::string number_or_dash(double x, int digits) {
  return std::isfinite(x) ? significant(x, digits) : "-";
}

void print_answer(const Page& page, const Answer& said) {
  page.out << '\n';
  if (!said.caution.empty()) page.wrapped(said.caution, page.warn("! "), "  ");
  page.wrapped(said.headline, said.misfit ? page.warn("! ") : "", said.misfit ? "  " : "");
  if (!said.detail.empty()) page.wrapped(said.detail, "", "");
}

void print_models(const Page& page, const std::vector<ModelFinding>& all) {
  std::vector<ModelFinding> models = all;
  if (all.size() > kMostBars) {
    std::ranges::stable_sort(models, std::ranges::greater{}, &ModelFinding::probability);
    models.resize(kTopModels);
  }
  std::size_t widest = 0;
  for (const ModelFinding& m : models) widest = std::max(widest, columns(m.name));
  for (const ModelFinding& m : models) {
    const double p = m.probability();
    const bool known = std::isfinite(m.standing.mcse);
    // An error of 1e-24 % is useless after "< 0.1 %"; the line below has the exact value.
    const bool with_error = known && !(m.standing.basis == inference::Basis::evidence && p < 0.001);
    const std::string error = with_error ? shown_error(p, m.standing.mcse) : "";
    const std::string said = with_error               ? percent(p, m.standing.mcse)
                             : known                  ? percent(p)
                             : m.standing.passed_over ? "-"
                                                      : "?";
    page.out << "  " << pad_right(m.name, widest) << "  "
             << pad_left(error.empty() ? said : percent(p), 8) << pad_right(error, 12) << ' '
             << bar(p, 30) << '\n';
    if (const std::string told = told_by_evidence(m); !told.empty()) {
      page.wrapped(told, "    ", "    ");
    }
  }
  if (models.size() < all.size()) {
    double shown = 0.0;
    for (const ModelFinding& m : models) shown += m.probability();
    page.out << "  and " << all.size() - models.size() << " other models, together "
             << percent(std::max(0.0, 1.0 - shown)) << '\n';
  }
  page.out << "  (± is the Monte Carlo error of this run; prior probabilities:";
  const bool alike =
      models.size() < all.size() && std::ranges::all_of(models, [&](const ModelFinding& m) {
        return m.prior == models.front().prior;
      });
  for (std::size_t i = 0; i < (alike ? 1 : models.size()); ++i) {
    page.out << (i > 0 ? ", " : " ") << percent(models[i].prior);
  }
  if (alike) page.out << " each";
  page.out << ")\n";
}

void print_condition(const Page& page, const ModelFinding& model, bool several) {
  page.out << '\n'
           << (several ? page.bold("If " + model.name) + " (" + percent(model.probability()) + ")"
                       : page.bold(model.name))
           << '\n';
}

void print_evidence(const Page& page, const Findings& findings) {
  for (const EvidenceFinding& by : findings.evidence) {
    page.heading("Evidence by " + method_name(by.method));
    std::vector<std::vector<std::string>> table = {{"model", "ln Z", "±", "P(model)", "±"}};
    for (std::size_t m = 0; m < by.evidences.size(); ++m) {
      const double log_evidence = by.evidences[m].log_evidence;
      table.push_back(
          {findings.models[m].name, std::isfinite(log_evidence) ? fixed(log_evidence, 3) : "-",
           number_or_dash(by.evidences[m].standard_error, 2), number_or_dash(by.implied.mean[m], 4),
           number_or_dash(by.implied.standard_error[m], 2)});
    }
    page.table(table);
  }
}

void print_closing(const Page& page, const Findings& findings,
                   const std::vector<std::string>& warnings, const std::string& what) {
  if (!warnings.empty()) page.heading("Warnings");
  for (const std::string& w : warnings) page.wrapped(w, page.warn("! "), "  ");

  const Sampling& sampling = findings.sampling;
  const inference::Verdict& verdict = sampling.verdict;
  page.out << '\n'
           << sampling.chains << (sampling.chains == 1 ? " chain of " : " chains of ")
           << sampling.draws << " draws in " << duration(sampling.wall_seconds)
           << "; effective sample size of the " << what << ' '
           << (std::isfinite(verdict.ess_model) ? rounded_count(verdict.ess_model) : "-")
           << ", largest R-hat "
           << (std::isfinite(verdict.rhat_max) ? fixed(verdict.rhat_max, 4) : "-") << ".\n";
  if (const std::string resolution = resolution_in_words(verdict); !resolution.empty()) {
    page.wrapped("Resolution: " + resolution + " (--search).", "", "  ");
  }
  if (sampling.tempered_draws) {
    page.out << "Parallel tempering: " << sampling.ladder_round_trips
             << " round trips between prior and posterior.\n";
  }
  page.out << (verdict.converged
                   ? "Converged."
                   : page.warn(in_words(verdict.not_established, *findings.space).size() > 1
                                   ? "NOT CONVERGED: see the first warnings above."
                                   : "NOT CONVERGED: see the first warning above."))
           << '\n';
}

namespace {

// The first `width` characters of a UTF-8 text.
std::string cut(const std::string& text, std::size_t width) {
  std::size_t used = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts = (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80;
    if (starts && used++ == width) return text.substr(0, i);
  }
  return text;
}

// Width of the terminal on standard error, in columns; longer lines cannot be overwritten.
std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::vector<ModelSoFar> models_so_far(const std::vector<double>& probabilities,
                                      const std::vector<std::string>& names) {
  std::vector<ModelSoFar> out;
  std::vector<std::size_t> order(probabilities.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t m) { return probabilities[m]; });
  order.resize(std::min(order.size(), kMostSoFar));
  for (const std::size_t m : order) out.push_back({names[m], probabilities[m]});
  return out;
}

std::string probabilities_so_far(const std::vector<ModelSoFar>& models) {
  std::string out;
  for (std::size_t rank = 0; rank < std::min<std::size_t>(models.size(), 2); ++rank) {
    if (rank > 0 && models[rank].probability < 0.005) break;
    out += (rank == 0 ? "P(" : ", P(") + models[rank].name +
           ") = " + fixed(models[rank].probability, 2);
  }
  return out;
}

std::optional<std::string> ProgressLines::next(const std::string& stage, double fraction,
                                               double seconds, double left,
                                               const std::string& detail) {
  constexpr double kShare = 0.1, kSeconds = 5.0, kLong = 30.0;
  const double since = seconds - seconds_;
  const bool new_stage = stage != stage_;
  if (!new_stage && since < kLong && !(fraction - fraction_ >= kShare && since >= kSeconds))
    return {};
  stage_ = stage;
  fraction_ = new_stage ? 0.0 : fraction;
  seconds_ = seconds;
  std::string line =
      stage + ": " + fixed(100.0 * fraction, 0) + " %, " + duration(seconds) + " so far";
  if (left >= 0.0) line += ", about " + duration(left) + " left";
  return detail.empty() ? line : line + ", " + detail;
}

ProgressBar::ProgressBar(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {
  const char* form = std::getenv(kProgressVariable);
  json_ = form != nullptr && std::string_view(form) == "json";
}

void ProgressBar::show(const std::string& stage, double fraction, const std::string& detail,
                       std::optional<double> left, const std::vector<ModelSoFar>& models) {
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  if (stage != stage_) stage_ = stage, began_ = now, last_ = {};
  if (now - last_ < std::chrono::milliseconds(80)) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - began_).count();
  if (!left && fraction > 0.005 && seconds > 1.0) left = seconds * (1.0 - fraction) / fraction;
  if (!terminal_ && json_) {
    nlohmann::json line = {{"stage", stage}, {"fraction", fraction}, {"detail", detail}};
    if (left) line["seconds_left"] = *left;
    for (const ModelSoFar& model : models)
      line["models"].push_back({{"name", model.name}, {"probability", model.probability}});
    std::fprintf(stderr, "%s\n",
                 line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    std::fflush(stderr);
    return;
  }
  if (!terminal_) {
    const double so_far = std::chrono::duration<double>(now - created_).count();
    if (const auto line = lines_.next(stage, fraction, so_far, left.value_or(-1.0), detail)) {
      std::fprintf(stderr, "%s\n", line->c_str());
      std::fflush(stderr);
    }
    return;
  }
  const std::string line = pad_right(stage, 12) + " " + pad_right(bar(fraction, 20), 20) + " " +
                           pad_left(fixed(100.0 * fraction, 0), 3) + " %" +
                           (left ? "  " + duration(*left) + " left" : std::string()) +
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
