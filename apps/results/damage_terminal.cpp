#include "apps/results/damage_terminal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <ostream>

#include "apps/results/baseline_words.hpp"
#include "apps/results/damage_summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/text/damage_words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string place_in_metres(double x) {
  return fixed(x, 3);
}

std::string damage_interval(const Marginal& e, const std::function<std::string(double)>& text) {
  return text(e.q2_5) + " to " + text(e.q97_5);
}

// A severity and its unit as text.
std::string severity_text(const DefectKind& kind, double x) {
  if (kind.type->percent) return fixed(100.0 * x, 0) + " %";
  return significant(x, 3) + " " + kind.severity_unit();
}

std::string true_place(const DefectKind& kind, double location) {
  if (kind.line.is_beam()) return place_in_metres(location) + " m";
  const SiteLine::Spot spot = kind.line.spot(location);
  const auto& on = kind.line.stretches()[static_cast<std::size_t>(spot.stretch)];
  return on.size > 0.0 ? on.name + ", " + place_in_metres(spot.s) + " m" : on.name;
}

// Prints one line per defect.
void print_defects(const Page& page, const DamageCase& damage_case,
                   const std::vector<ParameterFinding>& shown, bool folded) {
  std::vector<std::vector<std::string>> rows;
  std::map<std::size_t, std::array<std::string, 2>> extents;  // by row
  std::string severity_heading;
  for (std::size_t p = 0; p < shown.size(); ++p) {
    const Unknown& u = shown[p].unknown;
    if (u.kind < 0 || u.parameter != 0) continue;
    const DefectKind& kind = damage_case.kinds[static_cast<std::size_t>(u.kind)];
    const Marginal& x = shown[p].estimate;
    std::vector<std::string> row = {kind.name + " " + std::to_string(u.component + 1),
                                    place_in_metres(x.q50) + " m"};
    if (folded) row.push_back(place_in_metres(damage_case.beam.length - x.q50) + " m");
    row.push_back(damage_interval(x, place_in_metres) + " m");
    if (kind.severity_prior()) {
      const Marginal& s = shown[p + 1].estimate;
      const auto text = [&](double value) { return severity_text(kind, value); };
      row.push_back(text(s.q50));
      row.push_back(damage_interval(s, text));
      const std::string heading(kind.type->severity_words);
      severity_heading =
          severity_heading.empty() || severity_heading == heading ? heading : "severity";
    }
    if (kind.extent_prior) {
      const Marginal& length = shown[p + (kind.severity_prior() ? 2U : 1U)].estimate;
      extents[rows.size()] = {place_in_metres(length.q50) + " m",
                              damage_interval(length, place_in_metres) + " m"};
    }
    rows.push_back(std::move(row));
  }
  std::vector<std::string> header = {"", "location"};
  if (folded) header.emplace_back("or its mirror");
  header.emplace_back("95 % interval");
  if (!severity_heading.empty()) {
    header.push_back(severity_heading);
    header.emplace_back("95 % interval");
  }
  if (!extents.empty()) {
    const std::size_t width = header.size();
    header.insert(header.end(), {"extent", "95 % interval"});
    for (std::size_t r = 0; r < rows.size(); ++r) {
      rows[r].resize(width);
      const auto found = extents.find(r);
      for (std::size_t i = 0; i < 2; ++i)
        rows[r].push_back(found == extents.end() ? "-" : found->second[i]);
    }
  }
  rows.insert(rows.begin(), header);
  page.table(rows);
}

// Prints the locations on a structure at which at least 0.1 defects are expected.
void print_places(const Page& page, const DamageCase& damage_case, const DamageFindings& findings) {
  std::vector<std::vector<std::string>> rows = {
      {"", "on", "expected", "location", "95 % interval", "severity", "95 % interval"}};
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    for (const Place& p : findings.kinds[k].places) {
      const auto& on = kind.line.stretches()[static_cast<std::size_t>(p.stretch)];
      std::vector<std::string> row = {kind.name, on.name, fixed(p.expected, 2)};
      const bool along = on.size > 0.0;
      row.push_back(along ? place_in_metres(p.location.q50) + " m" : "-");
      row.push_back(along ? damage_interval(p.location, place_in_metres) + " m" : "-");
      const auto text = [&](double value) { return severity_text(kind, value); };
      row.push_back(p.severity ? text(p.severity->q50) : "-");
      row.push_back(p.severity ? damage_interval(*p.severity, text) : "-");
      rows.push_back(std::move(row));
    }
  }
  if (rows.size() > 1) page.table(rows);
}

