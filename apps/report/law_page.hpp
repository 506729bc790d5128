// The reference of force laws, generated from their descriptions. `wheeltap laws` prints this
// reference; docs/laws.md contains the printed text.
#pragma once

#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

/// Returns the section of the reference about one force law.
[[nodiscard]] std::string law_section(const dynamics::LawInfo& info);
/// Returns the page of all force laws as Markdown.
[[nodiscard]] std::string laws_page();

/// Returns a complete case as formatted JSON: data simulated with the force law, and models with
/// and without the force law.
[[nodiscard]] std::string law_example(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps
