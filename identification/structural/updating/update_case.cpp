#include "identification/structural/updating/update_case.hpp"

#include "base/random.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;

TrueModes true_modes(const UpdateCase& update_case, std::span<const double> parameters, int modes) {
  const fem::Discretisation d = discretise(update_case.structure->at(parameters));
  const auto rigid = static_cast<int>(d.rigid_motions.cols());
  const fem::StructureModes found = fem::structure_modes(d, rigid + modes);
  TrueModes out{.frequencies_hz = {},
                .shapes = MatrixXd(static_cast<Index>(update_case.data.sensors.size()), modes)};
  for (Index i = 0; i < modes; ++i) {
    out.frequencies_hz.push_back(found.frequencies_hz[rigid + i]);
    for (Index s = 0; s < out.shapes.rows(); ++s)
      out.shapes(s, i) = update_case.data.sensors[static_cast<std::size_t>(s)].motion.of(
          found.shapes.col(rigid + i));
    if (out.shapes.rows() == 0) continue;
    const double largest = out.shapes.col(i).cwiseAbs().maxCoeff();
    if (largest > 0.0) out.shapes.col(i) /= largest;
  }
  return out;
}

void simulate(UpdateCase& update_case, std::uint64_t seed) {
  const ModalSimulation& truth = *update_case.simulation;
  const TrueModes modes = true_modes(update_case, truth.parameters, truth.modes);
  ModalData& data = update_case.data;
  base::Random random(seed, 0, 0, base::Purpose::simulation);
  data.frequencies_hz.clear();
  for (const double f : modes.frequencies_hz)
    data.frequencies_hz.push_back(f * (1.0 + truth.cov * random.normal()));
  if (!data.cov_prior && data.covariance.size() == 0) {
    data.covariance = MatrixXd::Zero(truth.modes, truth.modes);
    for (Index i = 0; i < truth.modes; ++i) {
      const double sd = truth.cov * data.frequencies_hz[static_cast<std::size_t>(i)];
      data.covariance(i, i) = sd * sd;
    }
  }
  if (truth.shape_sd > 0.0 && !data.sensors.empty()) {
    const Index sensors = modes.shapes.rows();
    data.shapes.resize(truth.modes, sensors);
    for (Index i = 0; i < truth.modes; ++i)
      for (Index s = 0; s < sensors; ++s)
        data.shapes(i, s) = modes.shapes(s, i) + truth.shape_sd * random.normal();
    if (data.shape_covariances.empty()) {
      const double sd = data.shape_sd_prior ? 1.0 : truth.shape_sd;
      data.shape_covariances.assign(static_cast<std::size_t>(truth.modes),
                                    sd * sd * MatrixXd::Identity(sensors, sensors));
    }
  }
  data.simulated = true;
  data.origin = "simulated from the case's truth, seed " + std::to_string(seed);
}

std::vector<Remark> implausible(const UpdateCase& update_case) {
  std::vector<Remark> remarks = implausible(update_case.structure->nominal);
  for (Remark& remark : implausible(update_case.data.sensors)) remarks.push_back(std::move(remark));
  return remarks;
}

}  // namespace wheeltap::identification
