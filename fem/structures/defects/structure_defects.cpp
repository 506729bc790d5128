#include "fem/structures/defects/structure_defects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

/// Gauss rule on [0, 1], exact for polynomials of degree seven.
struct GaussPoint {
  double at, weight;
};
constexpr std::array<GaussPoint, 4> kFourGaussPoints = {
    {{0.06943184420297371, 0.1739274225687269},
     {0.33000947820757187, 0.3260725774312731},
     {0.66999052179242813, 0.3260725774312731},
     {0.93056815579702629, 0.1739274225687269}}};
/// Masses below this share of the largest mass that a kink moves are rounding errors.
constexpr double kNoMass = 1e-13;

using Flexibility = Eigen::Matrix<double, kElementStrains, kElementStrains>;

void require_share(const char* name, double value) {
  if (value >= 0.0 && value < 1.0) return;
  throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) +
                              ": must be in [0, 1)");
}

/// Collects the changes of each element.
class Gathered {
 public:
  explicit Gathered(const Mesh& mesh) : mesh_(mesh) {}

  void add(const StructureDefects::Reduction& d) {
    require_share("reduction", d.reduction);
    if (!(d.from <= d.to))
      throw std::invalid_argument("a reduction from " + std::to_string(d.from) + " to " +
                                  std::to_string(d.to) +
                                  " m: the end must not lie before the start");
    const double length = mesh_.member_length(d.member);
    for (int e = mesh_.element_at(d.member, std::clamp(d.from, 0.0, length));
         e < mesh_.first_element(d.member + 1); ++e) {
      const Mesh::Element& element = mesh_.elements()[index(e)];
      const double l = element.to - element.from;
      const double low = std::max(0.0, (d.from - element.from) / l);
      const double high = std::min(1.0, (d.to - element.from) / l);
      if (low >= 1.0 - 1e-12) continue;
      if (high <= low) break;
      stretches_[e].push_back({low, high, d.reduction});
    }
  }

  void add(const StructureDefects::ElementReduction& d) {
    require_share("reduction", d.reduction);
    stretches_[mesh_.element_at(d.member, d.at)].push_back({0.0, 1.0, d.reduction});
  }

  /// Adds a hinge of rotational compliance c about the section's y (deflection along z) or z.
  void add_hinge(int member, double at, double compliance, bool along_z) {
    if (!(compliance > 0.0)) return;
    const int e = mesh_.element_at(member, at);
    const Mesh::Element& element = mesh_.elements()[index(e)];
    const double xi = std::clamp((at - element.from) / (element.to - element.from), 0.0, 1.0);
    const Eigen::Vector2d v = moment(e, xi, along_z);
    const int b = strain_index(along_z);
    flexibility(e);  // an entry without hinges
    hinged_.try_emplace(e, Flexibility::Zero()).first->second.block<2, 2>(b, b) +=
        compliance * v * v.transpose();
    hinges_.push_back({e, along_z, xi, compliance, v});
  }

  /// Changes of the mass matrices of elements with kinks (hinges).
  [[nodiscard]] std::vector<StructureChange::Mass> masses() {
    std::vector<StructureChange::Mass> out;
    if (mesh_.structure().mass == Structure::Mass::lumped) return out;
    std::map<std::pair<int, bool>, std::vector<const Hinge*>> together;
    for (const Hinge& hinge : hinges_) together[{hinge.element, hinge.along_z}].push_back(&hinge);
    for (const auto& [where, hinges] : together) add_masses(hinges, out);
    return out;
  }

  [[nodiscard]] std::vector<StructureChange::Softening> softenings() {
    for (const auto& [e, list] : stretches_) add_stretches(e, list);
    std::vector<StructureChange::Softening> out;
    for (const auto& [e, without_hinges] : added_) {
      Flexibility added = without_hinges;
      if (const auto hinges = hinged_.find(e); hinges != hinged_.end()) added += hinges->second;
      const auto& strains = mesh_.elements()[index(e)].strains;
      // By blocks: axial, (moment, shear) along z, torsion, (moment, shear) along y.
      for (const auto& [first, size] : {std::pair{0, 1}, {1, 2}, {3, 1}, {4, 2}}) {
        if (strains[index(first)] < 0) continue;
        const Eigen::MatrixXd block = added.block(first, first, size, size);
        if (block.isZero(0.0)) continue;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(block);
        for (int k = 0; k < size; ++k) {
          const double more = std::max(0.0, solver.eigenvalues()[k]);
          // An eigenvalue of 0 within rounding is not a softening.
          if (more <= 1e-14 * solver.eigenvalues()[size - 1]) continue;
          StructureChange::Softening s{.direction = {}, .remaining = 1.0 / (1.0 + more)};
          for (int i = 0; i < size; ++i)
            s.direction.emplace_back(strains[index(first + i)], solver.eigenvectors()(i, k));
          out.push_back(std::move(s));
        }
      }
    }
    return out;
  }

