#include "apps/commands/data_command.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <stdexcept>

#include "apps/cases/records/measured_file.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/report/data_page.hpp"
#include "apps/results/summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/running.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/netcdf/netcdf_name.hpp"
#include "io/netcdf/netcdf_writer.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

std::string channel_with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

void print_universal(const io::UniversalFile& file) {
  if (file.header && !file.header->lines[0].empty())
    std::cout << "Model: " << io::printable(file.header->lines[0]) << "\n";
  if (file.units)
    std::cout << "Units: " << io::printable(file.units->description) << " (a metre is "
              << significant(file.units->factors[0], 6) << ", a newton "
              << significant(file.units->factors[1], 6) << " of the file's)\n";
  if (!file.nodes.empty())
    std::cout << file.nodes.size() << " nodes, " << file.traces.size() << " trace lines\n";
  if (!file.elements.empty()) std::cout << file.elements.size() << " finite elements\n";
  if (!file.systems.empty()) std::cout << file.systems.size() << " coordinate systems\n";
  for (const io::UniversalShape& s : file.shapes) {
    std::cout << "Shape at " << s.nodes.size() << " nodes";
    if (std::isfinite(s.frequency_hz()))
      std::cout << ": mode " << s.mode() << ", " << significant(s.frequency_hz(), 6) << " Hz";
    if (std::isfinite(s.damping())) std::cout << ", damping " << significant(s.damping(), 3);
    std::cout << "\n";
  }
  for (const auto& [number, count] : file.left_out)
    std::cout << "Not read: " << count << (count == 1 ? " dataset " : " datasets ") << number
              << "\n";
}

void print(const MeasuredFile& file) {
  std::cout << io::printable(file.path.filename().string()) << " (" << file.format << ")\n";
  if (file.universal) print_universal(*file.universal);
  for (const MeasuredTable& table : file.tables) {
    std::cout << "\n" << base::grouped(table.rows()) << (table.is_time ? " samples" : " lines");
    if (table.sample_rate_hz)
      std::cout << " at " << significant(*table.sample_rate_hz, 6) << " Hz, "
                << significant(static_cast<double>(table.rows()) / *table.sample_rate_hz, 4)
                << " s; spectrum up to " << significant(0.5 * *table.sample_rate_hz, 6) << " Hz";
    else if (!table.is_time && !table.x.empty())
      std::cout << " over " << channel_with_unit(table.abscissa, table.abscissa_unit) << " from "
                << significant(table.x.front(), 5) << " to " << significant(table.x.back(), 5);
    else if (table.sampling_fault.empty())
      std::cout
          << "; no column is called time: give the sampling rate with --sample-rate for spectra";
    std::cout << "\n";
    for (const std::string& text : reading_in_words(table))
      std::cout << io::printable(text) << "\n";
    if (!table.sampling_fault.empty()) std::cout << io::printable(table.sampling_fault) << "\n";
    std::vector<std::vector<std::string>> rows = {
        {"channel", "rms", "mean", "lowest", "highest", "peaks [Hz]"}};
    for (const MeasuredChannel& c : table.channels) {
      std::string peaks;
      for (const signals::SpectrumPeak& p : c.peaks)
        peaks += (peaks.empty() ? "" : ", ") + significant(p.frequency_hz, 4);
      rows.push_back({io::printable(channel_with_unit(c.name, c.unit)),
                      significant(c.quality.rms, 4), significant(c.quality.mean, 3),
                      significant(c.quality.lowest, 4), significant(c.quality.highest, 4),
                      peaks.empty() ? "-" : peaks});
    }
    Page(std::cout, false).table(rows);
    for (const MeasuredChannel& c : table.channels)
      for (const std::string& text : oddities(table, c))
        std::cout << "! " << io::printable(c.name) << " " << text << ".\n";
  }
  if (!file.others.empty()) std::cout << "\nAlso in the file, not among these channels:\n";
  for (const std::string& text : file.others) std::cout << "  " << io::printable(text) << "\n";
}

// ---- conversion ------------------------------------------------------------------------------

