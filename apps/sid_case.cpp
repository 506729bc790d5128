#include "apps/sid_case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "signals/excitation.hpp"
#include "signals/spectra.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {
namespace {

using dynamics::Coefficient;
using Role = SidChannel::Role;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kComparable = 128;   // samples of a window whose spectrum is worth comparing
constexpr double kPeculiar = 3.0;  // differences of spectra, in terms of their scatter
/// Share of an excitation's amplitude that may be lost by holding it to first order.
constexpr double kUpsampledLoss = 3e-3;
constexpr double kWorthWarning = 0.05;
/// So many steps from data of a simulation that its error stays far below any noise.
constexpr double kTruthStepLimit = 0.05;

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::string text_or_number(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Runs work(); what the libraries complain about becomes a complaint about the case.
template <class Work>
auto explained(const CaseFile& file, const Pointer& where, const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
  }
}

signals::Record read(const CaseFile& file, const Pointer& where, std::vector<std::string> columns) {
  const auto path = file.resolve(file.json.at(where).get<std::string>());
  try {
    return signals::read_record(path, std::move(columns));
  } catch (const io::FileError& error) {
    throw Failure(error.kind() == io::FileError::Kind::missing ? Exit::no_input : Exit::bad_input,
                  error.what());
  }
}

signals::Dimension dimension_of(Role role, dynamics::Quantity quantity) {
  if (role == Role::force) return signals::Dimension::force;
  if (role == Role::base_acceleration) return signals::Dimension::acceleration;
  if (role == Role::base_displacement || quantity == dynamics::Quantity::displacement)
    return signals::Dimension::length;
  return quantity == dynamics::Quantity::velocity ? signals::Dimension::velocity
                                                  : signals::Dimension::acceleration;
}

/// What a unit is in SI where it is one of this dimension.
std::optional<double> si_of(const std::string& unit, signals::Dimension dimension) {
  const auto known = signals::find_unit(unit);
  if (!known || known->dimension != dimension) return std::nullopt;
  return known->si;
}

class Parser {
 public:
  Parser(SidCase& out, SidNeeds needs) : out_(out), file_(out.file), json_(out.file.json) {
    parse_parameters();
    parse_channels();
    if (json_.contains("integration")) parse_integration();
    for (std::size_t m = 0; m < json_["models"].size(); ++m) parse_model(Pointer("/models") / m);
    check_channels();
    parse_truth();
    for (std::size_t p = 0; p < used_.size(); ++p) {
      if (!used_[p]) {
        file_.refuse(Pointer("/parameters") / out_.parameters[p].name,
                     "this parameter is used nowhere");
      }
    }
    if (needs == SidNeeds::record) load_record();
    finish_models();
  }

 private:
  // ---- parameters and coefficients

  void parse_parameters() {
    const Json priors = json_.value("parameters", Json::object());
    for (const auto& [name, ignored] : priors.items()) {
      out_.parameters.push_back({name, parse_prior(file_, Pointer("/parameters") / name)});
    }
    used_.assign(out_.parameters.size(), false);
  }

  int find_parameter(const Pointer& where) const {
    const auto name = file_.json.at(where).get<std::string>();
    std::vector<std::string> names;
    for (std::size_t p = 0; p < out_.parameters.size(); ++p) {
      names.push_back(out_.parameters[p].name);
      if (names.back() == name) return static_cast<int>(p);
    }
    file_.refuse(where, "no parameter has this name; /parameters holds: " + listed(names));
  }

  /// A number or a parameter, held to [low, ∞), or (0, ∞) for a number where `positive`.
  Coefficient coefficient(const Pointer& where, double low = -kInfinity, bool positive = false) {
    const Json& value = file_.json.at(where);
    const std::string bound = positive ? "positive" : "not negative";
    if (value.is_number()) {
      const double x = value;
      if (x < low || (positive && !(x > 0.0))) file_.refuse(where, "must be " + bound);
      return x;
    }
    if (!value.is_string()) file_.refuse(where, "must be a number, or the name of a parameter");
    const int p = find_parameter(where);
    const inference::Prior& prior = out_.parameters[static_cast<std::size_t>(p)].prior;
    if (prior.lower() < low) {
      const auto& name = out_.parameters[static_cast<std::size_t>(p)].name;
      file_.refuse(Pointer("/parameters") / name,
                   "reaches down to " + Json(prior.lower()).dump() + ", but " + where.to_string() +
                       " must be " + bound +
                       ": use a prior on [0, ∞), e.g. \"truncated_normal\" or \"log_normal\"");
    }
    used_[static_cast<std::size_t>(p)] = true;
    return Coefficient::of_parameter(p);
  }

  Coefficient added(const std::string& name, inference::Prior prior) {
    const auto same = std::ranges::find(out_.parameters, name, &inference::Parameter::name);
    if (same != out_.parameters.end()) {
      return Coefficient::of_parameter(static_cast<int>(same - out_.parameters.begin()));
    }
    out_.parameters.push_back({name, std::move(prior)});
    used_.push_back(true);
    return Coefficient::of_parameter(static_cast<int>(out_.parameters.size()) - 1);
  }

  // ---- channels

