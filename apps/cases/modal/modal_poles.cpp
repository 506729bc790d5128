#include "apps/cases/modal/modal_poles.hpp"

namespace wheeltap::apps {

void take_poles(const ModalCaseFile& modal, SetUp& set_up) {
  const Json& json = modal.file.json;
  if (!json.contains("poles")) return;
  if (json.value("method", "ssi-cov") != "ssi-cov")
    modal.file.refuse(Pointer("/poles"), "is allowed with the method \"ssi-cov\" only");
  if (modal.set_ups.size() > 1 && json.value("merge", "") != "preger")
    modal.file.refuse(Pointer("/poles"),
                      "needs one stabilisation diagram: give one record, or \"merge\": \"preger\"");
  for (const Json& one : json.at("poles"))
    set_up.options.poles.push_back(
        {.order = one.at("order").get<int>(), .frequency_hz = one.at("frequency").get<double>()});
}

}  // namespace wheeltap::apps
