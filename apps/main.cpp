// wheeltap: the command line.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <stdexcept>

#include "apps/batch_command.hpp"
#include "apps/command_line_faults.hpp"
#include "apps/command_line_options.hpp"
#include "apps/commands.hpp"
#include "apps/compare_command.hpp"
#include "apps/data_command.hpp"
#include "apps/explain.hpp"
#include "apps/failure_of.hpp"
#include "apps/init.hpp"
#include "apps/law_page.hpp"
#include "apps/modal_command.hpp"
#include "apps/program_text.hpp"
#include "apps/report/report.hpp"
#include "apps/restart.hpp"
#include "apps/run_cost.hpp"
#include "apps/section_command.hpp"
#include "apps/serve_command.hpp"
#include "apps/several_ranks.hpp"
#include "apps/update_command.hpp"
#include "base/simd.hpp"
#include "io/bytes.hpp"
#include "io/date_of_files.hpp"
#include "io/text.hpp"
#include "io/text_layout.hpp"

namespace {

using namespace wheeltap;
using apps::Exit;

std::string& last_words() {
  static std::string words;
  return words;
}

int report(Exit exit, const std::string& line) {
  // Names, keys and values in it are a user's: one line, whatever they hold.
  std::string words = io::printable(line);
  // What was typed may be of any length; what it lacks stands before it or behind.
  constexpr std::size_t kLongest = 1000;
  if (exit == Exit::usage && words.size() > kLongest)
    words.replace(kLongest / 2, words.size() - kLongest, " ... ");
  words = io::printable(words);  // the cut may have halved a character
  std::cerr << "wheeltap: " << words << '\n';
  last_words() = words;
  return static_cast<int>(exit);
}

// The end of whatever says something: a full disk behind standard output is no success.
int printed() {
  std::cout.flush();
  if (!std::cout) return report(Exit::cannot_create, "standard output cannot be written");
  return static_cast<int>(Exit::done);
}

std::string joined(int argc, char** argv) {
  std::string line = "wheeltap";
  for (int i = 1; i < argc; ++i) {
    const std::string word = io::printable(argv[i]);
    const bool plain =
        !word.empty() && word.find_first_of(" '\"{}[]$*?&|;<>()\\") == std::string::npos;
    line += " " + (plain ? word : "'" + word + "'");
  }
  return line;
}

// Before there is anything to lose.
void check_date_of_files() {
  try {
    (void)io::date_of_files();
  } catch (const std::invalid_argument& error) {
    throw apps::Failure(Exit::usage, error.what());
  }
}

// How the program is asked to start, before anything else of the command line is read.
void obey_simd(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    constexpr std::string_view kOption = "--simd";
    std::string value;
    if (word == kOption && i + 1 < argc) value = argv[i + 1];
    if (word.starts_with(std::string(kOption) + "=")) value = word.substr(kOption.size() + 1);
    if (value == "baseline" || value == "avx2" || value == "avx512")
      apps::restart_with(value, argv);
  }
}

// What --help says, for shells and manuals.
apps::ProgramText text_of(const CLI::App& app) {
  apps::ProgramText program{.name = "wheeltap",
                            .version = WHEELTAP_VERSION,
                            .description = app.get_description(),
                            .commands = {}};
  for (const CLI::App* command : app.get_subcommands({})) {
    program.commands.push_back(
        {.name = command->get_name(), .description = command->get_description(), .options = {}});
    for (const CLI::Option* option : command->get_options()) {
      apps::OptionText text{.names = {}, .description = option->get_description(), .value = {}};
      text.is_argument = option->get_positional();
      if (text.is_argument) text.names.push_back(option->get_name());
      for (const std::string& name : option->get_snames()) text.names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) text.names.push_back("--" + name);
      if (option->get_items_expected_max() > 0) text.value = option->get_type_name();
      program.commands.back().options.push_back(std::move(text));
    }
  }
  return program;
}

constexpr const char* kSummary = "print summary.json in place of the text";