  void parse_channels() {
    const Pointer list("/record/channels");
    for (std::size_t i = 0; i < json_.at(list).size(); ++i) {
      const Pointer where = list / i;
      const Json& c = json_.at(where);
      static const std::vector<std::string> roles = {
          "time", "force", "base-acceleration", "base-displacement", "response", "ignore"};
      SidChannel channel{.column = text_or_number(c["column"]), .where = where};
      channel.role =
          static_cast<Role>(std::ranges::find(roles, c["role"].get<std::string>()) - roles.begin());
      const bool on_mass = channel.role == Role::force || channel.role == Role::response;
      if (on_mass && !c.contains("mass")) {
        file_.refuse(where / "mass", "is missing: must be the number of a mass, from 1");
      }
      if (!on_mass && c.contains("mass")) {
        file_.refuse(where / "mass", "goes with the roles \"force\" and \"response\" only");
      }
      channel.mass = c.value("mass", 0);
      if (channel.role == Role::response) {
        if (!c.contains("quantity")) {
          file_.refuse(where / "quantity",
                       "is missing: must be \"displacement\", \"velocity\" or \"acceleration\"");
        }
        channel.quantity = c["quantity"] == "displacement" ? dynamics::Quantity::displacement
                           : c["quantity"] == "velocity"   ? dynamics::Quantity::velocity
                                                           : dynamics::Quantity::acceleration;
        channel.frame = c.value("frame", "") == "relative" ? dynamics::Frame::relative
                                                           : dynamics::Frame::absolute;
      } else {
        for (const char* key : {"quantity", "frame"}) {
          if (c.contains(key)) file_.refuse(where / key, "goes with the role \"response\" only");
        }
      }
      if (channel.role == Role::time || channel.role == Role::ignore) {
        for (const char* key : {"scale", "offset"}) {
          const bool of_time = channel.role == Role::time && std::string_view(key) == "scale";
          if (c.contains(key) && !of_time) file_.refuse(where / key, "does not go with this role");
        }
        if (c.contains("scale") && !(c["scale"].is_number() && c["scale"].get<double>() > 0.0)) {
          file_.refuse(where / "scale",
                       "must be a positive number: how many seconds one of time is");
        }
      }
      if (c.contains("scale")) {
        if (c["scale"].is_number() && c["scale"].get<double>() == 0.0) {
          file_.refuse(where / "scale", "must not be 0");
        }
        channel.signal.scale = coefficient(where / "scale");
      }
      channel.unit = io::column_of_header(channel.column).unit;
      convert_unit(channel);
      if (c.contains("offset")) channel.signal.offset = coefficient(where / "offset");
      if (channel.role == Role::time && find(Role::time) != nullptr) {
        file_.refuse(where, "there is a time channel already");
      }
      if (channel.role == Role::base_acceleration && find(channel.role) != nullptr) {
        file_.refuse(where, "there is a base acceleration already");
      }
      if (channel.role == Role::base_displacement && find(channel.role) != nullptr) {
        file_.refuse(where, "there is a base displacement already");
      }
      out_.channels.push_back(std::move(channel));
    }
    if (out_.responses().empty()) {
      file_.refuse(list, "no channel has the role \"response\": there is nothing to explain");
    }
  }

  /// A scale is the header's unit where the case gives none.
  void convert_unit(SidChannel& channel) const {
    if (channel.role == Role::ignore || json_.contains(channel.where / "scale")) return;
    const auto dimension = channel.role == Role::time
                               ? signals::Dimension::time
                               : dimension_of(channel.role, channel.quantity);
    if (const auto si = si_of(channel.unit, dimension)) channel.signal.scale = *si;
  }

  [[nodiscard]] const SidChannel* find(Role role) const {
    const auto found = std::ranges::find(out_.channels, role, &SidChannel::role);
    return found == out_.channels.end() ? nullptr : &*found;
  }

  void parse_integration() {
    const Json& i = json_["integration"];
    out_.integration.substeps = i.value("substeps", out_.integration.substeps);
    const std::string method = i.value("method", "automatic");
    out_.integration.prefer_series = method == "series";
    if (method == "runge-kutta") out_.integration.integrator = dynamics::Integrator::runge_kutta;
    out_.integration.step_limit = i.value("step_limit", out_.integration.step_limit);
  }

  // ---- models

  void parse_laws(const Pointer& where, dynamics::Link& link) {
    for (const dynamics::LawInfo& info : dynamics::law_infos()) {
      const Pointer here = where / std::string(info.name);
      if (!json_.contains(here)) continue;
      if (!json_.at(here).is_array()) {
        link.laws.push_back(parse_law(here, info));
        continue;
      }
      for (std::size_t i = 0; i < json_.at(here).size(); ++i) {
        link.laws.push_back(parse_law(here / i, info));
      }
    }
  }

