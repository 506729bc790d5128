#include "emulator/delaunay_interpolant.hpp"

#include <CGAL/Delaunay_triangulation.h>
#include <CGAL/Epick_d.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"

namespace wheeltap::emulator {
namespace {

using Eigen::Index;
using Geometry = CGAL::Epick_d<CGAL::Dynamic_dimension_tag>;
using Vertex = CGAL::Triangulation_vertex<Geometry, std::int32_t>;
using Simplex = CGAL::Triangulation_full_cell<Geometry, std::int32_t>;
using Triangulation = CGAL::Delaunay_triangulation<
    Geometry, CGAL::Triangulation_data_structure<CGAL::Dynamic_dimension_tag, Vertex, Simplex>>;

/// Tolerance in barycentric coordinates. A point outside a simplex by less than this tolerance
/// counts as a point on the face of the simplex.
constexpr double kOnFace = 1e-9;

std::string describe(const std::vector<Factor>& factors, std::span<const double> x) {
  std::string text = "(";
  for (std::size_t j = 0; j < x.size(); ++j) {
    char number[32];
    std::snprintf(number, sizeof number, "%.10g", x[j]);
    text += (j ? ", " : "") + factors[j].name + " = " + number;
  }
  return text + ")";
}

bool is_full_factorial(const RowMatrix& points) {
  double nodes = 1;
  for (Index j = 0; j < points.cols(); ++j)
    nodes *=
        static_cast<double>(std::set<double>(points.col(j).begin(), points.col(j).end()).size());
  return points.cols() > 1 && nodes == static_cast<double>(points.rows());
}

}  // namespace

DelaunayInterpolant::DelaunayInterpolant(std::vector<Factor> factors, const RowMatrix& points,
                                         RowMatrix values)
    : factors_(std::move(factors)), values_(std::move(values)) {
  check_factors(factors_);
  const std::size_t d = dimension();
  const auto runs = static_cast<std::size_t>(points.rows());
  const auto refuse = [](const std::string& why) {
    throw std::invalid_argument("Delaunay interpolation: " + why);
  };
  if (d > kMostFactors)
    refuse(std::to_string(d) + " factors, must be at most " + std::to_string(kMostFactors));
  if (points.cols() != static_cast<Index>(d) || values_.rows() != points.rows() ||
      values_.cols() < 1)
    refuse("sizes do not match: points " + std::to_string(points.rows()) + " x " +
           std::to_string(points.cols()) + " and values " + std::to_string(values_.rows()) + " x " +
           std::to_string(values_.cols()) + " in " + std::to_string(d) + " factors");
  if (runs < d + 1)
    refuse(std::to_string(runs) + " runs in " + std::to_string(d) + " factors; at least " +
           std::to_string(d + 1) + " are needed");
  if (!values_.allFinite()) refuse("a value is not finite");
  for (const Factor& factor : factors_) {
    low_.push_back(to_scale(factor.scale, factor.low()));
    range_.push_back(to_scale(factor.scale, factor.high()) - low_.back());
  }
  unit_points_.resize(points.rows(), points.cols());
  std::map<std::vector<double>, std::int32_t> run_at;
  for (Index i = 0; i < points.rows(); ++i) {
    const std::span<const double> x(points.row(i).data(), d);
    if (!emulator::contains(factors_, x))
      refuse("run " + std::to_string(i) + " at " + describe(factors_, x) +
             " lies outside the factors' ranges");
    Coordinates u;
    to_unit(x, u);
    if (!run_at.try_emplace({u, u + d}, static_cast<std::int32_t>(i)).second)
      refuse("the point " + describe(factors_, x) + " occurs twice");
    std::copy_n(u, d, unit_points_.row(i).data());
  }
  if (is_full_factorial(points))
    refuse("the runs are a full-factorial grid: use multilinear interpolation");

  Triangulation triangulation(static_cast<int>(d));
  {
    std::vector<Geometry::Point_d> sites;
    for (Index i = 0; i < points.rows(); ++i) {
      const double* const u = unit_points_.row(i).data();
      sites.emplace_back(static_cast<int>(d), u, u + d);
    }
    triangulation.insert(sites.begin(), sites.end());  // in a spatial order chosen by CGAL
  }
  for (auto vertex = triangulation.finite_vertices_begin();
       vertex != triangulation.finite_vertices_end(); ++vertex) {
    const auto& site = vertex->point();
    vertex->data() = run_at.at({site.cartesian_begin(), site.cartesian_end()});
  }
  if (triangulation.current_dimension() < static_cast<int>(d))
    refuse("all runs lie in a hyperplane");

  std::int32_t count = 0;
  for (auto cell = triangulation.full_cells_begin(); cell != triangulation.full_cells_end(); ++cell)
    cell->data() = triangulation.is_infinite(cell) ? -1 : count++;
  const auto all = static_cast<std::size_t>(count);
  simplices_.resize(all * (d + 1));
  neighbours_.resize(all * (d + 1));
  inverses_.resize(all * d * d);
  for (auto cell = triangulation.full_cells_begin(); cell != triangulation.full_cells_end();
       ++cell) {
    if (cell->data() < 0) continue;
    const auto s = static_cast<std::size_t>(cell->data());
    for (std::size_t i = 0; i <= d; ++i) {
      simplices_[s * (d + 1) + i] = cell->vertex(static_cast<int>(i))->data();
      neighbours_[s * (d + 1) + i] = cell->neighbor(static_cast<int>(i))->data();
    }
    const auto* const v = &simplices_[s * (d + 1)];
    RowMatrix edges(static_cast<Index>(d), static_cast<Index>(d));
    for (std::size_t i = 0; i < d; ++i)
      edges.col(static_cast<Index>(i)) =
          (unit_points_.row(v[i + 1]) - unit_points_.row(v[0])).transpose();
    Eigen::Map<RowMatrix>(&inverses_[s * d * d], static_cast<Index>(d), static_cast<Index>(d)) =
        edges.fullPivLu().inverse();
  }

  // About one simplex per cell. The search for a cell starts at the simplex of the previous cell.
  cells_a_side_ = std::max<std::size_t>(
      1,
      static_cast<std::size_t>(std::pow(static_cast<double>(all), 1.0 / static_cast<double>(d))));
  std::size_t cells = 1;
  for (std::size_t j = 0; j < d; ++j) cells *= cells_a_side_;
  hints_.assign(cells, 0);
  std::size_t simplex = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    Coordinates centre;
    for (std::size_t j = d, rest = cell; j-- > 0; rest /= cells_a_side_)
      centre[j] =
          (static_cast<double>(rest % cells_a_side_) + 0.5) / static_cast<double>(cells_a_side_);
    Weights lambda;
    (void)locate(centre, simplex, lambda);
    hints_[cell] = static_cast<std::int32_t>(simplex);
  }
}

