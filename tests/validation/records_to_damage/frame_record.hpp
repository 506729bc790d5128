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
/// with complex normal F at the lines of a period twice as long, of which half is taken, so that
/// the record is a piece of a stationary process and not its own period. Nothing is above half the
/// sampling rate: an ideal anti-alias filter. `noise` of each channel's standard deviation is white
/// and the sensor's own.
[[nodiscard]] Eigen::MatrixXd accelerations(const FrameCase::State& state, double damping,
                                            double noise, std::uint64_t seed);

/// A column a channel, headed a1, a2, … [m/s^2].
void write_csv(const std::filesystem::path& path, const Eigen::MatrixXd& channels);

}  // namespace wheeltap::coverage