  dynamics::Law parse_law(const Pointer& here, const dynamics::LawInfo& info) {
    const Json& value = json_.at(here);
    const std::string name(info.name);
    // What must not be negative, whatever the law.
    const auto low = [](std::string_view c) {
      return c == "gap" || c == "velocity" || c == "yield" ? 0.0 : -kInfinity;
    };
    std::vector<std::string> keys;
    for (int i = 0; i < info.size(); ++i) {
      keys.emplace_back(info.coefficients[static_cast<std::size_t>(i)].name);
    }
    std::vector<Coefficient> coefficients;
    auto side = dynamics::Side::opening;
    if (!value.is_object()) {
      if (info.one_sided || (info.size() > 1 && info.coefficients[1].required())) {
        file_.refuse(here, name + " must be an object with " + listed(keys) +
                               (info.one_sided ? " and side" : ""));
      }
      coefficients.push_back(coefficient(here, low(keys[0])));
    } else {
      for (const auto& [key, ignored] : value.items()) {
        if (std::ranges::find(keys, key) == keys.end() && !(info.one_sided && key == "side")) {
          file_.refuse(here / key, "unknown key; " + name + " has " + listed(keys) +
                                       (info.one_sided ? " and side" : ""));
        }
      }
      for (std::size_t i = 0; i < keys.size(); ++i) {
        if (value.contains(keys[i])) {
          coefficients.push_back(coefficient(here / keys[i], low(keys[i])));
        } else if (info.coefficients[i].required()) {
          file_.refuse(here / keys[i], "is missing: " + name + " has " + listed(keys));
        } else {
          coefficients.emplace_back(info.coefficients[i].otherwise);
        }
      }
      if (info.one_sided) {
        if (!value.contains("side") || (value["side"] != "opening" && value["side"] != "closing")) {
          file_.refuse(here / "side", "must be \"opening\" or \"closing\"");
        }
        if (value["side"] == "closing") side = dynamics::Side::closing;
      }
    }
    return explained(file_, here,
                     [&] { return dynamics::make_law(info.name, coefficients, side); });
  }

  void parse_model(const Pointer& where) {
    const Json& m = json_.at(where);
    SidModel model{.name = m["name"], .weight = m.value("prior", 1.0), .where = where};
    for (const SidModel& other : out_.models) {
      if (other.name == model.name) file_.refuse(where / "name", "two models have this name");
    }
    for (std::size_t i = 0; i < m["masses"].size(); ++i) {
      model.chain.masses.push_back(coefficient(where / "masses" / i, 0.0, true));
    }
    const int masses = model.chain.size();
    for (std::size_t l = 0; l < m["links"].size(); ++l) {
      const Pointer here = where / "links" / l;
      const Json& between = json_.at(here / "between");
      dynamics::Link link{.a = between[0], .b = between[1]};
      for (std::size_t end = 0; end < 2; ++end) {
        if (between[end] > masses) {
          file_.refuse(here / "between" / end, "no such mass; " + model.name + " has masses 1 to " +
                                                   std::to_string(masses) +
                                                   ", and 0 is the ground or the base");
        }
      }
      if (link.a == link.b) file_.refuse(here / "between", "must join two different masses");
      if (json_.contains(here / "stiffness")) link.stiffness = coefficient(here / "stiffness");
      if (json_.contains(here / "damping")) link.damping = coefficient(here / "damping");
      parse_laws(here, link);
      model.chain.links.push_back(std::move(link));
    }
    explained(file_, where / "links", [&] { dynamics::validate(model.chain); });

    const std::size_t responses = out_.responses().size();
    if (m["noise"].is_array()) {
      if (m["noise"].size() != responses) {
        file_.refuse(where / "noise",
                     "must have one value a response channel: " + std::to_string(responses));
      }
      for (std::size_t c = 0; c < responses; ++c) {
        model.noise.push_back(coefficient(where / "noise" / c, 0.0, true));
      }
    } else {
      model.noise.assign(responses, coefficient(where / "noise", 0.0, true));
    }
    const int order = m.value("residuals", json_.value("residuals", Json::object())).value("ar", 0);
    for (std::size_t c = 0; order > 0 && c < responses; ++c) {
      model.autocorrelations.emplace_back();
      for (int j = 1; j <= order; ++j) {
        const std::string channel = responses > 1 ? "[" + std::to_string(c + 1) + "]" : "";
        model.autocorrelations.back().push_back(
            added("ar" + channel + "[" + std::to_string(j) + "]", inference::Uniform{-1.0, 1.0}));
      }
    }
    parse_initial(model);
    out_.models.push_back(std::move(model));
  }

  void parse_initial(SidModel& model) {
    const Pointer where("/record/initial");
    if (!json_.contains(where) || !json_.at(where).is_object()) return;
    const auto masses = static_cast<std::size_t>(model.chain.size());
    const auto values = [&](const char* key, std::vector<Coefficient>& to) {
      if (!json_.contains(where / key)) return;
      if (json_.at(where / key).size() != masses) {
        file_.refuse(where / key, "must have one value a mass: " + std::to_string(masses));
      }
      for (std::size_t i = 0; i < masses; ++i) to.push_back(coefficient(where / key / i));
    };
    values("displacement", model.initial.displacement);
    values("velocity", model.initial.velocity);
  }

  void check_channels() {
    const bool base = find(Role::base_acceleration) != nullptr ||
                      find(Role::base_displacement) != nullptr || truth_moves_base();
    for (const SidChannel& channel : out_.channels) {
      for (const SidModel& model : out_.models) {
        if (channel.mass > model.chain.size()) {
          file_.refuse(channel.where / "mass", "no such mass; model \"" + model.name +
                                                   "\" has masses 1 to " +
                                                   std::to_string(model.chain.size()));
        }
      }
      if (channel.role == Role::response && base && channel.frame == dynamics::Frame::absolute &&
          channel.quantity != dynamics::Quantity::acceleration &&
          find(Role::base_displacement) == nullptr && !truth_displaces_base()) {
        file_.refuse(channel.where, "an absolute " +
                                        json_.at(channel.where / "quantity").get<std::string>() +
                                        " of a base-driven chain needs a channel with the role "
                                        "\"base-displacement\"; or say \"frame\": \"relative\"");
      }
    }
  }

