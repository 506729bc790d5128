#include "apps/text/answer.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>

#include "apps/text/damage_words.hpp"
#include "apps/text/fit_words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

constexpr double kDecided = 0.6;
constexpr double kCertain = 0.95;
constexpr double kWorthNaming = 0.1;
constexpr double kLocated = 0.25;  // width of an interval / length of the beam
constexpr std::size_t kMostValues = 6;

using Namer = std::function<std::string(const ModelFinding&)>;

std::string quoted_name(const ModelFinding& model) {
  return "“" + model.name + "”";
}

// The counts of a model as text: "two damages and one support"; "no damage".
std::string counted(const DamageCase& damage_case, const ModelFinding& model) {
  static const char* words[] = {"no",  "one",   "two",   "three", "four", "five",
                                "six", "seven", "eight", "nine",  "ten"};
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < model.counts.size(); ++k) {
    const int n = model.counts[k];
    parts.push_back((n <= 10 ? words[n] : std::to_string(n)) + std::string(" ") +
                    (n < 2 ? damage_case.kinds[k].name : damage_case.kinds[k].plural));
  }
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : " and ") + part;
  return text;
}

// Sentences on the count after adjacent damages are merged: " These two are adjacent: …
// Neighbouring damages counted as one: 1 damage 99 % and 2 damages 1 %."
std::string neighbours(const DamageCase& damage_case, const DamageFindings& findings,
                       std::size_t model) {
  constexpr double kMost = 0.5;  // fraction of the model's draws
  std::string text;
  for (const MergedFinding& merged : findings.merged) {
    const auto k = static_cast<std::size_t>(merged.kind);
    const MergedModel* of = merged.of(static_cast<int>(model));
    if (of == nullptr || of->merged < kMost) continue;
    text += " " + longer_in_words(damage_case.kinds[k], findings.models[model].counts[k], *of) +
            " Neighbouring " + damage_case.kinds[k].plural +
            " counted as one: " + merged_counts_in_words(damage_case.kinds[k], merged) + ".";
  }
  return text;
}

std::string percent_of(double fraction) {
  return fixed(100.0 * fraction, 0) + " %";
}

std::string median(const Marginal& e) {
  return resolved(e.q50, e.width());
}

std::string answer_interval(const Marginal& e) {
  return resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width());
}

std::string value_with_unit(const std::string& value, const Unknown& unknown) {
  return unknown.unit.empty() || unknown.unit == "1" ? value : value + " " + unknown.unit;
}

std::string answer_in_metres(const Marginal& x) {
  return fixed(x.q2_5, 3) + " to " + fixed(x.q97_5, 3) + " m";
}

std::string how_bad(const DefectKind& kind, const Marginal& severity);

// A component: "near 0.095 m (95 % interval 0.09 to 0.1 m) or its mirror image 0.905 m, …".
std::string place_in_words(const Marginal& x, const Marginal* severity, const Marginal* extent,
                           const DefectKind& kind, double length, bool mirrored) {
  std::string text;
  if (x.width() > kLocated * length) {
    text = "not located: anywhere from " + answer_in_metres(x) +
           (mirrored ? " or in the mirror image of this range" : "") + " (95 %)";
  } else {
    text = "near " + fixed(x.q50, 3) + " m (95 % interval " + answer_in_metres(x) + ")";
    if (mirrored && std::abs(length - 2.0 * x.q50) > 0.01 * length) {
      text += " or at its mirror image " + fixed(length - x.q50, 3) + " m";
    }
  }
  if (severity == nullptr) return text;
  text += ", " + how_bad(kind, *severity);
  if (const std::string over = extent_in_words(kind, x.q50, extent); !over.empty())
    text += " " + over;
  return text;
}

// A severity with its interval: "30 % (20 to 40 %)", "0.3 kg (0.2 to 0.4)".
std::string how_bad(const DefectKind& kind, const Marginal& severity) {
  const std::string words = std::string(kind.type->effect_words) + " ";
  if (kind.type->percent) {
    return words + percent_of(severity.q50) + " (" + fixed(100.0 * severity.q2_5, 0) + " to " +
           percent_of(severity.q97_5) + ")";
  }
  const std::string unit = kind.severity_unit();
  return words + median(severity) + (unit.empty() ? "" : " " + unit) + " (" +
         answer_interval(severity) + ")";
}

