#include "signals/modal/polyreference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// H(ω) = (iω)^derivative Σ φ_o φ_j / (ω_r² - ω² + 2iζω_rω) at even lines.
FrequencyResponses responses(const VibratingStructure& s, const std::vector<int>& outputs,
                             const std::vector<int>& inputs, double first, double step, int lines,
                             int derivative) {
  const VibratingStructure::Modes modes = s.modes();
  FrequencyResponses out{.frequencies_hz = Eigen::VectorXd(lines)};
  for (int k = 0; k < lines; ++k) {
    const double f = first + step * k, omega = kTwoPi * f;
    out.frequencies_hz[k] = f;
    Eigen::MatrixXcd h = Eigen::MatrixXcd::Zero(static_cast<Index>(outputs.size()),
                                                static_cast<Index>(inputs.size()));
    for (Index r = 0; r < modes.frequencies_hz.size(); ++r) {
      const double own = kTwoPi * modes.frequencies_hz[r];
      const Complex of = std::pow(Complex(0.0, omega), derivative) /
                         Complex(own * own - omega * omega, 2.0 * s.damping_ratio * own * omega);
      for (std::size_t o = 0; o < outputs.size(); ++o)
        for (std::size_t j = 0; j < inputs.size(); ++j)
          h(static_cast<Index>(o), static_cast<Index>(j)) +=
              of * modes.shapes(outputs[o], r) * modes.shapes(inputs[j], r);
    }
    out.h.push_back(std::move(h));
  }
  return out;
}

const Pole* nearest(const std::vector<Pole>& poles, double frequency) {
  const Pole* best = nullptr;
  for (const Pole& p : poles)
    if (best == nullptr ||
        std::abs(p.frequency_hz - frequency) < std::abs(best->frequency_hz - frequency))
      best = &p;
  return best;
}