  // ---- truth

  [[nodiscard]] bool truth_moves_base() const {
    if (json_["record"].contains("file") || !json_.contains("truth")) return false;
    return std::ranges::any_of(json_["truth"]["excitation"],
                               [](const Json& e) { return e.contains("base"); });
  }
  [[nodiscard]] bool truth_displaces_base() const {
    return truth_moves_base() &&
           std::ranges::any_of(json_["truth"]["excitation"], [](const Json& e) {
             return e.contains("base") && e.value("quantity", "") == "displacement";
           });
  }

  void parse_truth() {
    if (!json_.contains("truth")) return;
    const Json& t = json_["truth"];
    const Pointer where("/truth");
    SidTruth truth{.samples = t["samples"],
                   .sample_rate_hz = t["sample_rate"],
                   .seed = t.value("seed", std::uint64_t{1})};
    const auto found =
        std::ranges::find(out_.models, t["model"].get<std::string>(), &SidModel::name);
    if (found == out_.models.end()) {
      std::vector<std::string> names;
      for (const SidModel& model : out_.models) names.push_back(model.name);
      file_.refuse(where / "model", "no model has this name; there are: " + listed(names));
    }
    truth.model = static_cast<int>(found - out_.models.begin());
    truth.theta.assign(out_.parameters.size(), kNaN);
    const Json given = t.value("parameters", Json::object());
    for (const auto& [name, value] : given.items()) {
      const auto p = std::ranges::find(out_.parameters, name, &inference::Parameter::name);
      if (p == out_.parameters.end()) {
        file_.refuse(where / "parameters" / name, "no parameter has this name");
      }
      truth.theta[static_cast<std::size_t>(p - out_.parameters.begin())] = value;
    }
    for (const int p : parameters_of(*found)) {
      const auto at = static_cast<std::size_t>(p);
      const bool noise_only =
          std::ranges::any_of(found->noise, [&](const Coefficient& c) { return c.parameter == p; });
      if (std::isnan(truth.theta[at]) && noise_only && t.contains("noise")) continue;
      if (std::isnan(truth.theta[at]) && json_["parameters"].contains(out_.parameters[at].name)) {
        file_.refuse(where / "parameters" / out_.parameters[at].name,
                     "is missing: the true model uses it");
      }
    }
    const std::size_t responses = out_.responses().size();
    if (t.contains("noise") && t["noise"].is_array()) {
      truth.noise = t["noise"].get<std::vector<double>>();
      if (truth.noise.size() != responses) {
        file_.refuse(where / "noise",
                     "must have one value a response channel: " + std::to_string(responses));
      }
    } else if (t.contains("noise")) {
      truth.noise.assign(responses, t["noise"]);
    } else {
      for (const Coefficient& c : found->noise) truth.noise.push_back(c.at(truth.theta));
    }
    for (double& x : truth.theta) {
      if (std::isnan(x)) x = 0.0;  // initial states and autocorrelations of the runs
    }
    out_.truth = std::move(truth);
    if (!json_["record"].contains("file")) add_true_excitations();
  }

  /// The true excitation is measured exactly, also where no channel asks for it.
  void add_true_excitations() {
    const Json& list = json_["truth"]["excitation"];
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Pointer where = Pointer("/truth/excitation") / i;
      const bool base = list[i].contains("base");
      if (base == list[i].contains("mass")) {
        file_.refuse(where, "must have either a \"mass\" or \"base\": true");
      }
      const bool displacement = list[i].value("quantity", "") == "displacement";
      if (list[i].contains("quantity") && !base) {
        file_.refuse(where / "quantity", "goes with \"base\": true only");
      }
      const Role role = !base          ? Role::force
                        : displacement ? Role::base_displacement
                                       : Role::base_acceleration;
      const int mass = list[i].value("mass", 0);
      const int masses = out_.models[static_cast<std::size_t>(out_.truth->model)].chain.size();
      if (mass > masses) {
        file_.refuse(where / "mass",
                     "no such mass; the true model has masses 1 to " + std::to_string(masses));
      }
      if (std::ranges::any_of(out_.channels, [&](const SidChannel& c) {
            return c.role == role && c.mass == mass;
          })) {
        continue;
      }
      out_.channels.push_back({.column = !base          ? "force " + std::to_string(mass) + " [N]"
                                         : displacement ? "base displacement [m]"
                                                        : "base acceleration [m/s^2]",
                               .role = role,
                               .mass = mass,
                               .where = where});
    }
  }

  [[nodiscard]] std::vector<int> parameters_of(const SidModel& model) const {
    std::set<int> used;
    const auto use = [&](const Coefficient& c) {
      if (!c.is_constant()) used.insert(c.parameter);
    };
    for (const auto& mass : model.chain.masses) use(mass);
    for (const auto& link : model.chain.links) {
      use(link.stiffness), use(link.damping);
      for (const auto& law : link.laws) {
        for (const auto& c : law.coefficients) use(c);
      }
    }
    for (const auto& c : model.initial.displacement) use(c);
    for (const auto& c : model.initial.velocity) use(c);
    for (const auto& c : model.noise) use(c);
    for (const auto& channel : model.autocorrelations) {
      for (const auto& c : channel) use(c);
    }
    for (const SidChannel& channel : out_.channels) {
      use(channel.signal.scale), use(channel.signal.offset);
    }
    return {used.begin(), used.end()};
  }

