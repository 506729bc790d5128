// The measured Duffing oscillator of ../shared/data/silverbox, simulated on a segment that was not
// used for the fit of its parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "dynamics/simulate.hpp"
#include "signals/record.hpp"
#include "signals/spectra.hpp"

namespace {

using namespace wheeltap::dynamics;
using namespace wheeltap::signals;

/// Root mean square of the residual over that of the output. `stiffness` is in input volts per
/// output volt.
double simulation_error(const Record& record, int factor, double stiffness) {
  const int begin = 20000, end = 26000, lead_in = 400;
  const double f0 = 68.331, zeta = 0.0488, k3 = 3.935,
               k2 = -0.0355;  // least squares on [1000, 5096)
  const double omega = 2.0 * std::numbers::pi * f0;
  const Chain chain{.masses = {stiffness / (omega * omega)},
                    .links = {{.stiffness = stiffness,
                               .damping = 2.0 * zeta * stiffness / omega,
                               .laws = {make_law<laws::Quadratic>({k2 * stiffness}),
                                        make_law<laws::Cubic>({k3 * stiffness})}}}};
  const std::vector<double> input =
      upsample(record.columns[1].values, begin - lead_in, end, factor);
  const std::vector<double> output = window(record, 2, begin - lead_in, end);
  const Misfit misfit(Simulator(chain,
                                {.sample_rate_hz = 610.35 * factor,
                                 .forces = {{.mass = 1, .signal = {input, 1.0, -0.00543}}}},
                                {{.mass = 1}}, {}, {.substeps = 8 / factor, .stride = factor}),
                      {{output}}, lead_in);
  double sum = 0.0, power = 0.0;
  misfit.sums_of_squares({}, 1, {&sum, 1});
  for (int n = lead_in; n < end - begin + lead_in; ++n)
    power += output[static_cast<std::size_t>(n)] * output[static_cast<std::size_t>(n)];
  return std::sqrt(sum / power);
}

TEST(Silverbox, BandLimitedExcitationExplainsWhatLinearInterpolationCannot) {
  const std::filesystem::path file =
      std::filesystem::path(WHEELTAP_SHARED_DIR) / "data/silverbox/snls80mv_multisine_train.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Record record = read_record(file);
  const double banded = simulation_error(record, 4, 0.9883);
  const double linear = simulation_error(record, 1, 0.9525);
  RecordProperty("nrmse_band_limited", std::to_string(banded));
  RecordProperty("nrmse_linear", std::to_string(linear));
  EXPECT_LT(banded, 0.01);
  EXPECT_GT(linear, 2.0 * banded);
  // Predicted from the spectrum: the loss of the input's amplitude by interpolation between
  // samples.
  const Spectrum spectrum = welch(record.columns[1].values, 610.35, {.segment = 4096});
  EXPECT_GT(linear_interpolation_loss(spectrum, 610.35), 0.05);
}

}  // namespace
