#include "apps/runs/sid/sid_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "apps/failure.hpp"
#include "apps/report/report.hpp"
#include "apps/results/sid_summary.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "apps/runs/sid/sweep_journal.hpp"
#include "apps/text/answer.hpp"
#include "apps/text/verdict_words.hpp"
#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// A line of the table, and its headings.
struct Row {
  std::vector<std::string> header, cells;

  void add(const std::string& name, const std::string& cell) {
    header.push_back(name);
    cells.push_back(cell);
  }
};

std::string line(const std::vector<std::string>& list) {
  std::string text;
  for (const auto& cell : list) text += (text.empty() ? "" : ",") + cell;
  return text + "\n";
}

std::string csv_number(double x, int digits = 8) {
  return std::isfinite(x) ? significant(x, digits) : "";
}

Row table_row(const std::string& value, const SidFindings& findings) {
  Row row;
  row.add("value", value);
  for (const ModelFinding& m : findings.models) {
    const bool known = std::isfinite(m.standing.mcse);
    row.add("P(" + m.name + ")", known ? csv_number(m.probability()) : "");
    row.add("mcse", csv_number(m.standing.mcse));
    row.add("basis", m.standing.basis == inference::Basis::draws ? "draws" : "evidence");
  }
  for (const BayesFactor& b : findings.bayes_factors) {
    row.add("ln B(" + findings.models[static_cast<std::size_t>(b.model)].name + ":" +
                findings.models[static_cast<std::size_t>(b.against)].name + ")",
            b.log ? csv_number(*b.log) : "");
    row.add("mcse", csv_number(b.error));
  }
  for (const EvidenceFinding& by : findings.evidence) {
    const inference::Evidence& first = by.evidences[0];
    for (std::size_t m = 1; m < by.evidences.size(); ++m) {
      const inference::Evidence& e = by.evidences[m];
      row.add(method_name(by.method) + " ln B(" + findings.models[m].name + ")",
              csv_number(e.log_evidence - first.log_evidence));
      row.add("se", csv_number(std::hypot(e.standard_error, first.standard_error), 4));
    }
  }
  row.add("converged", findings.sampling.verdict.converged ? "1" : "0");
  return row;
}

Report summary_row(const Json& value, const SidFindings& findings) {
  const Report diagnosed = diagnostics(findings, warnings(findings, {}));
  Report row = {{"value", Report::parse(value.dump())},
                {"models", model_table(findings)},
                {"log_bayes_factors", bayes_factors_report(findings)},
                {"parameters", parameter_tables(findings)},
                {"fit", fit_report(findings.fit_verdict)},
                {"fit_at_mean", fits_report(findings)},
                {"converged", diagnosed["converged"]},
                {"explained", findings.fit_verdict.ok()},
                {"not_established", diagnosed["not_established"]},
                {"resolution", diagnosed["resolution"]},
                {"warnings", diagnosed["warnings"]},
                {"cost", cost(findings.sampling)}};
  if (!findings.evidence.empty()) row["evidence"] = evidence_report(findings);
  return row;
}

/// Comment lines for a row: reasons why it has not converged, and probabilities from evidence.
std::string remarks(const SidFindings& findings) {
  std::string text;
  const auto& open = findings.sampling.verdict.not_established;
  for (const std::string& sentence : in_words(open, *findings.space)) {
    text += "# " + sentence + '\n';
  }
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const std::string told = told_by_evidence(findings.models[m]);
    // Omit the comment if a reason already refers to the model.
    const auto about_it = [m](const auto& reason) {
      if constexpr (requires { reason.model; }) {
        return reason.model == static_cast<int>(m);
      } else {
        return false;
      }
    };
    const bool said = std::ranges::any_of(
        open, [&](const inference::Reason& reason) { return std::visit(about_it, reason); });
    if (!told.empty() && !said) text += "# " + findings.models[m].name + ": " + told + '\n';
  }
  return text;
}

/// The row of one value for the journal; empty if the run was interrupted.
std::optional<Report> run_row(const SidCaseFile& one, const Json& value,
                              const CommonOptions& common, const SamplingOptions& options,
                              CheckpointFile& checkpoint, spdlog::logger& log) {
  try {
    TerminalWatch watch(common, log);
    watch.keep(checkpoint);
    const SidFindings findings = identify(one, common, options, watch).findings;
    if (was_interrupted()) return {};
    if (!base::is_first_rank()) return Report();
    const Row row = table_row(value.dump(), findings);
    return Report{{"header", line(row.header)},
                  {"cells", line(row.cells)},
                  {"remarks", remarks(findings)},
                  {"summary", summary_row(value, findings)}};
  } catch (const Failure& failure) {
    if (failure.exit() != Exit::interrupted) throw;
    return {};
  }
}

