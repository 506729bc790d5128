// The possible locations of one kind of defect, concatenated along one line.
#pragma once

#include <string>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::identification {

/// Maps one number x in [0, length()) to a location, because the engine requires scalars. For a
/// beam, x is the location. For a structure, the allowed members are concatenated, each with a
/// length proportional to its prior weight. Each member, joint, storey or substructure is a stretch
/// of the line. With a uniform prior of x, each member then has its prior weight. Probabilities are
/// reported per cell: an element, or a whole joint.
class SiteLine {
 public:
  struct Stretch {
    int site;
    std::string name;   ///< name of the site (member, joint …)
    double start, end;  ///< positions of the start and the end on the line
    double size;        ///< length [m] of a member; 0 for a point
    int first_cell;     ///< index of the site's first cell
  };
  /// The location of a point on the line.
  struct Spot {
    int stretch;
    int site;
    double s;  ///< [m] from the member's first end; 0 for a point
    /// Length [m] of a defect, centred at the location; 0 for a point or a whole element.
    double extent = 0.0;
  };

  SiteLine() = default;
  [[nodiscard]] static SiteLine of_beam(const fem::Beam& beam);
  /// A line of members. Without weights, lengths on the line are in metres; with weights, lengths
  /// are proportional to the weights.
  [[nodiscard]] static SiteLine of_members(const fem::Mesh& mesh, const std::vector<int>& members,
                                           const std::vector<double>& weights = {});
  /// A line of joints, storeys or substructures, with one stretch for each.
  [[nodiscard]] static SiteLine of_points(const std::vector<int>& sites,
                                          const std::vector<std::string>& names,
                                          const std::vector<double>& weights = {});

  [[nodiscard]] bool empty() const { return stretches_.empty(); }
  /// True if the line is a beam, on which x alone is reported as the location.
  [[nodiscard]] bool is_beam() const { return is_beam_; }
  [[nodiscard]] double length() const { return stretches_.back().end; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] int cells() const { return static_cast<int>(bounds_.size()) - 1; }
  /// Start of cell c on the line; for c = `cells()`, the end of the line.
  [[nodiscard]] double cell_start(int c) const { return bounds_[static_cast<std::size_t>(c)]; }
  /// The cell that contains x; near a boundary, x is rounded as in Beam::element_at. Throws
  /// std::invalid_argument outside the line.
  [[nodiscard]] int cell_at(double x) const;
  [[nodiscard]] int stretch_of_cell(int c) const;
  /// Returns the location of the point with the coordinate x on the line. Throws the exceptions of
  /// `cell_at`.
  [[nodiscard]] Spot spot(double x) const;
  /// Inverse of `spot`; NaN if the site is not on the line.
  [[nodiscard]] double x_of(int site, double s) const;

 private:
  void add_stretch(int site, std::string name, double size, double extent,
                   const std::vector<double>& boundaries);

  std::vector<Stretch> stretches_;
  std::vector<double> bounds_ = {0.0};
  bool is_beam_ = false;
};

}  // namespace wheeltap::identification
