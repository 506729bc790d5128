#include "apps/cases/sid_case.hpp"

#include <algorithm>
#include <map>

#include "apps/cases/sid_record.hpp"
#include "apps/cases/sid_truth.hpp"
#include "apps/cases/syntax/case_remedies.hpp"
#include "apps/draw_columns.hpp"
#include "apps/law_words.hpp"
#include "apps/nearest.hpp"
#include "identification/sid/sid_discovery.hpp"
#include "identification/sid/sid_residuals.hpp"
#include "io/netcdf/netcdf_name.hpp"
#include "io/tables/columns.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;
namespace {

using Role = SidChannel::Role;

/// Runs work(); converts library errors to error messages about the case.
template <class Work>
auto explained_case(const CaseFile& file, const Pointer& where, const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
  }
}

class Parser {
 public:
  explicit Parser(SidCaseFile& parsed)
      : parsed_(parsed), out_(parsed.sid), file_(parsed.file), json_(parsed.file.json) {
    parse_parameters();
    parse_channels();
    if (json_.contains("integration")) parse_integration();
    for (std::size_t m = 0; m < json_["models"].size(); ++m) parse_model(Pointer("/models") / m);
    if (json_.contains("discover")) parse_discovery(Pointer("/discover"));
    check_channels();
    parse_truth(parsed_);
  }

  /// One entry per parameter: true if a model or a channel uses the parameter.
  [[nodiscard]] const std::vector<bool>& used() const { return used_; }

 private:
  // ---- parameters and coefficients

