// Ten minutes of accelerations of a frame.
#pragma once

#include <cstdint>
#include <filesystem>

#include "frame_case.hpp"

namespace wheeltap::coverage {

/// Accelerations at the sensors under independent white forces there, sensors × kSamples:
///
///   A(ω) = -ω² Σ φ φᵀ / (ω_j² - ω² + 2 i ζ ω_j ω) F(ω),
///
/// with complex normal F at the lines of a period twice as long. The record is half of this period:
/// a part of a stationary process that is not periodic itself. An ideal anti-alias filter removes
/// all content above half the sampling rate. Each sensor adds independent white noise with `noise`
/// times the channel's standard deviation.
[[nodiscard]] Eigen::MatrixXd accelerations(const FrameCase::State& state, double damping,
                                            double noise, std::uint64_t seed);

/// Writes one column per channel, with the names a1, a2, … [m/s^2].
void write_csv(const std::filesystem::path& path, const Eigen::MatrixXd& channels);

}  // namespace wheeltap::coverage
