// Standard output of a command with --json.
#pragma once

#include <iostream>
#include <string>
#include <vector>

#include "apps/run_options.hpp"
#include "apps/runs/run_cost.hpp"
#include "base/ranks.hpp"
#include "io/bytes.hpp"

namespace wheeltap::apps {

/// With --json, the program writes one JSON value to standard output instead of the text of the
/// command.
class JsonOutput {
 public:
  JsonOutput(bool wanted, CommonOptions& common) : common_(common) {
    if (!wanted) return;
    common.as_json = [this](const std::string& json) { outputs_.push_back(json); };
    if (common.dry_run) {
      common.dry_run = [this](const std::string& what, const RunCost& cost) {
        outputs_.push_back(estimate_json(what, cost));
      };
    }
    terminal_ = std::cout.rdbuf(&silence_);
  }
  JsonOutput(const JsonOutput&) = delete;
  JsonOutput& operator=(const JsonOutput&) = delete;
  ~JsonOutput() { give_back(); }

  /// Prints the JSON that the command produced before it failed, if any.
  void print_partial() {
    if (outputs_.empty()) return give_back();
    print();
  }
  /// Prints the JSON of the command or, if it produced none, summary.json of its results folder.
  void print() {
    if (terminal_ == nullptr) return;
    give_back();
    if (!base::is_first_rank()) return;
    if (outputs_.empty())
      outputs_.push_back(io::read_bytes(common_.output / "summary.json", std::size_t{1} << 31U));
    if (outputs_.size() == 1) {
      std::cout << outputs_[0] << (outputs_[0].ends_with('\n') ? "" : "\n");
      return;
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i)
      std::cout << (i == 0 ? "[" : ",\n ") << outputs_[i];
    std::cout << "]\n";
  }

 private:
  struct Silence : std::streambuf {
    int overflow(int c) override { return traits_type::not_eof(c); }
    std::streamsize xsputn(const char*, std::streamsize n) override { return n; }
  };
  void give_back() {
    if (terminal_ != nullptr) std::cout.rdbuf(terminal_);
    terminal_ = nullptr;
  }

  const CommonOptions& common_;
  Silence silence_;
  std::streambuf* terminal_ = nullptr;
  std::vector<std::string> outputs_;
};

}  // namespace wheeltap::apps
