#include "records_row.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/beta.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "base/random.hpp"
#include "frame_record.hpp"
#include "io/netcdf/netcdf_reader.hpp"

namespace wheeltap::coverage {
namespace {

using nlohmann::json;
constexpr double kMostDraws = 0.5;  // least P(damage) for ranks given damage

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 256> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

/// Runs a command and returns the seconds that it took.
double command(const RecordsOptions& o, const std::string& words) {
  const auto begun = std::chrono::steady_clock::now();
  const std::string line = "cd '" + o.folder.string() + "' && '" + o.program + "' " + words +
                           " --quiet --threads 1 >said.txt 2>&1 </dev/null";
  if (std::system(line.c_str()) != 0)
    throw std::runtime_error(o.folder.string() + ": wheeltap " + words + " failed: see said.txt");
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

json read_json(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return json::parse(stream);
}

/// One entry per draw: weight and ranked quantities.
struct Draws {
  std::vector<double> weight, posts, girders, place, reduction;
  std::vector<bool> damaged;
};

Draws read_draws(const std::filesystem::path& path, const json& summary,
                 const std::vector<double>& lengths) {
  const io::NetcdfReader file(path);
  const int group = file.required_group("posterior");
  const auto numbers = [&](const char* name) { return file.read(group, name).values; };
  const std::vector<double> k = numbers("k"), member = numbers("member"),
                            along = numbers("location"), reduction = numbers("reduction");
  Draws out{.weight = {},
            .posts = numbers("E posts"),
            .girders = numbers("E girders"),
            .place = {},
            .reduction = {},
            .damaged = {}};
  const auto with = static_cast<double>(std::ranges::count_if(k, [](double v) { return v > 0.5; }));
  const auto all = static_cast<double>(k.size());
  const double p = summary.at("models")[1].at("probability").get<double>();
  for (std::size_t i = 0; i < k.size(); ++i) {
    const bool damaged = k[i] > 0.5;
    out.damaged.push_back(damaged);
    out.weight.push_back(damaged ? p / with : (1.0 - p) / (all - with));
    out.reduction.push_back(damaged ? reduction[i] : 0.0);
    double place = damaged ? along[i] : 0.0;
    for (int m = 0; damaged && m < static_cast<int>(member[i]); ++m)
      place += lengths[static_cast<std::size_t>(m)];
    out.place.push_back(place);
  }
  return out;
}

double rank(const Draws& draws, const std::vector<double>& x, double truth, double u,
            bool given_damage) {
  double below = 0.0, same = 0.0, total = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (given_damage && !draws.damaged[i]) continue;
    const double w = draws.weight[i];
    (x[i] < truth ? below : x[i] == truth ? same : total) += w;
  }
  return (below + u * same) / (total + below + same);
}

std::vector<double> member_lengths(const json& structure) {
  std::vector<double> out;
  for (const json& m : structure.at("members")) {
    const json &a = structure.at("nodes").at(m.at("nodes")[0].get<std::string>()),
               &b = structure.at("nodes").at(m.at("nodes")[1].get<std::string>());
    out.push_back(std::hypot(a[0].get<double>() - b[0].get<double>(),
                             a[1].get<double>() - b[1].get<double>()));
  }
  return out;
}

double largest_shift(const FrameCase& c) {
  double out = 0.0;
  const double high = c.healthy.at("band")[1].get<double>();
  for (Eigen::Index i = 0;
       i < c.state_healthy.frequencies_hz.size() && c.state_healthy.frequencies_hz[i] < high; ++i)
    out =
        std::max(out, 1.0 - c.state_damaged.frequencies_hz[i] / c.state_healthy.frequencies_hz[i]);
  return out;
}

/// Clopper and Pearson's 95 % bounds of a share.
std::array<double, 2> bounds(int held, int of) {
  using boost::math::beta_distribution;
  return {held > 0 ? quantile(beta_distribution<>(held, of - held + 1), 0.025) : 0.0,
          held < of ? quantile(beta_distribution<>(held + 1, of - held), 0.975) : 1.0};
}

}  // namespace

RecordsRow run_records(const FrameCase& c, const RecordsOptions& options) {
  std::filesystem::create_directories(options.folder);
  const auto write = [&](const char* name, const json& j) {
    std::ofstream(options.folder / name) << j.dump(1) << '\n';
  };
  const std::uint64_t seed = 1'000'000 * options.seed + 2 * static_cast<std::uint64_t>(c.number);
  write_csv(options.folder / "healthy.csv",
            accelerations(c.state_healthy, c.damping, options.noise, seed));
  write_csv(options.folder / "damaged.csv",
            accelerations(c.state_damaged, c.damping, options.noise, seed + 1));
  write("healthy.json", c.healthy);
  write("damaged.json", c.damaged);
  write("damage.json", c.damage);
  RecordsRow row{.number = c.number,
                 .name = c.name,
                 .is_damaged = c.is_damaged,
                 .reduction = c.is_damaged ? c.reduction : 0.0,
                 .largest_shift = largest_shift(c),
                 .in_band = static_cast<int>(c.healthy_hz.size() + c.damaged_hz.size())};
  for (const char* state : {"healthy", "damaged"})
    row.seconds_modal += command(options, std::string("modal ") + state + ".json -o " + state);
  row.seconds_damage = command(options, "damage damage.json -o out --seed " +
                                            std::to_string(c.number + 1) + " " + options.sampling);
  if (!options.keep_records)
    for (const char* record : {"healthy.csv", "damaged.csv"})
      std::filesystem::remove(options.folder / record);

  const json summary = read_json(options.folder / "out" / "summary.json");
  row.probability = summary.at("models")[1].at("probability").get<double>();
  row.converged = summary.at("diagnostics").at("converged").get<bool>();
  row.fit_p = summary.at("fit").at("p").is_number() ? summary.at("fit").at("p").get<double>() : 0.0;
  row.modes = static_cast<int>(summary.at("data").at("modes").size());
  const Draws draws = read_draws(options.folder / "out" / "posterior.nc", summary,
                                 member_lengths(c.damage.at("structure")));
  base::Random random(options.seed, static_cast<std::uint64_t>(c.number), 2, base::Purpose::test);
  const auto all = [&](const char* what, const std::vector<double>& x, double truth) {
    row.ranks[what] = rank(draws, x, truth, random.uniform(), false);
  };
  all("E posts", draws.posts, c.posts_young);
  all("E girders", draws.girders, c.girders_young);
  all("reduction", draws.reduction, row.reduction);
  if (c.is_damaged && row.probability > kMostDraws) {
    row.ranks["place"] = rank(draws, draws.place, c.location, 0.5, true);
    row.ranks["reduction if any"] = rank(draws, draws.reduction, c.reduction, 0.5, true);
  }
  return row;
}

std::string RecordsRow::to_line() const {
  return json{{"case", number},
              {"name", name},
              {"damaged", is_damaged},
              {"reduction", reduction},
              {"largest_shift", largest_shift},
              {"modes", modes},
              {"in_band", in_band},
              {"P", probability},
              {"fit_p", fit_p},
              {"converged", converged},
              {"ranks", ranks},
              {"seconds_modal", seconds_modal},
              {"seconds_damage", seconds_damage}}
      .dump();
}

RecordsRow RecordsRow::from_line(const std::string& line) {
  const json j = json::parse(line);
  RecordsRow row;
  j.at("case").get_to(row.number);
  j.at("name").get_to(row.name);
  j.at("damaged").get_to(row.is_damaged);
  j.at("reduction").get_to(row.reduction);
  j.at("largest_shift").get_to(row.largest_shift);
  j.at("modes").get_to(row.modes);
  j.at("in_band").get_to(row.in_band);
  j.at("P").get_to(row.probability);
  j.at("fit_p").get_to(row.fit_p);
  j.at("converged").get_to(row.converged);
  j.at("ranks").get_to(row.ranks);
  j.at("seconds_modal").get_to(row.seconds_modal);
  j.at("seconds_damage").get_to(row.seconds_damage);
  return row;
}

std::string records_report(const std::vector<RecordsRow>& rows) {
  int converged = 0, found = 0, there = 0, misfits = 0;
  std::map<std::string, std::array<int, 2>> held;
  for (const RecordsRow& r : rows) {
    converged += r.converged ? 1 : 0;
    misfits += r.fit_p < 0.01 ? 1 : 0;
    found += r.modes;
    there += r.in_band;
    for (const auto& [name, u] : r.ranks) {
      ++held[name][1];
      ++held["all"][1];
      if (u < 0.05 || u > 0.95) continue;
      ++held[name][0];
      ++held["all"][0];
    }
  }
  std::string out = text(
      "%zu cases, %d converged; %d of %d modes in the bands were used; p < 0.01 of the fit in "
      "%d\n\n",
      rows.size(), converged, found, there, misfits);
  out +=
      "| quantity | cases | 90 % intervals held | share, 95 % bounds |\n| --- | ---: | ---: | --- "
      "|\n";
  for (const auto& [name, n] : held) {
    const auto [low, high] = bounds(n[0], n[1]);
    out += text("| %s | %d | %d | %.3f, %.3f to %.3f |\n", name.c_str(), n[1], n[0],
                static_cast<double>(n[0]) / n[1], low, high);
  }
  const auto table = [&](const std::string& head, auto of, const std::vector<double>& edges,
                         const char* format) {
    out += "\n| " + head +
           " | cases | P(damage) > 0.5 | > 0.95 | mean P |\n| --- | ---: | ---: | ---: | ---: |\n";
    const auto line = [&](const std::string& name,
                          const std::function<bool(const RecordsRow&)>& in) {
      int n = 0, half = 0, sure = 0;
      double sum = 0.0;
      for (const RecordsRow& r : rows)
        if (in(r)) {
          ++n;
          half += r.probability > 0.5 ? 1 : 0;
          sure += r.probability > 0.95 ? 1 : 0;
          sum += r.probability;
        }
      if (n > 0)
        out += text("| %s | %d | %d | %d | %.3f |\n", name.c_str(), n, half, sure, sum / n);
    };
    line("none", [](const RecordsRow& r) { return !r.is_damaged; });
    for (std::size_t i = 0; i + 1 < edges.size(); ++i)
      line(text(format, edges[i], edges[i + 1]), [&](const RecordsRow& r) {
        return r.is_damaged && of(r) >= edges[i] && of(r) < edges[i + 1];
      });
  };
  table(
      "stiffness lost by one element", [](const RecordsRow& r) { return 100.0 * r.reduction; },
      {0.0, 2.0, 5.0, 10.0, 20.0, 80.0}, "%g to %g %%");
  table(
      "largest shift of a frequency", [](const RecordsRow& r) { return 100.0 * r.largest_shift; },
      {0.0, 0.03, 0.1, 0.3, 1.0, 100.0}, "%g to %g %%");
  return out;
}

}  // namespace wheeltap::coverage
