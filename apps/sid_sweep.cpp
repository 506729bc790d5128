#include "apps/sid_sweep.hpp"

#include "apps/verdict_words.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "apps/report/answer.hpp"
#include "apps/report/report.hpp"
#include "apps/running.hpp"
#include "apps/sid_command.hpp"
#include "apps/sid_summary.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// A line of the table, with what heads it.
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

/// What the line above does not say.
void print_remarks(const SidFindings& findings) {
  const auto& open = findings.sampling.verdict.not_established;
  for (const std::string& sentence : in_words(open, *findings.space)) {
    std::cout << "# " << sentence << '\n';
  }
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const std::string told = told_by_evidence(findings.models[m]);
    // A reason that is about the model says as much.
    const auto about_it = [m](const auto& reason) {
      if constexpr (requires { reason.model; }) {
        return reason.model == static_cast<int>(m);
      } else {
        return false;
      }
    };
    const bool said = std::ranges::any_of(
        open, [&](const inference::Reason& reason) { return std::visit(about_it, reason); });
    if (!told.empty() && !said) {
      std::cout << "# " << findings.models[m].name << ": " << told << '\n';
    }
  }
  std::cout << std::flush;
}

}  // namespace

// What a case that is parsed keeps, besides its record.
constexpr double kCaseBytes = 20e3;

void sweep_sid(CaseFile file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log) {
  validate_against_schema(file, "sid");
  const Json sweep = file.json["sweep"];
  const auto path = sweep["path"].get<std::string>();
  Pointer pointer;
  try {
    pointer = Pointer(path);
  } catch (const Json::exception&) {
    file.refuse(Pointer("/sweep/path"), "must be a JSON pointer, e.g. \"/record/samples/1\"");
  }
  if (!file.json.contains(pointer)) {
    file.refuse(Pointer("/sweep/path"), "leads nowhere in this case");
  }
  {
    CaseFile one = file;
    one.json.erase("sweep");
    one.json[pointer] = sweep["values"][0];
    validate_against_schema(one, "sid");
    require_affordable(one, Pointer("/truth/samples"), cost_of_truth(one), common);
    const SidCaseFile parsed = parse_sid_case(std::move(one));
    RunCost cost = cost_of_sid(parsed, common, options);
    const auto rows = static_cast<double>(sweep["values"].size());
    double kept = kCaseBytes;
    for (const SidChannel& channel : parsed.sid.channels) {
      kept += 8.0 * static_cast<double>(channel.signal.samples.size());
    }
    cost.bytes += rows * kept;
    cost.likelihoods *= rows;
    cost.seconds *= rows;
    require_affordable(file, Pointer("/sweep"), cost, common);
    if (common.dry_run) {
      std::cout << "The sweep would take " << in_words(cost) << ".\n";
      return;
    }
  }
  make_output_folder(common.output);
  // All of them first, so that a mistake in the last does not cost the runs before it.
  std::vector<SidCaseFile> cases;
  for (const Json& value : sweep["values"]) {
    CaseFile one = file;
    one.json.erase("sweep");
    one.json[pointer] = value;
    cases.push_back(parse_sid_case(std::move(one)));
  }
  io::AtomicFile table_file(common.output / "sweep.csv");
  io::AtomicFile summary_file(common.output / "summary.json");
  Report rows = Report::array();
  std::vector<SweepRow> said;
  std::string table;
  const StopOnInterrupt stop;
  for (std::size_t i = 0; i < cases.size() && !was_interrupted(); ++i) {
    const Json& value = sweep["values"][i];
    const SidFindings findings = identify(cases[i], common, options, log).findings;
    const Row row = table_row(value.dump(), findings);
    if (i == 0) {
      const std::string& title = cases[i].sid.title;
      table = "# " + title + "; value of " + path + "\n" + line(row.header);
      std::cout << '\n' << title << "\nSweep of " << path << "\n" << line(row.header);
    }
    table += line(row.cells);
    std::cout << line(row.cells);
    print_remarks(findings);
    rows.push_back(summary_row(value, findings));
    said.push_back({value.dump(), findings.models, findings.sampling.verdict.converged,
                    findings.fit_verdict.ok()});
  }
  const Report summary = {
      {"wheeltap",
       about("sid", {.seed = common.seed.value_or(1), .command_line = common.command_line}, file)},
      {"answer", json(answer(path, said))},
      {"sweep", {{"path", path}, {"rows", rows}}}};
  write_text(table_file, table);
  write_text(summary_file, summary.dump(1) + "\n");
  table_file.commit();
  summary_file.commit();
  write_report(common.output);
  std::cout << "Results: " << io::printable((common.output / "sweep.csv").string())
            << " (the table), " << io::printable((common.output / "summary.json").string())
            << " (all numbers)\n";
}

}  // namespace wheeltap::apps
