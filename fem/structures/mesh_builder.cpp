// Builds the mesh of a structure: degrees of freedom, strains, masses and rigid motions.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "fem/structures/member_motions.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {
namespace {

using detail::Motions;
using detail::own_motions;
using detail::OwnMotions;
using detail::plane_motions;
using detail::RowSum;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Largest strain of a rigid motion, relative to the terms of the strain.
constexpr double kUnstrained = 1e-9;

void add_product(Triplets& matrix, double factor, const SparseRow& a, const SparseRow& b) {
  for (std::size_t i = 0; i < a.dofs.size(); ++i)
    for (std::size_t j = 0; j < b.dofs.size(); ++j)
      matrix.emplace_back(a.dofs[i], b.dofs[j], factor * a.coefficients[i] * b.coefficients[j]);
}

/// Gauss points and weights on [0, 1].
struct Quadrature {
  double at, weight;
};
/// Exact for squares of quadratics.
const std::array<Quadrature, 3> kThreePoints = {{{0.5 - 0.5 * std::sqrt(0.6), 5.0 / 18.0},
                                                 {0.5, 8.0 / 18.0},
                                                 {0.5 + 0.5 * std::sqrt(0.6), 5.0 / 18.0}}};
/// Exact for squares of cubics.
const std::array<Quadrature, 4> kFourPoints = [] {
  const double near = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(1.2));
  const double far = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(1.2));
  const double heavy = (18.0 + std::sqrt(30.0)) / 72.0, light = (18.0 - std::sqrt(30.0)) / 72.0;
  return std::array<Quadrature, 4>{{{0.5 - 0.5 * far, light},
                                    {0.5 - 0.5 * near, heavy},
                                    {0.5 + 0.5 * near, heavy},
                                    {0.5 + 0.5 * far, light}}};
}();

const Member::Piece& piece_of(const Member& member, double s) {
  for (const Member::Piece& piece : member.pieces)
    if (s < piece.to) return piece;
  return member.pieces.back();
}

std::string in_metres(double metres) {
  std::string text = std::to_string(metres);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " m";
}

}  // namespace

/// Fills a mesh, first with all possible degrees of freedom, then without the unused ones.
class MeshBuilder {
 public:
  explicit MeshBuilder(Mesh& mesh) : mesh_(mesh), s_(mesh.structure_) {}

  void build() {
    allocate_nodes();
    mesh_.joint_strains_.resize(s_.nodes.size());
    for (std::size_t m = 0; m < s_.members.size(); ++m) allocate_member(static_cast<int>(m));
    for (std::size_t m = 0; m < s_.members.size(); ++m) add_member(static_cast<int>(m));
    mesh_.first_element_.push_back(static_cast<int>(mesh_.elements_.size()));
    add_supports_and_springs();
    add_masses();
    finish();
  }

 private:
  /// Definition of a degree of freedom: a motion along or about `axis` at a location.
  struct Dof {
    Vector3 axis;
    Vector3 at;
    bool rotation;
    int part;  // node or element boundary, for connectivity
    DofName name;
  };

  [[nodiscard]] bool active(Direction d) const {
    if (s_.dimension == 3) return true;
    return (d == Direction::x && s_.axial) || d == Direction::y || d == Direction::rz;
  }

  SparseRow add_dof(const Vector3& axis, const Vector3& at, bool rotation, int part, DofName name) {
    const auto dof = static_cast<int>(dofs_.size());
    dofs_.push_back({axis, at, rotation, part, std::move(name)});
    return {{dof}, {1.0}};
  }

  int add_part() {
    parts_.push_back(static_cast<int>(parts_.size()));
    return parts_.back();
  }
  int root(int part) {
    while (parts_[index(part)] != part) part = parts_[index(part)];
    return part;
  }
  void unite(int a, int b) { parts_[index(root(a))] = root(b); }

  void allocate_nodes() {
    std::vector<std::array<bool, kDirections>> fixed(s_.nodes.size());
    for (const NodeSupport& support : s_.supports)
      for (std::size_t d = 0; d < kDirections; ++d)
        if (support.fix[d]) fixed[index(support.node)][d] = true;
    for (std::size_t n = 0; n < s_.nodes.size(); ++n) {
      const int part = add_part();
      Motions motions;
      for (std::size_t d = 0; d < kDirections; ++d) {
        const auto direction = static_cast<Direction>(d);
        if (!active(direction)) continue;
        const bool rotation = is_rotation(direction);
        if (fixed[n][d]) {
          holds_.push_back({unit_vector(d % 3), s_.nodes[n].at, rotation, part, {}});
        } else {
          motions[d] = add_dof(unit_vector(d % 3), s_.nodes[n].at, rotation, part,
                               {s_.nodes[n].name, direction_name(direction, s_.dimension)});
        }
      }
      mesh_.node_motions_.push_back(std::move(motions));
    }
  }

