#include "identification/modal/modal_record.hpp"

#include <cmath>

#include "signals/modal/free_decay.hpp"
#include "signals/modal/frequency_domain_decomposition.hpp"
#include "signals/modal/polyreference.hpp"
#include "signals/modal/shape_quantities.hpp"

namespace wheeltap::identification {
namespace {

signals::ModalResult identify_by_method(const ModalRecord& r, std::uint64_t seed) {
  const signals::ModalOptions& options = r.options;
  if (r.responses)
    return signals::identify_modes(*r.responses, {.lowest_hz = options.lowest_hz,
                                                  .highest_hz = options.highest_hz,
                                                  .largest_order = options.largest_order,
                                                  .seed = seed,
                                                  .threads = options.threads});
  if (!r.bands.empty())
    return identify_bands(r.records, options.sample_rate_hz, r.bands,
                          {.seed = seed, .threads = options.threads});
  if (r.spectral)
    return signals::decompose_spectra(r.records,
                                      {.sample_rate_hz = options.sample_rate_hz,
                                       .lowest_hz = options.lowest_hz,
                                       .highest_hz = options.highest_hz,
                                       .segment = r.segment,
                                       .enhanced = r.spectral == signals::ModalMethod::enhanced,
                                       .blocks = options.blocks,
                                       .threads = options.threads});
  if (!r.decays.empty()) return signals::identify_decays(r.decays, options, seed);
  return signals::identify_modes(r.records, options);
}

}  // namespace

signals::ModalResult identify(const ModalRecord& record, std::uint64_t seed) {
  signals::ModalResult result = identify_by_method(record, seed);
  // If all channels measure one quantity, the conversion at most scales the shapes.
  signals::convert_shapes(result, record.orders);
  return result;
}

std::vector<signals::SpectralLevel> spectral_levels(const ModalRecord& record,
                                                    const signals::ModalResult& result) {
  std::vector<signals::SpectralLevel> out;
  const auto add = [&out](double frequency_hz, double size) {
    if (size > 0.0) out.push_back({frequency_hz, 10.0 * std::log10(size)});
  };
  if (result.singular_spectrum.rows() > 0) {
    for (const auto& line : result.singular_spectrum.rowwise()) add(line[0], line[1]);
    return out;
  }
  if (record.responses) {
    const auto band = record.responses->band(result.lowest_hz, result.highest_hz);
    for (Eigen::Index k = 0; k < band.lines(); ++k)
      add(band.frequencies_hz[k], band.h[static_cast<std::size_t>(k)].squaredNorm());
    return out;
  }
  return signals::spectral_levels(record.records, record.options.sample_rate_hz, result.lowest_hz,
                                  result.highest_hz);
}

}  // namespace wheeltap::identification
