// The reference of force laws, generated from their descriptions. `wheeltap laws` prints it;
// docs/laws.md holds its output.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// Returns the section on one law.
[[nodiscard]] std::string law_section(const dynamics::LawInfo& info);
/// Returns the page of all laws as Markdown.
[[nodiscard]] std::string laws_page();

/// Returns a complete case as formatted JSON: data simulated with the law, and models with and
/// without it.
[[nodiscard]] std::string law_example(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps
