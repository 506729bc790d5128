#include "apps/modal_words.hpp"

#include <cmath>
#include <numbers>

#include "apps/words.hpp"

namespace wheeltap::apps {

using signals::ModeDoubt;

std::string with_sd(double x, double sd) {
  if (!(sd > 0.0) || !std::isfinite(sd)) return significant(x, 5);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(sd))));
  return fixed(x, decimals) + " ± " + fixed(sd, decimals);
}

std::vector<std::string> doubts_in_words(const signals::Mode& mode) {
  std::vector<std::string> out;
  for (const ModeDoubt doubt : mode.doubts) {
    switch (doubt) {
      case ModeDoubt::few_orders:
        out.push_back("in " + std::to_string(mode.present) + " of " + std::to_string(mode.orders) +
                      " orders only");
        break;
      case ModeDoubt::damping_unknown:
        out.emplace_back("its damping is hardly known");
        break;
      case ModeDoubt::complex_shape:
        out.emplace_back("its shape is no standing wave: noise, or two modes in one");
        break;
      case ModeDoubt::tone:
        out.emplace_back("a steady tone, as of a machine, rather than a mode");
        break;
      case ModeDoubt::twin:
        out.emplace_back("another one is as near as both are uncertain, with the same shape");
        break;
      case ModeDoubt::at_the_edge:
        out.emplace_back("at an end of the band, where a filter may bend it");
        break;
    }
  }
  return out;
}

std::vector<std::string> procedure_in_words(const signals::ModalResult& result) {
  std::vector<std::string> out;
  if (result.decimated > 1)
    out.push_back("Records were filtered and decimated by " + std::to_string(result.decimated) +
                  ", to " + significant(result.sample_rate_hz, 5) + " Hz.");
  out.push_back("Covariances over " + std::to_string(result.lags) + " lags (" +
                significant(result.lags / result.sample_rate_hz, 3) + " s), their scatter from " +
                std::to_string(result.blocks) + " blocks of " +
                significant(result.block_seconds, 3) + " s; orders up to " +
                std::to_string(result.largest_order) + ".");
  return out;
}

std::vector<std::string> warnings(const signals::ModalResult& result) {
  std::vector<std::string> out;
  if (result.modes.empty())
    out.emplace_back(
        "No mode was found in the band: no pole is stable over orders. Look at the spectra, widen "
        "the band, or record for longer.");
  if (result.remarks.short_blocks)
    out.push_back("The record is short: it gives " + std::to_string(result.blocks) + " blocks of " +
                  significant(result.block_seconds, 3) +
                  " s, and standard deviations themselves are known to about " +
                  significant(100.0 / std::sqrt(2.0 * (result.blocks - 1)), 2) + " %.");
  if (const int n = result.remarks.longer_decays; n > 0)
    out.push_back("Blocks of " + significant(result.block_seconds, 3) +
                  " s are shorter than the decay 1 / (ζω) of " + std::to_string(n) +
                  (n == 1 ? " mode" : " modes") +
                  ", whose standard deviations are rougher for it: a longer record would tell.");
  if (result.remarks.order_cut > 0)
    out.push_back("Orders stop at " + std::to_string(result.largest_order) + ", not at " +
                  std::to_string(result.remarks.order_cut) +
                  ": the record is too short for the lags that more would need.");
  if (result.blocks <= 2 * static_cast<int>(result.modes.size()))
    out.push_back("There are " + std::to_string(result.blocks) + " blocks for " +
                  std::to_string(2 * result.modes.size()) +
                  " frequencies and damping ratios: their joint covariance is singular; single "
                  "standard deviations hold.");
  if (result.references.size() == 1 && result.modes.size() > 1)
    out.emplace_back(
        "There is one reference: modes that hardly move it cannot be seen, and two modes of one "
        "frequency look like one.");
  return out;
}

}  // namespace wheeltap::apps
