#include "apps/cases/records/modal_poles.hpp"

namespace wheeltap::apps {

std::vector<signals::ChosenPole> chosen_poles(const CaseFile& file, bool several) {
  const Json& json = file.json;
  if (!json.contains("poles")) return {};
  if (json.value("method", "ssi-cov") != "ssi-cov")
    file.refuse(Pointer("/poles"), "is allowed with the method \"ssi-cov\" only");
  if (several && json.value("merge", "") != "preger")
    file.refuse(Pointer("/poles"),
                "needs one stabilisation diagram: give one record, or \"merge\": \"preger\"");
  std::vector<signals::ChosenPole> out;
  for (const Json& one : json.at("poles"))
    out.push_back(
        {.order = one.at("order").get<int>(), .frequency_hz = one.at("frequency").get<double>()});
  return out;
}

}  // namespace wheeltap::apps
