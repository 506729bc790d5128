// Findings in words: every sentence that a run may say, whoever prints it.
#pragma once

#include <string>
#include <vector>

#include "base/number.hpp"
#include "identification/findings/findings.hpp"
#include "identification/sid/findings/term_findings.hpp"
#include "identification/sid/sid_run.hpp"
#include "identification/structural/damage/damage_findings.hpp"

namespace wheeltap::apps {

using base::fixed;
using base::grouped;

/// `digits` significant ones, no trailing zeros, in the style of the report: plain from 1e-4 to a
/// million ("350", not "3.5e+02"), "5.4e-6" outside.
[[nodiscard]] std::string significant(double x, int digits);
/// A number with as many digits as an interval of this width needs to be told from a point: two of
/// the width, at least three of the number, at most ten.
[[nodiscard]] std::string resolved(double x, double width);
/// A count for people, to three digits: "80500".
[[nodiscard]] std::string rounded_count(double x);
/// "75 %", "> 99.9 %", "< 0.1 %".
[[nodiscard]] std::string percent(double probability);
/// "75 % ± 2 %" with its Monte Carlo error; near 0 and 1 a bound alone, two errors away where these
/// exceed 0.1 %: "> 99.9 %", "> 72 %".
[[nodiscard]] std::string percent(double probability, double error);
/// " ± 2 %": the error that it shows; empty beside a bound.
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

/// "never entered", "not entered in 786 proposals", "entered once in 786 proposals, but in no draw
/// that was kept": of a model without draws.
[[nodiscard]] std::string entered_in_words(long entered, long proposed);
/// "not entered in 123 456 proposals; its evidence puts it at P ≈ 0.21 ± 0.02"; empty for a model
/// that its draws speak for.
[[nodiscard]] std::string told_by_evidence(const identification::ModelFinding& model);

/// "posterior modes reached from less than 0.3 % of the prior may have been missed", and of which
/// width that is; empty where nothing was searched.
[[nodiscard]] std::string resolution_in_words(const inference::Verdict& verdict);

/// What a remark needs to be put into words, beside its own numbers.
struct Context {
  const identification::DamageCase* damage_case = nullptr;
  const identification::DamageFindings* damage = nullptr;
  std::vector<std::string> kinds = {};  ///< where the case has them: "damage", "damage.1"
};
[[nodiscard]] std::string sentence(const identification::Remark& remark, const Context& context);

/// What the engine chose, a sentence.
[[nodiscard]] std::string in_words(inference::Choice choice);
/// How much of a record a look was taken at.
[[nodiscard]] std::string in_words(const identification::Look& look);

/// Why a system identification was repeated, and with what.
[[nodiscard]] std::string repeat_note(const identification::StepsRefined& refined);

/// "1200 (1150 to 1260)", with the coefficients' names where a term has several; "-" for one that
/// no draw had.
[[nodiscard]] std::string coefficients_in_words(const identification::TermFinding& term);
/// "The link 0-1 has cubic (> 99.9 %) and quadratic (98 %) terms; undecided: bilinear (40 %);
/// nothing speaks for coulomb (3 %)." A sentence a link.
[[nodiscard]] std::string terms_in_words(const std::vector<identification::TermFinding>& terms);

/// What frequencies of a symmetric beam cannot tell.
[[nodiscard]] std::string symmetry_statement(bool emulated);
/// How far the intact model is from the measured baseline, and what was made of it.
[[nodiscard]] std::string baseline_statement(const identification::Baseline& baseline);
/// The same of a structure: what is alike, and on which members s is like L - s.
[[nodiscard]] std::string images_statement(const std::vector<std::vector<std::string>>& alike,
                                           const std::vector<std::string>& turned);
/// Why an emulator for so many damages should not be used; empty where it may.
[[nodiscard]] std::string emulator_warning(int damages, const std::vector<int>& blind);

/// All that a reader should keep in mind, the gravest first: what is not established, why the
/// models do not explain the data, the remarks.
[[nodiscard]] std::vector<std::string> warnings(const identification::Findings& findings,
                                                const Context& context);

}  // namespace wheeltap::apps
