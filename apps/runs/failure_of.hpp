// Whatever a command may throw, as the one line and the exit code that it ends with.
#pragma once

#include <exception>
#include <filesystem>

#include "apps/failure.hpp"

namespace wheeltap::apps {

/// `case_path` stands in lines about numbers that name no place themselves. The line is printable.
[[nodiscard]] Failure failure_of(const std::exception_ptr& error,
                                 const std::filesystem::path& case_path);

}  // namespace wheeltap::apps
