#include "apps/remote/outside_model.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <span>
#include <vector>

#include "apps/remote/command_model.hpp"
#include "apps/remote/umbridge_model.hpp"
#include "emulator/journal.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

const Pointer kPredictor("/predictor");

/// True for addresses of this machine.
bool is_loopback(const std::string& host) {
  in_addr four{};
  if (inet_pton(AF_INET, host.c_str(), &four) == 1) return ntohl(four.s_addr) >> 24U == 127U;
  in6_addr six{};
  if (inet_pton(AF_INET6, host.c_str(), &six) == 1) return IN6_IS_ADDR_LOOPBACK(&six);
  return host == "localhost";
}

/// A model whose inputs are the unknowns in another order.
class InOrder final : public OutsideModel {
 public:
  InOrder(std::unique_ptr<OutsideModel> model, std::vector<int> order)
      : model_(std::move(model)), order_(std::move(order)) {}
  [[nodiscard]] int inputs() const override { return model_->inputs(); }
  [[nodiscard]] int outputs() const override { return model_->outputs(); }
  void evaluate(std::span<const double> x, std::span<double> y) override {
    model_->evaluate(sent(x), y);
  }
  bool gradient(std::span<const double> x, std::span<const double> sensitivity,
                std::span<double> slope) override {
    std::vector<double> of_sent(slope.size());
    if (!model_->gradient(sent(x), sensitivity, of_sent)) return false;
    for (std::size_t i = 0; i < order_.size(); ++i)
      slope[static_cast<std::size_t>(order_[i])] = of_sent[i];
    return true;
  }

 private:
  [[nodiscard]] std::vector<double> sent(std::span<const double> x) const {
    std::vector<double> out;
    for (const int i : order_) out.push_back(x[static_cast<std::size_t>(i)]);
    return out;
  }

  std::unique_ptr<OutsideModel> model_;
  std::vector<int> order_;
};

}  // namespace

std::shared_ptr<RememberedModel> open_outside(const CaseFile& file, const OutsideSpec& spec,
                                              int outputs, const CommonOptions& common) {
  if (spec.command && !common.allow_commands)
    throw Failure(Exit::usage, file.path.string() + ": " + (kPredictor / "command").to_string() +
                                   ": runs the program \"" + spec.command->words[0] +
                                   "\", which needs --allow-commands");
  if (spec.umbridge && !is_loopback(spec.umbridge->host) &&
      std::ranges::find(common.allow_hosts, spec.umbridge->host) == common.allow_hosts.end())
    throw Failure(Exit::usage, file.path.string() + ": " + (kPredictor / "umbridge").to_string() +
                                   ": uses the server \"" + spec.umbridge->host +
                                   "\" on another machine, which needs --allow-hosts " +
                                   spec.umbridge->host);
  std::unique_ptr<OutsideModel> model;
  if (spec.umbridge) {
    model = umbridge_model(*spec.umbridge, static_cast<int>(spec.order.size()), outputs);
  } else {
    model = std::make_unique<CommandModel>(*spec.command, spec.names, outputs);
  }
  std::filesystem::path memory = spec.memory;
  if (memory.empty() && !common.output.empty()) {
    memory = common.output / kModelRuns;
    if (!common.resume) emulator::Journal::remove(memory);
  }
  // The identity of stored results omits keys that do not change results.
  Json identity = file.json.at(kPredictor);
  for (const char* key : {"timeout", "retries", "memory", "emulator"}) identity.erase(key);
  identity["inputs"] = spec.names;
  if (spec.command && !spec.command->files.json().empty())
    identity["files"] = spec.command->files.json();
  return std::make_shared<RememberedModel>(std::make_shared<InOrder>(std::move(model), spec.order),
                                           memory, identity.dump());
}

Report outside_report(const OutsideSpec& spec, const OutsideModel& model,
                      const OutsideEmulator* emulator) {
  Report out = {{"model", in_words(spec)}, {"inputs", spec.names}};
  if (const auto* asked = dynamic_cast<const RememberedModel*>(&model)) {
    out["asked"] = asked->asked();
    out["remembered"] = asked->remembered();
    out["gradients"] = asked->slopes();
  }
  if (emulator == nullptr) return out;
  Report modes = Report::array();
  for (std::size_t m = 0; m < emulator->error().holdout.size(); ++m) {
    const auto& error = emulator->error().holdout[m];
    modes.push_back({{"rmse", error.rmse},
                     {"max_error", error.max_error},
                     {"q2", error.q2},
                     {"leave_one_out_rmse", emulator->error().leave_one_out[m]},
                     {"scale", emulator->error().scale[m]}});
  }
  Report box = Report::object();
  for (const auto& factor : emulator->box()) box[factor.name] = {factor.low(), factor.high()};
  out["emulator"] = {{"kind", "Gaussian process"},
                     {"runs", emulator->runs()},
                     {"fresh_runs", emulator->fresh_runs()},
                     {"box", box},
                     {"modes", modes}};
  return out;
}

}  // namespace wheeltap::apps
