// Error messages, with corrections, for cases that do not satisfy their schema.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"

namespace wheeltap::apps {

struct Complaint {
  Pointer where;
  std::string message;
};

/// The first violation of the schema `schema_name` in `json`, described in engineering terms; empty
/// if `json` is valid. `rules` is schema(schema_name). If a correction satisfies the schema, the
/// message ends with this correction.
[[nodiscard]] std::optional<Complaint> first_complaint(const Json& rules,
                                                       const std::string& schema_name,
                                                       const Json& json);

}  // namespace wheeltap::apps