  // ---- the record

  void load_record() {
    const Json& r = json_["record"];
    signals::Record record;
    if (r.contains("file")) {
      std::vector<std::string> columns;
      for (const SidChannel& channel : out_.channels) {
        if (channel.role != Role::ignore) columns.push_back(channel.column);
      }
      record = read(file_, Pointer("/record/file"), std::move(columns));
      out_.origin = "measured, " + r["file"].get<std::string>();
    } else if (out_.truth) {
      record = simulate_record(out_, out_.truth->seed);
      out_.simulated = true;
      out_.origin = "simulated from the case's truth, seed " + std::to_string(out_.truth->seed);
    } else {
      file_.refuse(Pointer("/record/file"),
                   "is missing: give a record, or a \"truth\" to simulate it from");
    }
    read_rate(record);
    read_window(record);
    const bool band_limited = r.value("between_samples", "linear") == "band-limited";
    if (r.contains("upsample") && !band_limited) {
      file_.refuse(Pointer("/record/upsample"), "goes with \"between_samples\": \"band-limited\"");
    }
    try {
      if (band_limited) out_.stride = choose_stride(record);
      for (SidChannel& channel : out_.channels) load_channel(record, channel, band_limited);
    } catch (const io::FileError& error) {
      throw Failure(Exit::bad_input, error.what());
    }
    out_.integration.stride = out_.stride;
  }

  int find_column(const signals::Record& record, const SidChannel& channel) const {
    try {
      return record.find(channel.column);
    } catch (const io::FileError& error) {
      file_.refuse(
          json_.contains(channel.where / "column") ? channel.where / "column" : channel.where,
          error.what());
    }
  }

  void read_rate(const signals::Record& record) {
    const Json& r = json_["record"];
    std::optional<double> stated;
    if (r.contains("sample_rate")) stated = r["sample_rate"].get<double>();
    const SidChannel* time = find(Role::time);
    int column = time != nullptr ? find_column(record, *time) : record.find_time();
    // A column of that name which the case puts to another use is not time.
    for (const SidChannel& channel : out_.channels) {
      if (channel.role != Role::time && column == find_column(record, channel)) column = -1;
    }
    if (column < 0) {
      if (!stated) {
        file_.refuse(
            Pointer("/record/sample_rate"),
            "is missing: no channel is \"time\", so the sampling rate in Hz must be given");
      }
      out_.sample_rate_hz = *stated;
      return;
    }
    try {
      std::optional<double> scale;
      if (time != nullptr && json_.contains(time->where / "scale")) {
        scale = time->signal.scale.value;
      }
      out_.sample_rate_hz = signals::sample_rate_hz(record, column, stated, scale);
    } catch (const io::FileError& error) {
      throw Failure(Exit::bad_input, error.what());
    }
  }

  void read_window(const signals::Record& record) {
    const Json& r = json_["record"];
    const std::string there = record.file + " has " + std::to_string(record.samples()) + " samples";
    out_.end = record.samples();
    if (r.contains("samples")) {
      out_.begin = r["samples"][0];
      out_.end = r["samples"][1];
      if (out_.begin >= out_.end) {
        file_.refuse(Pointer("/record/samples"), "must be [first, one past the last]");
      }
      if (out_.end > record.samples()) {
        file_.refuse(Pointer("/record/samples"), "reaches beyond the record; " + there);
      }
    }
    if (out_.end - out_.begin < 4) {
      file_.refuse(Pointer("/record/samples"), "must be a window of at least 4 samples; " + there);
    }
    out_.lead_in = r.value("lead_in", 0);
    if (out_.lead_in > out_.begin) {
      file_.refuse(Pointer("/record/lead_in"),
                   "only " + std::to_string(out_.begin) + " samples stand before the window");
    }
  }

  template <class Visit>
  void each_excitation(const signals::Record& record, const Visit& visit) const {
    for (const SidChannel& channel : out_.channels) {
      if (!channel.is_excitation()) continue;
      visit(channel, signals::window(record, find_column(record, channel),
                                     out_.begin - out_.lead_in, out_.end));
    }
  }

  /// Amplitude that the worst excitation loses between samples when held at `factor` times the
  /// rate.
  double loss(const signals::Record& record, int factor, std::string* worst = nullptr) const {
    double most = 0.0;
    each_excitation(record, [&](const SidChannel& channel, std::vector<double> samples) {
      signals::detrend(samples, 0);
      const auto spectrum = signals::welch(samples, out_.sample_rate_hz);
      const double lost =
          signals::linear_interpolation_loss(spectrum, out_.sample_rate_hz * factor);
      if (lost > most) {
        most = lost;
        if (worst != nullptr) *worst = channel.column;
      }
    });
    return most;
  }

  int choose_stride(const signals::Record& record) const {
    if (json_["record"].contains("upsample")) return json_["record"]["upsample"];
    int factor = 1;
    while (factor < 16 && loss(record, factor) > kUpsampledLoss) factor *= 2;
    return factor;
  }

