#include "frame_record.hpp"

#include <cmath>
#include <complex>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "base/random.hpp"

namespace wheeltap::coverage {

Eigen::MatrixXd accelerations(const FrameCase::State& state, double damping, double noise,
                              std::uint64_t seed) {
  using Complex = std::complex<double>;
  const Eigen::Index sensors = state.shapes.rows();
  constexpr Eigen::Index kPeriod = 2 * kSamples;
  base::Random random(seed, 0, 1, base::Purpose::test);
  Eigen::MatrixXcd lines = Eigen::MatrixXcd::Zero(kPeriod / 2 + 1, sensors);
  const Eigen::ArrayXd natural = 2.0 * std::numbers::pi * state.frequencies_hz.array();
  Eigen::VectorXcd force(sensors);
  for (Eigen::Index k = 1; k < kPeriod / 2; ++k) {
    const double omega = 2.0 * std::numbers::pi * kSampleRate * static_cast<double>(k) /
                         static_cast<double>(kPeriod);
    for (Complex& f : force) f = {random.normal(), random.normal()};
    const Eigen::VectorXcd modal =
        (state.shapes.transpose() * force).array() * (-omega * omega) /
        (natural.square() - omega * omega + Complex(0.0, 2.0 * damping * omega) * natural);
    lines.row(k) = (state.shapes * modal).transpose();
  }
  Eigen::MatrixXd out(sensors, kSamples);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  for (Eigen::Index s = 0; s < sensors; ++s) {
    const std::vector<Complex> half(lines.col(s).begin(), lines.col(s).end());
    std::vector<double> x;
    fft.inv(x, half, kPeriod);
    const Eigen::Map<const Eigen::VectorXd> all(x.data(), kPeriod);
    const double sd = std::sqrt(all.squaredNorm() / kPeriod);
    for (Eigen::Index i = 0; i < kSamples; ++i) out(s, i) = all[i] / sd + noise * random.normal();
    out.row(s) *= sd;
  }
  // Scale to a largest RMS of 0.1 m/s², as by wind and traffic.
  out *= 0.1 * std::sqrt(kSamples) / out.rowwise().norm().maxCoeff();
  return out;
}

void write_csv(const std::filesystem::path& path, const Eigen::MatrixXd& channels) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"),
                                                             &std::fclose);
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  for (Eigen::Index s = 0; s < channels.rows(); ++s)
    std::fprintf(file.get(), "%sa%d [m/s^2]", s > 0 ? "," : "", static_cast<int>(s) + 1);
  for (Eigen::Index i = 0; i < channels.cols(); ++i)
    for (Eigen::Index s = 0; s < channels.rows(); ++s)
      std::fprintf(file.get(), "%s%.6g", s > 0 ? "," : "\n", channels(s, i));
  std::fprintf(file.get(), "\n");
}

}  // namespace wheeltap::coverage