// Locations on a structure with an expected number of at least 0.1 defects, largest first: "crack
// on beam near 0.37 m (95 % interval 0.35 to 0.4 m; expected number 0.93), depth a/h 30 % (20 to 40
// %)".
std::string places_in_structure(const DamageCase& damage_case, const DamageFindings& findings) {
  struct One {
    double expected;
    std::string text;
  };
  std::vector<One> all;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    for (const Place& p : findings.kinds[k].places) {
      const auto& on = kind.line.stretches()[static_cast<std::size_t>(p.stretch)];
      std::string text =
          kind.name + (kind.type->sites == DefectType::Sites::nodes ? " at " : " on ") + on.name;
      if (on.size > 0.0)
        text += " near " + fixed(p.location.q50, 3) + " m (95 % interval " +
                answer_in_metres(p.location) + "; expected number " + fixed(p.expected, 2) + ")";
      else
        text += " (expected number " + fixed(p.expected, 2) + ")";
      if (p.severity) text += ", " + how_bad(kind, *p.severity);
      const double at = kind.line.x_of(on.site, p.location.q50);
      if (const std::string over = extent_in_words(kind, at, p.extent ? &*p.extent : nullptr);
          p.severity && !over.empty())
        text += " " + over;
      all.push_back({p.expected, text});
    }
  }
  std::ranges::sort(all, std::ranges::greater{}, &One::expected);
  if (all.empty()) return {};
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), kMostValues); ++i) {
    text += (i == 0 ? "" : "; ") +
            (all.size() > 1 ? "(" + std::to_string(i + 1) + ") " : std::string()) + all[i].text;
  }
  if (all.size() > kMostValues)
    text += "; and " + std::to_string(all.size() - kMostValues) + " more places, tabulated below";
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

std::string where_and_how_bad(const DamageCase& damage_case, const DamageFindings& findings,
                              std::size_t model) {
  if (damage_case.structure) {
    const std::string places = places_in_structure(damage_case, findings);
    return places.empty() || !findings.symmetry
               ? places
               : places +
                     " Frequencies alone cannot distinguish a location from its images in this "
                     "symmetric structure.";
  }
  const bool mirrored = findings.symmetry.has_value();
  const auto& shown = findings.shown(model);
  const bool several = damage_case.kinds.size() > 1;
  std::vector<std::string> places;
  bool length_known = true;
  for (std::size_t p = 0; p < shown.size(); ++p) {
    const Unknown& u = shown[p].unknown;
    if (u.kind < 0 || u.parameter != 0) continue;
    const DefectKind& kind = damage_case.kinds[static_cast<std::size_t>(u.kind)];
    const Marginal* severity = kind.severity_prior() ? &shown[p + 1].estimate : nullptr;
    const std::size_t at = p + (kind.severity_prior() ? 2 : 1);
    const Marginal* extent = kind.extent_prior ? &shown[at].estimate : nullptr;
    if (extent != nullptr && findings.models[model].parameters[at].is_nearly_prior())
      length_known = false;
    places.push_back((several ? kind.name + " " : "") +
                     place_in_words(shown[p].estimate, severity, extent, kind,
                                    damage_case.beam.length, mirrored));
  }
  if (places.empty()) return {};
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::string one = places[i];
    if (places.size() > 1) {
      one = "(" + std::to_string(i + 1) + ") " + one;
    } else {
      one[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(one[0])));
    }
    text += (i == 0 ? "" : "; ") + one;
  }
  text += ".";
  if (!length_known)
    text += places.size() > 1
                ? " The data do not determine every length: these stiffness reductions depend on "
                  "the prior of the length."
                : " The data do not determine the length: this stiffness reduction depends on the "
                  "prior of the length.";
  if (mirrored) text += " Frequencies alone cannot distinguish a location from its mirror image.";
  return text;
}

std::string values_in_words(const ModelFinding& model) {
  std::vector<std::string> parts;
  for (const ParameterFinding& p : model.parameters) {
    if (parts.size() == kMostValues) {
      parts.emplace_back("others, tabulated below");
      break;
    }
    parts.push_back(p.unknown.label + " = " + value_with_unit(median(p.estimate), p.unknown) +
                    " (" + answer_interval(p.estimate) +
                    (p.is_nearly_prior() ? ", nearly its prior)" : ")"));
  }
  if (parts.empty()) return {};
  return "With 95 % intervals: " + in_words(parts) + ".";
}

