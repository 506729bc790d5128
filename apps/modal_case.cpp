#include "apps/modal_case.hpp"

#include <cmath>
#include <utility>

#include "apps/sid_record.hpp"
#include "base/number.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

struct Channels {
  std::vector<std::string> columns = {};  ///< of responses
  std::vector<double> scales = {};
  std::string time = {};
  std::optional<double> time_scale = {};
};

void refuse_keys(const CaseFile& file, const Pointer& where) {
  const Json& c = file.json.at(where);
  const bool of_time = c.at("role") == "time";
  for (const char* key : {"node", "direction", "azimuth", "elevation", "reference"})
    if (c.contains(key)) file.refuse(where / key, "goes with the role \"response\" only");
  if (c.contains("scale") && !of_time)
    file.refuse(where / "scale", "goes with the roles \"response\" and \"time\" only");
}

Channels parse_channels(ModalCaseFile& out) {
  const CaseFile& file = out.file;
  const Pointer list("/record/channels");
  Channels found;
  for (std::size_t i = 0; i < file.json.at(list).size(); ++i) {
    const Pointer where = list / i;
    const Json& c = file.json.at(where);
    const std::string role = c.at("role"), column = text_or_number(c.at("column"));
    if (c.value("scale", 1.0) == 0.0) file.refuse(where / "scale", "must not be 0");
    if (role == "force")
      file.refuse(where / "role",
                  "modes are identified from responses alone: a measured force must be \"ignore\"");
    if (role != "response") refuse_keys(file, where);
    if (role == "time") {
      if (!found.time.empty()) file.refuse(where, "there is a time channel already");
      found.time = column;
      if (c.contains("scale")) found.time_scale = c.at("scale").get<double>();
    }
    if (role != "response") continue;
    MeasuredSensor sensor{.name = column};
    if (c.contains("node")) sensor.node = text_or_number(c.at("node"));
    sensor.direction = c.value("direction", "");
    if (c.contains("azimuth") || c.contains("elevation")) {
      if (!sensor.direction.empty())
        file.refuse(where / "direction", "takes the place of azimuth and elevation: give either");
      sensor.azimuth = c.value("azimuth", 0.0);
      sensor.elevation = c.value("elevation", 0.0);
    }
    sensor.reference = c.value("reference", false);
    if (sensor.reference) out.options.references.push_back(static_cast<int>(out.sensors.size()));
    out.sensors.push_back(std::move(sensor));
    out.places.push_back(where);
    found.columns.push_back(column);
    found.scales.push_back(c.value("scale", 1.0));
  }
  if (found.columns.empty())
    file.refuse(list, "holds no channel with the role \"response\": there is nothing to identify");
  return found;
}

void read_rate(ModalCaseFile& out, const signals::Record& record, const Channels& channels) {
  const Json& r = out.file.json.at("record");
  std::optional<double> stated;
  if (r.contains("sample_rate")) stated = r.at("sample_rate").get<double>();
  int time = channels.time.empty() ? record.find_time() : record.find(channels.time);
  for (const std::string& column : channels.columns)
    if (channels.time.empty() && record.find(column) == time) time = -1;
  if (time < 0 && !stated)
    out.file.refuse(Pointer("/record/sample_rate"),
                    "is missing: no channel is \"time\", so the sampling rate in Hz must be given");
  out.options.sample_rate_hz =
      time < 0 ? *stated : signals::sample_rate_hz(record, time, stated, channels.time_scale);
}

void read_channels(ModalCaseFile& out) {
  const CaseFile& file = out.file;
  const Channels channels = parse_channels(out);
  std::vector<std::string> columns = channels.columns;
  if (!channels.time.empty()) columns.push_back(channels.time);
  const signals::Record record = read_record(file, Pointer("/record/file"), columns);
  try {
    read_rate(out, record, channels);
    const Json& r = file.json.at("record");
    int begin = 0, end = record.samples();
    if (r.contains("samples")) {
      begin = r.at("samples")[0];
      end = r.at("samples")[1];
    }
    MeasuredTable table{.sample_rate_hz = out.options.sample_rate_hz};
    for (std::size_t i = 0; i < channels.columns.size(); ++i) {
      const int column = record.find(channels.columns[i]);
      const io::Column& source = record.columns[static_cast<std::size_t>(column)];
      const std::vector<double> x = signals::window(record, column, begin, end);
      if (i == 0)
        out.records.resize(static_cast<Eigen::Index>(channels.columns.size()),
                           static_cast<Eigen::Index>(x.size()));
      out.records.row(static_cast<Eigen::Index>(i)) =
          channels.scales[i] *
          Eigen::Map<const Eigen::RowVectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
      out.sensors[i].name = source.name;
      const MeasuredChannel channel{
          .name = source.name, .unit = source.unit, .quality = signals::channel_quality(x)};
      if (channel.quality.constant)
        file.refuse(out.places[i],
                    "the channel never changes: give it the role \"ignore\", or mend its sensor");
      for (const std::string& text : oddities(table, channel))
        out.oddities.push_back("The channel " + io::printable(source.name) + " " + text + ".");
    }
  } catch (const io::FileError& error) {
    throw Failure(Exit::bad_input, error.what());
  }
}

}  // namespace

ModalCaseFile parse_modal_case(CaseFile file) {
  validate_against_schema(file, "modal");
  ModalCaseFile out{.file = std::move(file),
                    .title = {},
                    .sensors = {},
                    .places = {},
                    .records = {},
                    .oddities = {},
                    .options = {}};
  const Json& json = out.file.json;
  out.title = json.value("title", "Modes of " + json.at("record").at("file").get<std::string>());
  read_channels(out);
  if (json.contains("band")) {
    out.options.lowest_hz = json.at("band")[0];
    out.options.highest_hz = json.at("band")[1];
    if (!(out.options.lowest_hz < out.options.highest_hz))
      out.file.refuse(Pointer("/band"), "must be [lowest, highest] in Hz, ascending");
    if (out.options.highest_hz > 0.5 * out.options.sample_rate_hz)
      out.file.refuse(Pointer("/band/1"), "must be at most half the sampling rate, " +
                                              base::number(0.5 * out.options.sample_rate_hz) +
                                              " Hz");
  }
  if (json.contains("order")) out.options.largest_order = json.at("order").value("max", 0);
  out.options.lags = json.value("lags", 0);
  out.options.blocks = json.value("blocks", 0);
  return out;
}

}  // namespace wheeltap::apps