  void load_channel(const signals::Record& record, SidChannel& channel, bool band_limited) {
    if (channel.role == Role::ignore || channel.role == Role::time) {
      static_cast<void>(find_column(record, channel));
      return;
    }
    const int column = find_column(record, channel);
    const auto& source = record.columns[static_cast<std::size_t>(column)];
    channel.unit = source.unit;
    convert_unit(channel);
    const int begin = out_.begin - out_.lead_in;
    channel.signal.samples = signals::window(record, column, begin, out_.end);
    const bool whole =
        std::ranges::all_of(source.values, [](double x) { return std::isfinite(x); });
    const bool part = out_.begin > 0 || out_.end < record.samples();
    if (whole && part && !out_.simulated && out_.end - out_.begin >= kComparable) {
      channel.window = signals::compare_window(source.values, out_.begin, out_.end,
                                               out_.sample_rate_hz, {.segment = kComparable / 2});
      warn_of_window(channel);
    }
    if (!channel.is_excitation()) return;
    if (band_limited) {
      channel.signal.samples =
          whole ? signals::upsample(source.values, begin, out_.end, out_.stride)
                : signals::upsample(channel.signal.samples, 0, out_.end - begin, out_.stride);
    }
  }

  // ---- what depends on the data

  void finish_models() {
    if (out_.sample_rate_hz == 0.0) return finish_parameters();
    warn_of_interpolation();
    warn_of_units();
    const bool inferred = json_["record"].value("initial", Json("rest")) == "inferred";
    for (SidModel& model : out_.models) {
      if (inferred) infer_initial(model);
    }
    finish_parameters();
  }

  void finish_parameters() {
    for (SidModel& model : out_.models) model.parameters = parameters_of(model);
  }

  void warn_of_window(const SidChannel& channel) {
    if (channel.window->difference_db < kPeculiar * channel.window->expected_db) return;
    const auto decibel = [](double x) { return std::to_string(std::lround(x)) + " dB"; };
    out_.warnings.push_back("The window is not like the rest of the record: the spectrum of \"" +
                            channel.column + "\" differs by " +
                            decibel(channel.window->difference_db) + " (scatter alone gives " +
                            decibel(channel.window->expected_db) +
                            "). What is found holds for the window; try another, or a longer one.");
  }

  void warn_of_interpolation() {
    if (out_.simulated || out_.stride > 1) return;
    std::string worst;
    double most = 0.0;
    for (const SidChannel& channel : out_.channels) {
      if (!channel.is_excitation()) continue;
      std::vector<double> samples = channel.signal.samples;
      signals::detrend(samples, 0);
      const double lost = signals::linear_interpolation_loss(
          signals::welch(samples, out_.sample_rate_hz), out_.sample_rate_hz);
      if (lost > most) most = lost, worst = channel.column;
    }
    if (most < kWorthWarning) return;
    out_.warnings.push_back(
        "The excitation \"" + worst + "\" is taken as linear between its samples; if it was " +
        "measured behind an anti-alias filter this loses " +
        std::to_string(std::lround(100.0 * most)) +
        " % of its amplitude. Then set \"between_samples\": \"band-limited\" in the record.");
  }

  void warn_of_units() {
    for (const SidChannel& channel : out_.channels) {
      if (!channel.is_excitation() && channel.role != Role::response) continue;
      const bool plain = channel.unit.empty() || channel.unit == "1";
      const auto dimension = dimension_of(channel.role, channel.quantity);
      if (plain || si_of(channel.unit, dimension) || json_.contains(channel.where / "scale")) {
        continue;
      }
      out_.warnings.push_back("Channel \"" + channel.column + "\" is in " + channel.unit +
                              " and has no \"scale\": its numbers are used as they are, as if they "
                              "were SI units. Known units of " +
                              std::string(name(dimension)) + ": " + known_units(dimension) + ".");
    }
  }

  /// Normal priors about 0. Scales: the sd of the mass's own displacement, or that of a velocity or
  /// acceleration over ω or ω², ω the root mean square frequency of its spectrum; a mass without a
  /// sensor takes the largest of the others'.
  void infer_initial(SidModel& model) {
    const int masses = model.chain.size();
    std::vector<double> y(static_cast<std::size_t>(masses)), v(y.size());
    double top_y = 0.0, top_v = 0.0;
    for (const SidChannel* channel : out_.responses()) {
      std::vector<double> samples = channel->signal.samples;
      const double scale =
          channel->signal.scale.is_constant() ? std::abs(channel->signal.scale.value) : 1.0;
      signals::detrend(samples, 0);
      const auto spectrum = signals::welch(samples, out_.sample_rate_hz);
      double power = 0.0, moment = 0.0, squares = 0.0;
      for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
        const double w = 2.0 * M_PI * spectrum.frequencies_hz[i];
        power += spectrum.density[i];
        moment += w * w * spectrum.density[i];
      }
      for (const double x : samples) squares += x * x;
      const double sd = scale * std::sqrt(squares / static_cast<double>(samples.size()));
      const double omega = power > 0.0 ? std::sqrt(moment / power) : 1.0;
      const int order = static_cast<int>(channel->quantity);
      const auto at = static_cast<std::size_t>(channel->mass - 1);
      y[at] = std::max(y[at], sd / std::pow(omega, order));
      v[at] = std::max(v[at], sd / std::pow(omega, order - 1));
      top_y = std::max(top_y, y[at]);
      top_v = std::max(top_v, v[at]);
    }
    if (!(top_y > 0.0)) {
      file_.refuse(Pointer("/record/initial"), "the responses are constant: nothing to infer from");
    }
    for (std::size_t i = 0; i < y.size(); ++i) {
      const std::string index = "[" + std::to_string(i + 1) + "]";
      model.initial.displacement.push_back(
          added("y0" + index, inference::Normal{0.0, y[i] > 0.0 ? y[i] : top_y}));
      model.initial.velocity.push_back(
          added("v0" + index, inference::Normal{0.0, v[i] > 0.0 ? v[i] : top_v}));
    }
  }

  SidCase& out_;
  const CaseFile& file_;
  const Json& json_;
  std::vector<bool> used_;
};