  void allocate_member(int m) {
    const Member& member = s_.members[index(m)];
    mesh_.frames_.push_back(member_frame(s_, m));
    mesh_.boundaries_.push_back(element_boundaries(s_, m));
    const MemberFrame& frame = mesh_.frames_.back();
    const std::vector<double>& places = mesh_.boundaries_.back();
    std::vector<Motions> stations(places.size());
    int before = member.nodes[0];
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      if (i == 0) {
        stations[0] = end_motions(m, 0);
        continue;
      }
      Vector3 at = s_.nodes[index(member.nodes[0])].at;
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] += member.ends[0].offset[axis] + frame.axes[0][axis] * places[i];
      const int part = add_part();
      unite(part, before);
      before = part;
      const std::string place = "member \"" + member.name + "\" at " + in_metres(places[i]);
      for (std::size_t d = 0; d < kDirections; ++d) {
        const auto direction = static_cast<Direction>(d);
        if (active(direction))
          stations[i][d] = add_dof(unit_vector(d % 3), at, is_rotation(direction), part,
                                   {place, direction_name(direction, s_.dimension)});
      }
    }
    unite(member.nodes[0], member.nodes[1]);
    stations.back() = end_motions(m, 1);
    mesh_.station_motions_.push_back(std::move(stations));
  }

  /// u = u_node + θ_node × offset. The rotation is that of the node, except about the axes of a
  /// joint.
  Motions end_motions(int m, std::size_t end) {
    const Member& member = s_.members[index(m)];
    const MemberEnd& joint = member.ends[end];
    const MemberFrame& frame = mesh_.frames_[index(m)];
    const int node = member.nodes[end];
    const Motions& at_node = mesh_.node_motions_[index(node)];
    Motions out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      RowSum sum;
      sum.add(1.0, at_node[axis]);
      const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
      sum.add(joint.offset[last], at_node[3 + next]);
      sum.add(-joint.offset[next], at_node[3 + last]);
      out[axis] = sum.row();
    }
    std::array<RowSum, 3> rotation;
    Vector3 place = s_.nodes[index(node)].at;
    for (std::size_t k = 0; k < 3; ++k) place[k] += joint.offset[k];
    static constexpr std::array<const char*, 3> about = {"x", "y", "z"};
    for (std::size_t own = 0; own < 3; ++own) {
      if (s_.dimension == 2 && own != 1) continue;
      const Vector3& axis = frame.axes[own];
      RowSum of_node;
      for (std::size_t k = 0; k < 3; ++k) of_node.add(axis[k], at_node[3 + k]);
      SparseRow about_own = of_node.row();
      if (std::isfinite(joint.rotation[own])) {
        const SparseRow free =
            add_dof(axis, place, true, node,
                    {"member \"" + member.name + "\" at " + s_.nodes[index(node)].name,
                     s_.dimension == 2 ? std::string("rotation")
                                       : std::string("rotation about its ") + about[own]});
        if (joint.rotation[own] > 0.0) {
          RowSum turn;
          turn.add(1.0, free);
          turn.add(-1.0, about_own);
          const int strain = add_strain(turn.row(std::sqrt(joint.rotation[own])));
          mesh_.joint_strains_[index(node)].push_back(strain);
        }
        about_own = free;
      }
      for (std::size_t k = 0; k < 3; ++k) rotation[k].add(axis[k], about_own);
    }
    for (std::size_t k = 0; k < 3; ++k) out[3 + k] = rotation[k].row();
    return out;
  }

  int add_strain(SparseRow row, double factor = 1.0) {
    if (row.empty()) return -1;
    mesh_.discretisation_.strains.push_back({std::move(row), factor});
    return static_cast<int>(mesh_.discretisation_.strains.size()) - 1;
  }

  /// A row in terms of the bending motions (w₁, θ₁, w₂, θ₂) of an element.
  static SparseRow in_plane(const Eigen::Vector4d& coefficients,
                            const std::array<SparseRow, 4>& motions, double factor = 1.0) {
    RowSum sum;
    for (std::size_t i = 0; i < 4; ++i)
      sum.add(coefficients[static_cast<Eigen::Index>(i)], motions[i]);
    return sum.row(factor);
  }

  void add_member(int m) {
    const std::vector<double>& places = mesh_.boundaries_[index(m)];
    mesh_.first_element_.push_back(static_cast<int>(mesh_.elements_.size()));
    for (std::size_t e = 0; e + 1 < places.size(); ++e) add_element(m, e);
  }

  void add_element(int m, std::size_t e) {
    const Member& member = s_.members[index(m)];
    const MemberFrame& frame = mesh_.frames_[index(m)];
    const std::vector<double>& places = mesh_.boundaries_[index(m)];
    const double l = places[e + 1] - places[e];
    const Member::Piece& piece = piece_of(member, 0.5 * (places[e] + places[e + 1]));
    const MemberSection& section = piece.section;

    const OwnMotions own = own_motions(frame, mesh_.station_motions_[index(m)][e],
                                       mesh_.station_motions_[index(m)][e + 1]);
    Mesh::Element element{.member = m,
                          .from = places[e],
                          .to = places[e + 1],
                          .strains = {},
                          .piece = static_cast<int>(&piece - member.pieces.data())};
    element.strains.fill(-1);
    const auto strain = [&](ElementStrain which) -> int& {
      return element.strains[static_cast<std::size_t>(which)];
    };
    const auto stretch = [&](std::size_t k, double stiffness) {
      RowSum sum;
      sum.add(-1.0, own[0][k]);
      sum.add(1.0, own[1][k]);
      return add_strain(sum.row(std::sqrt(stiffness / l)));
    };
    strain(ElementStrain::axial) = stretch(0, piece.material.young * section.area);
    const bool lumped = s_.mass == Structure::Mass::lumped;
    const double line_mass = piece.material.density * section.area * l;
    if (lumped) {
      for (const auto& end : own)
        for (std::size_t k = 0; k < 3; ++k) add_product(mass_, 0.5 * line_mass, end[k], end[k]);
    } else {
      add_bar_mass(own[0][0], own[1][0], line_mass);
    }
    for (const bool along_z : {true, false}) {
      if (!along_z && s_.dimension == 2) continue;
      const std::array<SparseRow, 4> motions = plane_motions(own, along_z);
      const TimoshenkoElement<double> bending(flexure(piece, l, along_z, s_.rotary_inertia));
      strain(along_z ? ElementStrain::bending_z : ElementStrain::bending_y) =
          add_strain(in_plane(bending.bending(), motions));
      strain(along_z ? ElementStrain::shear_z : ElementStrain::shear_y) =
          add_strain(in_plane(bending.shear(), motions));
      if (member.axial_force != 0.0)
        for (const Quadrature& point : kThreePoints)
          add_strain(in_plane(bending.slope_row(point.at), motions,
                              std::sqrt(std::abs(member.axial_force) * l * point.weight)),
                     member.axial_force > 0.0 ? 1.0 : -1.0);
      if (member.foundation > 0.0)
        for (const Quadrature& point : kFourPoints)
          add_strain(in_plane(bending.deflection_row(point.at), motions,
                              std::sqrt(member.foundation * l * point.weight)));
      if (lumped) continue;
      const Eigen::Matrix4d mass = bending.mass();
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          add_product(mass_, mass(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)),
                      motions[i], motions[j]);
    }
    if (s_.dimension == 3) {
      strain(ElementStrain::torsion) =
          stretch(3, piece.material.shear_modulus() * section.torsion_constant);
      const double polar = section.second_moment_y + section.second_moment_z;
      if (!lumped) add_bar_mass(own[0][3], own[1][3], piece.material.density * polar * l);
    }
    mesh_.elements_.push_back(element);
  }

  /// Adds the mass matrix of linear shape functions, m/6 [2 1; 1 2].
  void add_bar_mass(const SparseRow& a, const SparseRow& b, double mass) {
    add_product(mass_, mass / 3.0, a, a);
    add_product(mass_, mass / 3.0, b, b);
    add_product(mass_, mass / 6.0, a, b);
    add_product(mass_, mass / 6.0, b, a);
  }

  void add_supports_and_springs() {
    for (const NodeSupport& support : s_.supports)
      for (std::size_t d = 0; d < kDirections; ++d)
        if (support.stiffness[d] > 0.0) {
          const int strain =
              add_spring(mesh_.node_motions_[index(support.node)][d], support.stiffness[d]);
          if (strain >= 0 && is_rotation(static_cast<Direction>(d)))
            mesh_.joint_strains_[index(support.node)].push_back(strain);
        }
    for (const NodeSpring& spring : s_.springs) {
      RowSum sum;
      const int other = spring.nodes[1];
      if (other != NodeSpring::kGround) unite(spring.nodes[0], other);
      if (spring.direction != NodeSpring::kAlong) {
        const auto d = static_cast<std::size_t>(spring.direction);
        sum.add(1.0, mesh_.node_motions_[index(spring.nodes[0])][d]);
        if (other != NodeSpring::kGround) sum.add(-1.0, mesh_.node_motions_[index(other)][d]);
      } else {
        const Vector3 &a = s_.nodes[index(spring.nodes[0])].at, &b = s_.nodes[index(other)].at;
        const Vector3 line = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const double length = std::sqrt(dot(line, line));
        for (std::size_t k = 0; k < 3; ++k) {
          sum.add(line[k] / length, mesh_.node_motions_[index(other)][k]);
          sum.add(-line[k] / length, mesh_.node_motions_[index(spring.nodes[0])][k]);
        }
      }
      add_spring(sum.row(), spring.stiffness);
    }
  }

  int add_spring(SparseRow row, double stiffness) {
    if (!(stiffness > 0.0)) return -1;
    for (double& c : row.coefficients) c *= std::sqrt(stiffness);
    return add_strain(std::move(row));
  }

  void add_masses() {
    for (const NodeMass& mass : s_.masses) {
      const Motions& motions = mesh_.node_motions_[index(mass.node)];
      for (std::size_t k = 0; k < 3; ++k) {
        add_product(mass_, mass.mass, motions[k], motions[k]);
        add_product(mass_, mass.inertia[k], motions[3 + k], motions[3 + k]);
      }
    }
  }

  /// Removes degrees of freedom without stiffness and mass, and numbers the rest along members.
  void finish() {
    Discretisation& d = mesh_.discretisation_;
    std::vector<bool> used(dofs_.size());
    for (const Strain& strain : d.strains)
      for (const int dof : strain.row.dofs) used[index(dof)] = true;
    for (const auto& entry : mass_)
      if (entry.value() != 0.0) used[index(entry.row())] = true;
    std::vector<int> number(dofs_.size(), -1);
    std::vector<Dof> kept;
    for (std::size_t i = 0; i < dofs_.size(); ++i) {
      if (!used[i]) continue;
      number[i] = static_cast<int>(kept.size());
      kept.push_back(dofs_[i]);
    }
    const auto renumber = [&](SparseRow& row) {
      SparseRow out;
      for (std::size_t i = 0; i < row.dofs.size(); ++i) {
        const int dof = number[index(row.dofs[i])];
        if (dof < 0) continue;
        out.dofs.push_back(dof);
        out.coefficients.push_back(row.coefficients[i]);
      }
      row = std::move(out);
    };
    // A spring whose motions are all restrained has no strain. Its row remains as an empty row.
    for (Strain& strain : d.strains) renumber(strain.row);
    for (Motions& motions : mesh_.node_motions_)
      for (SparseRow& row : motions) renumber(row);
    for (auto& stations : mesh_.station_motions_)
      for (Motions& motions : stations)
        for (SparseRow& row : motions) renumber(row);

    const auto n = static_cast<Eigen::Index>(kept.size());
    Triplets stiffness, mass;
    for (const Strain& strain : d.strains)
      add_product(stiffness, strain.factor, strain.row, strain.row);
    for (const auto& entry : mass_)
      if (entry.value() != 0.0)
        mass.emplace_back(number[index(entry.row())], number[index(entry.col())], entry.value());
    d.stiffness.resize(n, n);
    d.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
    d.mass.resize(n, n);
    d.mass.setFromTriplets(mass.begin(), mass.end());
    d.rest.resize(n, n);
    for (const Dof& dof : kept) d.names.push_back(dof.name);
    find_rigid_motions(kept);
  }

  /// Finds, for each connected part, the combinations of translations and rotations that move no
  /// restrained dof and cause no strain.
  void find_rigid_motions(const std::vector<Dof>& kept) {
    Discretisation& d = mesh_.discretisation_;
    const auto n = static_cast<Eigen::Index>(kept.size());
    std::vector<int> roots;
    for (const Dof& dof : kept) roots.push_back(root(dof.part));
    std::vector<int> parts = roots;
    std::ranges::sort(parts);
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    double size = 0.0;
    for (const Dof& a : kept)
      for (std::size_t k = 0; k < 3; ++k) size = std::max(size, std::abs(a.at[k] - kept[0].at[k]));
    if (size == 0.0) size = 1.0;
    // Translations, then rotations, each scaled to move by about 1.
    const std::vector<std::size_t> motions = s_.dimension == 2
                                                 ? std::vector<std::size_t>{0, 1, 5}
                                                 : std::vector<std::size_t>{0, 1, 2, 3, 4, 5};
    const auto count = static_cast<Eigen::Index>(motions.size());
    const auto value = [&](Eigen::Index c, const Dof& dof) {
      const std::size_t motion = motions[index(c)];
      if (motion < 3) return dof.rotation ? 0.0 : dof.axis[motion];
      const Vector3 turn = unit_vector(motion - 3);
      if (dof.rotation) return dot(dof.axis, turn) / size;
      return dot(dof.axis, cross(turn, difference(dof.at, kept[0].at))) / size;
    };
    std::vector<Eigen::VectorXd> found;
    for (const int part : parts) {
      Eigen::MatrixXd candidates = Eigen::MatrixXd::Zero(n, count);
      for (Eigen::Index i = 0; i < n; ++i)
        if (roots[index(i)] == part)
          for (Eigen::Index c = 0; c < count; ++c) candidates(i, c) = value(c, kept[index(i)]);
      std::vector<Eigen::VectorXd> conditions;
      for (const Dof& hold : holds_) {
        if (root(hold.part) != part) continue;
        Eigen::VectorXd row(count);
        for (Eigen::Index c = 0; c < count; ++c) row[c] = value(c, hold);
        conditions.push_back(hold.rotation ? Eigen::VectorXd(row * size) : row);
      }
      for (const Strain& strain : d.strains) {
        if (strain.row.empty() || roots[index(strain.row.dofs[0])] != part) continue;
        Eigen::VectorXd row(count);
        double largest = 0.0;
        for (Eigen::Index c = 0; c < count; ++c) {
          row[c] = 0.0;
          for (std::size_t i = 0; i < strain.row.dofs.size(); ++i) {
            const double term = strain.row.coefficients[i] * candidates(strain.row.dofs[i], c);
            row[c] += term;
            largest = std::max(largest, std::abs(term));
          }
        }
        for (double& x : row)
          if (std::abs(x) <= kUnstrained * largest) x = 0.0;
        if (largest > 0.0 && row.cwiseAbs().maxCoeff() > 0.0) conditions.push_back(row / largest);
      }
      Eigen::MatrixXd free = Eigen::MatrixXd::Identity(count, count);
      if (!conditions.empty()) {
        Eigen::MatrixXd matrix(static_cast<Eigen::Index>(conditions.size()), count);
        for (Eigen::Index r = 0; r < matrix.rows(); ++r)
          matrix.row(r) = conditions[index(r)].transpose();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> null(
            Eigen::MatrixXd(matrix.transpose() * matrix));
        const double largest = null.eigenvalues().maxCoeff();
        Eigen::Index free_count = 0;
        while (free_count < count && null.eigenvalues()[free_count] <= 1e-14 * largest)
          ++free_count;
        free = null.eigenvectors().leftCols(free_count);
      }
      for (const auto& combination : free.colwise()) {
        const Eigen::VectorXd motion = candidates * combination;
        if (motion.norm() > 0.0) found.push_back(motion / motion.norm());
      }
    }
    d.rigid_motions.resize(n, static_cast<Eigen::Index>(found.size()));
    for (std::size_t r = 0; r < found.size(); ++r)
      d.rigid_motions.col(static_cast<Eigen::Index>(r)) = found[r];
  }

  Mesh& mesh_;
  const Structure& s_;
  std::vector<Dof> dofs_, holds_;
  std::vector<int> parts_;  // union-find over nodes, then element boundaries
  Triplets mass_;
};

Mesh::Mesh(const Structure& structure) : structure_(structure) {
  validate(structure_);
  MeshBuilder(*this).build();
}

}  // namespace wheeltap::fem