/// The identity of a case without its sweep values, so that finished rows remain valid.
std::string identity_of_rows(const CaseFile& file, const CommonOptions& common,
                             const SamplingOptions& options) {
  Json fixed = file.json;
  fixed["sweep"].erase("values");
  return std::string(WHEELTAP_VERSION) + fixed.dump() + std::to_string(common.seed.value_or(1)) +
         options_report(options).dump();
}

std::optional<Report> stored_sweep(const std::filesystem::path& folder) {
  std::optional<Report> summary = stored_summary(folder);
  const auto has = [&](const char* name) {
    return summary->is_object() && summary->contains(name) && (*summary)[name].is_object();
  };
  return summary && has("sweep") && has("wheeltap") ? summary : std::nullopt;
}

std::string stopped(std::size_t done, std::size_t all, bool within) {
  return "stopped after " + std::to_string(done) + " of " + std::to_string(all) + " values" +
         (done > 0 || within ? ": the same command with --resume continues the sweep" : "");
}

void print_files(const std::filesystem::path& folder) {
  std::cout << "Results: " << io::printable((folder / "sweep.csv").string()) << " (the table), "
            << io::printable((folder / "summary.json").string()) << " (all numbers)\n";
}

/// The files of a sweep; their names are reserved before the sweep runs.
struct SweepFiles {
  SweepFiles(const std::filesystem::path& folder, const std::string& identity, bool resume)
      : table(folder / "sweep.csv"),
        summary(folder / "summary.json"),
        report(folder / "report.html"),
        journal(folder / "sweep.rows", identity, resume) {}

  io::AtomicFile table, summary, report;
  SweepJournal journal;
};

/// The case for one value of the sweep.
CaseFile with(const CaseFile& file, const Pointer& where, const Json& value) {
  CaseFile one = file;
  one.inputs = std::make_shared<InputFiles>(file.inputs->emptied());
  one.json.erase("sweep");
  one.json[where] = value;
  return one;
}

/// The cost of all rows, estimated from a few rows between the first and the last.
RunCost cost_of_sweep(const CaseFile& file, const Pointer& where, const CommonOptions& common,
                      const SamplingOptions& options) {
  const Json& values = file.json["sweep"]["values"];
  const std::size_t asked = std::min<std::size_t>(values.size(), 5);
  RunCost all;
  for (std::size_t i = 0; i < asked; ++i) {
    const std::size_t row = asked < 2 ? 0 : i * (values.size() - 1) / (asked - 1);
    CaseFile one = with(file, where, values[row]);
    require_room_for_truth(one, common);
    const SidCaseFile parsed = parse_sid_case(std::move(one));
    const RunCost cost = cost_of_sid(parsed, common, options);
    const double share = static_cast<double>(values.size()) / static_cast<double>(asked);
    double kept = 20e3;  // bytes of a parsed case without its record
    for (const SidChannel& channel : parsed.sid.channels) {
      kept += 8.0 * static_cast<double>(channel.signal.samples.size());
    }
    all.bytes += cost.bytes / static_cast<double>(asked) + kept * share;
    all.likelihoods += cost.likelihoods * share;
    all.seconds += cost.seconds * share;
  }
  return all;
}

}  // namespace

namespace {

/// The value that a sweep varies. The pointer may have invalid syntax, or name a missing key or an
/// element beyond the end of a list.
Pointer swept_place(const CaseFile& file, const std::string& path) {
  const Pointer where("/sweep/path");
  Pointer pointer;
  try {
    pointer = Pointer(path);
  } catch (const Json::exception&) {
    file.refuse(where, "must be a JSON pointer, e.g. \"/record/samples/1\"");
  }
  bool there = false;
  try {
    there = file.json.contains(pointer);
  } catch (const Json::exception&) {  // an invalid number of a list element
  }
  if (!there) file.refuse(where, "must point to an existing value of this case");
  if (pointer.empty() || path == "/sweep" || path.starts_with("/sweep/"))
    file.refuse(where, "must point to a single value of the case, outside of \"sweep\"");
  return pointer;
}

}  // namespace

