#include "apps/cases/sid_record.hpp"

#include "apps/cases/records/record_reading.hpp"
#include "identification/sid/base_integration.hpp"
#include "identification/sid/sid_record.hpp"
#include "identification/sid/sid_simulation.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Role = SidChannel::Role;

/// Seed of the simulation; several records have different seeds.
std::uint64_t seed_of(const SidCase& sid_case) {
  return sid_case.truth->seed + static_cast<std::uint64_t>(sid_case.number - 1);
}

RecordUse parse_use(const CaseFile& file) {
  const Json& r = file.json["record"];
  RecordUse use;
  if (r.contains("sample_rate")) use.sample_rate_hz = r["sample_rate"].get<double>();
  if (r.contains("samples")) use.samples = {r["samples"][0].get<int>(), r["samples"][1].get<int>()};
  use.lead_in = r.value("lead_in", 0);
  use.resample = r.value("resample", false);
  use.band_limited = r.value("between_samples", "linear") == "band-limited";
  if (r.contains("upsample")) {
    if (!use.band_limited) {
      file.refuse(Pointer("/record/upsample"),
                  "is allowed with \"between_samples\": \"band-limited\"");
    }
    use.upsample = r["upsample"].get<int>();
  }
  return use;
}

}  // namespace

signals::Record read_record(const CaseFile& file, const Pointer& where,
                            std::vector<std::string> columns, std::vector<std::string> ignored) {
  const auto path = file.resolve(file.json.at(where).get<std::string>());
  const Pointer block = where.parent_pointer();
  try {
    return signals::read_record(path, {.columns = std::move(columns),
                                       .ignored = std::move(ignored),
                                       .layout = parse_layout(file, block),
                                       .arrays = parse_array_layout(file, block)});
  } catch (const io::NoSuchColumn& error) {
    refuse_column(file, block, error);
  } catch (const io::FileError& error) {
    throw Failure(error.kind() == io::FileError::Kind::missing ? Exit::no_input : Exit::bad_input,
                  error.what());
  }
}

void load_record(SidCaseFile& parsed) {
  const CaseFile& file = parsed.file;
  const Json& r = file.json["record"];
  SidCase& out = parsed.sid;
  signals::Record record;
  if (r.contains("file")) {
    std::vector<std::string> columns, ignored;
    for (const SidChannel& channel : out.channels)
      (channel.role == Role::ignore ? ignored : columns).push_back(channel.column);
    record = read_record(file, Pointer("/record/file"), std::move(columns), std::move(ignored));
    out.origin = "measured, " + r["file"].get<std::string>();
  } else if (out.truth) {
    record = explained(parsed, [&] { return simulate_record(out, seed_of(out)); });
    record.file = file.path.string() + " (truth)";
    out.simulated = true;
    out.origin = "simulated from the case's truth, seed " + std::to_string(seed_of(out));
  } else {
    file.refuse(Pointer("/record/file"),
                "is missing: give a record, or a \"truth\" from which Wheeltap simulates it");
  }
  const RecordUse use = parse_use(file);
  explained(parsed, [&] {
    try {
      take_record(out, record, use);
    } catch (const io::FileError& error) {
      throw Failure(Exit::bad_input, error.what());
    }
  });
  if (!out.simulated && needs_integrated_base(out)) {
    explained(parsed, [&] { integrate_base(out); });
  }
  const bool is_given = r.contains("initial");
  if (!is_given && !out.simulated && out.lead_in == 0) out.starts_moving = moves_at_start(out);
  if (out.starts_moving || (is_given && r["initial"] == "inferred")) {
    explained(parsed, [&] {
      for (SidModel& model : out.models) infer_initial(out, model);
    });
  }
}

}  // namespace wheeltap::apps
