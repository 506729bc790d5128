// modes_check --files DIR --case N: dev only
#include <cstdio>
#include <iostream>
#include "apps/modes_file.hpp"
#include "frame_case.hpp"
#include "identification/real_shape.hpp"
#include "identification/shape_density.hpp"
int main(int, char** argv) {
  using namespace wheeltap;
  using namespace wheeltap::coverage;
  const FrameCase c = frame_case(1, std::atoi(argv[2]));
  for (const bool damaged : {false, true}) {
    const auto& st = damaged ? c.state_damaged : c.state_healthy;
    const auto modes = apps::read_modes_file(std::string(argv[1]) + "/" + argv[2] +
                                             (damaged ? "/damaged" : "/healthy") + "/modes.json");
    for (Eigen::Index i = 0; i < modes.frequencies_hz.size(); ++i) {
      Eigen::Index best = 0;
      double bm = -1;
      const auto rs = identification::real_shape(
          modes.shapes.col(i), modes.shape_covariance[std::size_t(i)], modes.blocks);
      const identification::ShapeDensity density(rs.values, rs.covariance);
      for (Eigen::Index j = 0; j < st.frequencies_hz.size(); ++j) {
        if (std::abs(st.frequencies_hz[j] / modes.frequencies_hz[i] - 1) > 0.1) continue;
        const double mac = density.against(st.shapes.col(j)).mac;
        if (mac > bm) {
          bm = mac;
          best = j;
        }
      }
      const auto cmp = density.against(st.shapes.col(best));
      const double zf =
          (modes.frequencies_hz[i] - st.frequencies_hz[best]) / std::sqrt(modes.covariance(i, i));
      const auto k = modes.frequencies_hz.size();
      const double zz = (modes.damping[i] - c.damping) / std::sqrt(modes.covariance(k + i, k + i));
      std::printf("%s mode %d %.4f%s: z %.2f, zeta z %.2f, 1-mac %.2e chi2 %.1f of %d, sd %.4f\n",
                  damaged ? "damaged" : "healthy", int(i) + 1, modes.frequencies_hz[i],
                  modes.doubtful[std::size_t(i)] ? " doubtful" : "", zf, zz, 1 - bm, cmp.chi_square,
                  density.freedoms(), density.sd());
      Eigen::VectorXd t = st.shapes.col(best);
      const double a = t.dot(rs.values) / t.squaredNorm();
      for (Eigen::Index s = 0; s < t.size(); ++s)
        std::printf("  %.4f(%.1f)", a * t[s],
                    (rs.values[s] - a * t[s]) / std::sqrt(rs.covariance(s, s)));
      std::printf("\n");
    }
  }
}
