// Input that cannot be used, and where in it.
#pragma once

#include <stdexcept>
#include <string>

namespace wheeltap::identification {

/// What is asked for contradicts itself or lies outside what is possible. The door that parsed the
/// input (a case file, a caller's arguments) turns the place into one of its own.
class InvalidInput : public std::invalid_argument {
 public:
  enum class Part {
    beam,
    data,
    truth,
    emulator,
    location,  ///< prior of kind `index`
    severity,  ///< prior of kind `index`
    models,
    model,       ///< `index`
    channel,     ///< `index`
    excitation,  ///< `index` of the truth's
    sample_rate,
    samples,  ///< the window of the record
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
