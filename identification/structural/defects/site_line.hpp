// Where defects of one kind may be, laid end to end along one line.
#pragma once

#include <string>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::identification {

/// The engine places a defect by one number x in [0, length()). On a beam that is its own place; on
/// a structure the members that a case allows follow each other, each as long as its prior weight
/// says, and so do joints, storeys and substructures, one a stretch. A location prior that is
/// uniform on the line is then that of the weights. Cells are what probabilities are told of: an
/// element, or a whole joint.
class SiteLine {
 public:
  struct Stretch {
    int site;           ///< index of the member, node, link or substructure
    std::string name;   ///< of it
    double start, end;  ///< on the line
    double size;        ///< m, of a member; 0 of a point
    int first_cell;     ///< the first of its cells
  };
  /// Where a number on the line is.
  struct Spot {
    int stretch;
    int site;
    double s;  ///< m from the member's first end; 0 of a point
    /// Length [m] that a defect there covers, about the spot; 0 where it is an element's, or none.
    double extent = 0.0;
  };

  SiteLine() = default;
  [[nodiscard]] static SiteLine of_beam(const fem::Beam& beam);
  /// Without weights, in metres: as likely anywhere. With them, as likely in members as they say.
  [[nodiscard]] static SiteLine of_members(const fem::Mesh& mesh, const std::vector<int>& members,
                                           const std::vector<double>& weights = {});
  /// Joints, storeys: one stretch each.
  [[nodiscard]] static SiteLine of_points(const std::vector<int>& sites,
                                          const std::vector<std::string>& names,
                                          const std::vector<double>& weights = {});

  [[nodiscard]] bool empty() const { return stretches_.empty(); }
  /// Of a beam, told by its place alone.
  [[nodiscard]] bool is_beam() const { return is_beam_; }
  [[nodiscard]] double length() const { return stretches_.back().end; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] int cells() const { return static_cast<int>(bounds_.size()) - 1; }
  /// Where cell c begins on the line; of `cells()`, its end.
  [[nodiscard]] double cell_start(int c) const { return bounds_[static_cast<std::size_t>(c)]; }
  /// The cell of x, as Beam::element_at counts. Throws std::invalid_argument outside the line.
  [[nodiscard]] int cell_at(double x) const;
  [[nodiscard]] int stretch_of_cell(int c) const;
  /// Throws as `cell_at`.
  [[nodiscard]] Spot spot(double x) const;
  /// The inverse of `spot`; NaN where the site is none of the line's.
  [[nodiscard]] double x_of(int site, double s) const;

 private:
  void add_stretch(int site, std::string name, double size, double extent,
                   const std::vector<double>& boundaries);

  std::vector<Stretch> stretches_;
  std::vector<double> bounds_ = {0.0};
  bool is_beam_ = false;
};

}  // namespace wheeltap::identification
