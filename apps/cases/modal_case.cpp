#include "apps/cases/modal_case.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/cases/records/free_decays.hpp"
#include "apps/cases/records/modal_poles.hpp"
#include "apps/cases/records/modal_units.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/cases/sid_record.hpp"
#include "base/number.hpp"
#include "io/text/text.hpp"
#include "signals/frequency_response_file.hpp"

namespace wheeltap::apps {
namespace {

bool of_forces(const CaseFile& file) {
  return file.json.value("method", "ssi-cov") == "plscf";
}

bool of_decays(const CaseFile& file) {
  return file.json.value("method", "ssi-cov") == "era";
}

struct Channels {
  std::vector<std::string> columns = {};  ///< columns of the responses
  std::vector<StatedUnit> units = {};     ///< units of the responses
  std::vector<std::string> forces = {};
  std::vector<StatedUnit> force_units = {};
  std::vector<std::string> ignored = {};
  std::string time = {};
  std::optional<double> time_scale = {};
};

void refuse_keys(const CaseFile& file, const Pointer& where) {
  const Json& c = file.json.at(where);
  const bool of_time = c.at("role") == "time";
  const bool force = c.at("role") == "force";
  for (const char* key : {"node", "direction", "azimuth", "elevation"})
    if (c.contains(key) && !force)
      file.refuse(where / key, "is allowed for the roles \"response\" and \"force\" only");
  if (c.contains("reference"))
    file.refuse(where / "reference", "is allowed for the role \"response\" only");
  if (c.contains("scale") && !of_time && !force)
    file.refuse(where / "scale", "is not allowed for the role \"ignore\"");
  if (c.contains("unit") && !force)
    file.refuse(where / "unit", "is allowed for the roles \"response\" and \"force\" only");
  if (c.contains("quantity"))
    file.refuse(where / "quantity", "is allowed for the role \"response\" only");
}

std::string columns_listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

/// Checks units: the entries of a shape must be comparable. All channels must therefore have one
/// unit, or quantities that can be converted to each other.
void compare_units(const CaseFile& file, SetUp& out, const Channels& channels) {
  using Basis = signals::Conversion::Basis;
  std::vector<std::string> none, known;
  std::optional<std::size_t> foreign;
  for (std::size_t i = 0; i < channels.columns.size(); ++i) {
    const signals::Conversion& c = out.channels[i].conversion;
    const std::string& column = out.channels[i].column;
    if (c.basis == Basis::foreign) {
      if (foreign && out.channels[*foreign].conversion.unit != c.unit)
        file.refuse(out.places[i] / "scale",
                    "is missing: the channel is in " + c.unit + ", and " +
                        out.channels[*foreign].column + " is in " +
                        out.channels[*foreign].conversion.unit +
                        ". Give \"scale\" and \"quantity\" to both channels, or \"role\": "
                        "\"ignore\" to one");
      foreign = i;
    } else if (c.basis == Basis::none) {
      none.push_back(column);
    } else {
      known.push_back(column);
    }
  }
  if (foreign && !known.empty())
    file.refuse(out.places[*foreign] / "scale",
                "is missing: the unit of this channel, " + out.channels[*foreign].conversion.unit +
                    ", is unknown, but the unit of " + known.front() +
                    " is known. Give \"scale\" and \"quantity\", or \"role\": \"ignore\"");
  if (!none.empty() && (!known.empty() || foreign))
    out.oddities.push_back(
        "No unit is given for " + io::printable(columns_listed(none)) +
        ", but other channels have units. The numbers of this channel are used unchanged: if they "
        "are not in SI units, the mode shapes are wrong. State \"unit\" in the channel.");
  for (std::size_t i = 0; i < channels.columns.size(); ++i) {
    if (out.channels[i].conversion.basis != Basis::none || channels.units[i].unit) continue;
    const std::string& column = out.channels[i].column;
    if (const std::string unit = signals::possible_unit_of({.name = column}); !unit.empty())
      out.oddities.push_back("The unit of " + io::printable(column) + " is not known: if it is " +
                             unit + ", state \"unit\": \"" + unit + "\" in its channel.");
  }
  // The case may state the quantity. Otherwise the unit determines it or, without a unit, the other
  // channels.
  std::optional<signals::Dimension> common;
  bool mixed = false;
  for (std::size_t i = 0; i < channels.columns.size(); ++i) {
    const auto& d = out.channels[i].conversion.dimension;
    if (!d) continue;
    if (!is_motion(*d))
      file.refuse(out.places[i] / "role",
                  "is a response in " + out.channels[i].conversion.unit + ", " +
                      std::string(signals::name(*d)) +
                      ": responses are displacements, velocities or accelerations");
    mixed = mixed || (common && *common != *d);
    common = d;
  }
  if (!common) return;
  std::vector<std::string> unsaid;
  for (std::size_t i = 0; i < channels.columns.size(); ++i) {
    const auto& d = out.channels[i].conversion.dimension;
    if (!d) unsaid.push_back(out.channels[i].column);
    const signals::Dimension used = d.value_or(*common);
    out.orders.push_back(signals::derivative_order(used));
    out.sensors[i].quantity = quantity_name(used);
  }
  if (mixed && !unsaid.empty())
    file.refuse(out.where / "channels",
                "measure different quantities, and the quantity of " + columns_listed(unsaid) +
                    " is unknown: state \"quantity\" or \"unit\" in the channel");
  if (!unsaid.empty() && known.empty())
    out.oddities.push_back(
        "The quantity of " + io::printable(columns_listed(unsaid)) +
        " is unknown: Wheeltap assumes " + std::string(signals::name(*common)) +
        ", as for the other channels. State \"quantity\" or \"unit\" in the channel.");
  if (mixed && file.json.value("method", "ssi-cov") == "bayoma")
    file.refuse(out.where / "channels",
                "measure different quantities, but the method \"bayoma\" needs one quantity: "
                "give other channels the role \"ignore\", or use the method \"ssi-cov\"");
}

Channels parse_channels(const CaseFile& file, SetUp& out) {
  const Pointer list = out.where / "channels";
  Channels found;
  for (std::size_t i = 0; i < file.json.at(list).size(); ++i) {
    const Pointer where = list / i;
    const Json& c = file.json.at(where);
    const std::string role = c.at("role").get<std::string>(),
                      column = text_or_number(c.at("column"));
    if (c.value("scale", 1.0) == 0.0) file.refuse(where / "scale", "must not be 0");
    if (role == "force" && !of_forces(file))
      file.refuse(where / "role",
                  "this method uses responses only: give a measured force the role \"ignore\", or "
                  "use the method \"plscf\"");
    if (role == "force") {
      found.forces.push_back(column);
      found.force_units.push_back(parse_unit(file, where));
      std::string name = column;
      if (c.contains("node")) name = text_or_number(c.at("node")) + ":" + c.value("direction", "");
      out.inputs.push_back(std::move(name));
    }
    if (role != "response") refuse_keys(file, where);
    if (role == "time") {
      if (!found.time.empty()) file.refuse(where, "there is a time channel already");
      found.time = column;
      if (c.contains("scale")) found.time_scale = c.at("scale").get<double>();
    }
    if (role == "ignore") found.ignored.push_back(column);
    if (role != "response") continue;
    MeasuredSensor sensor{.name = column};
    if (c.contains("node")) sensor.node = text_or_number(c.at("node"));
    sensor.direction = c.value("direction", "");
    if (c.contains("azimuth") || c.contains("elevation")) {
      if (!sensor.direction.empty())
        file.refuse(where / "direction",
                    "replaces azimuth and elevation: give either \"direction\" or the two angles");
      sensor.azimuth = c.value("azimuth", 0.0);
      sensor.elevation = c.value("elevation", 0.0);
    }
    sensor.reference = c.value("reference", false);
    if (sensor.reference) out.options.references.push_back(static_cast<int>(out.sensors.size()));
    out.sensors.push_back(std::move(sensor));
    out.places.push_back(where);
    found.columns.push_back(column);
    found.units.push_back(parse_unit(file, where));
  }
  if (found.columns.empty())
    file.refuse(list, "has no channel with the role \"response\": there is nothing to identify");
  if (of_forces(file) && found.forces.empty())
    file.refuse(list,
                "has no channel with the role \"force\": add one, or use the method \"ssi-cov\"");
  return found;
}

int time_column(const signals::Record& record, const Channels& channels) {
  if (!channels.time.empty()) return record.find(channels.time);
  const int time = record.find_time();
  if (time < 0 || record.columns[static_cast<std::size_t>(time)].values.empty()) return -1;
  for (const std::string& column : channels.columns)
    if (record.find(column) == time) return -1;
  return time;
}

/// Resamples the record at a uniform rate if the case requests it, and determines its sampling.
void read_rate(const CaseFile& file, SetUp& out, signals::Record& record,
               const Channels& channels) {
  const Json& r = file.json.at(out.where);
  std::optional<double> stated;
  if (r.contains("sample_rate")) stated = r.at("sample_rate").get<double>();
  const int time = time_column(record, channels);
  out.sampling = {.rate_hz = stated.value_or(0.0)};
  if (time < 0 && !stated) {
    const std::optional<signals::Sampling> said = signals::sampling_from_header(record);
    if (!said)
      file.refuse(out.where / "sample_rate",
                  "is missing: no channel is \"time\", so the sampling rate in Hz must be given");
    out.sampling = *said;
  }
  out.layout = record.layout;
  if (r.value("resample", false)) {
    if (time < 0) file.refuse(out.where / "resample", "needs a channel with the role \"time\"");
    record = signals::resampled(record, time, stated, channels.time_scale);
    out.sampling = signals::sampling_of(record, time, stated);
  } else if (time >= 0) {
    out.sampling = signals::sampling_of(record, time, stated, channels.time_scale);
  }
  out.options.sample_rate_hz = out.sampling.rate_hz;
  if (std::string text = jitter_in_words(out.sampling); !text.empty())
    out.oddities.push_back(std::move(text));
  if (out.sampling.doubtful_unit) out.oddities.push_back(sampling_in_words(out.sampling));
}

void read_responses(const CaseFile& file, SetUp& out) {
  try {
    signals::MeasuredResponses measured = signals::read_frequency_responses(file.resolve(out.name));
    for (const io::UniversalDof& dof : measured.outputs)
      out.sensors.push_back({.name = io::dof_in_words(dof),
                             .node = dof.node != 0 ? std::to_string(dof.node) : std::string(),
                             .direction = io::translation_axis(dof)});
    for (const io::UniversalDof& dof : measured.inputs) out.inputs.push_back(io::dof_in_words(dof));
    for (std::size_t i = 0; i < measured.conversions.size(); ++i)
      out.channels.push_back(
          {.column = out.sensors[i].name, .conversion = measured.conversions[i]});
    if (measured.transposed)
      out.oddities.push_back(
          "There are more references than responses: by reciprocity, Wheeltap exchanges references "
          "and responses, and the mode shapes are those at the references.");
    out.responses = std::move(measured.responses);
    out.orders = std::move(measured.orders);
    out.places.assign(out.sensors.size(), out.where / "file");
  } catch (const io::FileError& error) {
    throw Failure(error.kind() == io::FileError::Kind::missing ? Exit::no_input : Exit::bad_input,
                  error.what());
  }
}

void cut_decays(const CaseFile& file, SetUp& out) {
  for (const auto& [begin, end] : parse_decays(file, out.where / "decays", out.records.cols()))
    out.decays.emplace_back(out.records.middleCols(begin, end - begin));
}

void estimate_responses(const CaseFile& file, SetUp& out, const Eigen::MatrixXd& forces) {
  try {
    out.responses = signals::estimate_frequency_responses(
        forces, out.records, out.options.sample_rate_hz, file.json.value("segment", 0));
  } catch (const std::invalid_argument& error) {
    file.refuse(file.json.contains("segment") ? Pointer("/segment") : out.where, error.what());
  }
}

SetUp read_set_up(const CaseFile& file, const Pointer& where,
                  std::optional<signals::Record> given) {
  SetUp out;
  out.where = where;
  out.name = file.json.at(where / "file").get<std::string>();
  if (!file.json.at(where).contains("channels")) {
    if (!of_forces(file))
      file.refuse(where / "channels", "is missing: must list the response columns");
    for (const char* key : {"samples", "sample_rate"})
      if (file.json.at(where).contains(key))
        file.refuse(where / key,
                    "applies to time records only. The case lists no channels of a record, so "
                    "Wheeltap uses the FRFs of the file. Remove this key");
    if (file.json.contains("segment"))
      file.refuse(Pointer("/segment"),
                  "applies to time records only. The case lists no channels of a record, so "
                  "Wheeltap uses the FRFs of the file. Remove this key");
    read_responses(file, out);
    return out;
  }
  const Channels channels = parse_channels(file, out);
  std::vector<std::string> columns = channels.columns;
  columns.insert(columns.end(), channels.forces.begin(), channels.forces.end());
  if (!channels.time.empty()) columns.push_back(channels.time);
  signals::Record record =
      given ? std::move(*given) : read_record(file, where / "file", columns, channels.ignored);
  try {
    read_rate(file, out, record, channels);
    const Json& r = file.json.at(where);
    int begin = 0, end = record.samples();
    if (r.contains("samples")) {
      begin = r.at("samples")[0].get<int>();
      end = r.at("samples")[1].get<int>();
    }
    if (of_decays(file) != r.contains("decays"))
      file.refuse(where / "decays", of_decays(file)
                                        ? "is missing: the windows of the free decays, in samples"
                                        : "is allowed with the method \"era\" only");
    if (of_decays(file) && r.contains("samples"))
      file.refuse(where / "samples", "is not allowed with \"decays\", which give the windows");
    MeasuredTable table{.sample_rate_hz = out.options.sample_rate_hz};
    for (std::size_t i = 0; i < channels.columns.size(); ++i) {
      const int column = record.find(channels.columns[i]);
      const io::Column& source = record.columns[static_cast<std::size_t>(column)];
      const std::vector<double> x = signals::window(record, column, begin, end);
      if (i == 0)
        out.records.resize(static_cast<Eigen::Index>(channels.columns.size()),
                           static_cast<Eigen::Index>(x.size()));
      const signals::Conversion conversion =
          convert(file, source, channels.units[i], channels.units[i].quantity);
      out.channels.push_back({.column = source.name, .conversion = conversion});
      out.sensors[i].unit = conversion.unit;
      out.records.row(static_cast<Eigen::Index>(i)) =
          conversion.factor *
          Eigen::Map<const Eigen::RowVectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
      out.sensors[i].name = source.name;
      const MeasuredChannel channel{
          .name = source.name, .unit = source.unit, .quality = signals::channel_quality(x)};
      if (channel.quality.constant)
        file.refuse(out.places[i],
                    "the channel is constant: give it the role \"ignore\", or check its sensor");
      for (const std::string& text : oddities(table, channel))
        out.oddities.push_back("The channel " + io::printable(source.name) + " " + text + ".");
    }
    compare_units(file, out, channels);
    if (of_decays(file)) cut_decays(file, out);
    if (!channels.forces.empty()) {
      Eigen::MatrixXd forces(static_cast<Eigen::Index>(channels.forces.size()), out.records.cols());
      for (std::size_t i = 0; i < channels.forces.size(); ++i) {
        const int column = record.find(channels.forces[i]);
        const std::vector<double> x = signals::window(record, column, begin, end);
        const io::Column& source = record.columns[static_cast<std::size_t>(column)];
        const signals::Conversion conversion =
            convert(file, source, channels.force_units[i], signals::Dimension::force);
        out.channels.push_back({.column = source.name, .is_force = true, .conversion = conversion});
        forces.row(static_cast<Eigen::Index>(i)) =
            conversion.factor *
            Eigen::Map<const Eigen::RowVectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
      }
      estimate_responses(file, out, forces);
    }
  } catch (const io::NoSuchColumn& error) {
    refuse_column(file, where, error);
  } catch (const io::FileError& error) {
    throw Failure(Exit::bad_input, error.what());
  }
  return out;
}

/// True if two channels of different set-ups are the same sensor: equal node and direction or,
/// without nodes, references with equal names.
bool same_sensor(const MeasuredSensor& a, const MeasuredSensor& b) {
  if (a.node.empty() != b.node.empty()) return false;
  if (a.node.empty()) return a.reference && b.reference && a.name == b.name;
  return a.node == b.node && a.direction == b.direction && a.azimuth == b.azimuth &&
         a.elevation == b.elevation;
}

/// Adds a remark if two channels of a record have the same node and direction, perhaps by mistake.
void remark_on_duplicate_sensors(SetUp& s) {
  for (std::size_t i = 0; i < s.sensors.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (s.responses || s.sensors[i].node.empty() || !same_sensor(s.sensors[i], s.sensors[j]))
        continue;
      s.oddities.push_back(
          "The channels " + io::printable(s.sensors[j].name) + " and " +
          io::printable(s.sensors[i].name) + " measure at the same node (" +
          io::printable(s.sensors[i].node) +
          ") in the same direction. Is a node or a direction wrong? Two sensors at the same node "
          "and in the same direction count one motion twice in the shapes.");
      break;
    }
}

void collect_sensors(ModalCaseFile& out) {
  if (out.set_ups.size() == 1) {
    SetUp& only = out.set_ups[0];
    remark_on_duplicate_sensors(only);
    out.sensors = only.sensors;
    for (std::size_t c = 0; c < only.sensors.size(); ++c) only.which.push_back(static_cast<int>(c));
    return;
  }
  for (SetUp& s : out.set_ups) {
    std::vector<bool> taken(out.sensors.size());
    for (std::size_t c = 0; c < s.sensors.size(); ++c) {
      std::size_t k = 0;
      while (k < out.sensors.size() && !same_sensor(out.sensors[k], s.sensors[c])) ++k;
      if (k == out.sensors.size()) {
        out.sensors.push_back(s.sensors[c]);
        taken.push_back(false);
      }
      if (taken[k])
        out.file.refuse(s.places[c],
                        "measures at the same node and in the same direction as another channel");
      taken[k] = true;
      s.which.push_back(static_cast<int>(k));
    }
  }
  const auto shared = [&](int k) {
    return std::ranges::all_of(out.set_ups, [k](const SetUp& s) {
      return std::ranges::find(s.which, k) != s.which.end();
    });
  };
  bool some = false;
  for (const SetUp& s : out.set_ups)
    for (std::size_t c = 0; c < s.sensors.size(); ++c) {
      some = some || shared(s.which[c]);
      if (s.sensors[c].reference && !shared(s.which[c]))
        out.file.refuse(
            s.places[c] / "reference",
            "is not in every record: a reference must be at the same location in all records");
    }
  if (!some)
    out.file.refuse(Pointer("/records"),
                    "have no sensor in common (the same node and direction or, without nodes, "
                    "references with the same name): their shapes cannot be merged");
}

void take_bands(const CaseFile& file, SetUp& s) {
  if (!file.json.contains("bands"))
    file.refuse(
        Pointer("/bands"),
        "is missing: the method \"bayoma\" needs the bands of the modes, [{\"band\": [lowest, "
        "highest], \"modes\": [frequency, ...]}]");
  for (const char* key : {"band", "order", "lags", "blocks", "segment"})
    if (file.json.contains(key))
      file.refuse(Pointer() / std::string(key), "is not an option of this method");
  for (std::size_t i = 0; i < file.json.at("bands").size(); ++i) {
    const Json& one = file.json.at("bands")[i];
    identification::ModalBand band{.lowest_hz = one.at("band")[0].get<double>(),
                                   .highest_hz = one.at("band")[1].get<double>()};
    for (const Json& peak : one.at("modes")) band.peaks_hz.push_back(peak.get<double>());
    try {
      const identification::BandProblem checked(
          identification::band_lines(s.records, s.options.sample_rate_hz, band), band);
    } catch (const std::invalid_argument& error) {
      file.refuse(Pointer("/bands") / i, error.what());
    }
    s.bands.push_back(std::move(band));
  }
}

void take_band(const ModalCaseFile& out, SetUp& s) {
  const Json& json = out.file.json;
  s.options.poles = chosen_poles(out.file, out.set_ups.size() > 1);
  if (json.value("method", "ssi-cov") == "bayoma") return take_bands(out.file, s);
  if (json.contains("bands"))
    out.file.refuse(Pointer("/bands"), "is allowed with the method \"bayoma\" only");
  if (json.contains("band")) {
    s.options.lowest_hz = json.at("band")[0].get<double>();
    s.options.highest_hz = json.at("band")[1].get<double>();
    if (!(s.options.lowest_hz < s.options.highest_hz))
      out.file.refuse(Pointer("/band"), "must be [lowest, highest] in Hz, ascending");
    if (!s.responses && s.options.highest_hz > 0.5 * s.options.sample_rate_hz)
      out.file.refuse(Pointer("/band/1"), "must be at most half the sampling rate, " +
                                              base::number(0.5 * s.options.sample_rate_hz) + " Hz");
  }
  const std::string method = json.value("method", "ssi-cov");
  if (method == "fdd") s.spectral = signals::ModalMethod::decomposition;
  if (method == "efdd") s.spectral = signals::ModalMethod::enhanced;
  for (const char* key : {"order", "lags", "blocks"})
    if (json.contains(key) && s.spectral && (method == "fdd" || key != std::string("blocks")))
      out.file.refuse(Pointer() / std::string(key), "is not an option of this method");
  if (method == "fdd" && out.set_ups.size() > 1)
    out.file.refuse(Pointer("/method"),
                    "gives no uncertainty, which is needed to weight set-ups: use \"efdd\" or "
                    "\"ssi-cov\" for several records");
  if (json.contains("order")) s.options.largest_order = json.at("order").value("max", 0);
  s.segment = json.value("segment", 0);
  s.options.lags = json.value("lags", 0);
  s.options.blocks = json.value("blocks", 0);
  for (const char* key : {"lags", "blocks"})
    if (json.contains(key) && (s.responses || (!s.decays.empty() && key == std::string("blocks"))))
      out.file.refuse(Pointer() / std::string(key), "is not an option of this method");
  if (json.contains("segment") && !s.responses && !s.spectral)
    out.file.refuse(Pointer("/segment"),
                    "is an option of the methods \"plscf\", \"fdd\" and \"efdd\" only");
}

void take_merging(ModalCaseFile& out) {
  const Json& json = out.file.json;
  if (!json.contains("merge")) return;
  if (out.set_ups.size() < 2)
    out.file.refuse(Pointer("/merge"), "is allowed with several \"records\" only");
  out.pre_merged = json.at("merge") == "preger";
  if (!out.pre_merged) return;
  if (json.value("method", "ssi-cov") != "ssi-cov")
    out.file.refuse(Pointer("/merge"), "is allowed with the method \"ssi-cov\" only");
  const double rate = out.set_ups.front().options.sample_rate_hz;
  for (const SetUp& s : out.set_ups)
    if (std::abs(s.options.sample_rate_hz / rate - 1.0) > 1e-6)
      out.file.refuse(
          s.where,
          "has a different sampling rate from the first record: \"preger\" needs equal rates");
  bool named = false;
  for (const MeasuredSensor& s : out.sensors) named = named || s.reference;
  std::vector<int> common;
  for (int k = 0; k < static_cast<int>(out.sensors.size()); ++k)
    if ((!named || out.sensors[static_cast<std::size_t>(k)].reference) &&
        std::ranges::all_of(out.set_ups, [k](const SetUp& s) {
          return std::ranges::find(s.which, k) != s.which.end();
        }))
      common.push_back(k);
  for (const SetUp& s : out.set_ups) {
    out.references.emplace_back();
    for (const int k : common)
      out.references.back().push_back(
          static_cast<int>(std::ranges::find(s.which, k) - s.which.begin()));
  }
}

/// Determines the common quantity of the shapes of all set-ups.
void take_quantity(ModalCaseFile& out) {
  int highest = -1, lowest = 3;
  bool all = true;
  for (const SetUp& s : out.set_ups) {
    all = all && !s.orders.empty();
    for (const int order : s.orders) {
      highest = std::max(highest, order);
      lowest = std::min(lowest, order);
    }
  }
  if (highest < 0) return;
  if (highest != lowest && !all)
    out.file.refuse(Pointer("/records"),
                    "measure different quantities, some of them unknown: state \"quantity\" or "
                    "\"unit\" in their channels");
  if (highest != lowest && out.pre_merged)
    for (std::size_t k = 0; k < out.sensors.size(); ++k) {
      std::optional<int> order;
      for (const SetUp& s : out.set_ups)
        for (std::size_t c = 0; c < s.which.size(); ++c) {
          if (s.which[c] != static_cast<int>(k)) continue;
          if (order && *order != s.orders[c])
            out.file.refuse(
                s.places[c] / "quantity",
                "differs from that in an earlier record: \"preger\" needs one quantity per sensor");
          order = s.orders[c];
        }
    }
  out.quantity = quantity_name(highest == 0   ? signals::Dimension::length
                               : highest == 1 ? signals::Dimension::velocity
                                              : signals::Dimension::acceleration);
}

void take_geometry(ModalCaseFile& out) {
  out.geometry = parse_geometry(out.file);
  for (const SetUp& s : out.set_ups)
    for (std::size_t c = 0; c < s.sensors.size(); ++c) {
      if (s.responses || s.sensors[c].node.empty()) continue;
      if (!out.geometry->nodes.contains(s.sensors[c].node))
        out.file.refuse(s.places[c] / "node", "is not a node of the geometry");
      if (!direction_of(s.sensors[c]))
        out.file.refuse(s.places[c] / "direction",
                        "must be x, y or z, with or without a sign, to be drawn on the "
                        "geometry; or give azimuth and elevation");
    }
}

}  // namespace

ModalCaseFile parse_modal_case(CaseFile file, std::optional<signals::Record> given) {
  validate_against_schema(file, "modal");
  ModalCaseFile out{.file = std::move(file)};
  const Json& json = out.file.json;
  if (json.contains("record") == json.contains("records"))
    out.file.refuse(Pointer(json.contains("record") ? "/records" : "/record"),
                    json.contains("record") ? "replaces \"record\": give only one"
                                            : "is missing: a record, or \"records\" of several "
                                              "set-ups");
  if (json.contains("record")) {
    out.set_ups.push_back(read_set_up(out.file, Pointer("/record"), std::move(given)));
  } else {
    for (std::size_t i = 0; i < json.at("records").size(); ++i)
      out.set_ups.push_back(read_set_up(out.file, Pointer("/records") / i, {}));
  }
  collect_sensors(out);
  for (SetUp& s : out.set_ups) take_band(out, s);
  take_merging(out);
  take_quantity(out);
  if (json.contains("geometry")) take_geometry(out);
  out.title =
      json.value("title", out.set_ups.size() == 1
                              ? "Modes of " + out.set_ups[0].name
                              : "Modes of " + std::to_string(out.set_ups.size()) + " set-ups");
  return out;
}

}  // namespace wheeltap::apps