const MeasuredTable& only_table(const MeasuredFile& file) {
  if (file.tables.size() == 1) return file.tables.front();
  throw Failure(
      Exit::bad_input,
      file.path.string() + ": contains " + std::to_string(file.tables.size()) +
          " tables with different abscissae; a file of the requested format contains one table");
}

signals::Record record_of(const MeasuredTable& table) {
  signals::Record record;
  const auto add = [&](const std::string& name, const std::string& unit,
                       const std::vector<double>& values) {
    record.columns.push_back(
        {.header = channel_with_unit(name, unit), .name = name, .unit = unit, .values = values});
  };
  if (!table.x.empty()) {
    add(table.abscissa, table.abscissa_unit, table.x);
  } else if (table.sample_rate_hz) {
    std::vector<double> time;
    for (long i = 0; i < table.rows(); ++i)
      time.push_back(static_cast<double>(i) / *table.sample_rate_hz);
    add("time", "s", time);
  }
  for (const MeasuredChannel& c : table.channels) add(c.name, c.unit, c.values);
  return record;
}

std::string netcdf(const signals::Record& record, const std::filesystem::path& path) {
  const io::NetcdfLock lock;
  io::NetcdfWriter out(path);
  int dimension = 0;
  out.check(nc_def_dim(out.root(), "sample", static_cast<std::size_t>(record.rows()), &dimension));
  std::vector<std::string> taken;
  for (const io::Column& c : record.columns) {
    const std::string base = io::netcdf_name(c.name);
    std::string name = base;
    for (int again = 2; std::ranges::count(taken, name) > 0; ++again)
      name = base + "_" + std::to_string(again);
    taken.push_back(name);
    const int id = out.put(out.root(), name, {dimension}, c.values);
    out.text(out.root(), id, "long_name", c.name);
    if (!c.unit.empty()) out.text(out.root(), id, "units", c.unit);
  }
  return out.close();
}

std::string universal(const MeasuredFile& file) {
  if (file.universal) return io::universal_text(*file.universal);
  io::UniversalFile out;
  for (const MeasuredTable& table : file.tables) {
    int node = 0;
    for (const MeasuredChannel& c : table.channels) {
      io::UniversalFunction f{.type = 1,
                              .response = {.node = ++node},
                              .even = table.sample_rate_hz.has_value(),
                              .abscissa = {.quantity = 17, .label = "time", .unit = "s"}};
      f.ids = {c.name, "NONE", "NONE", "NONE", "NONE"};
      f.numerator = {.quantity = 0, .label = c.name, .unit = c.unit};
      if (f.even) {
        f.first = table.x.empty() ? 0.0 : table.x.front();
        f.step = 1.0 / *table.sample_rate_hz;
      }
      for (std::size_t i = 0; i < c.values.size(); ++i) {
        f.x.push_back(table.x.empty() ? static_cast<double>(i) : table.x[i]);
        f.y.emplace_back(c.values[i], 0.0);
      }
      out.functions.push_back(std::move(f));
    }
  }
  return io::universal_text(out);
}

void convert_file(const MeasuredFile& file, const std::string& to) {
  std::filesystem::path path(to);
  if (to == "csv" || to == "nc" || to == "uff") path = file.path.stem().string() + "." + to;
  const std::string ending = path.extension().string();
  std::error_code ignored;
  if (std::filesystem::equivalent(path, file.path, ignored))
    throw Failure(Exit::usage, "--to " + to + ": would overwrite the file itself");
  std::string text;
  if (ending == ".csv") {
    text =
        signals::record_csv(record_of(only_table(file)),
                            "converted from " + io::printable(file.path.filename().string()), 17);
  } else if (ending == ".nc") {
    text = netcdf(record_of(only_table(file)), path);
  } else if (ending == ".uff" || ending == ".unv") {
    text = universal(file);
    if (text.empty())
      throw Failure(Exit::bad_input,
                    file.path.string() + ": contains no dataset that can be written as " + to);
  } else {
    throw Failure(
        Exit::usage,
        "--to " + to + ": must be csv, nc or uff, or a file name with one of these extensions");
  }
  write_text(path, text);
  std::cout << "\nConverted: " << io::printable(path.string()) << "\n";
}

}  // namespace

