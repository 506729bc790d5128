#include "frame_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "apps/cases/damage_case.hpp"
#include "base/random.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::coverage {
namespace {

using nlohmann::json;

constexpr double kYoung = 210e9, kSpread = 0.05;
constexpr double kHealthyShare = 0.25, kWorst = 0.8;
constexpr Eigen::Index kMostModes = 8;  // in the band
constexpr double kHighest = 85.0;       // upper end of the band [Hz]

double between(base::Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

double rounded(double x, double to) {
  return std::round(x / to) * to;
}

json section(base::Random& random) {
  const double height = rounded(between(random, 0.08, 0.2), 0.01);
  return {{"shape", "rectangle"},
          {"height", height},
          {"width", rounded(height * between(random, 0.4, 1.0), 0.01)}};
}

struct Place {
  std::string member;
  double at;
  const char* direction;
};

/// Sensor places: per storey one horizontal at the head of its first post; then the middles of
/// girders and posts in a random order, then their quarter points.
std::vector<Place> places(base::Random& random, const json& structure,
                          const std::vector<double>& lengths, int storeys, int columns) {
  std::vector<Place> out, middles, quarters;
  for (std::size_t m = 0; m < lengths.size(); ++m) {
    const json& member = structure.at("members")[m];
    const bool post = member.at("material") == "posts";
    const std::string name = member.at("name").get<std::string>();
    const char* direction = post ? "x" : "y";
    middles.push_back({name, rounded(0.5 * lengths[m], 0.05), direction});
    for (const double q : {0.25, 0.75})
      quarters.push_back({name, rounded(q * lengths[m], 0.05), direction});
    if (post && static_cast<int>(m) % columns == 0 && static_cast<int>(m) < storeys * columns)
      out.push_back({name, lengths[m], "x"});
  }
  for (auto* list : {&middles, &quarters})
    for (std::size_t i = list->size() - 1; i > 0; --i)
      std::swap((*list)[i],
                (*list)[static_cast<std::size_t>(random.index(static_cast<int>(i) + 1))]);
  // A single bay and storey has eleven such places: eighths.
  for (auto* list : {&middles, &quarters}) out.insert(out.end(), list->begin(), list->end());
  for (std::size_t m = 0; out.size() < kSensors; ++m)
    out.push_back({structure.at("members")[m].at("name").get<std::string>(),
                   rounded(0.125 * lengths[m], 0.05),
                   structure.at("members")[m].at("material") == "posts" ? "x" : "y"});
  out.resize(kSensors);
  return out;
}

struct Frame {
  json structure;
  std::vector<double> lengths;
  int bays, storeys;
};

Frame frame(base::Random& random) {
  Frame out{
      .structure = {{"dimension", 2}}, .lengths = {}, .bays = 1 + random.index(2), .storeys = 1};
  const int elements = out.bays == 1 ? 4 : 3;
  std::vector<double> x = {0.0}, y = {0.0};
  for (int i = 0; i < out.bays; ++i)
    x.push_back(x.back() + rounded(between(random, 3.0, 8.0), 0.1));
  for (int i = 0; i < out.storeys; ++i)
    y.push_back(y.back() + rounded(between(random, 2.8, 4.5), 0.1));
  json& s = out.structure;
  for (const auto& [name, young] : {std::pair{"posts", "E posts"}, {"girders", "E girders"}})
    s["materials"][name] = {{"young", young}, {"poisson", 0.3}, {"density", 7850}};
  s["sections"] = {{"post", section(random)}, {"girder", section(random)}};
  const auto name = [](std::size_t column, std::size_t level) {
    return std::string(1, static_cast<char>('A' + column)) + std::to_string(level);
  };
  for (std::size_t level = 0; level < y.size(); ++level)
    for (std::size_t column = 0; column < x.size(); ++column)
      s["nodes"][name(column, level)] = {x[column], y[level]};
  s["members"] = json::array();
  const auto add = [&](const std::string& a, const std::string& b, bool post, double length) {
    s["members"].push_back({{"name", a + "-" + b},
                            {"nodes", {a, b}},
                            {"elements", elements},
                            {"material", post ? "posts" : "girders"},
                            {"section", post ? "post" : "girder"}});
    out.lengths.push_back(length);
  };
  for (std::size_t level = 0; level + 1 < y.size(); ++level)
    for (std::size_t column = 0; column < x.size(); ++column)
      add(name(column, level), name(column, level + 1), true, y[level + 1] - y[level]);
  for (std::size_t level = 1; level < y.size(); ++level)
    for (std::size_t bay = 0; bay + 1 < x.size(); ++bay)
      add(name(bay, level), name(bay + 1, level), false, x[bay + 1] - x[bay]);
  s["supports"] = json::array();
  for (std::size_t column = 0; column < x.size(); ++column)
    s["supports"].push_back({{"node", name(column, 0)}, {"fix", {"x", "y", "rotation"}}});
  return out;
}

FrameCase::State state(const identification::DamageCase& damage,
                       const std::vector<fem::SparseRow>& sensors) {
  const fem::Discretisation d = identification::true_structure(damage);
  const auto all = static_cast<int>(fem::mode_count(d));
  const fem::StructureModes modes = fem::structure_modes(d, all);
  Eigen::Index kept = 0;
  while (kept < all && modes.frequencies_hz[kept] < 2.0 * kSampleRate) ++kept;
  FrameCase::State out{.frequencies_hz = modes.frequencies_hz.head(kept),
                       .shapes = Eigen::MatrixXd(static_cast<Eigen::Index>(sensors.size()), kept)};
  for (Eigen::Index j = 0; j < kept; ++j)
    for (std::size_t i = 0; i < sensors.size(); ++i)
      out.shapes(static_cast<Eigen::Index>(i), j) = sensors[i].of(modes.shapes.col(j));
  return out;
}

json modal_case(const std::string& record, const std::vector<Place>& places, double low,
                double high) {
  json channels = json::array();
  for (std::size_t i = 0; i < places.size(); ++i)
    channels.push_back({{"column", "a" + std::to_string(i + 1)},
                        {"role", "response"},
                        {"node", places[i].member + " " + std::to_string(i + 1)},
                        {"direction", places[i].direction}});
  return {{"kind", "modal"},
          {"band", {low, high}},
          {"record",
           {{"file", record}, {"sample_rate", kSampleRate}, {"channels", std::move(channels)}}}};
}

}  // namespace

FrameCase frame_case(std::uint64_t seed, int number) {
  base::Random random(seed, static_cast<std::uint64_t>(number), 0, base::Purpose::test);
  const Frame f = frame(random);
  FrameCase out{.number = number,
                .name = "frame " + std::to_string(f.bays) + "x" + std::to_string(f.storeys),
                .posts_young = kYoung * std::exp(kSpread * random.normal()),
                .girders_young = kYoung * std::exp(kSpread * random.normal()),
                .is_damaged = random.uniform() >= kHealthyShare};
  double total = 0.0;
  for (const double length : f.lengths) total += length;
  out.location = total * random.uniform();
  out.reduction = kWorst * random.uniform();
  out.damping = between(random, 0.005, 0.02);
  out.along = out.location;
  while (out.along > f.lengths[static_cast<std::size_t>(out.member)])
    out.along -= f.lengths[static_cast<std::size_t>(out.member++)];
  const std::vector<Place> where = places(random, f.structure, f.lengths, f.storeys, f.bays + 1);

  const json prior = {{"log_normal", {std::log(kYoung), kSpread}}};
  json sensors = json::array();
  for (const Place& p : where)
    sensors.push_back({{"member", p.member}, {"at", p.at}, {"direction", p.direction}});
  out.damage = {
      {"kind", "damage"},
      {"title", out.name},
      {"structure", f.structure},
      {"parameters", {{"E posts", prior}, {"E girders", prior}}},
      {"baseline", {{"data", {{"from", "healthy/modes.json"}, {"sensors", sensors}}}}},
      {"data", {{"from", "damaged/modes.json"}, {"sensors", sensors}}},
      {"damage",
       {{"kind", "reduction"},
        {"count", {{"min", 0}, {"max", 1}, {"prior", {kHealthyShare, 1.0 - kHealthyShare}}}},
        {"reduction", {{"uniform", {0.0, kWorst}}}}}}};

  json truth = out.damage;
  truth.erase("baseline");
  truth.erase("parameters");
  truth["structure"]["materials"]["posts"]["young"] = out.posts_young;
  truth["structure"]["materials"]["girders"]["young"] = out.girders_young;
  truth["data"] = {{"frequencies", {1.0}}, {"cov", 0.01}};
  apps::DamageCaseFile parsed =
      apps::parse_damage_case({.path = "truth.json", .json = truth}, apps::Needs::structure);
  const fem::Mesh mesh(std::get<fem::Structure>(parsed.damage.structure->nominal));
  std::vector<fem::SparseRow> motions;
  for (const Place& p : where) {
    std::size_t m = 0;
    while (f.structure.at("members")[m].at("name") != p.member) ++m;
    motions.push_back(mesh.motion(static_cast<int>(m), p.at,
                                  *p.direction == 'x' ? fem::Direction::x : fem::Direction::y));
  }
  out.state_healthy = state(parsed.damage, motions);
  out.state_damaged = out.state_healthy;
  if (out.is_damaged) {
    parsed.damage.kinds[0].truth = {{.location = out.location, .severity = out.reduction}};
    out.state_damaged = state(parsed.damage, motions);
  }

  // The band ends in the widest gap behind one of its last modes, as an
  // engineer would choose from the spectra.
  const Eigen::VectorXd& hz = out.state_healthy.frequencies_hz;
  Eigen::Index most = 1;
  while (most < kMostModes && hz[most] < kHighest) ++most;
  Eigen::Index best = most;
  for (Eigen::Index n = std::max<Eigen::Index>(1, most - 3); n <= most; ++n)
    if (hz[n] / hz[n - 1] > hz[best] / hz[best - 1]) best = n;
  const double low = rounded(0.5 * hz[0], 0.1);
  const double high = rounded(std::min(kHighest, 0.5 * (hz[best - 1] + hz[best])), 0.1);
  out.healthy = modal_case("healthy.csv", where, low, high);
  out.damaged = modal_case("damaged.csv", where, low, high);
  const auto in_band = [&](const FrameCase::State& s) {
    std::vector<double> list;
    for (const double v : s.frequencies_hz)
      if (v > low && v < high) list.push_back(v);
    return list;
  };
  out.healthy_hz = in_band(out.state_healthy);
  out.damaged_hz = in_band(out.state_damaged);
  return out;
}

}  // namespace wheeltap::coverage
