// `wheeltap serve`: a UM-Bridge server.
#pragma once

#include <string>

#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct ServeOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free port
};

/// Serves the case's predictor by the UM-Bridge protocol until Ctrl-C. Prints its address once it
/// accepts connections.
void run_serve(const CommonOptions& common, const ServeOptions& options);

}  // namespace wheeltap::apps
