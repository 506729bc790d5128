#include "apps/cases/records/modal_units.hpp"

#include "io/tables/columns.hpp"

namespace wheeltap::apps {

StatedUnit parse_unit(const CaseFile& file, const Pointer& where) {
  const Json& c = file.json.at(where);
  StatedUnit out{.where = where};
  if (c.contains("unit")) {
    if (c.contains("scale"))
      file.refuse(where / "unit", "is not allowed with \"scale\", which defines the conversion");
    out.unit = c.at("unit").get<std::string>();
  }
  if (c.contains("scale")) out.scale = c.at("scale").get<double>();
  const std::string quantity = c.value("quantity", "");
  if (quantity == "displacement") out.quantity = signals::Dimension::length;
  if (quantity == "velocity") out.quantity = signals::Dimension::velocity;
  if (quantity == "acceleration") out.quantity = signals::Dimension::acceleration;
  return out;
}

bool is_motion(signals::Dimension dimension) {
  using signals::Dimension;
  return dimension == Dimension::length || dimension == Dimension::velocity ||
         dimension == Dimension::acceleration;
}

std::string quantity_name(signals::Dimension dimension) {
  return dimension == signals::Dimension::length     ? "displacement"
         : dimension == signals::Dimension::velocity ? "velocity"
                                                     : "acceleration";
}

signals::Conversion convert(const CaseFile& file, const io::Column& column,
                            const StatedUnit& stated, std::optional<signals::Dimension> wanted) {
  using Basis = signals::Conversion::Basis;
  const std::string unit = stated.unit ? *stated.unit : signals::unit_of(column);
  if (stated.scale) {
    signals::Conversion out = signals::conversion_of(unit, {});
    out.basis = Basis::stated_scale;
    out.factor = *stated.scale;
    if (wanted) out.dimension = wanted;
    return out;
  }
  signals::Conversion out = signals::conversion_of(unit, wanted);
  const std::optional<signals::Unit> known = signals::find_unit(unit);
  if (out.basis == Basis::foreign && wanted && known) {
    const std::string what = unit + ", " + std::string(signals::name(known->dimension)) + ", but " +
                             std::string(signals::name(*wanted)) + " is expected";
    if (stated.quantity || stated.unit)
      file.refuse(stated.where / (stated.unit ? "unit" : "quantity"),
                  "is in " + what + ": correct \"" + (stated.quantity ? "quantity" : "unit") +
                      "\", or give \"scale\"");
    file.refuse(stated.where / "unit", "is missing: the file states " + what +
                                           ". State \"unit\": \"" +
                                           std::string(signals::si_unit(*wanted)) +
                                           "\" if the file is wrong, or correct \"role\"");
  }
  if (stated.unit && !known && unit != "1")
    file.refuse(stated.where / "unit",
                "is unknown: give \"scale\" instead, or one of " +
                    (wanted ? signals::known_units(*wanted)
                            : signals::known_units(signals::Dimension::acceleration) + ", " +
                                  signals::known_units(signals::Dimension::velocity) + ", " +
                                  signals::known_units(signals::Dimension::length)));
  return out;
}

}  // namespace wheeltap::apps
