// The reference of force laws, written from the laws' own descriptions: `wheeltap laws` prints it,
// docs/laws.md is what it printed.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// The part of the page about one law.
[[nodiscard]] std::string law_section(const dynamics::LawInfo& info);
/// All laws, as Markdown.
[[nodiscard]] std::string laws_page();

/// A complete case, simulated with the law and asked whether it is there: JSON as a person would
/// lay it out.
[[nodiscard]] std::string law_example(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps
