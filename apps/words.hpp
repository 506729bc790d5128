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

/// x with `digits` significant digits, without trailing zeros. Numbers from 1e-4 to a million have
/// plain notation ("350", not "3.5e+02"); other numbers have the form "5.4e-6".
[[nodiscard]] std::string significant(double x, int digits);
/// x rounded to the decimal place of the second significant digit of `width`, the width of its
/// interval. The result has at least three and at most ten significant digits.
[[nodiscard]] std::string resolved(double x, double width);
/// A count rounded to three significant digits: "80500".
[[nodiscard]] std::string rounded_count(double x);
/// A probability as text: "75 %", "> 99.9 %", "< 0.1 %".
[[nodiscard]] std::string percent(double probability);
/// A probability with its Monte Carlo error, "75 % ± 2 %". Near 0 and 1, the text is a bound of the
/// probability: "> 99.9 %". If twice the Monte Carlo error exceeds 0.1 %, the difference between
/// the bound and the probability is twice this error: "> 72 %".
[[nodiscard]] std::string percent(double probability, double error);
/// " ± 2 %": the error shown by percent(); empty if percent() returns a bound.
[[nodiscard]] std::string shown_error(double probability, double error);
/// A probability as an equation: "P = 75 %", "P > 99.9 %".
[[nodiscard]] std::string probability_is(double probability);
/// A p-value as text: "p 0.03", "p < 1e-15".
[[nodiscard]] std::string p_value(double p);
/// A duration as text: "3.1 s", "52 s", "12 min", "2.3 h", "5 days".
[[nodiscard]] std::string duration(double seconds);
/// An NRMSE as text: "0.35 % of the response".
[[nodiscard]] std::string share_of_response(double nrmse);
/// The first `most` items and "N more"; all items if there are no more than `most`.
[[nodiscard]] std::vector<std::string> shortened(std::vector<std::string> items, std::size_t most);
/// The items as a list in words: "a, b and c".
[[nodiscard]] std::string in_words(const std::vector<std::string>& items,
                                   const std::string& last = "and");
/// Mode numbers in words: "modes 5 to 20", "modes 3, 7 and 9".
[[nodiscard]] std::string name_modes(const std::vector<int>& modes);

/// Text on a model without draws: "never proposed", "not entered in 786 proposals", "entered once
/// in 786 proposals, but in no draw that was kept".
[[nodiscard]] std::string entered_in_words(long entered, long proposed);
/// Text on a model whose probability comes from its evidence: "not entered in 123 456 proposals;
/// its evidence puts it at P ≈ 0.21 ± 0.02". The text is empty for a model with enough draws.
[[nodiscard]] std::string told_by_evidence(const identification::ModelFinding& model);

/// Text on the resolution of the searches for posterior modes: "posterior modes reached from less
/// than 0.3 % of the prior may have been missed", and the widths of the posterior modes to which
/// this statement applies. The text is empty without a search.
[[nodiscard]] std::string resolution_in_words(const inference::Verdict& verdict);

/// The case and results of the run, for remarks whose texts need more than their own numbers.
struct Context {
  const identification::DamageCase* damage_case = nullptr;
  const identification::DamageFindings* damage = nullptr;
  /// Paths of the defect kinds in the case: "damage", "damage.1"
  std::vector<std::string> kinds = {};
};
[[nodiscard]] std::string sentence(const identification::Remark& remark, const Context& context);

/// A sentence on a setting that the sampler chose.
[[nodiscard]] std::string in_words(inference::Choice choice);
/// A sentence on a model whose likelihood is zero for every draw from its prior.
[[nodiscard]] std::string impossible_in_words(const std::string& model);
/// A sentence on the part of a record that a quick run used.
[[nodiscard]] std::string in_words(const identification::Look& look);

/// A sentence on why a system identification was repeated, with the new settings.
[[nodiscard]] std::string repeat_note(const identification::StepsRefined& refined);

/// The coefficients of a term as text: "1200 (1150 to 1260)", with their names if the term has
/// several coefficients. The text is "-" for a term without draws.
[[nodiscard]] std::string coefficients_in_words(const identification::TermFinding& term);
/// "The link 0-1 has cubic (> 99.9 %) and quadratic (98 %) terms; undecided: bilinear (40 %); no
/// evidence for coulomb (3 %)." One sentence per link.
[[nodiscard]] std::string terms_in_words(const std::vector<identification::TermFinding>& terms);

/// A sentence on the mirror-image ambiguity of a symmetric beam.
[[nodiscard]] std::string symmetry_statement(bool emulated);
/// A sentence on the difference between the intact model and the measured baseline, and on its
/// correction.
[[nodiscard]] std::string baseline_statement(const identification::Baseline& baseline);
/// A sentence on the ambiguity of a symmetric structure: equivalent locations, and members on which
/// the positions s and L - s are equivalent.
[[nodiscard]] std::string images_statement(const std::vector<std::vector<std::string>>& alike,
                                           const std::vector<std::string>& turned);
/// A warning that the emulator for the given number of damages is inaccurate; empty if the emulator
/// is accurate.
[[nodiscard]] std::string emulator_warning(int damages, const std::vector<int>& blind);

/// All warnings of a run, the most serious first: missing convergence, misfit of the models,
/// remarks.
[[nodiscard]] std::vector<std::string> warnings(const identification::Findings& findings,
                                                const Context& context);

}  // namespace wheeltap::apps