  void parse_parameters() {
    const Json priors = json_.value("parameters", Json::object());
    std::map<std::string, std::string> by_variable;
    for (const auto& [name, ignored] : priors.items()) {
      if (out_.number > 1) break;  // all records use the table of the first record
      const std::string variable = variable_of(name);
      if (const auto why = io::netcdf_name_error(variable)) {
        file_.refuse(Pointer("/parameters") / name, "a parameter's name " + *why);
      }
      if (const auto [other, fresh] = by_variable.emplace(variable, name); !fresh) {
        file_.refuse(Pointer("/parameters") / name,
                     "is too similar to the parameter \"" + other->second +
                         "\": the draws of both would have the name \"" + variable + "\"");
      }
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
    file_.refuse(where, unknown_parameter(name, names));
  }

  /// Parses a number or a parameter and checks its bounds.
  dynamics::Coefficient coefficient(const Pointer& where, const dynamics::LawCoefficient& bounds) {
    const Json& value = file_.json.at(where);
    if (value.is_number()) {
      const double x = value.get<double>();
      if (!bounds.allows(x)) file_.refuse(where, "must be " + bounds_in_words(bounds));
      return x;
    }
    if (!value.is_string()) file_.refuse(where, "must be a number, or the name of a parameter");
    return use(find_parameter(where), where, bounds);
  }

  /// Checks the prior of a parameter against the bounds of the coefficient at `where`.
  dynamics::Coefficient use(int p, const Pointer& where, const dynamics::LawCoefficient& bounds) {
    const inference::Prior& prior = out_.parameters[static_cast<std::size_t>(p)].prior;
    const auto refuse = [&](const std::string& reaches) {
      const Pointer of_prior =
          Pointer("/parameters") / out_.parameters[static_cast<std::size_t>(p)].name;
      file_.refuse(of_prior, reaches + ", but " + where.to_string() + " must be " +
                                 bounds_in_words(bounds) +
                                 kept_within(file_, of_prior, bounds.lower, bounds.upper));
    };
    if (prior.lower() < bounds.lower) refuse("reaches down to " + plain_number(prior.lower()));
    if (prior.upper() > bounds.upper) refuse("reaches up to " + plain_number(prior.upper()));
    used_[static_cast<std::size_t>(p)] = true;
    return dynamics::Coefficient::of_parameter(p);
  }
  dynamics::Coefficient coefficient(const Pointer& where) { return coefficient(where, {}); }
  dynamics::Coefficient positive(const Pointer& where) {
    return coefficient(where, {.name = {}, .unit = {}, .lower = 0.0, .above_lower = true});
  }

  dynamics::Coefficient added(const std::string& name, inference::Prior prior) {
    const dynamics::Coefficient found = out_.parameter(name, std::move(prior));
    used_.resize(out_.parameters.size(), true);
    return found;
  }

  // ---- channels

  void parse_channels() {
    const Pointer list("/record/channels");
    for (std::size_t i = 0; i < json_.at(list).size(); ++i) {
      const Pointer where = list / i;
      const Json& c = json_.at(where);
      static const std::vector<std::string> roles = {
          "time", "force", "base-acceleration", "base-displacement", "response", "ignore"};
      SidChannel channel{.column = text_or_number(c["column"]), .record = out_.number};
      channel.role =
          static_cast<Role>(std::ranges::find(roles, c["role"].get<std::string>()) - roles.begin());
      const bool on_mass = channel.role == Role::force || channel.role == Role::response;
      if (on_mass && !c.contains("mass")) {
        file_.refuse(where / "mass", "is missing: must be the number of a mass, from 1");
      }
      if (!on_mass && c.contains("mass")) {
        file_.refuse(where / "mass", "is allowed for the roles \"force\" and \"response\" only");
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
          if (c.contains(key))
            file_.refuse(where / key, "is allowed for the role \"response\" only");
        }
      }
      if (channel.role == Role::time || channel.role == Role::ignore) {
        for (const char* key : {"scale", "offset"}) {
          const bool of_time = channel.role == Role::time && std::string_view(key) == "scale";
          if (c.contains(key) && !of_time)
            file_.refuse(where / key, "is not allowed for this role");
        }
        if (c.contains("scale") && !(c["scale"].is_number() && c["scale"].get<double>() > 0.0)) {
          file_.refuse(where / "scale", "must be a positive number: the time unit in seconds");
        }
      }
      if (c.contains("scale")) {
        if (c["scale"].is_number() && c["scale"].get<double>() == 0.0) {
          file_.refuse(where / "scale", "must not be 0");
        }
        channel.signal.scale = coefficient(where / "scale");
        channel.scale_given = true;
      }
      if (c.contains("unit")) {
        if (channel.role == Role::time || channel.role == Role::ignore)
          file_.refuse(where / "unit", "is not allowed for this role");
        if (c.contains("scale"))
          file_.refuse(where / "unit",
                       "is not allowed with \"scale\", which defines the conversion");
        channel.unit = c["unit"].get<std::string>();
        channel.unit_given = true;
      }
      channel.take_unit(signals::unit_of(io::column_of_header(channel.column)));
      if (c.contains("offset")) channel.signal.offset = coefficient(where / "offset");
      if (channel.role == Role::time && out_.find(Role::time) != nullptr) {
        file_.refuse(where, "there is a time channel already");
      }
      if (channel.role == Role::base_acceleration && out_.find(channel.role) != nullptr) {
        file_.refuse(where, "there is a base acceleration already");
      }
      if (channel.role == Role::base_displacement && out_.find(channel.role) != nullptr) {
        file_.refuse(where, "there is a base displacement already");
      }
      out_.channels.push_back(std::move(channel));
      parsed_.channels.push_back(where);
    }
    if (out_.responses().empty()) {
      file_.refuse(list, "no channel has the role \"response\": there is nothing to identify");
    }
  }

  void parse_integration() {
    const Json& i = json_["integration"];
    out_.fixed_integration = true;
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
    // The schema has already checked this value by the rule of the force law (law_rule).
    const Json& value = json_.at(here);
    std::vector<dynamics::Coefficient> coefficients;
    auto side = dynamics::Side::opening;
    if (!value.is_object()) {
      coefficients.push_back(coefficient(here, info.coefficients[0]));
    } else {
      for (int i = 0; i < info.size(); ++i) {
        const dynamics::LawCoefficient& c = info.coefficients[static_cast<std::size_t>(i)];
        const std::string key(c.name);
        coefficients.push_back(value.contains(key) ? coefficient(here / key, c)
                                                   : dynamics::Coefficient(c.otherwise));
      }
      if (value.value("side", "") == "closing") side = dynamics::Side::closing;
    }
    return explained_case(file_, here,
                          [&] { return dynamics::make_law(info.name, coefficients, side); });
  }

