// `wheeltap serve`: a UM-Bridge server.
#pragma once

#include <string>

#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct ServeOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< port of the server; 0: any free port
};

/// Serves the predictor of the case by the UM-Bridge protocol until Ctrl-C. The server prints its
/// URL once it accepts connections.
void run_serve(const CommonOptions& common, const ServeOptions& options);

}  // namespace wheeltap::apps
