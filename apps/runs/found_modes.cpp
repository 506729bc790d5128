#include "apps/runs/found_modes.hpp"

#include <cmath>
#include <sstream>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/runs/found_structure_modes.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string sparkline(const Eigen::VectorXd& shape) {
  static const char* levels[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  constexpr int kColumns = 40;
  std::string text;
  const auto nodes = shape.size() / 2;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < nodes; ++i) largest = std::max(largest, std::abs(shape[2 * i]));
  for (int c = 0; c < kColumns; ++c) {
    const auto node = static_cast<Eigen::Index>(
        std::lround(static_cast<double>(c) / (kColumns - 1) * static_cast<double>(nodes - 1)));
    const double w = largest > 0.0 ? shape[2 * node] / largest : 0.0;
    text += levels[std::clamp(static_cast<int>(std::lround(3.5 + 3.5 * w)), 0, 7)];
  }
  return text;
}

// Frequencies and nodal deflections of a beam whose true defects are of types that only structures
// support.
fem::Modes true_modes(const DamageCase& damage_case, int wanted) {
  const fem::StructureModes found = fem::structure_modes(true_structure(damage_case), wanted);
  const fem::Beam& beam = damage_case.beam;
  const fem::Mesh mesh(std::get<fem::Structure>(damage_case.solved_structure()));
  fem::Modes modes{.frequencies_hz = found.frequencies_hz,
                   .eigenvalues = found.eigenvalues,
                   .shapes = Eigen::MatrixXd::Zero(2 * beam.nodes(), found.shapes.cols()),
                   .rigid_body_modes = found.rigid_body_modes,
                   .certified = found.certified,
                   .solver = found.solver};
  int member = 0;
  double start = 0.0;
  for (int i = 0; i < beam.nodes(); ++i) {
    const double x = i * beam.element_length();
    while (member + 1 < static_cast<int>(mesh.structure().members.size()) &&
           x > start + mesh.member_length(member) * (1.0 + 1e-9)) {
      start += mesh.member_length(member++);
    }
    const fem::SparseRow deflection =
        mesh.motion(member, std::min(x - start, mesh.member_length(member)), fem::Direction::y);
    for (Eigen::Index j = 0; j < found.shapes.cols(); ++j) {
      modes.shapes(2 * i, j) = deflection.of(found.shapes.col(j));
    }
  }
  return modes;
}

}  // namespace

FoundModes find_modes(CaseFile file, const ModesOptions& options) {
  if (has_structure(file)) return find_structure_modes(std::move(file), options);
  if (!options.vtk.empty())
    throw Failure(Exit::usage, "--vtk: needs a structure; this case has a beam");
  const DamageCaseFile parsed = parse_damage_case(std::move(file), Needs::structure);
  const DamageCase& damage_case = parsed.damage;
  if (options.truth && !damage_case.simulation) {
    parsed.file.refuse(Pointer("/damage/truth"), "is missing: --truth needs it");
  }
  const fem::Defects defects = options.truth && !damage_case.solved_as_structure()
                                   ? damage_case.true_defects()
                                   : fem::Defects{};
  const int wanted = options.modes.value_or((damage_case.modes() > 0 ? damage_case.modes() : 10) +
                                            damage_case.rigid_body_modes);
  fem::Modes modes;
  try {
    modes = options.truth && damage_case.solved_as_structure()
                ? true_modes(damage_case, wanted)
                : fem::modal_analysis(damage_case.beam, defects, {.modes = wanted});
  } catch (const std::invalid_argument& error) {
    parsed.file.refuse(Pointer("/beam"), error.what());
  }
  const std::vector<double> frequencies(modes.frequencies_hz.begin(), modes.frequencies_hz.end());
  Report report = {{"frequencies_hz", frequencies},
                   {"rigid_body_modes", modes.rigid_body_modes},
                   {"certified", modes.certified},
                   {"solver", modes.solver}};
  if (options.shapes) {
    Report shapes = Report::array();
    for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
      std::vector<double> w;
      for (Eigen::Index i = 0; i < modes.shapes.rows(); i += 2) w.push_back(modes.shapes(i, j));
      shapes.push_back(w);
    }
    std::vector<double> x;
    for (int i = 0; i < damage_case.beam.nodes(); ++i) {
      x.push_back(i * damage_case.beam.element_length());
    }
    report["x_m"] = x;
    report["deflections"] = shapes;
  }
  std::ostringstream text;
  text << damage_case.title << (options.truth ? " (as damaged in truth)" : " (intact)") << "\n\n";
  text << "  mode   frequency [Hz]   deflection along the beam\n";
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
    char line[64];
    std::snprintf(line, sizeof line, "  %4d   %14.6f   ", static_cast<int>(j) + 1,
                  frequencies[static_cast<std::size_t>(j)]);
    text << line << sparkline(modes.shapes.col(j))
         << (j < modes.rigid_body_modes ? "  rigid body" : "") << '\n';
  }
  text << (modes.certified
               ? "\nA Sturm count certifies that no mode below the last listed mode is missing.\n"
               : "\nNot certified: a mode may be missing.\n");
  return {.report = std::move(report), .text = text.str(), .doubts = implausible(damage_case.beam)};
}

}  // namespace wheeltap::apps