std::string capitalised(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

// The beginning of the headline if the models do not explain the data; it may name the model.
using MisfitWords = std::function<std::string(const FitVerdict&, const ModelFinding&)>;

// Caution and headline; if no model reaches kDecided, the headline begins with `undecided`.
Answer verdict_on(const Findings& findings, const std::string& undecided, const Namer& said,
                  const MisfitWords& misfit) {
  Answer out;
  const bool converged = findings.sampling.verdict.converged;
  out.caution = caution(findings);
  const bool explained = findings.fit_verdict.ok();
  const auto& models = findings.models;
  const auto order = by_probability(models);
  const ModelFinding& best = models[order[0]];
  const auto named = [&](const ModelFinding& m) {
    return said(m) + " (" + percent(m.probability()) +
           (m.standing.basis == inference::Basis::evidence ? ", by its evidence)" : ")");
  };
  if (models.size() == 1) {
    out.headline = "The case allows only " + said(best) + ".";
  } else if (best.probability() >= kDecided) {
    const std::string name = named(best);
    out.headline =
        best.probability() >= kCertain || !explained ? name + "." : "Most likely " + name + ".";
    if (!converged && explained) out.headline = "So far: " + out.headline;
    out.headline = capitalised(out.headline);
  } else {
    std::vector<std::string> list;
    for (const std::size_t m : order) {
      if (models[m].probability() >= kWorthNaming || list.empty()) {
        list.push_back(named(models[m]));
      }
    }
    if (list.size() == 1) list.emplace_back("others, each below 10 %");
    out.headline = std::string(converged || !explained ? "Undecided" : "So far undecided") +
                   undecided + in_words(list, "or") + ".";
  }
  if (!explained) {
    out.misfit = true;
    out.headline = misfit(findings.fit_verdict, best) +
                   (models.size() == 1
                        ? std::string()
                        : (converged ? " Best model: " : " Best model so far: ") + out.headline);
  }
  return out;
}

}  // namespace

std::string caution(const Findings& findings) {
  if (findings.sampling.verdict.converged) return {};
  if (findings.sampling.quick)
    return "Quick run: posterior modes and short chains, not a posterior. Run without --quick "
           "before you use these numbers.";
  return findings.sampling.stopped_early
             ? "This run stopped before it had converged: do not trust these numbers yet."
             : "The chains have not converged: do not trust these numbers yet.";
}

Answer answer(const DamageCase& damage_case, const DamageFindings& findings) {
  const Namer said = [&](const ModelFinding& m) { return counted(damage_case, m); };
  const MisfitWords misfit = [](const FitVerdict& verdict, const ModelFinding&) -> std::string {
    const auto* beyond = std::get_if<misfit::BeyondNoise>(&verdict.why.front());
    if (beyond != nullptr && !beyond->chains_agree)
      return "The draws so far do not explain the frequencies (" + in_brief(verdict) +
             "), and the Markov chains disagree.";
    const bool too_close = std::holds_alternative<misfit::WithinNoise>(verdict.why.front());
    return (too_close ? "The frequencies fit more closely than the stated noise" +
                            stated(std::get<misfit::WithinNoise>(verdict.why.front()).cv) +
                            " allows (" + in_brief(verdict) + ")."
                      : "No number of damages that the case allows explains the frequencies (" +
                            in_brief(verdict) + ").");
  };
  Answer out = verdict_on(findings, ": the data allow ", said, misfit);
  const std::size_t at = findings.by_probability()[0];
  const ModelFinding& best = findings.models[at];
  const bool none = std::ranges::all_of(best.counts, [](int n) { return n == 0; });
  if (!none) {
    out.headline += neighbours(damage_case, findings, at);
    out.detail = where_and_how_bad(damage_case, findings, at);
    if (best.probability() < kDecided && !out.detail.empty()) {
      out.detail = "If " + said(best) + ": " + out.detail;
    }
  } else if (findings.models.size() > 1) {
    out.detail = "Probability of at least one defect: " + percent(1.0 - best.probability()) + "." +
                 (best.probability() >= kDecided
                      ? " The location estimates below are conditional on at least one defect."
                      : "");
  }
  return out;
}

