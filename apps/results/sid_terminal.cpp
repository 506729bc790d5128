#include "apps/results/sid_terminal.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "apps/results/sid_summary.hpp"
#include "apps/results/terminal.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

void print_bayes_factors(std::ostream& out, const SidFindings& findings) {
  for (const BayesFactor& b : findings.bayes_factors) {
    out << "  ln Bayes factor of " << findings.models[static_cast<std::size_t>(b.model)].name
        << " against " << findings.models[static_cast<std::size_t>(b.against)].name << ": ";
    if (b.log) {
      out << fixed(*b.log, 2)
          << (std::isfinite(b.error) ? " ± " + significant(b.error, 2) : std::string())
          << (b.basis == inference::Basis::evidence ? " (by their evidences)" : "") << '\n';
    } else if (findings.models[static_cast<std::size_t>(b.model)].standing.passed_over) {
      out << "not evaluated\n";
    } else {
      out << "not known (no draws and no evidence of " << never_visited(findings, b) << ")\n";
    }
  }
}

std::string sid_interval(const Interval& i) {
  const double width = i.q97_5 - i.q2_5;
  return resolved(i.q2_5, width) + " to " + resolved(i.q97_5, width);
}

void print_parameters(const Page& page, const std::vector<ParameterFinding>& parameters) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "mean", "sd", "95 % interval"}};
  const bool windows = std::ranges::any_of(
      parameters, [](const ParameterFinding& p) { return p.between_windows.has_value(); });
  if (windows) {
    rows.front().emplace_back("a further window (95 %)");
    rows.front().emplace_back("use");
  }
  for (const ParameterFinding& p : parameters) {
    const Marginal& e = p.estimate;
    rows.push_back({p.unknown.with_unit(), resolved(e.mean, e.width()), number_or_dash(e.sd, 2),
                    resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width())});
    if (!windows) continue;
    const auto& between = p.between_windows;
    rows.back().push_back(between ? sid_interval(between->next) : "-");
    rows.back().emplace_back(between && between->scatters() ? "windows" : "this run");
  }
  if (rows.size() > 1) page.table(rows);
}

void print_terms(const Page& page, const Discovery& discovery) {
  page.heading("Which terms?");
  std::vector<std::vector<std::string>> rows = {
      {"term", "P(in)", "±", "prior", "coefficients, if present: median (95 % interval)"}};
  for (const TermFinding& term : discovery.terms) {
    rows.push_back({term.label, percent(term.inclusion), significant(100.0 * term.mcse, 2) + " %",
                    percent(term.prior), coefficients_in_words(term)});
  }
  page.table(rows);
}

void print_modes(const Page& page, const std::vector<ChainMode>& modes) {
  std::vector<std::vector<std::string>> rows = {
      {"mode", "frequency [Hz]", "95 % interval", "damping ratio", "95 % interval"}};
  const auto interval = [](const Marginal& x) {
    return resolved(x.q2_5, x.width()) + " to " + resolved(x.q97_5, x.width());
  };
  for (const ChainMode& mode : modes) {
    const Marginal &f = mode.frequency_hz, &zeta = mode.damping_ratio;
    rows.push_back({std::to_string(rows.size()), resolved(f.q50, f.width()), interval(f),
                    resolved(zeta.q50, zeta.width()), interval(zeta)});
  }
  if (rows.size() > 1) page.table(rows);
}

void print_fits(const Page& page, const std::vector<ChannelFit>& fits) {
  std::vector<std::vector<std::string>> rows = {{"response", "MSE (SI)", "NRMSE", "R2", "white?"}};
  for (const ChannelFit& fit : fits) {
    const bool varies = std::isfinite(fit.nrmse);
    rows.push_back(
        {fit.channel, number_or_dash(fit.mse, 3), varies ? fixed(100.0 * fit.nrmse, 2) + " %" : "-",
         varies ? fixed(fit.r2, 5) : "-",
         fit.whiteness
             ? (fit.whiteness->white() ? "yes, " : "NO, ") + p_value(fit.whiteness->test.p_value)
             : "-"});
  }
  if (rows.size() > 1) page.table(rows);
}

// True for models whose parameters get a table: models with enough probability. For a discovery,
// only the most probable model, because the terms have a separate table.
std::vector<bool> worth_printing(const SidFindings& findings) {
  std::vector<bool> out;
  std::size_t best = 0;
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const double p = findings.models[m].probability();
    if (findings.of_models[m] && p > findings.models[best].probability()) best = m;
    out.push_back(findings.of_models[m] && p >= kWorthPrinting);
  }
  if (findings.discovery.terms.empty()) return out;
  out.assign(out.size(), false);
  out[best] = findings.of_models[best].has_value();
  return out;
}

}  // namespace

void print_sid(std::ostream& out, const SidCase& sid_case, const SidFindings& findings,
               bool colour) {
  const Page page{out, colour};
  page.heading(sid_case.title);
  out << "Data: " << sid_case.origin << "; samples " << sid_case.begin << " to " << sid_case.end
      << " at " << number_or_dash(sid_case.sample_rate_hz, 6) << " Hz\n";
  for (const SidCase& record : sid_case.further) {
    out << "and " << record.origin << "; samples " << record.begin << " to " << record.end << " at "
        << number_or_dash(record.sample_rate_hz, 6) << " Hz\n";
  }
  print_answer(page, answer(findings));
  if (!findings.discovery.terms.empty()) print_terms(page, findings.discovery);
  const bool several = findings.models.size() > 1;
  if (several) {
    page.heading("Which model?");
    print_models(page, findings.models);
  }
  if (findings.discovery.terms.empty()) print_bayes_factors(out, findings);
  print_evidence(page, findings);
  const std::vector<bool> told = worth_printing(findings);
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const ModelFinding& model = findings.models[m];
    if (!told[m]) continue;
    print_condition(page, model, several);
    if (const auto& residuals = sid_case.models[m].residuals; residuals.chosen_kind != nullptr) {
      const ResidualWords words = residuals.model->words();
      out << "Residuals: " << words.name << words.detail << ", chosen by "
          << residuals.chosen_kind->criterion << '\n';
    }
    print_parameters(page, model.parameters);
    print_modes(page, findings.of_models[m]->modes);
    print_fits(page, findings.of_models[m]->at_mean);
  }
  out << "\nThe " << percent(sid_case.band) << " predictive band contains ";
  const auto responses = sid_case.responses();
  for (std::size_t c = 0; c < responses.size(); ++c) {
    out << (c == 0 ? "" : ", ") << fixed(100.0 * findings.coverage[c], 1) << " % of "
        << responses[c]->name();
  }
  out << ".\n";
  print_closing(page, findings, warnings(findings, {}), "model");
}

}  // namespace wheeltap::apps