// Prints a bar for each member, node or link.
void print_sites(std::ostream& out, const DefectKind& kind, const std::vector<double>& expected) {
  std::vector<double> sums(kind.line.stretches().size());
  std::size_t width = 0;
  for (std::size_t c = 0; c < expected.size(); ++c)
    sums[static_cast<std::size_t>(kind.line.stretch_of_cell(static_cast<int>(c)))] += expected[c];
  for (const auto& s : kind.line.stretches()) width = std::max(width, columns(s.name));
  const double peak = std::max(1e-300, *std::ranges::max_element(sums));
  for (std::size_t s = 0; s < sums.size(); ++s)
    out << "  " << pad_right(kind.line.stretches()[s].name, width) << "  " << fixed(sums[s], 3)
        << "  " << bar(sums[s] / peak, 30) << '\n';
}

std::string support_glyph(const fem::Support& s) {
  if (s.stiffness) return "≀";
  if (s.deflection && s.rotation) return "█";
  return s.deflection ? "▲" : "◆";
}

// Prints the predictor and its error.
void print_predictor(const Page& page, const DamageCase& damage_case,
                     const DamageFindings& findings) {
  if (!findings.emulator) return;
  const EmulatorFinding& e = *findings.emulator;
  page.heading("Predictor");
  print_emulator(page.out, e, false, false);
  if (e.exact) {
    page.wrapped(
        "The emulator only screened proposals: the posterior is the posterior of the FE solution. "
        "The run called the "
        "FE solution " +
            rounded_count(static_cast<double>(e.likelihood_calls)) + " times and the emulator " +
            rounded_count(static_cast<double>(findings.sampling.likelihood_evaluations)) +
            " times.",
        "", "  ");
    return;
  }
  const double discrepancy = damage_case.data.discrepancy_cv;
  page.wrapped(
      std::string("The emulator error is ") + (e.error_in_likelihood ? "part of" : "NOT part of") +
          " the likelihood" +
          (discrepancy > 0.0 ? "; a discrepancy of " + significant(100.0 * discrepancy, 3) +
                                   " % is part of the likelihood"
                             : std::string()) +
          ".",
      "", "  ");
  if (!e.check) return;
  const auto& at = e.check->error_to_noise[static_cast<std::size_t>(e.check->worst_mode - 1)];
  page.wrapped("Check of " + std::to_string(e.check->draws) +
                   " draws with the FE solution: error up to " + significant(at.rms, 2) +
                   " times noise sd (mode " + std::to_string(e.check->worst_mode) +
                   "), effective fraction of the weighted draws " +
                   percent(e.check->effective_share) + ". " +
                   (e.check->answer_moved() ? "The emulator error changed the results: see below."
                                            : "The emulator error did not change the results."),
               "", "  ");
}

}  // namespace

