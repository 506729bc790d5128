// Models of ours behind a port, by the UM-Bridge protocol: HTTP and JSON.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identification/emulation/outside_model.hpp"

namespace wheeltap::apps {

/// A model with one vector of inputs and one of outputs. What throws std::invalid_argument about an
/// input is told to who asked.
struct ServedModel {
  std::string name;
  bool has_gradient = false;
  std::function<std::unique_ptr<identification::OutsideModel>()> make;  ///< one a thread
};

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: one that is free
  int threads = 1;
  std::function<void(int port)> ready = {};  ///< called once it listens
  std::function<bool()> stop = {};           ///< asked a few times a second
};

/// Answers /Info, /ModelInfo, /InputSizes, /OutputSizes, /Evaluate and /Gradient of version 1.0
/// until it is to stop. Numbers are written so that they are read as the same ones. Throws Failure
/// where the port cannot be had.
void serve_models(const std::vector<ServedModel>& models, const ServerOptions& options);

}  // namespace wheeltap::apps