// Without noise every pole is found, for every measured quantity.
TEST(Polyreference, ExactResponsesGiveExactPoles) {
  const VibratingStructure s = chain(4, 1.0, 400.0);
  const VibratingStructure::Modes truth = s.modes();
  for (const int derivative : {0, 1, 2}) {
    const FrequencyResponses f = responses(s, {0, 1, 2, 3}, {0}, 0.2, 0.02, 350, derivative);
    const PolyreferenceFit fit = polyreference(f, 14);
    for (Index m = 0; m < 4; ++m) {
      const Pole* p = nearest(fit.poles, truth.frequencies_hz[m]);
      ASSERT_NE(p, nullptr);
      EXPECT_NEAR(p->frequency_hz / truth.frequencies_hz[m], 1.0, 1e-7) << derivative << " " << m;
      EXPECT_NEAR(p->damping, s.damping_ratio, 1e-7) << derivative << " " << m;
      EXPECT_GT(modal_assurance(p->shape, truth.shapes.col(m).cast<Complex>()), 1.0 - 1e-6);
    }
    double error = 0.0, size = 0.0;
    for (Index k = 0; k < f.lines(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      error = std::max(error, (fit.model.fitted[i] - f.h[i]).cwiseAbs().maxCoeff());
      size = std::max(size, f.h[i].cwiseAbs().maxCoeff());
    }
    EXPECT_LT(error, 1e-5 * size) << derivative;
  }
}

// Lines four half-power widths apart: no line hits a peak, but the model is found.
TEST(Polyreference, ResolvesModesBetweenLines) {
  VibratingStructure s = chain(3, 1.0, 400.0);
  s.damping_ratio = 5e-4;
  const VibratingStructure::Modes truth = s.modes();
  const ModalResult found = identify_modes(responses(s, {0, 1}, {0}, 0.1, 0.05, 140, 2), {});
  ASSERT_EQ(found.modes.size(), 3U);
  for (Index m = 0; m < 3; ++m) {
    const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
    EXPECT_NEAR(p.frequency_hz / truth.frequencies_hz[m], 1.0, 1e-5);
    EXPECT_NEAR(p.damping, 5e-4, 1e-5);
  }
  EXPECT_EQ(found.remarks.narrow, 3);
}

// Two modes at one frequency need two inputs.
TEST(Polyreference, SeparatesEqualFrequenciesWithTwoInputs) {
  VibratingStructure s;
  s.mass = Eigen::MatrixXd::Identity(2, 2);
  s.stiffness = 100.0 * Eigen::MatrixXd::Identity(2, 2);
  s.stiffness(1, 1) *= 1.0 + 1e-9;
  const FrequencyResponses f = responses(s, {0, 1}, {0, 1}, 0.5, 0.01, 250, 2);
  const double truth = 10.0 / kTwoPi;
  const std::vector<Pole> poles = polyreference(f, 6).poles;
  EXPECT_EQ(std::ranges::count_if(
                poles, [&](const Pole& p) { return std::abs(p.frequency_hz - truth) < 1e-5; }),
            2);
}

FrequencyResponses noisy(FrequencyResponses f, double level, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  double size = 0.0;
  for (const Eigen::MatrixXcd& h : f.h)
    size += h.squaredNorm() / static_cast<double>(h.size() * f.lines());
  for (Eigen::MatrixXcd& h : f.h)
    for (Complex& x : h.reshaped())
      x += level * std::sqrt(0.5 * size) * Complex(random.normal(), random.normal());
  return f;
}

// The errors of many realisations match the bootstrap.
TEST(Polyreference, CovarianceMatchesTheErrors) {
  const VibratingStructure s = chain(3, 1.0, 400.0);
  const VibratingStructure::Modes truth = s.modes();
  const FrequencyResponses exact = responses(s, {0, 1, 2}, {0}, 0.2, 0.02, 350, 2);
  constexpr int kRuns = 40;
  double f = 0.0, zeta = 0.0;
  int modes = 0;
  for (int run = 0; run < kRuns; ++run) {
    const ModalResult found = identify_modes(
        noisy(exact, 0.05, static_cast<std::uint64_t>(10 + run)), {.largest_order = 40});
    ASSERT_EQ(found.modes.size(), 3U) << run;
    for (Index m = 0; m < 3; ++m) {
      const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
      f += std::pow((p.frequency_hz - truth.frequencies_hz[m]) / p.frequency_sd, 2);
      zeta += std::pow((p.damping - s.damping_ratio) / p.damping_sd, 2);
      ++modes;
    }
  }
  // 120 squares of Student's variables with 49 degrees of freedom: mean 1.04, standard error .13.
  std::printf("  mean square errors over predicted: f %.2f, damping %.2f\n", f / modes,
              zeta / modes);
  EXPECT_NEAR(f / modes, 1.04, 0.5);
  EXPECT_NEAR(zeta / modes, 1.04, 0.5);
}

// From forces and accelerations in the time domain, by H₁.
TEST(Polyreference, FindsModesFromRecordsOfForceAndResponse) {
  const VibratingStructure s = chain(3, 1.0, 400.0);
  const VibratingStructure::Modes truth = s.modes();
  const VibratingStructure::Driven driven = s.driven(40000, 0.02, 5);
  const FrequencyResponses f =
      estimate_frequency_responses(driven.forces, driven.accelerations, 1.0 / s.step, 2048);
  EXPECT_GT(f.coherence.minCoeff(), 0.0);
  EXPECT_LE(f.coherence.maxCoeff(), 1.0 + 1e-12);
  const ModalResult found = identify_modes(f, {.lowest_hz = 0.3, .largest_order = 40});
  ASSERT_EQ(found.modes.size(), 3U);
  for (Index m = 0; m < 3; ++m) {
    const Pole& p = found.modes[static_cast<std::size_t>(m)].pole;
    EXPECT_NEAR(p.frequency_hz / truth.frequencies_hz[m], 1.0, 2e-3);
    EXPECT_NEAR(p.damping, 0.015, 0.002) << "Hann windows smear by 4 % here";
    EXPECT_GT(modal_assurance(p.shape, truth.shapes.col(m).cast<Complex>()), 0.999);
  }
}

TEST(Polyreference, RejectsMisuse) {
  const VibratingStructure s = chain(2, 1.0, 400.0);
  FrequencyResponses f = responses(s, {0}, {0}, 0.2, 0.02, 100, 2);
  EXPECT_THROW(polyreference(f, 0), std::invalid_argument);
  EXPECT_THROW(polyreference(f, 60), std::invalid_argument);
  EXPECT_THROW(identify_modes(f, {.lowest_hz = 1.0, .highest_hz = 1.05}), std::invalid_argument);
  f.h[3](0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(identify_modes(f, {}), std::invalid_argument);
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(1, 1000);
  EXPECT_THROW(estimate_frequency_responses(x, x.leftCols(900), 1.0, 64), std::invalid_argument);
  EXPECT_THROW(estimate_frequency_responses(x, x, 1.0, 900), std::invalid_argument);
  EXPECT_THROW(estimate_frequency_responses(0.0 * x, x, 1.0, 64), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals
