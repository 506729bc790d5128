#include "identification/defect_kind.hpp"

#include "identification/defects/crack.hpp"
#include "identification/defects/joint.hpp"
#include "identification/defects/mass.hpp"
#include "identification/defects/reduction.hpp"
#include "identification/defects/storey.hpp"
#include "identification/defects/substructure.hpp"
#include "identification/defects/support.hpp"

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
