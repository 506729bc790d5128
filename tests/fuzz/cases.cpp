// Any bytes are a case of some kind, or a Failure with a code for bad input.
#include "apps/cases/damage_case.hpp"
#include "apps/cases/modal_case.hpp"
#include "apps/cases/sid_case.hpp"
#include "apps/cases/update_case.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wheeltap;
  const fuzz::InFile in(fuzz::text_of(data, size), ".json");
  const auto try_as = [&](auto&& parse) {
    try {
      parse(apps::read_case(in.path()));
    } catch (const apps::Failure& failure) {
      if (failure.exit() != apps::Exit::bad_input && failure.exit() != apps::Exit::no_input) throw;
    }
  };
  try_as([](apps::CaseFile file) {
    (void)apps::parse_damage_case(std::move(file), apps::Needs::structure);
  });
  try_as([](apps::CaseFile file) {
    (void)apps::parse_sid_case(std::move(file), apps::SidNeeds::truth);
  });
  try_as([](apps::CaseFile file) { (void)apps::parse_update_case(std::move(file)); });
  try_as([](apps::CaseFile file) { (void)apps::parse_modal_case(std::move(file)); });
  return 0;
}