void DelaunayInterpolant::to_unit(std::span<const double> x, Coordinates& u) const {
  for (std::size_t j = 0; j < x.size(); ++j)
    u[j] = (to_scale(factors_[j].scale, x[j]) - low_[j]) / range_[j];
}

/// Computes barycentric coordinates. After one refinement step, x = Σ λ_i v_i holds to rounding
/// even for thin simplices.
void DelaunayInterpolant::weights(std::size_t simplex, const Coordinates& u,
                                  Weights& lambda) const {
  const std::size_t d = dimension();
  const double* const inverse = &inverses_[simplex * d * d];
  const std::int32_t* const v = &simplices_[simplex * (d + 1)];
  const double* const origin = unit_points_.row(v[0]).data();
  Coordinates residual;
  for (std::size_t j = 0; j < d; ++j) residual[j] = u[j] - origin[j];
  std::fill_n(lambda, d + 1, 0.0);
  for (int pass = 0; pass < 2; ++pass) {
    Coordinates change;
    for (std::size_t i = 0; i < d; ++i) {
      change[i] = 0.0;
      for (std::size_t j = 0; j < d; ++j) change[i] += inverse[i * d + j] * residual[j];
      lambda[i + 1] += change[i];
    }
    for (std::size_t i = 0; i < d; ++i) {
      const double* const vertex = unit_points_.row(v[i + 1]).data();
      for (std::size_t j = 0; j < d; ++j) residual[j] -= change[i] * (vertex[j] - origin[j]);
    }
  }
  lambda[0] = 1.0;
  for (std::size_t i = 1; i <= d; ++i) lambda[0] -= lambda[i];
}