/// "--output is required: …", with its own help and an example.
std::string output_is_missing(const CLI::App& command) {
  const CLI::Option* output = command.get_option("--output");
  std::string what = output->get_description();
  if (const std::string prefix = "required: "; what.starts_with(prefix))
    what.erase(0, prefix.size());
  const std::string type = output->get_type_name();
  return "--output is required: " + what + ", e.g. -o results" +
         (type.starts_with("FILE") ? type.substr(4) : "");
}

/// With --json: standard output holds one JSON value, in place of all that commands print.
class JsonOutput {
 public:
  JsonOutput(bool wanted, apps::CommonOptions& common) : common_(common) {
    if (!wanted) return;
    common.as_json = [this](const std::string& json) { said_.push_back(json); };
    if (common.dry_run) {
      common.dry_run = [this](const std::string& what, const apps::RunCost& cost) {
        said_.push_back(apps::estimate_json(what, cost));
      };
    }
    terminal_ = std::cout.rdbuf(&silence_);
  }
  JsonOutput(const JsonOutput&) = delete;
  JsonOutput& operator=(const JsonOutput&) = delete;
  ~JsonOutput() { give_back(); }

  /// What the command said before it failed, if anything.
  void print_said() {
    if (said_.empty()) return give_back();
    print();
  }
  /// What the command said, else the summary in its folder.
  void print() {
    if (terminal_ == nullptr) return;
    give_back();
    if (!base::is_first_rank()) return;
    if (said_.empty())
      said_.push_back(io::read_bytes(common_.output / "summary.json", std::size_t{1} << 31U));
    if (said_.size() == 1) {
      std::cout << said_[0] << (said_[0].ends_with('\n') ? "" : "\n");
      return;
    }
    for (std::size_t i = 0; i < said_.size(); ++i) std::cout << (i == 0 ? "[" : ",\n ") << said_[i];
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

  const apps::CommonOptions& common_;
  Silence silence_;
  std::streambuf* terminal_ = nullptr;
  std::vector<std::string> said_;
};

int run(int argc, char** argv) {
  // A file that may not grow is an error of writing, which has a line and an exit code.
  std::signal(SIGXFSZ, SIG_IGN);
  // What is ours is locked by ourselves, and on some file systems of clusters nothing can be.
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  CLI::App app{
      "Structural health monitoring: how many damages, where, how bad, with honest "
      "probabilities"};
  app.set_version_flag("--version", std::string("wheeltap ") + WHEELTAP_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);

  apps::CommonOptions common;
  bool as_json = false;
  common.command_line = joined(argc, argv);
  apps::ModesOptions modes;
  apps::SamplingOptions sampling;
  std::string schema = "damage";
  constexpr int kMany = 1'000'000'000;
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();

  const auto add_case = [&](CLI::App* command) {
    command->add_option("CASE", common.case_path, "the case, a JSON file")->required();
    command->add_option("--set", common.overrides, "override the case: path.to.key=VALUE")
        ->take_all()
        ->allow_extra_args(false);
  };
  // `type` is what the help calls the value: FOLDER, FILE.nc.
  const auto add_output = [&](CLI::App* command, const char* type, const char* what) {
    command->add_option("-o,--output", common.output, std::string("required: ") + what)
        ->required()
        ->type_name(type);
    command->add_flag("--quiet", common.quiet, "no progress on standard error");
  };
  constexpr const char* kResults =
      "the folder for the results: summary.json, posterior.nc and report.html";
  const auto add_json = [&](CLI::App* command, const char* what) {
    command->add_flag("--json", as_json, what);
  };
  const auto add_seed = [&](CLI::App* command, const char* what) {
    command->add_option("--seed", common.seed, what)->transform(apps::whole(0, kLargestSeed));
  };
  const auto add_limits = [&](CLI::App* command) {
    command
        ->add_option("--max-memory", common.max_memory_gb,
                     "GB: a run is refused that would take more (default 4)")
        ->check(apps::positive());
    command
        ->add_option("--max-hours", common.max_hours,
                     "a run is refused that would take longer (default 100)")
        ->check(apps::positive());
    command
        ->add_option("--max-disk", common.max_disk_gb,
                     "GB: a run is refused whose draws would take more in the folder of its "
                     "results (default: what is free there)")
        ->check(apps::positive());
  };
  const auto add_dry_run = [&](CLI::App* command) {
    command->add_flag_callback(
        "--dry-run", [&] { common.dry_run = apps::print_estimate; },
        "print the estimated run time and memory, and stop; needs no --output");
    command->get_option("--output")->required(false);  // unless it runs
  };
  const auto add_permissions = [&](CLI::App* command) {
    command->add_flag("--allow-commands", common.allow_commands,
                      "let the case run programs (\"predictor\": {\"command\": ...})");
    command
        ->add_option("--allow-hosts", common.allow_hosts,
                     "let the case reach this host, once for each (\"predictor\": {\"umbridge\": "
                     "...}); this machine needs no leave")
        ->type_name("NAME")
        ->take_all()
        ->allow_extra_args(false);
  };
  std::string simd;  // obeyed before
  const auto add_threads = [&](CLI::App* command) {
    command
        ->add_option("--simd", simd,
                     "keep to the vector instructions baseline, avx2 or avx512 (default: the "
                     "processor's)")
        ->check(CLI::IsMember({"baseline", "avx2", "avx512"}));
    command
        ->add_option("--threads", common.threads, "threads (default: all); never changes a result")
        ->envname(apps::kThreadsVariable)
        ->transform(apps::whole(1, 4096));
  };

  const auto add_sampling = [&](CLI::App* command) {
    command->add_option("--chains", sampling.chains, "independent chains (default 4)")
        ->transform(apps::whole(1, 1000));
    command
        ->add_option("--warmup", sampling.warmup,
                     "iterations a chain before the first draw (default: chosen)")
        ->transform(apps::whole(1, kMany));
    command
        ->add_option("--draws", sampling.draws,
                     "draws a chain, after warm-up (default: until converged)")
        ->transform(apps::whole(100, kMany));
    command
        ->add_option("--search", sampling.searches,
                     "climbs to modes of each model, from draws of its prior (default: chosen)")
        ->transform(apps::whole(0, kMany));
    command
        ->add_option("--checkpoint", common.checkpoint_seconds,
                     "seconds between two checkpoints for --resume (default 60; 0: none)")
        ->check(apps::seconds());
    CLI::Option* prior_only = command->add_flag("--prior-only", sampling.prior_only,
                                                "leave the data out: must return the prior");
    command
        ->add_flag("--quick", sampling.quick,
                   "fixed, little work: modes and short chains, never a posterior; --dry-run "
                   "estimates its time")
        ->excludes(prior_only);
    command
        ->add_flag("--evidence{tmcmc+bridge}", sampling.evidence,
                   "also the evidence of each model on its own: --evidence, or "
                   "--evidence=METHODS of tmcmc, bridge, laplace, joined by +")
        ->excludes(prior_only);
  };

  CLI::App* modes_command =
      app.add_subcommand("modes", "natural frequencies of the case's beam or structure");
  add_case(modes_command);
  modes_command->add_option("--modes", modes.modes, "how many, rigid-body ones included")
      ->transform(apps::whole(1, kMany));
  modes_command->add_flag("--truth", modes.truth, "damaged as damage.truth says");
  modes_command->add_flag("--json", modes.json, "as JSON");
  modes_command->add_flag("--shapes", modes.shapes, "with --json: the shapes too");
  modes_command->add_option("--vtk", modes.vtk,
                            "draw the structure and its shapes into this file, for ParaView");

  apps::SectionOptions section;
  CLI::App* section_command =
      app.add_subcommand("section", "properties of the case's cross-section, from its outline");
  add_case(section_command);
  section_command->add_option("-o,--output", common.output, "draw the section into this file")
      ->type_name("FILE.svg|FILE.html");
  section_command->add_option("--name", section.name, "which of a structure's sections");
  section_command->add_flag("--json", section.json, "as JSON");

  apps::DataOptions measured;
  CLI::App* data_command =
      app.add_subcommand("data", "what a measured file holds, and what is odd about it");
  data_command
      ->add_option("FILE", measured.file,
                   "delimited text, MATLAB, Excel, universal file or another format")
      ->required();
  data_command->add_option("-o,--output", measured.page, "draw the record into this file")
      ->type_name("FILE.html");
  data_command->add_option("--to", measured.to,
                           "convert: csv, nc or uff, or the file to write with such an ending");
  data_command
      ->add_option("--sample-rate", measured.reading.sample_rate_hz,
                   "in Hz, where the file does not say")
      ->check(apps::positive());
  data_command->add_flag("--json", measured.json, "as JSON");
  apps::add_layout(data_command, measured.reading.layout, measured.reading.arrays);
  data_command->add_flag("--resample", measured.reading.resample,
                         "interpolate a record of uneven time steps at an even rate");

  CLI::App* table_command = app.add_subcommand(
      "table", "run a design of experiments, train the emulator, measure its error");
  add_case(table_command);
  add_output(table_command, "FILE.nc", "the table file to write, NetCDF");
  add_json(table_command, "print the emulator's errors as JSON");
  add_seed(table_command, "of the fresh FE runs that measure the error (default 1)");
  add_threads(table_command);
  add_limits(table_command);
  add_dry_run(table_command);
  table_command->add_flag("--resume", common.resume, "go on where an interrupted table stopped");
  apps::TableOptions tabling;
  table_command->add_option("--part", tabling.part, "I/N: make this part of the FE runs only");
  table_command->add_option("--merge", tabling.merge,
                            "the parts to join: their FE runs are not repeated");

  CLI::App* damage_command = app.add_subcommand("damage", "how many damages, where, how bad");
  add_case(damage_command);
  add_output(damage_command, "FOLDER", kResults);
  add_json(damage_command, kSummary);
  add_seed(damage_command, "of the chains (default 1)");
  add_threads(damage_command);
  add_sampling(damage_command);
  add_permissions(damage_command);
  add_limits(damage_command);
  add_dry_run(damage_command);
  damage_command->add_flag("--resume", common.resume,
                           "go on where an interrupted run stopped; print a finished one again");

  CLI::App* sid_command = app.add_subcommand("sid", "which equation of motion a record obeys");
  add_case(sid_command);
  add_output(sid_command, "FOLDER", kResults);
  add_json(sid_command, kSummary);
  add_seed(sid_command, "of the chains (default 1)");
  add_threads(sid_command);
  add_sampling(sid_command);
  add_limits(sid_command);
  add_dry_run(sid_command);
  sid_command->add_flag("--resume", common.resume,
                        "go on where an interrupted run or sweep stopped; print a finished one "
                        "again");

  CLI::App* modal_command =
      app.add_subcommand("modal", "modes with their uncertainty, from records of a vibration");
  add_case(modal_command);
  add_output(modal_command, "FOLDER",
             "the folder for the results: modes.json, summary.json and report.html");
  add_json(modal_command, kSummary);
  add_threads(modal_command);
  add_dry_run(modal_command);

  CLI::App* batch_command =
      app.add_subcommand("batch", "many cases, each by its kind, with one table of results");
  batch_command->add_option("LIST", common.case_path, "one path of a case a line; # comments")
      ->required();
  batch_command->add_option("--set", common.overrides, "override every case: path.to.key=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  add_output(batch_command, "FOLDER",
             "the folder for the results: batch.csv, and one folder per case");
  add_json(batch_command, "print the table as JSON");
  add_seed(batch_command, "of every run's chains (default 1)");
  add_threads(batch_command);
  add_sampling(batch_command);
  add_permissions(batch_command);
  add_limits(batch_command);
  add_dry_run(batch_command);
  batch_command->add_flag("--resume", common.resume,
                          "keep finished runs, go on with interrupted ones, run the others");

  CLI::App* update_command =
      app.add_subcommand("update", "a structure's parameters from its measured modes");
  add_case(update_command);
  add_output(update_command, "FOLDER", kResults);
  add_json(update_command, kSummary);
  add_seed(update_command, "of the chains (default 1)");
  add_threads(update_command);
  add_sampling(update_command);
  add_permissions(update_command);
  add_limits(update_command);
  add_dry_run(update_command);
  update_command->add_flag("--resume", common.resume,
                           "go on where an interrupted run stopped; print a finished one again");

  apps::ServeOptions serving;
  CLI::App* serve_command = app.add_subcommand(
      "serve", "offer the case's predictor to other programs, as a UM-Bridge model");
  add_case(serve_command);
  serve_command->add_option("--port", serving.port, "to listen at (default: one that is free)")
      ->transform(apps::whole(0, 65535));
  serve_command->add_option("--host", serving.host,
                            "address to listen at (default 127.0.0.1, this machine alone; 0.0.0.0: "
                            "whoever reaches it)");
  serve_command->add_flag("--quiet", common.quiet, "no progress on standard error");
  add_threads(serve_command);
  add_permissions(serve_command);

  CLI::App* simulate_command =
      app.add_subcommand("simulate", "synthetic data from the case's truth");
  add_case(simulate_command);
  add_output(simulate_command, "FILE",
             "the file to write: .csv, or .json for a complete damage or update case");
  add_json(simulate_command, "print what was written as JSON");
  add_limits(simulate_command);
  add_seed(simulate_command, "of the noise (default: the case's, or 1)");

  apps::ReportOptions drawing;
  CLI::App* report_command =
      app.add_subcommand("report", "draw report.html of a finished run again");
  report_command->add_option("DIR", common.output, "the folder of the run")->required();
  report_command->add_flag("--figures", drawing.figures,
                           "write the figures as SVG files too (needs Node.js)");

  apps::CompareOptions comparing;
  CLI::App* compare_command = app.add_subcommand(
      "compare", "which of several finished runs' cases explains the data that they share");
  compare_command->add_option("DIR", comparing.folders, "the folders of the runs")->required();
  compare_command
      ->add_option("--prior", comparing.prior,
                   "their prior weights, one a folder, after commas (default: all alike)")
      ->delimiter(',')
      ->check(apps::positive());
  compare_command->add_flag("--json", comparing.json, "as JSON");

  std::string starting;
  std::filesystem::path start_in = ".";
  CLI::App* init_command =
      app.add_subcommand("init", "a case to start from, every key explained beside it");
  std::string start_structure = "beam";
  init_command->add_option("KIND", starting, "damage, sid, update or modal")->required();
  init_command->add_option("--structure", start_structure,
                           "of damage: beam (unless given), frame, building or matrices");
  init_command
      ->add_option("-o,--output", start_in, "the folder for the files (default: this folder)")
      ->type_name("FOLDER");

  apps::LawsOptions laws;
  CLI::App* laws_command =
      app.add_subcommand("laws", "the force laws of links: formula, sign, keys, an example each");
  laws_command->add_option("NAME", laws.name, "one law (default: all)");
  laws_command->add_flag("--example", laws.example, "a case that has it, alone");
  laws_command->add_option("--figures", laws.figures, "a folder to write their pictures into, SVG");

  CLI::App* schema_command = app.add_subcommand("schema", "the JSON Schema of a case");
  schema_command->add_option("NAME", schema, "which kind of case (default: damage)");

  std::string key;
  CLI::App* explain_command =
      app.add_subcommand("explain", "what a key of a case means, and what may stand there");
  explain_command->add_option("KEY", key, "e.g. count.max or /data/cov")->required();

  std::string shell;
  CLI::App* completion_command =
      app.add_subcommand("completion", "what a shell sources to complete commands and options");
  completion_command->add_option("SHELL", shell, "bash, zsh or fish")->required();
  CLI::App* man_command = app.add_subcommand("man", "the manual page, for man -l -");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return printed();
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    std::string what = error.what();
    if (chosen.empty() && argc > 1 && argv[1][0] != '-') {
      what = apps::unknown_command(app, argv[1]);
    }
    if (!chosen.empty()) {
      if (const std::string words = apps::unexpected_words(app, *chosen[0]); !words.empty())
        what = words;
      if (what == "CASE is required")
        what += ": the path of a case file, e.g. wheeltap " + chosen[0]->get_name() + " case.json";
      if (what == "--output is required") what = output_is_missing(*chosen[0]);
    }
    // The number may be the environment's, which nobody typed.
    const bool typed = std::any_of(argv + 1, argv + argc, [](const char* word) {
      return std::string_view(word).starts_with("--threads");
    });
    if (const std::string option = "--threads: "; what.starts_with(option) && !typed)
      what.replace(0, option.size(), std::string(apps::kThreadsVariable) + ": ");
    std::ranges::replace(what, '\n', ' ');
    return report(Exit::usage, what + " (see wheeltap " +
                                   (chosen.empty() ? "" : chosen[0]->get_name() + " ") + "--help)");
  }

