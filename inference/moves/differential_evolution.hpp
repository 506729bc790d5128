// Steps in the direction of the difference between two archived states.
#pragma once

#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// States of each model from warm-up, one per column; fixed before sampling, so that the kernel
/// does not change between draws.
using Archive = std::vector<Eigen::MatrixXd>;

/// z' = z + γ (a - b) + e on one block of coordinates, with a and b two archived states of the same
/// model (ter Braak & Vrugt 2008, with a fixed archive). The pair (b, a) has the same probability,
/// so the proposal ratio is 1. γ is 2.38/√(2d), or 1 with probability 0.1 to jump between posterior
/// modes. For irreducibility, e ~ N(0, s²) with s_i = 10⁻⁴ |c_i - d_i| + 10⁻¹² for two other states
/// c and d. If the posterior or each of its modes is narrow, e is also small, because c and d often
/// belong to the same posterior mode.
class DifferentialEvolution : public Move {
 public:
  explicit DifferentialEvolution(std::shared_ptr<const Archive> archive)
      : archive_(std::move(archive)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::shared_ptr<const Archive> archive_;
};

}  // namespace wheeltap::inference