/// Steps from `simplex` to adjacent simplices, each time through the face beyond which x is
/// farthest. Returns false if x is outside the convex hull; `simplex` is then the last visited
/// simplex.
bool DelaunayInterpolant::locate(const Coordinates& u, std::size_t& simplex,
                                 Weights& lambda) const {
  const std::size_t d = dimension();
  // In exact arithmetic the search ends, because Delaunay triangulations are acyclic. If rounding
  // causes a cycle, every simplex is tested.
  const std::size_t patience = 100 + 20 * cells_a_side_ * (d + 1);
  for (std::size_t step = 0; step < patience; ++step) {
    weights(simplex, u, lambda);
    const double* const least = std::min_element(lambda, lambda + d + 1);
    if (*least >= -kOnFace) return true;
    const std::int32_t next =
        neighbours_[simplex * (d + 1) + static_cast<std::size_t>(least - lambda)];
    if (next < 0) return false;
    simplex = static_cast<std::size_t>(next);
  }
  for (simplex = 0; simplex < simplices(); ++simplex) {
    weights(simplex, u, lambda);
    if (*std::min_element(lambda, lambda + d + 1) >= -kOnFace) return true;
  }
  simplex = 0;
  return false;
}

std::size_t DelaunayInterpolant::hint(const Coordinates& u) const {
  std::size_t cell = 0;
  for (std::size_t j = 0; j < dimension(); ++j)
    cell = cell * cells_a_side_ +
           std::min(static_cast<std::size_t>(u[j] * static_cast<double>(cells_a_side_)),
                    cells_a_side_ - 1);
  return static_cast<std::size_t>(hints_[cell]);
}

void DelaunayInterpolant::evaluate(std::span<const double> x, std::span<double> out) const {
  if (x.size() != dimension() || out.size() != static_cast<std::size_t>(responses()))
    throw std::invalid_argument("a point has " + std::to_string(x.size()) + " values for " +
                                std::to_string(dimension()) + " factors, the output array has " +
                                std::to_string(out.size()) + " of " + std::to_string(responses()) +
                                " responses");
  Weights lambda;
  std::size_t simplex = 0;
  bool inside = emulator::contains(factors_, x);
  if (inside) {
    Coordinates u;
    to_unit(x, u);
    simplex = hint(u);
    inside = locate(u, simplex, lambda);
  }
  if (!inside)
    throw std::out_of_range("the point " + describe(factors_, x) +
                            " lies outside the convex hull of the runs");
  const std::int32_t* const v = &simplices_[simplex * (dimension() + 1)];
  std::fill(out.begin(), out.end(), 0.0);
  for (std::size_t i = 0; i <= dimension(); ++i) {
    const double* const y = values_.row(v[i]).data();
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += lambda[i] * y[k];
  }
}

bool DelaunayInterpolant::contains(std::span<const double> x) const {
  if (!emulator::contains(factors_, x)) return false;
  Coordinates u;
  to_unit(x, u);
  std::size_t simplex = hint(u);
  Weights lambda;
  return locate(u, simplex, lambda);
}

std::unique_ptr<const Interpolant> train_delaunay(Table& table, const TrainingOptions&) {
  return std::make_unique<DelaunayInterpolant>(table.factors, table.points, table.values);
}

}  // namespace wheeltap::emulator
