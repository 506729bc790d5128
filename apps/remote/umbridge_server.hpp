// Server of the UM-Bridge protocol (HTTP and JSON) for models of Wheeltap.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identification/emulation/outside_model.hpp"

namespace wheeltap::apps {

/// A model with one vector of inputs and one vector of outputs. If an input is invalid, the server
/// returns the text of the std::invalid_argument to the client.
struct ServedModel {
  std::string name;
  bool has_gradient = false;
  /// Creates one model per thread
  std::function<std::unique_ptr<identification::OutsideModel>()> make;
};

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< port of the server; 0: any free port
  int threads = 1;
  std::function<void(int port)> ready = {};  ///< called when the server accepts connections
  /// Called a few times per second; the server ends if it returns true
  std::function<bool()> stop = {};
};

/// Answers the requests /Info, /ModelInfo, /InputSizes, /OutputSizes, /Evaluate and /Gradient of
/// version 1.0 until stop() returns true. Numbers in responses have all significant digits of a
/// double. Throws Failure if the port is not available.
void serve_models(const std::vector<ServedModel>& models, const ServerOptions& options);

}  // namespace wheeltap::apps