void sweep_sid(CaseFile file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log) {
  validate_against_schema(file, "sid");
  const Json sweep = file.json["sweep"];
  const auto path = sweep["path"].get<std::string>();
  const Pointer pointer = swept_place(file, path);
  const RunCost cost = cost_of_sweep(file, pointer, common, options);
  require_affordable(file, Pointer("/sweep"), cost, common);
  if (common.dry_run) return common.dry_run("sweep", cost);
  on_first_rank([&] { claim_output_folder(common.output); });
  // Parse all cases first, so that an error in the last case stops the sweep before it runs.
  std::vector<SidCaseFile> cases;
  for (const Json& value : sweep["values"]) {
    CaseFile one = with(file, pointer, value);
    require_room_for_truth(one, common);
    cases.push_back(parse_sid_case(std::move(one)));
  }
  Json inputs = Json::array();  // one entry per value
  for (const SidCaseFile& one : cases) inputs.push_back(one.file.inputs->json());
  require_same_on_all_ranks("case", file.json.dump() + inputs.dump());
  const bool first = base::is_first_rank();
  const std::string identity = identity_of_rows(file, common, options);
  const std::string run = io::fingerprint(identity + sweep["values"].dump() + inputs.dump());
  bool whole = false;
  const auto finished = first_rank_says([&]() -> std::optional<std::string> {
    io::finish_commit(common.output);
    const auto stored = stored_sweep(common.output);
    whole = stored && !(*stored)["sweep"].contains("left");
    if (!common.resume || !whole || (*stored)["wheeltap"].value("run", "") != run) return {};
    return sealed_file(common.output, "sweep.csv", *stored).value_or("");
  });
  if (finished && !first) return;
  if (finished) {
    log.info("{} holds the finished results of this sweep; nothing is run again.",
             io::printable(common.output.string()));
    std::cout << *finished;
    // Remove files that a run could not remove because it was killed at its end.
    if (const auto rows = common.output / "sweep.rows"; std::filesystem::exists(rows))
      SweepJournal(rows, identity, true).remove();
    CheckpointFile::discard(common.output);
    return print_files(common.output);
  }
  outlive_readers();
  std::optional<SweepFiles> files;
  on_first_rank([&] { files.emplace(common.output, identity, common.resume); });
  Report rows = Report::array();
  std::string table;
  bool within = false;  // stopped within a row that has a checkpoint
  const StopOnInterrupt stop;
  for (std::size_t i = 0; i < cases.size() && !was_interrupted(); ++i) {
    const Json& value = sweep["values"][i];
    const Report key = {{"value", Report::parse(value.dump())},
                        {"inputs", Report::parse(inputs[i].dump())}};
    std::optional<Report> row;
    const auto found = first_rank_says([&]() -> std::optional<std::string> {
      row = files->journal.find(key);
      return row ? std::optional<std::string>("") : std::nullopt;
    });
    if (!found) {
      CheckpointFile checkpoint(common.output,
                                {.command = "sid",
                                 .seed = common.seed.value_or(1),
                                 .options = options_report(options),
                                 .case_json = cases[i].file.json,
                                 .inputs = cases[i].file.inputs->json()},
                                common, true);
      row = run_row(cases[i], value, common, options, checkpoint, log);
      within = checkpoint.kept();
      if (!row) break;
      on_first_rank([&] { files->journal.append(key, *row); });
      checkpoint.remove();
    }
    if (!first) {
      rows.push_back(nullptr);
      continue;
    }
    const auto text = [&](const char* of) { return (*row)[of].get<std::string>(); };
    if (i == 0) {
      const std::string& title = cases[i].sid.title;
      table = "# " + title + "; value of " + path + "\n" + text("header");
      std::cout << '\n' << title << "\nSweep of " << path << "\n" << text("header");
    }
    table += text("cells");
    std::cout << text("cells") << text("remarks") << std::flush;
    rows.push_back((*row)["summary"]);
  }
  const std::size_t left = cases.size() - rows.size();
  if (rows.empty() || (left > 0 && whole)) {
    if (rows.empty() && first) files->journal.remove();
    throw Failure(Exit::interrupted, stopped(rows.size(), cases.size(), within));
  }
  if (!first) return;
  Report summary = {
      {"wheeltap",
       about("sid", {.seed = common.seed.value_or(1), .command_line = common.command_line}, file)},
      {"sweep", {{"path", path}, {"rows", rows}}}};
  summary["wheeltap"]["run"] = run;
  if (left > 0) summary["sweep"]["left"] = left;
  summary["files"] = {{"sweep.csv", seal(table)}};
  summary["answer"] = json(read_answer(summary));
  files->table.write(table);
  files->summary.write(summary.dump(1) + "\n");
  files->report.write(report_page(common.output, summary, nullptr));
  io::AtomicFile* const all[] = {&files->table, &files->report, &files->summary};
  io::commit_together(all);
  if (left > 0) throw Failure(Exit::interrupted, stopped(rows.size(), cases.size(), within));
  files->journal.remove();
  CheckpointFile::discard(common.output);
  print_files(common.output);
}

}  // namespace wheeltap::apps
