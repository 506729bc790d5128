// Unit and quantity of the channels of a modal case.
#pragma once

#include <optional>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "signals/units.hpp"

namespace wheeltap::io {
struct Column;
}

namespace wheeltap::apps {

/// Unit, scale and quantity of a channel, as given in the case.
struct StatedUnit {
  Pointer where{};
  std::optional<std::string> unit = {};
  std::optional<double> scale = {};
  std::optional<signals::Dimension> quantity = {};
};

[[nodiscard]] StatedUnit parse_unit(const CaseFile& file, const Pointer& where);

/// True if `dimension` is a displacement, a velocity or an acceleration.
[[nodiscard]] bool is_motion(signals::Dimension dimension);

/// Name of a kinematic quantity in cases: "displacement", "velocity" or "acceleration".
[[nodiscard]] std::string quantity_name(signals::Dimension dimension);

/// Conversion of a column to SI units. Throws Failure for an unknown or a contradictory unit.
[[nodiscard]] signals::Conversion convert(const CaseFile& file, const io::Column& column,
                                          const StatedUnit& stated,
                                          std::optional<signals::Dimension> wanted);

}  // namespace wheeltap::apps
