// Texts of findings, for the terminal, summaries and reports.
#pragma once

#include <string>
#include <vector>

#include "base/number.hpp"
#include "identification/findings/findings.hpp"
#include "identification/sid/findings/term_findings.hpp"
#include "identification/sid/sid_run.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

using base::fixed;
using base::grouped;

/// x with `digits` significant digits, without trailing zeros: plain from 1e-4 to a million ("350",
/// not "3.5e+02"), "5.4e-6" outside.
[[nodiscard]] std::string significant(double x, int digits);
/// x with as many digits as its interval of this width needs: two of the width, at least three of
/// the number, at most ten.
[[nodiscard]] std::string resolved(double x, double width);
/// A count rounded to three digits: "80500".
[[nodiscard]] std::string rounded_count(double x);
/// "75 %", "> 99.9 %", "< 0.1 %".
[[nodiscard]] std::string percent(double probability);
/// "75 % ± 2 %" with its Monte Carlo error; near 0 and 1 only a bound, two errors away if these
/// exceed 0.1 %: "> 99.9 %", "> 72 %".
[[nodiscard]] std::string percent(double probability, double error);
/// " ± 2 %": the error shown by percent(); empty for a bound.
[[nodiscard]] std::string shown_error(double probability, double error);
/// "P = 75 %", "P > 99.9 %".
[[nodiscard]] std::string probability_is(double probability);
/// "p 0.03", "p < 1e-15".
[[nodiscard]] std::string p_value(double p);
/// "3.1 s", "52 s", "12 min", "2.3 h", "5 days".
[[nodiscard]] std::string duration(double seconds);
/// "0.35 % of the response".
[[nodiscard]] std::string share_of_response(double nrmse);
/// "a, b and c".
[[nodiscard]] std::string in_words(const std::vector<std::string>& items,
                                   const std::string& last = "and");
/// "modes 5 to 20", "modes 3, 7 and 9".
[[nodiscard]] std::string name_modes(const std::vector<int>& modes);

/// "never proposed", "not entered in 786 proposals", "entered once in 786 proposals, but in no draw
/// that was kept": for a model without draws.
[[nodiscard]] std::string entered_in_words(long entered, long proposed);
/// "not entered in 123 456 proposals; its evidence puts it at P ≈ 0.21 ± 0.02"; empty for a model
/// with enough draws.
[[nodiscard]] std::string told_by_evidence(const identification::ModelFinding& model);

/// "posterior modes reached from less than 0.3 % of the prior may have been missed", with the
/// widths for which this holds; empty without a search.
[[nodiscard]] std::string resolution_in_words(const inference::Verdict& verdict);

/// Data for the text of a remark, in addition to the numbers in the remark.
struct Context {
  const identification::DamageCase* damage_case = nullptr;
  const identification::DamageFindings* damage = nullptr;
  std::vector<std::string> kinds = {};  ///< places in the case: "damage", "damage.1"
};
[[nodiscard]] std::string sentence(const identification::Remark& remark, const Context& context);

/// A sentence on a choice of the sampler.
[[nodiscard]] std::string in_words(inference::Choice choice);
/// A model without a possible point in its prior.
[[nodiscard]] std::string impossible_in_words(const std::string& model);
/// A sentence on the part of a record that a quick run used.
[[nodiscard]] std::string in_words(const identification::Look& look);

/// A sentence on why a system identification was repeated, with the new settings.
[[nodiscard]] std::string repeat_note(const identification::StepsRefined& refined);

/// "1200 (1150 to 1260)", with the coefficients' names if a term has several; "-" for a term
/// without draws.
[[nodiscard]] std::string coefficients_in_words(const identification::TermFinding& term);
/// "The link 0-1 has cubic (> 99.9 %) and quadratic (98 %) terms; undecided: bilinear (40 %); no
/// evidence for coulomb (3 %)." One sentence per link.
[[nodiscard]] std::string terms_in_words(const std::vector<identification::TermFinding>& terms);

/// A sentence on the mirror-image ambiguity of a symmetric beam.
[[nodiscard]] std::string symmetry_statement(bool emulated);
/// A sentence on the difference between intact model and measured baseline, and on its correction.
[[nodiscard]] std::string baseline_statement(const identification::Baseline& baseline);
/// The ambiguity of a symmetric structure: equivalent places, and members on which s and L - s are
/// equivalent.
[[nodiscard]] std::string images_statement(const std::vector<std::vector<std::string>>& alike,
                                           const std::vector<std::string>& turned);
/// A warning against an emulator for so many damages; empty if the emulator is accurate.
[[nodiscard]] std::string emulator_warning(int damages, const std::vector<int>& blind);

/// All warnings, the most serious first: missing convergence, misfit of the models, remarks.
[[nodiscard]] std::vector<std::string> warnings(const identification::Findings& findings,
                                                const Context& context);

}  // namespace wheeltap::apps
