#include "identification/structural/defects/defect_kind.hpp"

#include "identification/structural/defects/crack.hpp"
#include "identification/structural/defects/joint.hpp"
#include "identification/structural/defects/mass.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "identification/structural/defects/storey.hpp"
#include "identification/structural/defects/substructure.hpp"
#include "identification/structural/defects/support.hpp"

namespace wheeltap::identification {

const std::vector<const DefectType*>& defect_types() {
  static const std::vector<const DefectType*> list = {
      &defects::kReduction, &defects::kSupport, &defects::kCrack,        &defects::kJoint,
      &defects::kMass,      &defects::kStorey,  &defects::kSubstructure,
  };
  return list;
}

const DefectType* find_defect_type(std::string_view name) {
  for (const DefectType* type : defect_types()) {
    if (type->name == name) return type;
  }
  return nullptr;
}

}  // namespace wheeltap::identification