  /// Bending properties of an element.
  struct Bending {
    double stiffness;  // EI
    double phi;        // Φ
    double length;     // l
  };
  [[nodiscard]] Bending bending(int e, bool along_z) const {
    const Mesh::Element& element = mesh_.elements()[index(e)];
    const Member::Piece& piece =
        mesh_.structure().members[index(element.member)].pieces[index(element.piece)];
    const double l = element.to - element.from;
    const double ei = piece.material.young *
                      (along_z ? piece.section.second_moment_y : piece.section.second_moment_z);
    const double kappa =
        along_z ? piece.section.shear_coefficient_z : piece.section.shear_coefficient_y;
    const double shear = kappa * piece.section.area * piece.material.shear_modulus();
    return {.stiffness = ei, .phi = 12.0 * ei / (shear * l * l), .length = l};
  }

 private:
  struct Stretch {
    double low, high;  // ξ
    double reduction;
  };

  struct Hinge {
    int element;
    bool along_z;
    double xi;
    double compliance;
    Eigen::Vector2d v;  // bending moment at the hinge per unit stress
  };

  /// Adds the changes of mass due to the hinges of one element in one plane.
  void add_masses(const std::vector<const Hinge*>& hinges,
                  std::vector<StructureChange::Mass>& out) {
    const int e = hinges[0]->element;
    const bool along_z = hinges[0]->along_z;
    const Mesh::Element& element = mesh_.elements()[index(e)];
    const Member::Piece& piece =
        mesh_.structure().members[index(element.member)].pieces[index(element.piece)];
    const double l = element.to - element.from;
    const Flexure<double> bending = flexure(piece, l, along_z, mesh_.structure().rotary_inertia);
    const int at = strain_index(along_z);
    const int moment_row = element.strains[index(at)], shear_row = element.strains[index(at + 1)];
    if (!(bending.mass > 0.0) || moment_row < 0 || shear_row < 0) return;
    const TimoshenkoElement<double> shapes(bending);
    const Eigen::Matrix4d mass = shapes.mass();
    // Rotations θ = P B u of the hinges, the vector m of each hinge, and G = ∫ g_i g_j. With the
    // compliances C and the moments V of the hinges and the flexibility F of the element without
    // them, P = C Vᵀ (F + V C Vᵀ)⁻¹ = (C⁻¹ + Vᵀ F⁻¹ V)⁻¹ Vᵀ F⁻¹. The second form has no
    // cancellation for large compliances.
    const auto n = static_cast<Eigen::Index>(hinges.size());
    const Eigen::Matrix2d flexible =
        Eigen::Matrix2d::Identity() + flexibility(e).block<2, 2>(at, at);
    Eigen::MatrixXd v(2, n), stiffness = Eigen::MatrixXd::Zero(n, n), m(n, 4), g(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Hinge& hinge = *hinges[static_cast<std::size_t>(i)];
      v.col(i) = hinge.v;
      stiffness(i, i) = 1.0 / hinge.compliance;
    }
    const Eigen::MatrixXd eased = flexible.inverse() * v;
    stiffness += v.transpose() * eased;
    const Eigen::MatrixXd p = stiffness.ldlt().solve(eased.transpose());
    std::vector<Eigen::Vector4d> f, d;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Hinge& hinge = *hinges[static_cast<std::size_t>(i)];
      const double rest = 1.0 - hinge.xi;
      d.emplace_back(0.0, 0.0, l * rest, 1.0);
      Eigen::Vector4d load = Eigen::Vector4d::Zero();
      for (const GaussPoint& point : kFourGaussPoints) {
        const double x = hinge.xi + rest * point.at, weight = rest * l * point.weight;
        load += weight * (bending.mass * l * (x - hinge.xi) * shapes.deflection_row(x) +
                          bending.rotary * shapes.rotation_row(x));
      }
      f.push_back(load);
      m.row(i) = (load - mass * d.back()).transpose();
    }
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const double rest = 1.0 - std::max(hinges[a]->xi, hinges[b]->xi);
        const double apart = std::abs(hinges[a]->xi - hinges[b]->xi);
        // ∫ (x - x_i)₊ (x - x_j)₊ dx
        const double square = l * l * l * rest * rest * (rest / 3.0 + apart / 2.0);
        g(i, j) = bending.mass * square + bending.rotary * l * rest - d[a].dot(f[b]) -
                  d[b].dot(f[a]) + d[a].dot(mass * d[b]);
      }
    // Change [Pᵀ G P, Pᵀ m; mᵀ P, 0] in the two strains and the four motions of the element. Each
    // strain or motion is scaled by its value for a unit rotation, so that all have the same order
    // of magnitude.
    Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Zero();
    change.topLeftCorner<2, 2>() = p.transpose() * g * p;
    change.topRightCorner<2, 4>() = p.transpose() * m;
    change.bottomLeftCorner<4, 2>() = m.transpose() * p;
    Eigen::Matrix<double, 6, 1> size;
    size << shapes.bending()[3], shapes.shear()[1], l, 1.0, l, 1.0;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        Eigen::MatrixXd(size.asDiagonal() * change * size.asDiagonal()));
    const std::array<SparseRow, 4> motions = mesh_.bending_motions(e, along_z);
    const std::vector<Strain>& strains = mesh_.discretisation().strains;
    const std::array<const SparseRow*, 6> rows = {&strains[index(moment_row)].row,
                                                  &strains[index(shear_row)].row,
                                                  &motions[0],
                                                  &motions[1],
                                                  &motions[2],
                                                  &motions[3]};
    const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < 6; ++k) {
      const double value = solver.eigenvalues()[k];
      if (std::abs(value) <= kNoMass * largest) continue;
      std::map<int, double> sum;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto at_row = static_cast<Eigen::Index>(r);
        const double weight = solver.eigenvectors()(at_row, k) / size[at_row];
        for (std::size_t i = 0; i < rows[r]->dofs.size(); ++i)
          sum[rows[r]->dofs[i]] += weight * rows[r]->coefficients[i];
      }
      SparseRow row;
      for (const auto& [dof, coefficient] : sum) {
        row.dofs.push_back(dof);
        row.coefficients.push_back(coefficient);
      }
      out.push_back({std::move(row), value});
    }
  }

  static int strain_index(bool along_z) {
    return static_cast<int>(along_z ? ElementStrain::bending_z : ElementStrain::bending_y);
  }

  Flexibility& flexibility(int e) {
    return added_.try_emplace(e, Flexibility::Zero()).first->second;
  }

  [[nodiscard]] Eigen::Vector2d moment(int e, double xi, bool along_z) const {
    const auto [ei, phi, l] = bending(e, along_z);
    return {std::sqrt(ei / l),
            std::sqrt(12.0 * ei / (l * (1.0 + phi))) * (std::clamp(xi, 0.0, 1.0) - 0.5)};
  }

  void add_stretches(int e, const std::vector<Stretch>& list) {
    std::vector<double> ends;
    for (const Stretch& s : list) {
      ends.push_back(s.low);
      ends.push_back(s.high);
    }
    std::ranges::sort(ends);
    Flexibility& f = flexibility(e);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double low = ends[i], high = ends[i + 1];
      if (high <= low) continue;
      double left = 1.0;
      for (const Stretch& s : list)
        if (s.low <= low && s.high >= high) left *= 1.0 - s.reduction;
      const double more = 1.0 / left - 1.0, part = high - low;
      f(static_cast<int>(ElementStrain::axial), static_cast<int>(ElementStrain::axial)) +=
          more * part;
      f(static_cast<int>(ElementStrain::torsion), static_cast<int>(ElementStrain::torsion)) +=
          more * part;
      for (const bool along_z : {true, false}) {
        if (!along_z && mesh_.structure().dimension == 2) continue;
        const double phi = bending(e, along_z).phi;
        const double root = std::sqrt(12.0 / (1.0 + phi));
        const double a = low - 0.5, b = high - 0.5;
        const int k = strain_index(along_z);
        f(k, k) += more * part;
        // ∫ (ξ - ½) dξ, ∫ (ξ - ½)² dξ, and the share of shear.
        f(k, k + 1) += more * root * 0.5 * (b * b - a * a);
        f(k + 1, k) = f(k, k + 1);
        f(k + 1, k + 1) +=
            more * (root * root * (b * b * b - a * a * a) / 3.0 + phi / (1.0 + phi) * part);
      }
    }
  }

  const Mesh& mesh_;
  std::map<int, std::vector<Stretch>> stretches_;
  std::map<int, Flexibility> added_;   // by reductions
  std::map<int, Flexibility> hinged_;  // by hinges
  std::vector<Hinge> hinges_;
};

