// The reference of force laws, written from the laws' own descriptions: `wheeltap laws` prints it,
// docs/laws.md is what it printed.
#pragma once

#include <filesystem>
#include <string>

#include "dynamics/laws.hpp"

namespace wheeltap::apps {

struct LawsOptions {
  std::string name;               ///< of one law; empty: all
  bool example = false;           ///< its example case alone, as JSON
  std::filesystem::path figures;  ///< a folder to write the pictures into; empty: none
};

/// Prints the page, one law's part of it, or its example. Throws Failure for an unknown law.
void run_laws(const LawsOptions& options);

/// All laws, as Markdown.
[[nodiscard]] std::string laws_page();

/// A complete case, simulated with the law and asked whether it is there: JSON as a person would
/// lay it out.
[[nodiscard]] std::string law_example(const dynamics::LawInfo& info);

}  // namespace wheeltap::apps
