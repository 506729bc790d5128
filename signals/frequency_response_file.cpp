#include "signals/frequency_response_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "io/file_error.hpp"
#include "io/universal/universal_file.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;

constexpr int kFrequencyResponse = 4;

std::size_t place_of(const io::UniversalDof& dof, std::vector<io::UniversalDof>& list) {
  const auto same = [&](const io::UniversalDof& other) {
    return other.entity == dof.entity && other.node == dof.node && other.direction == dof.direction;
  };
  const auto found = std::ranges::find_if(list, same);
  const auto place = static_cast<std::size_t>(found - list.begin());
  if (found == list.end()) list.push_back(dof);
  return place;
}

/// Returns the conversion of the numerator of a function, by the unit or the quantity of the
/// numerator.
Conversion numerator_conversion(const io::UniversalFunction& f) {
  std::optional<Dimension> wanted;
  if (f.numerator.quantity == 8) wanted = Dimension::length;
  if (f.numerator.quantity == 11) wanted = Dimension::velocity;
  if (f.numerator.quantity == 12) wanted = Dimension::acceleration;
  Conversion out = conversion_of(f.numerator.unit, {});
  // The unit may be that of the numerator alone ("g") or a quotient ("(m/s^2)/N").
  if (out.basis == Conversion::Basis::foreign) out = {.unit = out.unit};
  if (!out.dimension) out.dimension = wanted;
  return out;
}

}  // namespace

MeasuredResponses read_frequency_responses(const std::filesystem::path& path) {
  const io::UniversalFile file = io::read_universal_file(path);
  const auto refuse = [&](const std::string& what) {
    throw io::FileError(io::FileError::Kind::corrupt, path, what);
  };
  std::vector<io::UniversalDof> outputs, inputs;
  std::map<std::pair<std::size_t, std::size_t>, const io::UniversalFunction*> found;
  const io::UniversalFunction* first = nullptr;
  for (const io::UniversalFunction& f : file.functions) {
    if (f.type != kFrequencyResponse || !f.is_complex) continue;
    if (first == nullptr) first = &f;
    const auto which = std::pair{place_of(f.response, outputs), place_of(f.reference, inputs)};
    if (f.y.size() != first->y.size() || f.even != first->even || f.first != first->first ||
        f.step != first->step || f.x != first->x)
      refuse("the frequency responses of " + io::dof_in_words(f.response) + " and " +
             io::dof_in_words(first->response) + " have different spectral lines");
    if (!found.emplace(which, &f).second)
      refuse("two frequency responses of " + io::dof_in_words(f.response) + " to " +
             io::dof_in_words(f.reference) + ": delete one of them");
  }
  if (first == nullptr) refuse("holds no frequency response (dataset 58 of function type 4)");
  for (std::size_t o = 0; o < outputs.size(); ++o)
    for (std::size_t j = 0; j < inputs.size(); ++j)
      if (!found.contains({o, j}))
        refuse("lacks the frequency response of " + io::dof_in_words(outputs[o]) + " to " +
               io::dof_in_words(inputs[j]) + ": every output needs a response to every reference");
  MeasuredResponses out;
  out.transposed = inputs.size() > outputs.size();
  const auto lines = static_cast<Index>(first->y.size());
  out.responses.frequencies_hz.resize(lines);
  for (Index k = 0; k < lines; ++k)
    out.responses.frequencies_hz[k] = first->even
                                          ? first->first + first->step * static_cast<double>(k)
                                          : first->x[static_cast<std::size_t>(k)];
  const auto rows = static_cast<Index>(outputs.size()), columns = static_cast<Index>(inputs.size());
  out.responses.h.assign(static_cast<std::size_t>(lines), Eigen::MatrixXcd(rows, columns));
  bool any = false, all = true, dimensions = true;
  for (const auto& [which, f] : found) {
    const Conversion c = numerator_conversion(*f);
    const bool known = c.basis == Conversion::Basis::unit;
    any = any || known;
    all = all && known;
    dimensions = dimensions && c.dimension.has_value();
  }
  if (any && !all)
    refuse(
        "the units of some outputs are known, but other outputs have no known unit: "
        "the entries of a mode shape cannot be compared");
  for (const auto& [which, f] : found) {
    const Conversion conversion = numerator_conversion(*f);
    for (Index k = 0; k < lines; ++k)
      out.responses.h[static_cast<std::size_t>(k)](static_cast<Index>(which.first),
                                                   static_cast<Index>(which.second)) =
          conversion.factor * f->y[static_cast<std::size_t>(k)];
    if (which.second != 0 || out.transposed) continue;
    // The map is in the order of the outputs, so the conversions are, too.
    out.conversions.push_back(conversion);
    if (dimensions) out.orders.push_back(derivative_order(*conversion.dimension));
  }
  if (out.transposed) {
    for (Eigen::MatrixXcd& h : out.responses.h) h = h.transpose().eval();
    std::swap(outputs, inputs);
  }
  out.outputs = std::move(outputs);
  out.inputs = std::move(inputs);
  return out;
}

}  // namespace wheeltap::signals
