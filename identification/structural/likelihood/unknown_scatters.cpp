#include "identification/structural/likelihood/unknown_scatters.hpp"

#include <algorithm>

namespace wheeltap::identification {

UnknownScatters::UnknownScatters(const ModalData& data)
    : known_{.discrepancy = data.discrepancy.value,
             .shape_discrepancy = data.shape_discrepancy.value,
             .mixing = data.mixing.value,
             .stiffness_discrepancy = data.stiffness_discrepancy.value} {
  const auto add = [this](const std::string& name, const std::optional<inference::Prior>& prior,
                          double ModalNoise::*place) {
    if (!prior) return;
    parameters_.push_back({name, *prior});
    places_.push_back(place);
  };
  const std::vector<std::string>& names = scatter_names();
  add(names[0], data.cov_prior, &ModalNoise::cov);
  add(names[1], data.shape_sd_prior, &ModalNoise::shape_sd);
  add(names[2], data.discrepancy.prior, &ModalNoise::discrepancy);
  add(names[3], data.shape_discrepancy.prior, &ModalNoise::shape_discrepancy);
  add(names[4], data.mixing.prior, &ModalNoise::mixing);
  add("stiffness_discrepancy", data.stiffness_discrepancy.prior,
      &ModalNoise::stiffness_discrepancy);
}

ModalNoise UnknownScatters::noise(std::span<const double> values) const {
  ModalNoise out = known_;
  for (std::size_t i = 0; i < places_.size(); ++i) out.*places_[i] = values[i];
  return out;
}

bool UnknownScatters::contains(double ModalNoise::*scatter) const {
  return std::ranges::find(places_, scatter) != places_.end();
}

const std::vector<std::string>& scatter_names() {
  static const std::vector<std::string> names = {"cov", "shape_sd", "discrepancy",
                                                 "shape_discrepancy", "mixing"};
  return names;
}

}  // namespace wheeltap::identification
