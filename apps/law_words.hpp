// A force law in words: what the schema, error messages and the page on laws say of its keys.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// The shortest text that reads back as x, as people write it: "1e7", "0.004", "60000".
[[nodiscard]] std::string plain_number(double x);

/// Whether a bare number or name may stand for the law: its first coefficient.
[[nodiscard]] bool has_short_form(const dynamics::LawInfo& info);

/// "force [N], velocity [m/s]", with " and side" where it has one.
[[nodiscard]] std::string keys_in_words(const dynamics::LawInfo& info);

/// What may stand in a case: "force [N] (a number or a parameter's name), an object with force [N],
/// velocity [m/s], or a list of these (dry friction; `wheeltap laws coulomb`)".
[[nodiscard]] std::string law_in_words(const dynamics::LawInfo& info);

/// "the force at which it slips [N]: a number or a parameter's name; 0 unless given".
[[nodiscard]] std::string in_words(const dynamics::LawCoefficient& coefficient);

/// "not negative", "positive", "at least 1"; empty where any number will do.
[[nodiscard]] std::string bounds_in_words(const dynamics::LawCoefficient& coefficient);

}  // namespace wheeltap::apps
