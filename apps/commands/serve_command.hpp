// `wheeltap serve`.
#pragma once

#include <string>

#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct ServeOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: one that is free
};

/// Offers the case's predictor to others by the UM-Bridge protocol, until Ctrl-C. The line that
/// says where it listens is printed once it does.
void run_serve(const CommonOptions& common, const ServeOptions& options);

}  // namespace wheeltap::apps