// ---- simulation

std::vector<double> make_excitation(const SidCase& sid_case, std::size_t i, signals::Noise& noise) {
  const CaseFile& file = sid_case.file;
  const Pointer where = Pointer("/truth/excitation") / i;
  const Json& e = file.json.at(where);
  const std::string kind = e["kind"];
  static const std::vector<std::pair<std::string, std::vector<std::string>>> kinds = {
      {"white", {"variance"}},
      {"band-limited", {"low", "high", "variance"}},
      {"sine", {"amplitude", "frequency"}},
      {"multisine", {"low", "high", "rms"}},
      {"file", {"file", "column"}}};
  for (const auto& [name, keys] : kinds) {
    if (name != kind) continue;
    for (const auto& key : keys) {
      if (!e.contains(key)) {
        file.refuse(where / key, "is missing: \"" + kind + "\" has " + listed(keys));
      }
    }
  }
  const auto value = [&](const char* key) { return e[key].get<double>(); };
  const int samples = sid_case.truth->samples;
  const double rate = sid_case.truth->sample_rate_hz;
  if (kind == "file") {
    const std::string name = text_or_number(e["column"]);
    const signals::Record record = read(file, where / "file", {name});
    try {
      const int column = record.find(name);
      std::vector<double> x = signals::window(record, column, 0, samples);
      const bool moved = e.value("quantity", "") == "displacement";
      const auto si = si_of(record.columns[static_cast<std::size_t>(column)].unit,
                            !e.contains("base") ? signals::Dimension::force
                            : moved             ? signals::Dimension::length
                                                : signals::Dimension::acceleration);
      for (double& sample : x) sample *= e.value("scale", si.value_or(1.0));
      return x;
    } catch (const io::FileError& error) {
      file.refuse(where, error.what());
    }
  }
  return explained(file, where, [&] {
    if (kind == "white") return signals::white_noise(samples, value("variance"), noise);
    if (kind == "band-limited") {
      return signals::band_limited_noise(samples, rate, value("low"), value("high"),
                                         value("variance"), noise);
    }
    if (kind == "sine") {
      return signals::sine(samples, rate, value("amplitude"), value("frequency"),
                           e.value("phase", 0.0));
    }
    return signals::multisine(samples, rate,
                              {.period = e.value("period", 1024),
                               .low_hz = value("low"),
                               .high_hz = value("high"),
                               .rms = value("rms"),
                               .odd_lines_only = e.value("odd", false)},
                              noise);
  });
}

}  // namespace

std::vector<const SidChannel*> SidCase::responses() const {
  std::vector<const SidChannel*> list;
  for (const SidChannel& channel : channels) {
    if (channel.role == Role::response) list.push_back(&channel);
  }
  return list;
}

dynamics::Excitation SidCase::excitation() const {
  dynamics::Excitation out{.sample_rate_hz = sample_rate_hz * stride};
  for (const SidChannel& channel : channels) {
    if (channel.role == Role::force) out.forces.push_back({channel.mass, channel.signal});
    if (channel.role == Role::base_acceleration || channel.role == Role::base_displacement) {
      if (!out.base) out.base.emplace();
      (channel.role == Role::base_acceleration ? out.base->acceleration : out.base->displacement) =
          channel.signal;
    }
  }
  return out;
}

std::vector<dynamics::Sensor> SidCase::sensors() const {
  std::vector<dynamics::Sensor> list;
  for (const SidChannel* channel : responses()) {
    list.push_back({channel->mass, channel->quantity, channel->frame});
  }
  return list;
}

SidCase parse_sid_case(CaseFile file, SidNeeds needs) {
  validate_against_schema(file, "sid");
  SidCase out{.file = std::move(file)};
  const Json& json = out.file.json;
  out.title = json.value("title", out.file.path.stem().string());
  out.band = json.value("band", out.band);
  out.balance = json.value("balance", false);
  if (json.contains("notes")) {
    if (json["notes"].is_string()) {
      out.notes = {json["notes"].get<std::string>()};
    } else {
      out.notes = json["notes"].get<std::vector<std::string>>();
    }
  }
  const Parser parser(out, needs);
  return out;
}

