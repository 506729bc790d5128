#include "apps/commands/serve_command.hpp"

#include <iostream>
#include <limits>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "base/parallel.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

/// Shows the progress of training; this command does not sample.
class ServeWatch final : public RunWatch {
 public:
  explicit ServeWatch(bool quiet) : bar_(quiet) {}
  inference::Posterior sample(const inference::Problem&, inference::Options) override {
    throw std::logic_error("ServeWatch: nothing is sampled");
  }
  void show(const char* stage, double fraction, const std::string& detail) override {
    bar_.show(stage, fraction, detail);
  }
  void clear() override { bar_.clear(); }
  void note(const std::string&) override {}
  void warn(const std::string& line) override { std::cerr << "wheeltap: " << line << '\n'; }
  [[nodiscard]] bool stopped() const override { return was_interrupted(); }

 private:
  ProgressBar bar_;
};

std::vector<ServedModel> models_of(CaseFile file, CommonOptions common) {
  common.max_memory_gb =
      std::numeric_limits<double>::infinity();  // this command has no such option
  const Command* command = command_of_kind(file);
  if (command == nullptr || !command->make_run)
    file.refuse(Pointer("/kind"),
                "must be one of " + listed(case_kinds(true)) + " for wheeltap serve");
  const auto run = command->make_run(std::move(file), common, {});
  ServeWatch watch(common.quiet);
  run->prepare(watch);
  return run->served();
}

}  // namespace

void run_serve(const CommonOptions& common, const ServeOptions& options) {
  const std::vector<ServedModel> models =
      models_of(read_case(common.case_path, common.overrides), common);
  const StopOnInterrupt stop;
  serve_models(models, {.host = options.host,
                        .port = options.port,
                        .threads = base::thread_count(common.threads),
                        .ready =
                            [&](int port) {
                              std::cout
                                  << "Serving " << io::printable(common.case_path.string())
                                  << " at http://"
                                  << (options.host == "127.0.0.1" ? "localhost" : options.host)
                                  << ":" << port << " (Ctrl-C ends it):";
                              for (const ServedModel& model : models)
                                std::cout << (&model == &models[0] ? " " : ", ") << model.name;
                              std::cout << std::endl;
                            },
                        .stop = was_interrupted});
}

Command serve_command() {
  const auto serving = std::make_shared<ServeOptions>();
  return {.name = "serve",
          .summary = "serve the case's predictor to other programs as a UM-Bridge model",
          .add_options =
              [serving](CommandOptions& options) {
                options.add_case();
                CLI::App& app = options.app();
                app.add_option("--port", serving->port,
                               "TCP port of the server (default or 0: any free port)")
                    ->transform(whole(0, 65535));
                app.add_option("--host", serving->host,
                               "address of the server (default 127.0.0.1: this machine only; "
                               "0.0.0.0: all network interfaces)");
                options.add_quiet();
                options.add_threads();
                options.add_permissions();
              },
          .run = [serving](const Invocation& asked) { run_serve(asked.common, *serving); }};
}

}  // namespace wheeltap::apps
