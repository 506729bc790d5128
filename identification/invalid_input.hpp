// Exception for invalid input, with the location of the fault in the input.
#pragma once

#include <stdexcept>
#include <string>

namespace wheeltap::identification {

/// Thrown for contradictory input and for values out of range. The caller that parsed the input (a
/// case file, function arguments) converts `part` to a location in this input, for example a JSON
/// path.
class InvalidInput : public std::invalid_argument {
 public:
  enum class Part {
    beam,
    data,
    truth,
    emulator,
    location,  ///< prior of defect kind `index`
    severity,  ///< prior of defect kind `index`
    models,
    model,       ///< `index`
    channel,     ///< `index`
    excitation,  ///< excitation `index` of the truth
    sample_rate,
    samples,  ///< window of the record
    lead_in,
    initial
  };
  InvalidInput(Part part, const std::string& message, int index = 0)
      : std::invalid_argument(message), part_(part), index_(index) {}
  [[nodiscard]] Part part() const { return part_; }
  [[nodiscard]] int index() const { return index_; }

 private:
  Part part_;
  int index_;
};

}  // namespace wheeltap::identification
