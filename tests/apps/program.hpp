// Runs of the program from the command line, and cases for them.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace wheeltap::apps {

/// A directory of one test, removed at its end.
class Workspace {
 public:
  Workspace() {
    std::string name = (std::filesystem::temp_directory_path() / "wheeltap-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  ~Workspace() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  [[nodiscard]] std::filesystem::path write_json(const std::string& name,
                                                 const nlohmann::json& json) const {
    return write(name, json.dump());
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_all(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code;
  std::string out, err;
};

/// Runs `wheeltap ARGUMENTS` (shell words) and waits for its end.
inline Outcome wheeltap(const Workspace& where, const std::string& arguments) {
  const auto out = where / "stdout.txt", err = where / "stderr.txt";
  const std::string command = std::string(WHEELTAP_PROGRAM) + " " + arguments + " >" +
                              out.string() + " 2>" + err.string() + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_all(out), read_all(err)};
}

/// The beam of the case in the source with ten frequencies of its intact state, 10 elements.
inline nlohmann::json small_case() {
  return nlohmann::json::parse(R"({
    "kind": "damage",
    "title": "A small case",
    "beam": {
      "length": 1.0, "elements": 10, "supports": "simply-supported",
      "material": {"young": 70e9, "poisson": 0.3, "density": 2700},
      "section": {"shape": "rectangle", "width": 0.025, "height": 0.006}
    },
    "data": {"frequencies": [13.8, 55.3, 124.0], "cov": 0.01},
    "damage": {
      "count": {"min": 0, "max": 2, "prior": "uniform"},
      "location": {"uniform": [0.0, 1.0]},
      "reduction": {"uniform": [0.0, 0.6]}
    },
    "predictor": "fe"
  })");
}

}  // namespace wheeltap::apps
