#include "apps/results/update_posterior_file.hpp"

#include <cmath>

#include "apps/draw_columns.hpp"
#include "apps/results/posterior_file.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

struct ShapeColumns {
  std::size_t chains, draws, modes, width;
};

void write_replicates(const io::NetcdfWriter& file, const UpdateProblem& problem,
                      const inference::Posterior& posterior, const ShapeColumns& shape,
                      std::uint64_t seed) {
  const int group = file.group("posterior_predictive");
  const int chain = file.dimension(group, "chain", shape.chains, 0);
  const int draw = file.dimension(group, "draw", shape.draws, 0);
  const int mode = file.dimension(group, "mode", shape.modes, 1);
  const auto& observed = problem.update_case.data.frequencies_hz;
  Eigen::VectorXd noise(static_cast<Eigen::Index>(shape.modes));
  const UnknownScatters& scatters = problem.modes().scatters();
  const bool scatters_vary = scatters.contains(&ModalNoise::cov) ||
                             scatters.contains(&ModalNoise::discrepancy) ||
                             (problem.program() != nullptr && problem.program()->emulator);
  Eigen::MatrixXd root;
  const auto replicate = [&](std::size_t c, std::vector<float>& values) {
    const auto& from = posterior.chains[c];
    for (std::size_t i = 0; i < shape.draws; ++i) {
      if (scatters_vary || root.size() == 0) {
        const std::span<const double> x(from.theta.data() + i * shape.width, shape.width);
        Eigen::MatrixXd covariance = problem.covariance(problem.noise(x));
        for (std::size_t m = 0; m < shape.modes; ++m)
          if (std::isnan(observed[m]))
            covariance(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(m)) = 1.0;
        root = covariance.llt().matrixL();
      }
      base::Random random(seed, c, i, base::Purpose::prediction);
      for (double& e : noise) e = random.normal();
      const Eigen::VectorXd moved = root * noise;
      for (std::size_t m = 0; m < shape.modes; ++m)
        values.push_back(std::isnan(observed[m])
                             ? std::nanf("")
                             : static_cast<float>(from.prediction[i * shape.modes + m] +
                                                  moved[static_cast<Eigen::Index>(m)]));
    }
  };
  const int id = file.put_rows<float>(group, "frequency", {chain, draw, mode}, replicate);
  file.text(group, id, "units", "Hz");
}

}  // namespace

void write_update_posterior(const io::NetcdfWriter& file, const std::string& run,
                            const UpdateCaseFile& parsed, const UpdateProblem& problem,
                            const inference::Posterior& posterior, std::uint64_t seed) {
  const ModalData& data = problem.update_case.data;
  const ShapeColumns shape{.chains = posterior.chains.size(),
                           .draws = posterior.chains[0].model.size(),
                           .modes = static_cast<std::size_t>(data.modes()),
                           .width = static_cast<std::size_t>(posterior.dimension)};
  file.about(WHEELTAP_VERSION, run);
  file.text(file.root(), NC_GLOBAL, "title", parsed.update.title);
  file.text(file.root(), NC_GLOBAL, "case", parsed.file.json.dump());
  write_draws(file, posterior, parameter_columns(posterior));
  write_sample_stats(
      file, posterior,
      {.name = "k", .value = [](const auto&, std::size_t, std::size_t) { return 0; }});
  if (posterior.predictions == data.modes())
    write_replicates(file, problem, posterior, shape, seed);
  {
    const int group = file.group("observed_data");
    const int mode = file.dimension(group, "mode", shape.modes, 1);
    const int id = file.put(group, "frequency", {mode}, data.frequencies_hz);
    file.text(group, id, "units", "Hz");
    if (data.covariance.size() > 0) {
      std::vector<double> sd;
      for (Eigen::Index i = 0; i < data.covariance.rows(); ++i)
        sd.push_back(std::sqrt(data.covariance(i, i)));
      file.put(group, "sd", {mode}, sd);
    }
    if (data.has_shapes()) {
      const int sensor = file.dimension(group, "sensor", data.sensors.size(), 1);
      std::vector<double> values;
      for (Eigen::Index i = 0; i < data.shapes.rows(); ++i)
        for (Eigen::Index s = 0; s < data.shapes.cols(); ++s) values.push_back(data.shapes(i, s));
      file.put(group, "shape", {mode, sensor}, values);
    }
  }
}

}  // namespace wheeltap::apps
