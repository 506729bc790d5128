// Server of the UM-Bridge protocol (HTTP and JSON) for models of Wheeltap.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identification/emulation/outside_model.hpp"

namespace wheeltap::apps {

/// A model with one vector of inputs and one of outputs. The server returns the text of
/// std::invalid_argument about an input to the client.
struct ServedModel {
  std::string name;
  bool has_gradient = false;
  std::function<std::unique_ptr<identification::OutsideModel>()> make;  ///< one per thread
};

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free port
  int threads = 1;
  std::function<void(int port)> ready = {};  ///< called when it listens
  std::function<bool()> stop = {};           ///< called a few times per second
};

/// Answers /Info, /ModelInfo, /InputSizes, /OutputSizes, /Evaluate and /Gradient of version 1.0
/// until stop() returns true. Numbers keep all digits. Throws Failure if the port is not available.
void serve_models(const std::vector<ServedModel>& models, const ServerOptions& options);

}  // namespace wheeltap::apps
