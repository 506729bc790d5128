#include "apps/results/update_terminal.hpp"

#include <cmath>
#include <ostream>

#include "apps/results/terminal.hpp"
#include "apps/text/answer.hpp"
#include "apps/text/update_words.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string update_interval(const Marginal& e) {
  return resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width());
}

std::string standing(const Contraction& c) {
  using Bound = Contraction::Bound;
  if (c.bound == Bound::upper) return "piles up at its upper bound";
  if (c.bound == Bound::lower) return "piles up at its lower bound";
  return c.at_prior() ? "left at its prior" : "";
}

void print_updated_parameters(const Page& page, const UpdateFindings& findings) {
  page.heading("The parameters");
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "mean", "sd", "95 % interval", "contracted by", ""}};
  const auto& parameters = findings.models[0].parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Marginal& e = parameters[p].estimate;
    const Contraction& c = findings.contractions[p];
    rows.push_back({parameters[p].unknown.label, resolved(e.mean, e.width()),
                    number_or_dash(e.sd, 2), update_interval(e),
                    fixed(100.0 * std::max(0.0, c.contraction), 0) + " %", standing(c)});
  }
  page.table(rows);
  page.out << "Contraction: 1 - posterior variance / prior variance, with the prior mapped to a\n"
              "standard normal. 0 %: no information in the data; 100 %: no effect of the prior.\n";
}

void print_solutions(const Page& page, const UpdateFindings& findings) {
  if (findings.solutions.empty()) return;
  page.heading("Separate solutions");
  std::vector<std::vector<std::string>> rows = {{"parameter"}};
  for (std::size_t s = 0; s < findings.solutions.size(); ++s)
    rows[0].push_back("solution " + std::to_string(s + 1) + " (" +
                      percent(findings.solutions[s].probability) + ")");
  const auto& parameters = findings.models[0].parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    rows.push_back({parameters[p].unknown.label});
    for (const Solution& s : findings.solutions)
      rows.back().push_back(resolved(s.parameters[p].q50, s.parameters[p].width()) + " (" +
                            update_interval(s.parameters[p]) + ")");
  }
  page.table(rows);
}

void print_matched_modes(const Page& page, const UpdateFindings& findings) {
  page.heading("The modes");
  bool shapes = false;
  for (const ModeFinding& m : findings.modes) shapes = shapes || m.has_shape;
  std::vector<std::vector<std::string>> rows = {
      {"mode", "measured [Hz]", "model [Hz]", "95 % interval", "off by [sd]"}};
  if (shapes) rows[0].insert(rows[0].end(), {"MAC", "shape's p"});
  rows[0].insert(rows[0].end(), {"information", "without it"});
  for (const ModeFinding& m : findings.modes) {
    std::string name = std::to_string(m.mode);
    if (m.spurious > kSpurious)
      name += " (spurious: " + percent(m.spurious) + ")";
    else if (m.computed != m.mode)
      name += " (model's " + std::to_string(m.computed) + ")";
    std::vector<std::string> row = {name, number_or_dash(m.measured_hz, 6),
                                    resolved(m.frequency_hz.mean, m.frequency_hz.width()),
                                    update_interval(m.frequency_hz),
                                    std::isnan(m.residual) ? "-" : fixed(m.residual, 2)};
    if (shapes) {
      row.push_back(m.has_shape ? fixed(m.mac.q50, 4) : "-");
      row.push_back(m.has_shape ? significant(m.shape_p, 2) : "-");
    }
    row.push_back((m.reliable ? "" : "> ") + fixed(m.information, 1) + " nats");
    row.push_back(m.moves.empty() || !m.reliable ? "-"
                                                 : m.moves + (m.moved > 0.0 ? " +" : " -") +
                                                       fixed(std::abs(m.moved), 1) + " sd");
    rows.push_back(std::move(row));
  }
  page.table(rows);
}

void print_predictions(const Page& page, const UpdateFindings& findings) {
  if (findings.predictions.empty()) return;
  page.heading("Predicted modes");
  std::vector<std::vector<std::string>> rows = {
      {"mode", "model [Hz]", "95 % of a measurement", "held out [Hz]", ""}};
  for (const PredictedMode& p : findings.predictions)
    rows.push_back({std::to_string(p.mode), resolved(p.frequency_hz.q50, p.high_hz - p.low_hz),
                    resolved(p.low_hz, p.high_hz - p.low_hz) + " to " +
                        resolved(p.high_hz, p.high_hz - p.low_hz),
                    p.measured_hz ? significant(*p.measured_hz, 6) : "-",
                    p.misses()      ? "OUTSIDE"
                    : p.useless()   ? "too wide to be useful"
                    : p.measured_hz ? "inside"
                                    : ""});
  page.table(rows);
}

}  // namespace

void print_update(std::ostream& out, const UpdateCaseFile& parsed, const UpdateFindings& findings,
                  bool colour) {
  const Page page{out, colour};
  page.heading(parsed.update.title);
  const ModalData& data = parsed.update.data;
  const int modes = data.measured_modes();
  std::string line =
      "Data: " + std::to_string(modes) + (modes == 1 ? " mode, " : " modes, ") + data.origin;
  if (data.has_shapes())
    line += "; shapes at " + std::to_string(data.sensors.size()) +
            (data.sensors.size() == 1 ? " sensor" : " sensors");
  page.wrapped(line + "; " + std::to_string(findings.numbers) + " numbers", "", "  ");
  if (findings.numbering)
    out << "Measured modes without shapes are matched to computed modes by number. This matching "
           "has "
        << probability_is(findings.numbering->probability) << " under the priors.\n";
  print_answer(page, answer(findings));
  print_updated_parameters(page, findings);
  print_solutions(page, findings);
  print_matched_modes(page, findings);
  print_predictions(page, findings);
  print_evidence(page, findings);
  print_closing(page, findings, update_warnings(findings), "model");
}

}  // namespace wheeltap::apps
