#include "fem/structures/mesh.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/index.hpp"
#include "fem/structures/member_motions.hpp"

namespace wheeltap::fem {
namespace detail {

OwnMotions own_motions(const MemberFrame& frame, const Motions& first, const Motions& second) {
  OwnMotions own;
  for (std::size_t end = 0; end < 2; ++end) {
    const Motions& global = end == 0 ? first : second;
    for (std::size_t k = 0; k < 3; ++k) {
      RowSum along, about;
      for (std::size_t g = 0; g < 3; ++g) {
        along.add(frame.axes[k][g], global[g]);
        about.add(frame.axes[k][g], global[3 + g]);
      }
      own[end][k] = along.row();
      own[end][3 + k] = about.row();
    }
  }
  return own;
}

std::array<SparseRow, 4> plane_motions(const OwnMotions& own, bool along_z) {
  if (!along_z) return {own[0][1], own[0][5], own[1][1], own[1][5]};
  std::array<SparseRow, 4> out = {own[0][2], own[0][4], own[1][2], own[1][4]};
  for (const std::size_t turn : {std::size_t{1}, std::size_t{3}})
    for (double& c : out[turn].coefficients) c = -c;
  return out;
}

}  // namespace detail

using detail::Motions;
using detail::RowSum;

Flexure<double> flexure(const Member::Piece& piece, double length, bool along_z,
                        bool rotary_inertia) {
  const MemberSection& s = piece.section;
  const double shear_area =
      (along_z ? s.shear_coefficient_z : s.shear_coefficient_y) * piece.section.area;
  const double second_moment = along_z ? s.second_moment_y : s.second_moment_z;
  return {.length = length,
          .bending_stiffness = piece.material.young * second_moment,
          .shear_stiffness = piece.material.shear_modulus() * shear_area,
          .mass = piece.material.density * s.area,
          .rotary = rotary_inertia ? piece.material.density * second_moment : 0.0};
}

double Mesh::member_length(int member) const {
  return frames_[index(member)].length;
}

int Mesh::element_at(int member, double s) const {
  const std::vector<double>& places = boundaries_[index(member)];
  const double length = places.back(), slack = 1e-9 * length;
  if (!(s >= -slack && s <= length + slack))
    throw std::invalid_argument("s = " + std::to_string(s) + ": must be in [0, " +
                                std::to_string(length) + "], the length of member \"" +
                                structure_.members[index(member)].name + "\"");
  const auto after = std::upper_bound(places.begin() + 1, places.end() - 1, s + slack);
  return first_element(member) + static_cast<int>(after - places.begin()) - 1;
}

std::array<SparseRow, 4> Mesh::bending_motions(int element, bool along_z) const {
  const int m = elements_[index(element)].member;
  const std::size_t e = index(element - first_element(m));
  const auto& stations = station_motions_[index(m)];
  return detail::plane_motions(detail::own_motions(frames_[index(m)], stations[e], stations[e + 1]),
                               along_z);
}

const SparseRow& Mesh::motion(int node, Direction direction) const {
  return node_motions_[index(node)][static_cast<std::size_t>(direction)];
}

SparseRow Mesh::motion(int member, double s, Direction direction) const {
  return motion(member, s, unit_vector(static_cast<std::size_t>(direction) % 3),
                is_rotation(direction));
}

SparseRow Mesh::motion(int member, double s, const Vector3& wanted, bool rotation) const {
  const int number = element_at(member, s);
  const Element& element = elements_[index(number)];
  const MemberFrame& frame = frames_[index(member)];
  const std::size_t e = index(number - first_element(member));
  const double l = element.to - element.from;
  const double xi = std::clamp((s - element.from) / l, 0.0, 1.0);
  const Member::Piece& piece = structure_.members[index(member)].pieces[index(element.piece)];
  RowSum sum;
  const auto add = [&](double factor, std::size_t end, std::size_t own, bool about) {
    const Motions& global = station_motions_[index(member)][e + end];
    for (std::size_t g = 0; g < 3; ++g)
      sum.add(factor * frame.axes[own][g], global[(about ? 3 : 0) + g]);
  };
  // Motions along and about the member's x axis are linear; the shape functions give the others.
  const double x = dot(wanted, frame.axes[0]);
  add(x * (1.0 - xi), 0, 0, rotation);
  add(x * xi, 1, 0, rotation);
  for (const bool along_z : {true, false}) {
    if (!along_z && structure_.dimension == 2) continue;
    const TimoshenkoElement<double> bending(flexure(piece, l, along_z, structure_.rotary_inertia));
    const Eigen::Vector4d shape = rotation ? bending.rotation_row(xi) : bending.deflection_row(xi);
    const std::size_t deflects = along_z ? 2 : 1, turns = along_z ? 1 : 2;
    const double sign = along_z ? -1.0 : 1.0;  // w' = sign θ
    const double share =
        rotation ? sign * dot(wanted, frame.axes[turns]) : dot(wanted, frame.axes[deflects]);
    for (std::size_t end = 0; end < 2; ++end) {
      const auto k = static_cast<Eigen::Index>(2 * end);
      add(share * shape[k], end, deflects, false);
      add(share * sign * shape[k + 1], end, turns, true);
    }
  }
  return sum.row();
}

}  // namespace wheeltap::fem
