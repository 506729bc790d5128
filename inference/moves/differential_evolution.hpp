// Steps along the difference of two archived states.
#pragma once

#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// States of each model kept from warm-up, one a column; frozen before sampling, so that the kernel
/// is the same at every draw.
using Archive = std::vector<Eigen::MatrixXd>;

/// z' = z + γ (a - b) + e on one block of coordinates, a and b being two archived states of the
/// same model (ter Braak & Vrugt 2008, with the archive frozen). The pair (b, a) is as likely, so
/// the ratio is 1. γ is 2.38/√(2d), or 1 one time in ten to jump between modes. So that the chain
/// is irreducible, e ~ N(0, s²) with s_i = 10⁻⁴ |c_i - d_i| + 10⁻¹² of another two states c and d:
/// narrow where the posterior is, and where its modes are, since c and d are often of the same one.
class DifferentialEvolution : public Move {
 public:
  explicit DifferentialEvolution(std::shared_ptr<const Archive> archive)
      : archive_(std::move(archive)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::shared_ptr<const Archive> archive_;
};

}  // namespace wheeltap::inference