Report data_report(const MeasuredFile& file) {
  Report tables = Report::array();
  for (const MeasuredTable& table : file.tables) {
    Report channels = Report::array();
    for (const MeasuredChannel& c : table.channels) {
      const signals::ChannelQuality& q = c.quality;
      Report peaks = Report::array();
      for (const signals::SpectrumPeak& p : c.peaks)
        peaks.push_back({{"frequency_hz", p.frequency_hz}, {"prominence_db", p.prominence_db}});
      Report dropouts = Report::array();
      for (const signals::Stretch& d : q.dropouts) dropouts.push_back({d.begin, d.end});
      channels.push_back({{"name", c.name},
                          {"unit", c.unit},
                          {"si", conversion_json(signals::conversion_of(c.unit))},
                          {"missing", q.missing},
                          {"rms", q.rms},
                          {"mean", q.mean},
                          {"sd", q.sd},
                          {"lowest", q.lowest},
                          {"highest", q.highest},
                          {"resolution", q.step},
                          {"constant", q.constant},
                          {"dropouts", dropouts},
                          {"clipped", {{"high", q.clipped_high}, {"low", q.clipped_low}}},
                          {"spikes", q.spikes},
                          {"drift", std::isfinite(q.drift) ? Report(q.drift) : Report()},
                          {"wander", q.wander},
                          {"peaks", peaks},
                          {"remarks", oddities(table, c)}});
    }
    tables.push_back(
        {{"rows", table.rows()},
         {"abscissa", table.abscissa},
         {"abscissa_unit", table.abscissa_unit},
         {"time_history", table.is_time},
         {"sample_rate_hz", table.sample_rate_hz ? Report(*table.sample_rate_hz) : Report()},
         {"sampling_fault", table.sampling_fault},
         {"sampling", table.sampling.rate_hz > 0.0 ? sampling_json(table.sampling) : Report()},
         {"layout", table.layout ? layout_json(*table.layout) : Report()},
         {"left_out", left_out_in_words(table)},
         {"channels", channels}});
  }
  return {{"file", io::printable(file.path.string())},
          {"format", file.format},
          {"tables", tables},
          {"others", file.others}};
}

void run_data(const DataOptions& options) {
  const MeasuredFile file = look_at(options.file, options.reading);
  if (options.json) {
    std::cout << data_report(file).dump() << "\n";
  } else {
    print(file);
  }
  if (!options.page.empty()) {
    write_text(options.page, data_page(file));
    if (!options.json) std::cout << "\nDrawn: " << options.page.string() << "\n";
  }
  if (!options.to.empty()) convert_file(file, options.to);
}

Command data_command() {
  const auto data = std::make_shared<DataOptions>();
  return {
      .name = "data",
      .summary = "show the channels of a measured file and their faults",
      .add_options =
          [data](CommandOptions& options) {
            CLI::App& app = options.app();
            app.add_option(
                   "FILE", data->file,
                   "measured file: delimited text, MATLAB, Excel, universal file or another format")
                ->required();
            app.add_option("-o,--output", data->page, "HTML file for the plots of the record")
                ->type_name("FILE.html");
            app.add_option("--to", data->to,
                           "format of the converted file (csv, nc or uff), or a file name with "
                           "one of these extensions");
            app.add_option("--sample-rate", data->reading.sample_rate_hz,
                           "sampling rate in Hz, if the file does not state it")
                ->check(positive());
            app.add_flag("--json", data->json, "print the channels and their faults as JSON");
            add_layout(&app, data->reading.layout, data->reading.arrays);
            app.add_flag(
                "--resample", data->reading.resample,
                "interpolate a record with non-uniform time steps to a uniform sampling rate");
          },
      .run = [data](const Invocation&) { run_data(*data); }};
}

}  // namespace wheeltap::apps
