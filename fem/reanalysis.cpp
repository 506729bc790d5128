#include "fem/reanalysis.hpp"

#include <algorithm>
#include <vector>

#include "fem/modal_analysis.hpp"

namespace wheeltap::fem {

struct Reanalysis::Impl {
  Beam beam;
  Modes intact;
  std::vector<double> frequencies;
};
struct Reanalysis::Workspace::Impl {};

Reanalysis::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reanalysis::Workspace::Workspace(Workspace&&) noexcept = default;
Reanalysis::Workspace& Reanalysis::Workspace::operator=(Workspace&&) noexcept = default;
Reanalysis::Workspace::~Workspace() = default;

Reanalysis::Reanalysis(const Beam& beam, int modes) {
  Modes intact = modal_analysis(beam, {}, {.modes = modes});
  std::vector<double> f(intact.frequencies_hz.begin(), intact.frequencies_hz.end());
  impl_ = std::make_unique<const Impl>(
      Impl{.beam = beam, .intact = std::move(intact), .frequencies = std::move(f)});
}
Reanalysis::~Reanalysis() = default;
Reanalysis::Reanalysis(Reanalysis&&) noexcept = default;
Reanalysis& Reanalysis::operator=(Reanalysis&&) noexcept = default;

Reanalysis::Workspace Reanalysis::make_workspace() const {
  return Workspace(std::make_unique<Workspace::Impl>());
}
int Reanalysis::modes() const {
  return static_cast<int>(impl_->frequencies.size());
}
int Reanalysis::rigid_body_modes() const {
  return impl_->intact.rigid_body_modes;
}
const Beam& Reanalysis::beam() const {
  return impl_->beam;
}
std::span<const double> Reanalysis::intact_frequencies_hz() const {
  return impl_->frequencies;
}

void Reanalysis::frequencies_hz(std::span<const Damage> damages,
                                std::span<const SpringSupport> supports, Workspace&,
                                std::span<double> out) const {
  const Defects defects{.damages = {damages.begin(), damages.end()},
                        .supports = {supports.begin(), supports.end()}};
  const Modes m = modal_analysis(impl_->beam, defects, {.modes = static_cast<int>(out.size())});
  std::copy(m.frequencies_hz.begin(), m.frequencies_hz.end(), out.begin());
}

}  // namespace wheeltap::fem
