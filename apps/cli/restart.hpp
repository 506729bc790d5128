// Restart of the program with environment variables that libraries read at start.
#pragma once

#include <string>

namespace wheeltap::apps {

/// Limits the vector instructions that libraries choose at start to `instructions` ("baseline",
/// "avx2" or "avx512"). These libraries read environment variables when the program starts. The
/// program therefore sets the variables and restarts itself with the same arguments. The function
/// returns only if the variables are already set or if the restart fails.
void restart_with(const std::string& instructions, char** argv);

}  // namespace wheeltap::apps
