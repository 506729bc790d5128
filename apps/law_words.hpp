// Texts on the keys of force laws, for the schema, error messages and the page on laws.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// The shortest text that parses to x: "1e7", "0.004", "60000".
[[nodiscard]] std::string plain_number(double x);

/// True if a case may give the force law by its first coefficient alone: a number, or the name of a
/// parameter.
[[nodiscard]] bool has_short_form(const dynamics::LawInfo& info);

/// The keys of a force law: "force [N], velocity [m/s]", with " and side" for a one-sided force
/// law.
[[nodiscard]] std::string keys_in_words(const dynamics::LawInfo& info);

/// The allowed values of a force law in a case, as text: "force [N] (a number or a parameter's
/// name), an object with force [N], velocity [m/s], or a list of these (dry friction; `wheeltap
/// laws coulomb`)".
[[nodiscard]] std::string law_in_words(const dynamics::LawInfo& info);

/// Description of a coefficient: "the force at which it slips [N]: a number or a parameter's name;
/// default 0".
[[nodiscard]] std::string in_words(const dynamics::LawCoefficient& coefficient);

/// Bounds of a coefficient: "positive", "at least 0", "at least 1"; empty without bounds.
[[nodiscard]] std::string bounds_in_words(const dynamics::LawCoefficient& coefficient);

}  // namespace wheeltap::apps