void loosen(const Mesh& mesh, const StructureDefects::LooseJoint& joint, Gathered& gathered,
            StructureChange& out) {
  require_share("loosening", joint.reduction);
  const Structure& s = mesh.structure();
  if (joint.node < 0 || index(joint.node) >= s.nodes.size())
    throw std::invalid_argument("joint at node " + std::to_string(joint.node) + ": does not exist");
  const std::vector<int> springs = mesh.joint_strains(joint.node);
  if (!springs.empty()) {
    for (const int row : springs) out.softenings.push_back({{{row, 1.0}}, 1.0 - joint.reduction});
    return;
  }
  for (std::size_t m = 0; m < s.members.size(); ++m)
    for (std::size_t end = 0; end < 2; ++end) {
      const Member& member = s.members[m];
      if (member.nodes[end] != joint.node) continue;
      const auto number = static_cast<int>(m);
      const double length = mesh.member_length(number), at = end == 0 ? 0.0 : length;
      for (const bool along_z : {true, false}) {
        if (!along_z && s.dimension == 2) continue;
        if (std::isfinite(member.ends[end].rotation[along_z ? 1 : 2])) continue;
        const double ei = gathered.bending(mesh.element_at(number, at), along_z).stiffness;
        gathered.add_hinge(
            number, at, joint.reduction / (1.0 - joint.reduction) * length / (3.0 * ei), along_z);
      }
    }
}

}  // namespace