signals::Record simulate_record(const SidCase& sid_case, std::uint64_t seed) {
  if (!sid_case.truth) {
    sid_case.file.refuse(Pointer("/truth"), "is missing: there is nothing to simulate");
  }
  const SidTruth& truth = *sid_case.truth;
  const auto samples = static_cast<std::size_t>(truth.samples);
  // Streams of their own, so that one more channel or excitation leaves the others as they were.
  const auto stream = [&](std::uint64_t i) { return signals::Noise(seed * 4096 + i); };

  signals::Record record;
  record.file = sid_case.file.path.string() + " (truth)";
  const auto add = [&](const std::string& header, std::vector<double> values) {
    record.columns.push_back(io::column_of_header(header));
    record.columns.back().values = std::move(values);
  };

  // Excitations in SI, summed by where they act.
  std::vector<std::pair<std::pair<Role, int>, std::vector<double>>> acting;
  const Json& list = sid_case.file.json["truth"]["excitation"];
  for (std::size_t i = 0; i < list.size(); ++i) {
    signals::Noise noise = stream(i);
    const std::vector<double> x = make_excitation(sid_case, i, noise);
    const Role role = !list[i].contains("base")                         ? Role::force
                      : list[i].value("quantity", "") == "displacement" ? Role::base_displacement
                                                                        : Role::base_acceleration;
    const std::pair<Role, int> target{role, list[i].value("mass", 0)};
    auto same = std::ranges::find(acting, target, [](const auto& entry) { return entry.first; });
    if (same == acting.end()) {
      acting.emplace_back(target, x);
    } else {
      for (std::size_t n = 0; n < samples; ++n) same->second[n] += x[n];
    }
  }
  dynamics::Excitation excitation{.sample_rate_hz = truth.sample_rate_hz};
  for (const auto& [target, x] : acting) {
    if (target.first == Role::force) {
      excitation.forces.push_back({target.second, {.samples = x}});
      continue;
    }
    if (!excitation.base) excitation.base.emplace();
    (target.first == Role::base_acceleration ? excitation.base->acceleration
                                             : excitation.base->displacement)
        .samples = x;
  }
  if (excitation.forces.empty() && !excitation.base) {
    excitation.forces.push_back({1, {.samples = std::vector<double>(samples)}});
  }

  const SidModel& model = sid_case.models[static_cast<std::size_t>(truth.model)];
  dynamics::SimulatorOptions options = sid_case.integration;
  options.stride = 1;
  options.step_limit = std::min(options.step_limit, kTruthStepLimit);
  dynamics::Response response;
  try {
    // The extension that nonlinear laws see is known only afterwards; twice is enough.
    for (int pass = 0; pass < 2; ++pass) {
      const dynamics::Simulator simulator(model.chain, excitation, sid_case.sensors(),
                                          model.initial, options);
      response = simulator.simulate(truth.theta);
      if (response.failed) break;
      std::vector<dynamics::Sensor> all;
      for (int i = 1; i <= model.chain.size(); ++i) {
        all.push_back({.mass = i, .frame = dynamics::Frame::relative});
      }
      const auto motion = dynamics::Simulator(model.chain, excitation, all, model.initial, options)
                              .simulate(truth.theta);
      if (motion.failed) break;
      options.extension.clear();
      for (const dynamics::Link& link : model.chain.links) {
        Eigen::VectorXd e = Eigen::VectorXd::Zero(motion.values.rows());
        if (link.b > 0) e += motion.values.col(link.b - 1);
        if (link.a > 0) e -= motion.values.col(link.a - 1);
        options.extension.push_back(e.cwiseAbs().maxCoeff());
      }
    }
  } catch (const std::invalid_argument& error) {
    sid_case.file.refuse(Pointer("/truth"), error.what());
  }
  if (response.failed) {
    sid_case.file.refuse(Pointer("/truth"),
                         "the true model's response grows without bound, or its parameters are "
                         "impossible (a mass <= 0, a gap < 0)");
  }

  std::vector<double> time(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    time[n] = static_cast<double>(n) / truth.sample_rate_hz;
  }
  const SidChannel* clock = nullptr;
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role == Role::time) clock = &channel;
  }
  if (clock != nullptr) {
    for (double& t : time) t /= clock->signal.scale.value;
  }
  const auto numbered = [](const std::string& column) {
    return column.find_first_not_of("0123456789") == std::string::npos;
  };
  add(clock != nullptr && !numbered(clock->column) ? clock->column : "time [s]", time);
  std::uint64_t responses = 0;
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role == Role::time) continue;
    std::vector<double> values(samples, 0.0);
    if (channel.is_excitation()) {
      for (const auto& [target, x] : acting) {
        if (target.first == channel.role && target.second == channel.mass) values = x;
      }
    } else if (channel.role == Role::response) {
      signals::Noise noise = stream(2048 + responses);
      const double sd = truth.noise[responses];
      for (std::size_t n = 0; n < samples; ++n) {
        values[n] =
            response.values(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(responses)) +
            sd * noise.normal();
      }
      ++responses;
    }
    const double scale = channel.signal.scale.at(truth.theta);
    const double offset = channel.signal.offset.at(truth.theta);
    for (double& x : values) x = (x - offset) / scale;
    add(numbered(channel.column) ? "column " + channel.column : channel.column, std::move(values));
  }
  return record;
}

std::string record_csv(const signals::Record& record, const std::string& comment) {
  std::string text = "# " + comment + "\n";
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    text += (c > 0 ? "," : "") + record.columns[c].header;
  }
  text += '\n';
  char cell[40];
  for (std::size_t n = 0; n < record.columns[0].values.size(); ++n) {
    for (std::size_t c = 0; c < record.columns.size(); ++c) {
      std::snprintf(cell, sizeof cell, "%s%.10g", c > 0 ? "," : "", record.columns[c].values[n]);
      text += cell;
    }
    text += '\n';
  }
  return text;
}

}  // namespace wheeltap::apps