std::string draw_beam(const fem::Beam& beam, const std::vector<double>& inclusion, int width) {
  static const char* levels[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const double length = beam.length;
  const auto n = static_cast<int>(inclusion.size());
  std::vector<double> density(static_cast<std::size_t>(width));
  // The expected number of an element is spread evenly over the columns that the element covers.
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
  for (const fem::Support& s : beam.supports) {
    const double at = s.at / length * (width - 1);
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

void print_emulator(std::ostream& out, const EmulatorFinding& emulator, bool colour, bool in_full) {
  const Page page{out, colour};
  for (std::size_t c = 0; c < emulator.counts.size(); ++c) {
    const EmulatorFinding::Count& count = emulator.counts[c];
    const int n = static_cast<int>(c) + 1;
    const std::string damages = std::to_string(n) + (n == 1 ? " damage" : " damages");
    std::string worst;
    if (count.worst_mode > 0) {
      worst = "RMSE up to " + significant(count.rmse_to_noise, 2) + " times the noise sd (mode " +
              std::to_string(count.worst_mode) + "), single errors up to " +
              significant(count.largest_to_noise, 2);
    }
    if (!in_full) {
      page.wrapped("Emulator for " + damages + ": " + count.kind + " (" +
                       std::to_string(count.runs) + " FE runs)" +
                       (worst.empty() ? "" : "; " + worst) + ".",
                   "", "  ");
      continue;
    }
    out << "\nEmulator for " << damages << " (" << count.runs << " FE runs), " << count.kind
        << "; error on further FE runs:\n";
    const bool one_out = count.modes[0].leave_one_out.has_value();
    std::vector<std::vector<std::string>> rows = {{"mode", "RMSE [Hz]", "largest [Hz]",
                                                   "RMSE / effect", "Q2", "noise sd [Hz]",
                                                   "RMSE / noise", "z rms"}};
    if (one_out) rows[0].emplace_back("leave-one-out [Hz]");
    for (std::size_t mode = 0; mode < count.modes.size(); ++mode) {
      const EmulatorFinding::Mode& m = count.modes[mode];
      rows.push_back({std::to_string(mode + 1), number_or_dash(m.rmse, 3),
                      number_or_dash(m.max_error, 3), number_or_dash(m.relative_rmse, 2),
                      number_or_dash(m.q2, 3), number_or_dash(m.noise, 3),
                      number_or_dash(m.rmse / m.noise, 2),
                      m.standardised ? number_or_dash(m.standardised->rms, 2) : "-"});
      if (one_out) rows.back().push_back(number_or_dash(*m.leave_one_out, 3));
    }
    page.table(rows);
    if (!worst.empty()) out << "  " << worst << ".\n";
    if (const std::string warning = emulator_warning(n, count.blind); !warning.empty()) {
      page.wrapped(warning, page.warn("! "), "  ");
    }
  }
}

void print_damage(std::ostream& out, const DamageCaseFile& file, const DamageFindings& findings,
                  bool colour) {
  const Page page{out, colour};
  const DamageCase& damage_case = file.damage;
  page.heading(damage_case.title);
  page.wrapped("Data: " + damage_case.data.origin, "", "  ");
  if (damage_case.baseline)
    page.wrapped("Baseline: " + baseline_statement(*damage_case.baseline), "", "  ");
  print_answer(page, answer(damage_case, findings));

  const bool several = findings.models.size() > 1;
  if (several) {
    page.heading(damage_case.kinds.size() > 1 ? "Which defects?"
                                              : "How many " + damage_case.kinds[0].plural + "?");
    print_models(page, findings.models);
    for (const MergedFinding& merged : findings.merged) {
      constexpr double kWorthSaying = 0.005;
      if (merged.merged < kWorthSaying) continue;
      const DefectKind& kind = damage_case.kinds[static_cast<std::size_t>(merged.kind)];
      page.wrapped("Neighbouring " + kind.plural +
                       " counted as one: " + merged_counts_in_words(kind, merged) + ".",
                   "  ", "  ");
    }
  }

  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const ModelFinding& model = findings.models[m];
    const bool any = std::ranges::any_of(model.counts, [](int n) { return n > 0; });
    if (model.probability() < kWorthPrinting || !model.drawn() || !any) continue;
    if (damage_case.structure) continue;
    print_condition(page, model, several);
    print_defects(page, damage_case, findings.shown(m), !findings.folded.empty());
  }
  if (damage_case.structure) {
    page.heading("Location and severity");
    print_places(page, damage_case, findings);
  }
  for (const ModelFinding& model : findings.models) {
    if (model.probability() < kWorthPrinting || !model.drawn()) continue;
    if (const Marginal* cv = model.find("cov")) {
      out << "\nNoise (coefficient of variation of a frequency) if " << model.name << ": "
          << significant(cv->q50, 3) << ", 95 % "
          << damage_interval(*cv, [](double x) { return significant(x, 3); }) << '\n';
    }
  }

  print_baseline(page, findings);
  print_evidence(page, findings);
  print_predictor(page, damage_case, findings);

  if (damage_case.data.simulated) {
    std::string truth;
    for (const DefectKind& kind : damage_case.kinds) {
      for (const auto& t : kind.truth) {
        truth += (truth.empty() ? "" : "; ") + kind.name + " at " + true_place(kind, t.location);
        if (kind.type->percent) truth += ", " + severity_text(kind, t.severity);
      }
    }
    out << "\nTruth of the simulated data: " << (truth.empty() ? "no damage" : truth) << ".\n";
  }

  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const std::vector<double>& expected = findings.kinds[k].expected;
    if (damage_case.structure) {
      out << '\n'
          << page.bold("Where are the " + damage_case.kinds[k].plural + "?")
          << " (expected number)\n";
      print_sites(out, damage_case.kinds[k], expected);
      continue;
    }
    out << '\n'
        << page.bold("Where along the beam are the " + damage_case.kinds[k].plural + "?")
        << " (expected number "
        << significant(std::accumulate(expected.begin(), expected.end(), 0.0), 3)
        << "; tallest bar " << percent(*std::ranges::max_element(expected)) << " in one element)\n";
    out << draw_beam(damage_case.beam, expected, kTerminalWidth - 4);
  }
  print_closing(page, findings, damage_warnings(file, findings), "count");
}

}  // namespace wheeltap::apps