Answer answer(const Findings& findings) {
  const bool alone = findings.models.size() == 1;
  const MisfitWords misfit = [alone](const FitVerdict& verdict, const ModelFinding& best) {
    return (alone ? quoted_name(best) + " does not explain the record ("
                  : "None of these models explains the record (") +
           in_brief(verdict) + ").";
  };
  Answer out = verdict_on(findings, " between models: ", quoted_name, misfit);
  out.detail = values_in_words(findings.models[findings.by_probability()[0]]);
  return out;
}

Answer answer(const SidFindings& findings) {
  const auto& terms = findings.discovery.terms;
  if (terms.empty()) return answer(static_cast<const Findings&>(findings));
  Answer out = answer(static_cast<const Findings&>(findings));
  out.headline = terms_in_words(terms);
  if (!findings.sampling.verdict.converged) out.headline = "So far: " + out.headline;
  if (out.misfit) {
    out.headline = "No subset of these terms explains the record (" +
                   in_brief(findings.fit_verdict) + "). Best subset: " + out.headline;
  }
  out.detail.clear();
  std::vector<std::string> values;
  for (const TermFinding& term : terms) {
    if (!term.is_in() || values.size() == kMostValues) continue;
    for (const ParameterFinding& p : term.parameters) {
      values.push_back(p.unknown.label + " = " + value_with_unit(median(p.estimate), p.unknown) +
                       " (" + answer_interval(p.estimate) + ")");
    }
  }
  if (!values.empty()) out.detail = "With 95 % intervals: " + in_words(values) + ".";
  return out;
}

Answer answer(const std::string& path, const std::vector<SweepRow>& rows) {
  Answer out;
  std::vector<std::string> best;
  std::size_t failed = 0, misfits = 0;
  for (const SweepRow& row : rows) {
    best.push_back(row.models.empty() ? ""
                                      : quoted_name(row.models[by_probability(row.models)[0]]));
    failed += row.converged ? 0 : 1;
    misfits += row.explained ? 0 : 1;
  }
  if (failed > 0) {
    out.caution = std::to_string(failed) + " of " + std::to_string(rows.size()) +
                  " runs have not converged: do not trust their results yet.";
  }
  std::vector<std::string> stretches;
  for (std::size_t i = 0, j = 0; i < best.size(); i = j) {
    for (j = i; j < best.size() && best[j] == best[i];) ++j;
    stretches.push_back(best[i] + (j - i == 1
                                       ? " at " + rows[i].value
                                       : " from " + rows[i].value + " to " + rows[j - 1].value));
  }
  out.headline = "Most probable over " + path + ": " + in_words(stretches) + ".";
  if (misfits > 0) {
    out.misfit = true;
    out.headline = "In " + std::to_string(misfits) + " of " + std::to_string(rows.size()) +
                   " runs no model explains the record. " + out.headline;
  }
  return out;
}

Report json(const Answer& answer) {
  return {{"caution", answer.caution},
          {"headline", answer.headline},
          {"detail", answer.detail},
          {"misfit", answer.misfit}};
}

Answer read_answer(const Report& summary) {
  if (const auto kept = summary.find("answer"); kept != summary.end()) {
    return {.caution = kept->value("caution", ""),
            .headline = kept->value("headline", ""),
            .detail = kept->value("detail", ""),
            .misfit = kept->value("misfit", false)};
  }
  const auto models = [](const Report& rows) {
    std::vector<ModelFinding> out;
    for (const Report& row : rows) {
      out.emplace_back().name = row.at("name").get<std::string>();
      out.back().standing.probability = row.at("probability").get<double>();
    }
    return out;
  };
  if (summary.contains("sweep")) {
    std::vector<SweepRow> rows;
    for (const Report& row : summary.at("sweep").at("rows")) {
      rows.push_back({row.at("value").dump(), models(row.at("models")),
                      row.value("converged", false), row.value("explained", true)});
    }
    return answer(summary.at("sweep").at("path").get<std::string>(), rows);
  }
  Findings findings;
  findings.models = models(summary.at("models"));
  const Report& diagnosed = summary.at("diagnostics");
  findings.sampling.verdict.converged = diagnosed.value("converged", false);
  findings.sampling.stopped_early = diagnosed.value("stopped_early", false);
  findings.sampling.quick = diagnosed.value("quick", false);
  return verdict_on(findings, ": ", [](const ModelFinding& m) { return m.name; }, {});
}

}  // namespace wheeltap::apps