  if (base::ranks() != nullptr) {
    if (common.threads == 0) common.threads = 1;
    const auto shared = {table_command, damage_command, sid_command, update_command, batch_command};
    // Whatever else there is rank 0 does by itself.
    if (std::ranges::none_of(shared, [](const CLI::App* command) { return command->parsed(); })) {
      if (!base::is_first_rank()) return 0;
      base::ranks() = nullptr;
    }
  }
  JsonOutput json(as_json, common);
  try {
    check_date_of_files();
    if (base::ranks() != nullptr) apps::require_equal_processors();
    for (const CLI::App* runs : {table_command, damage_command, sid_command, update_command,
                                 modal_command, batch_command}) {
      if (runs->parsed() && common.output.empty() && !common.dry_run) {
        throw apps::Failure(Exit::usage, output_is_missing(*runs) + " (see wheeltap " +
                                             runs->get_name() + " --help)");
      }
    }
    if (modes_command->parsed()) apps::run_modes(common, modes);
    if (section_command->parsed()) apps::run_section(common, section);
    if (data_command->parsed()) apps::run_data(measured);
    if (table_command->parsed()) apps::run_table(common, tabling);
    if (damage_command->parsed()) apps::run_damage(common, sampling);
    if (sid_command->parsed()) apps::run_sid(common, sampling);
    if (modal_command->parsed()) apps::run_modal(common);
    if (batch_command->parsed()) apps::run_batch(common, sampling);
    if (update_command->parsed()) apps::run_update(common, sampling);
    if (serve_command->parsed()) apps::run_serve(common, serving);
    if (simulate_command->parsed()) apps::run_simulate(common);
    if (report_command->parsed()) apps::run_report(common.output, drawing);
    if (init_command->parsed()) apps::run_init(starting, start_structure, start_in);
    if (laws_command->parsed()) apps::run_laws(laws);
    if (compare_command->parsed()) apps::run_compare(comparing);
    if (schema_command->parsed()) apps::run_schema(schema);
    if (explain_command->parsed()) std::cout << apps::explanation(key);
    if (completion_command->parsed()) std::cout << apps::completion(text_of(app), shell);
    if (man_command->parsed()) std::cout << apps::man_page(text_of(app));
    json.print();
    return printed();
  } catch (const apps::FailedOnFirstRank&) {
    return static_cast<int>(Exit::done);  // that one says and returns what it was
  } catch (const std::exception&) {
    json.print_said();
    const apps::Failure failure = apps::failure_of(std::current_exception(), common.case_path);
    return report(failure.exit(), failure.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  obey_simd(argc, argv);
  try {
    apps::JoinedRanks joined;
    const int code = run(argc, argv);
    joined.leave(code, last_words());
    return code;
  } catch (const apps::Failure& failure) {
    return report(failure.exit(), failure.what());
  }
}
