// Measured modes of a structure: of one state, or of several states.
#pragma once

#include <memory>
#include <utility>
#include <variant>

#include "identification/structural/modal_data.hpp"
#include "identification/structural/observed_states.hpp"

namespace wheeltap::identification {

/// Measured modes of one state or of several states. For several states, the object also contains
/// the concatenation of their modes. Empty by default.
class MeasuredModes {
 public:
  MeasuredModes() = default;
  explicit MeasuredModes(ModalData data)
      : of_(std::make_shared<const ModalData>(std::move(data))) {}
  MeasuredModes(std::shared_ptr<const ObservedStates> states, ModalData joined)
      : of_(States{std::move(states), std::make_shared<const ModalData>(std::move(joined))}) {}

  /// The modes of all states, concatenated; null if there are no modes.
  [[nodiscard]] const ModalData* modal() const {
    if (const auto* several = std::get_if<States>(&of_)) return several->joined.get();
    const auto* one = std::get_if<std::shared_ptr<const ModalData>>(&of_);
    return one != nullptr ? one->get() : nullptr;
  }
  /// The states; null if the modes belong to one state.
  [[nodiscard]] std::shared_ptr<const ObservedStates> states() const {
    const auto* several = std::get_if<States>(&of_);
    return several != nullptr ? several->list : nullptr;
  }
  /// Replaces the modes of all states.
  void set_modal(ModalData data) {
    if (auto* several = std::get_if<States>(&of_))
      several->joined = std::make_shared<const ModalData>(std::move(data));
    else
      of_ = std::make_shared<const ModalData>(std::move(data));
  }

 private:
  struct States {
    std::shared_ptr<const ObservedStates> list;
    std::shared_ptr<const ModalData> joined;
  };
  std::variant<std::monostate, std::shared_ptr<const ModalData>, States> of_;
};

}  // namespace wheeltap::identification
