#include "apps/sid_record.hpp"

#include <cmath>

#include "identification/sid_record.hpp"
#include "identification/sid_simulation.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Role = SidChannel::Role;

constexpr double kWorthWarning = 0.05;  // of an excitation's amplitude

/// Several records are several simulations.
std::uint64_t seed_of(const SidCase& sid_case) {
  return sid_case.truth->seed + static_cast<std::uint64_t>(sid_case.number - 1);
}

RecordUse parse_use(const CaseFile& file) {
  const Json& r = file.json["record"];
  RecordUse use;
  if (r.contains("sample_rate")) use.sample_rate_hz = r["sample_rate"].get<double>();
  if (r.contains("samples")) use.samples = {r["samples"][0], r["samples"][1]};
  use.lead_in = r.value("lead_in", 0);
  use.band_limited = r.value("between_samples", "linear") == "band-limited";
  if (r.contains("upsample")) {
    if (!use.band_limited) {
      file.refuse(Pointer("/record/upsample"), "goes with \"between_samples\": \"band-limited\"");
    }
    use.upsample = r["upsample"].get<int>();
  }
  return use;
}

void warn_of_window(SidCaseFile& parsed, const SidChannel& channel) {
  if (!channel.window || !is_peculiar(*channel.window)) return;
  const auto decibel = [](double x) { return std::to_string(std::lround(x)) + " dB"; };
  parsed.warnings.push_back("The window is not like the rest of the record: the spectrum of \"" +
                            channel.column + "\" differs by " +
                            decibel(channel.window->difference_db) + " (scatter alone gives " +
                            decibel(channel.window->expected_db) +
                            "). What is found holds for the window; try another, or a longer one.");
}

void warn_of_interpolation(SidCaseFile& parsed) {
  if (parsed.sid.simulated || parsed.sid.stride > 1) return;
  const InterpolationLoss worst = interpolation_loss(parsed.sid);
  if (worst.share < kWorthWarning) return;
  parsed.warnings.push_back(
      "The excitation \"" + worst.channel->column + "\" is taken as linear between its samples; " +
      "if it was measured behind an anti-alias filter this loses " +
      std::to_string(std::lround(100.0 * worst.share)) +
      " % of its amplitude. Then set \"between_samples\": \"band-limited\" in the record.");
}

void warn_of_units(SidCaseFile& parsed) {
  for (const SidChannel& channel : parsed.sid.channels) {
    if (!channel.is_excitation() && channel.role != Role::response) continue;
    const auto known = signals::find_unit(channel.unit);
    const bool converted = known && known->dimension == channel.dimension();
    const bool plain = channel.unit.empty() || channel.unit == "1";
    if (plain || converted || channel.scale_given) continue;
    parsed.warnings.push_back(
        "Channel \"" + channel.column + "\" is in " + channel.unit +
        " and has no \"scale\": its numbers are used as they are, as if they were SI units. Known "
        "units of " +
        std::string(name(channel.dimension())) + ": " + known_units(channel.dimension()) + ".");
  }
}

}  // namespace

signals::Record read_record(const CaseFile& file, const Pointer& where,
                            std::vector<std::string> columns) {
  const auto path = file.resolve(file.json.at(where).get<std::string>());
  try {
    return signals::read_record(path, std::move(columns));
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
    std::vector<std::string> columns;
    for (const SidChannel& channel : out.channels) {
      if (channel.role != Role::ignore) columns.push_back(channel.column);
    }
    record = read_record(file, Pointer("/record/file"), std::move(columns));
    out.origin = "measured, " + r["file"].get<std::string>();
  } else if (out.truth) {
    record = explained(parsed, [&] { return simulate_record(out, seed_of(out)); });
    record.file = file.path.string() + " (truth)";
    out.simulated = true;
    out.origin = "simulated from the case's truth, seed " + std::to_string(seed_of(out));
  } else {
    file.refuse(Pointer("/record/file"),
                "is missing: give a record, or a \"truth\" to simulate it from");
  }
  const RecordUse use = parse_use(file);
  explained(parsed, [&] {
    try {
      take_record(out, record, use);
    } catch (const io::FileError& error) {
      throw Failure(Exit::bad_input, error.what());
    }
  });
  for (const SidChannel& channel : out.channels) warn_of_window(parsed, channel);
  warn_of_interpolation(parsed);
  warn_of_units(parsed);
  if (r.value("initial", Json("rest")) == "inferred") {
    explained(parsed, [&] {
      for (SidModel& model : out.models) infer_initial(out, model);
    });
  }
}

}  // namespace wheeltap::apps
