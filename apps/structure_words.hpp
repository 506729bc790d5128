// Warnings on implausible values of a structure.
#pragma once

#include <string>
#include <vector>

#include "identification/findings/remarks.hpp"

namespace wheeltap::apps {

[[nodiscard]] std::string sentence(const identification::remark::ImplausibleMaterial& r);
[[nodiscard]] std::string sentence(const identification::remark::DeepSection& r);
[[nodiscard]] std::string sentence(const identification::remark::TwinMembers& r);
[[nodiscard]] std::string sentence(const identification::remark::UnusedNodes& r);
[[nodiscard]] std::string sentence(const identification::remark::CrossingMembers& r);
[[nodiscard]] std::string sentence(const identification::remark::SensorsAtOnePlace& r);

/// Prints each remark on standard error, for commands without a report.
void warn_of(const std::vector<identification::Remark>& remarks);

}  // namespace wheeltap::apps