StructureChange change_of(const Mesh& mesh, const StructureDefects& defects, StructureChange out) {
  Gathered gathered(mesh);
  for (const StructureDefects::ElementReduction& d : defects.elements) gathered.add(d);
  for (const StructureDefects::Reduction& d : defects.reductions) gathered.add(d);
  for (const StructureDefects::Crack& d : defects.cracks) {
    const int e = mesh.element_at(d.member, d.at);
    const Member::Piece& piece =
        mesh.structure().members[index(d.member)].pieces[index(mesh.elements()[index(e)].piece)];
    gathered.add_hinge(
        d.member, d.at,
        crack_compliance(*d.law, d.depth, piece.section.depth, gathered.bending(e, true).stiffness,
                         piece.material.poisson),
        true);
  }
  for (const StructureDefects::LooseJoint& d : defects.joints) loosen(mesh, d, gathered, out);
  for (StructureChange::Softening& s : gathered.softenings())
    out.softenings.push_back(std::move(s));
  compound(out);
  for (StructureChange::Mass& m : gathered.masses()) out.masses.push_back(std::move(m));
  for (const StructureDefects::AddedMass& d : defects.masses) {
    if (!std::isfinite(d.mass))
      throw std::invalid_argument("added mass = " + std::to_string(d.mass) + ": must be finite");
    // Uses the member's own axes, because its stiffnesses along these axes differ most.
    for (const std::size_t k : {0, 1, 2})
      if (k != 1 || mesh.structure().dimension == 3)
        out.masses.push_back(
            {mesh.motion(d.member, d.at, mesh.member_axes(d.member)[k], false), d.mass});
  }
  for (const StructureDefects::AddedSupport& d : defects.supports)
    out.springs.push_back({mesh.motion(d.member, d.at, d.direction), d.stiffness});
  return out;
}

}  // namespace wheeltap::fem
