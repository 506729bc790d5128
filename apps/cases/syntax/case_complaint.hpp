// Error messages for cases that do not satisfy their schema, with a correction.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

struct Complaint {
  Pointer where;
  std::string message;
};

/// The first fault of `json` by the rules of `schema_name` (schema(schema_name) is `rules`), in
/// engineering terms; empty if there is no fault. If a correction is found that satisfies the
/// rules, the message ends with it.
[[nodiscard]] std::optional<Complaint> first_complaint(const Json& rules,
                                                       const std::string& schema_name,
                                                       const Json& json);

}  // namespace wheeltap::apps
