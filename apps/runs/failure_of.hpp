// Converts exceptions of a command to its error line and exit code.
#pragma once

#include <exception>
#include <filesystem>

#include "apps/failure.hpp"

namespace wheeltap::apps {

/// Returns the printable error line and exit code of an exception. For numerical errors without a
/// location, the line names `case_path`.
[[nodiscard]] Failure failure_of(const std::exception_ptr& error,
                                 const std::filesystem::path& case_path);

}  // namespace wheeltap::apps
