#include "identification/emulation/interpolants.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include "emulator/cubic_interpolant.hpp"
#include "emulator/delaunay_interpolant.hpp"
#include "emulator/gaussian_process.hpp"
#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::identification {
namespace {

#ifdef WHEELTAP_WITH_CGAL
constexpr auto kTrainDelaunay = &emulator::train_delaunay;
#else
std::unique_ptr<const emulator::Interpolant> kTrainDelaunay(emulator::Table&,
                                                            const emulator::TrainingOptions&) {
  throw std::invalid_argument(
      "this program was built without Delaunay interpolation (CMake option WHEELTAP_WITH_CGAL)");
}
#endif

constexpr emulator::InterpolantType kDelaunay = emulator::delaunay_type(kTrainDelaunay);

constexpr std::array<const emulator::InterpolantType*, 5> kTypes = {
    &emulator::kMultilinear, &emulator::kCubic, &emulator::kMonotoneCubic,
    &emulator::kGaussianProcess, &kDelaunay};

}  // namespace

InterpolantTypes interpolant_types() {
  return kTypes;
}

const emulator::InterpolantType* find_interpolant_type(std::string_view name,
                                                       InterpolantTypes types) {
  for (const emulator::InterpolantType* type : types) {
    if (type->name == name) return type;
  }
  return nullptr;
}

std::string interpolant_names(emulator::InterpolantType::Runs runs, InterpolantTypes types) {
  std::vector<std::string> names;
  for (const emulator::InterpolantType* type : types) {
    if (type->runs == runs) names.push_back('"' + std::string(type->name) + '"');
  }
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
  }
  return text;
}

}  // namespace wheeltap::identification
