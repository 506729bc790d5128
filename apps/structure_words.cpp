#include "apps/structure_words.hpp"

#include <algorithm>
#include <iostream>

#include "apps/words.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

std::string sentence(const remark::ImplausibleMaterial& r) {
  using Property = remark::ImplausibleMaterial::Property;
  if (r.property == Property::speed_of_sound)
    return "The material of " + r.of + " has a speed of sound (root of young over density) of " +
           significant(r.value, 3) + " m/s: no material has more than " +
           significant(r.highest, 3) + " m/s. Check that young is in Pa and density in kg/m³.";
  const bool young = r.property == Property::young;
  const std::string unit = young ? " Pa" : " kg/m³";
  std::string text = std::string(young ? "Young's modulus" : "The density") + " of " + r.of +
                     " is " + significant(r.value, 4) + unit + ": expected " +
                     significant(r.lowest, 3) + " to " + significant(r.highest, 3) + unit +
                     (young ? " (steel 2.1e11, aluminium 7e10, concrete 3e10, wood 1e10)."
                            : " (steel 7850, aluminium 2700, concrete 2400, wood 500).");
  if (!r.unit.empty())
    text += " If " + significant(r.value, 4) + " is in " + r.unit + ", write " +
            significant(r.converted, 4) + ".";
  return text;
}

std::string sentence(const remark::DeepSection& r) {
  return "The section of " + r.of + " is " + significant(r.height, 3) +
         " m deep (as a rectangle of its area and second moment), but " + r.of + " is " +
         significant(r.length, 3) + " m long. Check that all lengths are in m.";
}

std::string sentence(const remark::TwinMembers& r) {
  return "Members \"" + r.first + "\" and \"" + r.second + "\" join the same nodes, " + r.from +
         " and " + r.to +
         ": Wheeltap adds their stiffnesses and masses. If only one is real, delete the other.";
}

std::string sentence(const remark::UnusedNodes& r) {
  constexpr std::size_t kNamed = 8;
  return (r.nodes.size() == 1 ? "Node " : "Nodes ") + in_words(shortened(r.nodes, kNamed)) +
         (r.nodes.size() == 1 ? " belongs" : " belong") +
         " to no member and no spring, so the structure does not move there. Connect or delete " +
         (r.nodes.size() == 1 ? "it." : "them.");
}

std::string sentence(const remark::CrossingMembers& r) {
  std::string text;
  for (const auto& pair : r.pairs) {
    text += text.empty() ? "" : "; ";
    text += "\"" + pair.first + "\" and \"" + pair.second + "\" " +
            (pair.between ? "meet at (" : "end at different nodes with the same location, at (") +
            significant(pair.at[0], 4) + ", " + significant(pair.at[1], 4) +
            (r.dimension == 3 ? ", " + significant(pair.at[2], 4) : std::string()) + ")";
  }
  const int more = r.count - static_cast<int>(r.pairs.size());
  if (more > 0) text += "; and " + std::to_string(more) + " more";
  return "Members meet without a common node, so the model does not join them: " + text +
         ". If the real members are joined, let both end at a common node.";
}

std::string sentence(const remark::SensorsAtOnePlace& r) {
  std::vector<std::string> list;
  for (const auto& pair : r.pairs)
    list.push_back(std::to_string(pair.first) + " and " + std::to_string(pair.second) + " (" +
                   pair.name + ")");
  return "Sensors measure at the same location in the same direction: " + in_words(list) +
         ". Is a node or a direction wrong? Two sensors at the same location in the same direction "
         "count one motion twice.";
}

void warn_of(const std::vector<Remark>& remarks) {
  for (const Remark& remark : remarks)
    std::cerr << "warning: " << io::printable(sentence(remark, Context{})) << '\n';
}

}  // namespace wheeltap::apps