  void parse_model(const Pointer& where) {
    const Json& m = json_.at(where);
    SidModel model{.name = m["name"].get<std::string>(), .weight = m.value("prior", 1.0)};
    for (const SidModel& other : out_.models) {
      if (other.name == model.name) file_.refuse(where / "name", "two models have this name");
    }
    for (std::size_t i = 0; i < m["masses"].size(); ++i) {
      model.chain.masses.push_back(positive(where / "masses" / i));
    }
    const int masses = model.chain.size();
    for (std::size_t l = 0; l < m["links"].size(); ++l) {
      const Pointer here = where / "links" / l;
      const Json& between = json_.at(here / "between");
      dynamics::Link link{.a = between[0].get<int>(), .b = between[1].get<int>()};
      for (std::size_t end = 0; end < 2; ++end) {
        if (between[end] > masses) {
          file_.refuse(here / "between" / end, "unknown mass; " + model.name + " has masses 1 to " +
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
    explained_case(file_, where / "links", [&] { dynamics::validate(model.chain); });

    const std::size_t responses = out_.responses().size();
    if (m["noise"].is_array()) {
      if (m["noise"].size() != responses) {
        file_.refuse(where / "noise",
                     "must have one value per response channel: " + std::to_string(responses));
      }
      for (std::size_t c = 0; c < responses; ++c) {
        model.noise.push_back(positive(where / "noise" / c));
      }
    } else {
      model.noise.assign(responses, positive(where / "noise"));
    }
    const Json residuals = m.value("residuals", json_.value("residuals", Json::object()));
    for (const ResidualKind* kind : residual_kinds()) {
      const Json value = residuals.value(std::string(kind->key), Json());
      if (value == "auto") model.residuals.chosen_kind = kind;
      if (value.is_number()) add_residuals(out_, model, kind->make(value.get<int>()));
    }
    used_.resize(out_.parameters.size(), true);
    parse_initial(model);
    out_.models.push_back(std::move(model));
  }

  // ---- candidate terms of a discovery

  /// Indices of the base model's links that have candidate terms; default: all links.
  std::vector<int> parse_discovered_links(const Pointer& where, const dynamics::Chain& chain) {
    std::vector<int> out;
    if (!json_.contains(where)) {
      for (std::size_t l = 0; l < chain.links.size(); ++l) out.push_back(static_cast<int>(l));
      return out;
    }
    for (std::size_t i = 0; i < json_.at(where).size(); ++i) {
      const Json& ends = json_.at(where / i);
      const auto found = std::ranges::find_if(chain.links, [&](const dynamics::Link& link) {
        return (ends[0] == link.a && ends[1] == link.b) || (ends[0] == link.b && ends[1] == link.a);
      });
      if (found == chain.links.end()) {
        file_.refuse(where / i, "the model has no link between these two masses");
      }
      const int at = static_cast<int>(found - chain.links.begin());
      if (std::ranges::count(out, at) > 0) file_.refuse(where / i, "this link is listed twice");
      out.push_back(at);
    }
    return out;
  }

  /// Parses "cubic", or {"contact": {"gap": 0.001, "side": "closing"}}. A coefficient that is not
  /// given becomes a parameter with the term's name and a prior from the case or the record.
  SidTerm parse_term(const Pointer& where, int index, bool several) {
    const dynamics::Link& link = out_.models.front().chain.links[static_cast<std::size_t>(index)];
    const Json& value = json_.at(where);
    const std::string name = value.is_string() ? value.get<std::string>() : value.begin().key();
    const auto infos = dynamics::law_infos();
    const auto info = std::ranges::find(infos, name, &dynamics::LawInfo::name);
    if (info == infos.end()) {
      std::vector<std::string> names;
      for (const auto& other : infos) names.emplace_back(other.name);
      file_.refuse(where, "no law has this name" + did_you_mean(name, names));
    }
    SidTerm term{.link = index, .law = {.kind = static_cast<int>(info - infos.begin())}};
    const Pointer given = where / name;
    const bool has_object = value.is_object() && value.begin()->is_object();
    if (has_object) {
      for (const auto& [key, ignored] : value.begin()->items()) {
        const auto same = [&](const dynamics::LawCoefficient& c) { return c.name == key; };
        if (key.empty() || (std::ranges::none_of(info->coefficients, same) &&
                            !(info->one_sided && key == "side"))) {
          file_.refuse(given / key, "unknown key of the term \"" + name + "\"");
        }
      }
      const std::string side = value.begin()->value("side", Json("opening")).dump();
      if (side != "\"opening\"" && side != "\"closing\"") {
        file_.refuse(given / "side", "must be \"opening\" or \"closing\"");
      }
      if (side == "\"closing\"") term.law.side = dynamics::Side::closing;
    }
    term.name = term_name(term.law, link, several);
    for (std::size_t c = 0; c < static_cast<std::size_t>(info->size()); ++c) {
      const dynamics::LawCoefficient& bounds = info->coefficients[c];
      const std::string key(bounds.name);
      if (has_object && value.begin()->contains(key)) {
        term.law.coefficients[c] = coefficient(given / key, bounds);
      } else if (c == 0 && value.is_object() && !has_object) {
        term.law.coefficients[c] = coefficient(given, bounds);
      } else if (!bounds.required()) {
        term.law.coefficients[c] = bounds.otherwise;
      } else {
        const std::string parameter = term_parameter(term.law, c, link, several);
        const auto same =
            std::ranges::find(out_.parameters, parameter, &inference::Parameter::name);
        if (same != out_.parameters.end()) {
          term.law.coefficients[c] =
              use(static_cast<int>(same - out_.parameters.begin()), where, bounds);
        } else {
          // The scale of this prior is set later, from the record.
          term.law.coefficients[c] = added(parameter, inference::Normal{0.0, 1.0});
          term.by_default.push_back(c);
        }
      }
    }
    const auto twin = [&](const dynamics::Law& law) {
      return law.kind == term.law.kind && law.side == term.law.side;
    };
    if (std::ranges::any_of(link.laws, twin)) {
      file_.refuse(where, "the link of the model already has this force law");
    }
    return term;
  }

  void parse_discovery(const Pointer& where) {
    if (out_.models.size() != 1) {
      file_.refuse(Pointer("/models"),
                   "must be one model, to which \"discover\" adds all subsets of its terms");
    }
    const auto links = parse_discovered_links(where / "links", out_.models.front().chain);
    const std::size_t terms = json_.at(where / "terms").size();
    if (terms * links.size() > kMostTerms) {
      file_.refuse(where / "terms",
                   std::to_string(terms) + " terms on " + std::to_string(links.size()) +
                       (links.size() == 1 ? " link" : " links") + " are " +
                       std::to_string(terms * links.size()) +
                       ", and every subset is a model: at most " + std::to_string(kMostTerms) +
                       " (" + std::to_string(1UL << kMostTerms) + " models)");
    }
    SidDiscovery asked{.inclusion = json_.at(where).value("inclusion", 0.5)};
    for (const int link : links) {
      for (std::size_t t = 0; t < terms; ++t) {
        SidTerm term = parse_term(where / "terms" / t, link, links.size() > 1);
        if (std::ranges::count(asked.terms, term.name, &SidTerm::name) > 0) {
          file_.refuse(where / "terms" / t, "this term is listed twice");
        }
        asked.terms.push_back(std::move(term));
      }
    }
    out_.discovery = std::move(asked);
    add_subsets(out_);
  }

  void parse_initial(SidModel& model) {
    const Pointer where("/record/initial");
    if (!json_.contains(where) || !json_.at(where).is_object()) return;
    const auto masses = static_cast<std::size_t>(model.chain.size());
    const auto values = [&](const char* key, std::vector<dynamics::Coefficient>& to) {
      if (!json_.contains(where / key)) return;
      if (json_.at(where / key).size() != masses) {
        file_.refuse(where / key, "must have one value per mass: " + std::to_string(masses));
      }
      for (std::size_t i = 0; i < masses; ++i) to.push_back(coefficient(where / key / i));
    };
    values("displacement", model.initial.displacement);
    values("velocity", model.initial.velocity);
  }

  void check_channels() {
    const bool base = out_.find(Role::base_acceleration) != nullptr ||
                      out_.find(Role::base_displacement) != nullptr || truth_moves_base(json_);
    for (std::size_t i = 0; i < out_.channels.size(); ++i) {
      const SidChannel& channel = out_.channels[i];
      const Pointer& where = parsed_.channels[i];
      for (const SidModel& model : out_.models) {
        if (channel.mass > model.chain.size()) {
          file_.refuse(where / "mass", "unknown mass; model \"" + model.name +
                                           "\" has masses 1 to " +
                                           std::to_string(model.chain.size()));
        }
      }
      if (channel.role == Role::response && base && channel.frame == dynamics::Frame::absolute &&
          channel.quantity != dynamics::Quantity::acceleration &&
          out_.find(Role::base_displacement) == nullptr && !truth_displaces_base(json_) &&
          !json_["record"].contains("file")) {
        file_.refuse(where, "an absolute " + json_.at(where / "quantity").get<std::string>() +
                                " of a base-driven chain needs a channel with the role "
                                "\"base-displacement\"; or write \"frame\": \"relative\"");
      }
    }
  }

  SidCaseFile& parsed_;
  SidCase& out_;
  const CaseFile& file_;
  const Json& json_;
  std::vector<bool> used_;
};

/// Checks that windows have more samples than any model has parameters.
void check_windows(const SidCaseFile& parsed) {
  if (parsed.sid.windows == 0) return;
  for (const SidCase* record : parsed.sid.records()) {
    const int length = (record->end - record->begin) / parsed.sid.windows;
    const auto samples = static_cast<std::size_t>(length) * record->responses().size();
    for (const SidModel& model : record->models) {
      const std::size_t parameters = record->parameters_of(model).size();
      if (samples > parameters) continue;
      parsed.file.refuse(Pointer("/windows"),
                         "gives windows of " + std::to_string(length) + " samples; model \"" +
                             model.name + "\" has " + std::to_string(parameters) +
                             " parameters, and a window must have more samples than parameters");
    }
  }
}

/// Parses the case of one record, at /record. If there are several records, `number` is the number
/// of the record, from 1, and `table` has the parameters of earlier records. `used` collects the
/// flags of used parameters.
SidCaseFile parse_one(CaseFile file, SidNeeds needs, std::vector<bool>& used, int number = 1,
                      std::vector<inference::Parameter> table = {}) {
  SidCaseFile out{.file = std::move(file), .notes = {}, .sid = {}, .channels = {}};
  out.sid.number = number;
  out.sid.parameters = std::move(table);
  const Json& json = out.file.json;
  SidCase& sid_case = out.sid;
  sid_case.title = json.value("title", io::printable(out.file.path.stem().string()));
  sid_case.band = json.value("band", sid_case.band);
  sid_case.balance = json.value("balance", false);
  if (json.contains("notes")) {
    if (json["notes"].is_string()) {
      out.notes = {json["notes"].get<std::string>()};
    } else {
      out.notes = json["notes"].get<std::vector<std::string>>();
    }
  }
  const Parser parser(out);
  used.resize(parser.used().size(), false);
  for (std::size_t p = 0; p < used.size(); ++p) used[p] = used[p] || parser.used()[p];
  const bool simulated = needs == SidNeeds::record && !json["record"].contains("file");
  if (sid_case.truth && (needs == SidNeeds::truth || simulated)) parse_excitations(out);
  if (needs == SidNeeds::record) load_record(out);
  // If there are several records, the scales of the priors follow from the first record.
  if (needs == SidNeeds::record && sid_case.discovery && number == 1) {
    explained_case(out.file, Pointer("/discover/terms"), [&] { set_term_priors(sid_case); });
  }
  sid_case.windows = json.value("windows", 0);
  sid_case.unite();
  return out;
}

/// Parses the case of the first record, with the other records in SidCase::further.
SidCaseFile parse_several(const CaseFile& file, SidNeeds needs, std::vector<bool>& used) {
  const Json& records = file.json["records"];
  SidCaseFile out;
  for (std::size_t i = 0; i < records.size(); ++i) {
    CaseFile one = file;
    one.json.erase("records");
    one.json["record"] = records[i];
    one.record_place = (Pointer("/records") / i).to_string();
    SidCaseFile part = parse_one(std::move(one), needs, used, static_cast<int>(i) + 1,
                                 i == 0 ? std::vector<inference::Parameter>{} : out.sid.parameters);
    if (i == 0) {
      out = std::move(part);
      continue;
    }
    out.sid.parameters = part.sid.parameters;
    if (double& bound = out.sid.integration.displacement_bound;
        needs == SidNeeds::record && out.sid.discovery)
      bound = std::max(bound, runaway_bound(part.sid));  // as the largest motion needs
    out.sid.further.push_back(std::move(part.sid));
  }
  out.sid.unite();
  out.file = file;
  out.file.record_place = "/records/0";
  return out;
}

}  // namespace

void SidCaseFile::refuse(const InvalidInput& error) const {
  using Part = InvalidInput::Part;
  const auto index = static_cast<std::size_t>(error.index());
  switch (error.part()) {
    case Part::models:
      file.refuse(Pointer("/models"), error.what());
    case Part::model:
      file.refuse(Pointer("/models") / index, error.what());
    case Part::truth:
      file.refuse(Pointer("/truth"), error.what());
    case Part::excitation:
      file.refuse(Pointer("/truth/excitation") / index, error.what());
    case Part::channel: {
      const Pointer column = channels[index] / "column";
      file.refuse(file.json.contains(column) ? column : channels[index], error.what());
    }
    case Part::sample_rate:
      file.refuse(Pointer("/record/sample_rate"), error.what());
    case Part::samples:
      file.refuse(Pointer("/record/samples"), error.what());
    case Part::lead_in:
      file.refuse(Pointer("/record/lead_in"), error.what());
    case Part::initial:
      file.refuse(Pointer("/record/initial"), error.what());
    default:
      file.refuse(Pointer(), error.what());
  }
}

SidCaseFile parse_sid_case(CaseFile file, SidNeeds needs) {
  validate_against_schema(file, "sid");
  const bool several = file.json.contains("records");
  if (several && file.json.contains("record")) {
    file.refuse(Pointer("/records"), "is not allowed with \"record\": give one of the two");
  }
  if (!several && !file.json.contains("record")) {
    file.refuse(Pointer("/record"),
                "is missing: must be an object with \"channels\" and a \"file\"; without a file, "
                "Wheeltap simulates the record from \"truth\"");
  }
  std::vector<bool> used;
  SidCaseFile out = several ? parse_several(file, needs, used) : parse_one(file, needs, used);
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (used[p]) continue;
    std::vector<std::string> names;
    for (std::size_t other = 0; other < used.size(); ++other)
      if (used[other]) names.push_back(out.sid.parameters[other].name);
    const std::string& name = out.sid.parameters[p].name;
    out.file.refuse(Pointer("/parameters") / name,
                    "this parameter is not used: write its name in place of a number of the "
                    "model, or remove the parameter (parameters in use: " +
                        listed(names) + ")");
  }
  if (needs == SidNeeds::record) check_windows(out);
  return out;
}

}  // namespace wheeltap::apps
