// The program started once more, for what libraries read when it starts.
#pragma once

#include <string>

namespace wheeltap::apps {

/// Keeps libraries, which choose by the processor for themselves, to these instructions
/// ("baseline", "avx2" or "avx512"): they read environment variables when the program starts, so it
/// starts once more, with the same arguments. Returns where it has these variables, or cannot be
/// started.
void restart_with(const std::string& instructions, char** argv);

}  // namespace wheeltap::apps
