#include "fem/sections/section_analysis.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Vector2d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6x2 = Eigen::Matrix<double, 6, 2>;

/// Six-point rule, exact to degree 4 (Dunavant 1985, Int. J. Numer. Meth. Eng. 21:1129, table II).
struct Rule {
  std::array<Eigen::Vector3d, 6> at;  ///< barycentric
  std::array<double, 6> weight;       ///< share of the triangle's area
};
const Rule& rule() {
  static const Rule six = [] {
    Rule r;
    const std::array<double, 2> a = {0.44594849091596488632, 0.09157621350977074346};
    const std::array<double, 2> w = {0.22338158967801146570, 0.10995174365532186764};
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < 3; ++i) {
        Eigen::Vector3d b = Eigen::Vector3d::Constant(a[k]);
        b[static_cast<Eigen::Index>(i)] = 1.0 - 2.0 * a[k];
        r.at[3 * k + i] = b;
        r.weight[3 * k + i] = w[k];
      }
    return r;
  }();
  return six;
}

/// A quadratic triangle with straight sides: corners 0 to 2, then the midpoint opposite each
/// corner.
///   N_i = b_i (2 b_i - 1),  N_{3+i} = 4 b_j b_k,  b barycentric
class Triangle {
 public:
  Triangle(const std::array<Vector2d, 3>& p) : corners_(p) {
    const Vector2d u = p[1] - p[0], v = p[2] - p[0];
    const double twice = u.x() * v.y() - u.y() * v.x();
    area_ = 0.5 * twice;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector2d opposite = p[(i + 2) % 3] - p[(i + 1) % 3];
      gradients_.row(static_cast<Eigen::Index>(i)) << -opposite.y() / twice, opposite.x() / twice;
    }
  }
  [[nodiscard]] double area() const { return area_; }
  [[nodiscard]] Vector2d position(const Eigen::Vector3d& b) const {
    return b[0] * corners_[0] + b[1] * corners_[1] + b[2] * corners_[2];
  }
  [[nodiscard]] static Vector6 shapes(const Eigen::Vector3d& b) {
    Vector6 n;
    n << b[0] * (2.0 * b[0] - 1.0), b[1] * (2.0 * b[1] - 1.0), b[2] * (2.0 * b[2] - 1.0),
        4.0 * b[1] * b[2], 4.0 * b[2] * b[0], 4.0 * b[0] * b[1];
    return n;
  }
  [[nodiscard]] Matrix6x2 gradients(const Eigen::Vector3d& b) const {
    Matrix6x2 d;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      d.row(i) = (4.0 * b[i] - 1.0) * gradients_.row(i);
      d.row(3 + i) = 4.0 * (b[j] * gradients_.row(k) + b[k] * gradients_.row(j));
    }
    return d;
  }

 private:
  std::array<Vector2d, 3> corners_;
  double area_ = 0.0;
  Eigen::Matrix<double, 3, 2> gradients_;
};

/// Constants of the regions in the equations.
struct Moduli {
  double e, g, poisson;
};

/// ν/2 d for c = (c_y, c_z): in-plane deformation of the section if the curvature varies along x.
Vector2d in_plane(const Vector2d& c, const Vector2d& r, double poisson) {
  const double difference = r.x() * r.x() - r.y() * r.y(), product = 2.0 * r.x() * r.y();
  return 0.5 * poisson *
         Vector2d(c.x() * difference + c.y() * product, c.x() * product - c.y() * difference);
}

/// The problem in coordinates from the centroid in units of √A; all quantities are dimensionless.
class Scaled {
 public:
  Scaled(const TriangleMesh& mesh, std::span<const Region> regions, double reference_poisson)
      : mesh_(mesh), edges_(number_edges(mesh)), shear_factor_(2.0 * (1.0 + reference_poisson)) {
    for (const Region& r : regions)
      moduli_.push_back(
          {r.modulus, r.modulus * (1.0 + reference_poisson) / (1.0 + r.poisson), r.poisson});
    // Uses a point of the mesh as origin, because a distant origin would reduce the accuracy.
    origin_ = mesh.points[static_cast<std::size_t>(mesh.triangles[0][0])];
    double weight = 0.0, plain = 0.0;
    Vector2d first = Vector2d::Zero();
    each([&](const Triangle& t, const Moduli& m, std::size_t i) {
      plain += t.area();
      weight += m.e * t.area();
      first += m.e * t.area() * t.position(Eigen::Vector3d::Constant(1.0 / 3.0));
      mass_ += regions[static_cast<std::size_t>(mesh.regions[i])].density * t.area();
    });
    origin_ += first / weight;
    length_ = std::sqrt(plain);
    if (!(length_ > 0.0)) throw std::invalid_argument("mesh: has no area");
    moments_.setZero();
    each([&](const Triangle& t, const Moduli& m, std::size_t) {
      area_ += m.e * t.area();
      shear_area_ += m.g * t.area();
      for (std::size_t q = 0; q < 6; ++q) {
        const Vector2d r = t.position(rule().at[q]);
        moments_ += m.e * t.area() * rule().weight[q] * r * r.transpose();
      }
    });
    flexure_ = moments_.inverse();
  }

  SectionProperties run() {
    solve();
    double j = 0.0, work = 0.0, rest = 0.0;
    Vector2d along = Vector2d::Zero();  // ∫ e ω (y, z)
    Eigen::Matrix2d alpha = Eigen::Matrix2d::Zero();
    Vector2d moment = Vector2d::Zero();  // about x, from the stresses of a unit force along y, z
    each([&](const Triangle& t, const Moduli& m, std::size_t i) {
      const Eigen::Matrix<double, 6, 3> local = values_(nodes(i), Eigen::all);
      for (std::size_t q = 0; q < 6; ++q) {
        const double w = t.area() * rule().weight[q];
        const Vector2d r = t.position(rule().at[q]);
        const Eigen::Matrix<double, 2, 3> slope = t.gradients(rule().at[q]).transpose() * local;
        j += w * m.g * (slope.col(0) + Vector2d(-r.y(), r.x())).squaredNorm();
        Eigen::Matrix2d shear = slope.rightCols<2>();  // ∇ψ - ν/2 d, one column per force
        for (int k = 0; k < 2; ++k) shear.col(k) -= in_plane(flexure_.col(k), r, m.poisson);
        alpha += w * m.g * shear.transpose() * shear;
        moment += w * m.g * (r.x() * shear.row(1) - r.y() * shear.row(0)).transpose();
        const double warping = Triangle::shapes(rule().at[q]).dot(local.col(0));
        rest += w * m.e * warping;
        along += w * m.e * warping * r;
      }
    });
    moment /= shear_factor_;
    // ∫ e ω_D (y, z) = 0: [I_zz -I_yz; I_yz -I_yy] (z_D, y_D) = ∫ e ω (y, z).
    Eigen::Matrix2d system = moments_;
    system.col(1) *= -1.0;
    const Vector2d d = system.inverse() * along;
    const Vector2d trefftz(d.y(), d.x());
    const double mean = rest / area_;
    each([&](const Triangle& t, const Moduli& m, std::size_t i) {
      const Vector6 local = values_(nodes(i), 0);
      for (std::size_t q = 0; q < 6; ++q) {
        const Vector2d r = t.position(rule().at[q]);
        const double warping = Triangle::shapes(rule().at[q]).dot(local) - mean -
                               trefftz.y() * r.x() + trefftz.x() * r.y();
        work += t.area() * rule().weight[q] * m.e * warping * warping;
      }
    });
    const double l2 = length_ * length_, l4 = l2 * l2;
    alpha *= shear_area_ / (shear_factor_ * shear_factor_);
    return {.area = area_ * l2,
            .geometric_area = l2,
            .shear_area = shear_area_ * l2,
            .mass_per_length = mass_,
            .centroid = origin_,
            .second_moments = {moments_(1, 1) * l4, moments_(0, 0) * l4, moments_(0, 1) * l4},
            .torsion_constant = j * l4,
            .warping_constant = work * l4 * l2,
            .shear_centre = length_ * Vector2d(moment.y(), -moment.x()),
            .trefftz_centre = length_ * trefftz,
            .shear_flexibility = {alpha(0, 0), alpha(1, 1), alpha(0, 1)}};
  }

  [[nodiscard]] int unknowns() const {
    return static_cast<int>(mesh_.points.size() + edges_.ends.size());
  }

 private:
  template <class Visit>
  void each(const Visit& visit) const {
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      std::array<Vector2d, 3> p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = (mesh_.points[static_cast<std::size_t>(mesh_.triangles[i][k])] - origin_) / length_;
      visit(Triangle(p), moduli_[static_cast<std::size_t>(mesh_.regions[i])], i);
    }
  }

  [[nodiscard]] std::array<int, 6> nodes(std::size_t i) const {
    const auto& c = mesh_.triangles[i];
    const auto& e = edges_.of_triangle[i];
    const int n = static_cast<int>(mesh_.points.size());
    return {c[0], c[1], c[2], n + e[0], n + e[1], n + e[2]};
  }

  /// The values at node 0 are set to 0. The loads are in equilibrium, so the reaction at node 0 is
  /// 0.
  void solve() {
    const int n = unknowns();
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(21 * mesh_.triangles.size());
    Eigen::MatrixX3d loads = Eigen::MatrixX3d::Zero(n, 3);
    each([&](const Triangle& t, const Moduli& m, std::size_t i) {
      Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 3> load = Eigen::Matrix<double, 6, 3>::Zero();
      for (std::size_t q = 0; q < 6; ++q) {
        const double w = t.area() * rule().weight[q];
        const Vector2d r = t.position(rule().at[q]);
        const Matrix6x2 gradients = t.gradients(rule().at[q]);
        const Vector6 shapes = Triangle::shapes(rule().at[q]);
        stiffness += w * m.g * gradients * gradients.transpose();
        load.col(0) += w * m.g * gradients * Vector2d(r.y(), -r.x());
        for (int k = 0; k < 2; ++k) {
          const Vector2d c = flexure_.col(k);
          load.col(1 + k) += w * (m.g * gradients * in_plane(c, r, m.poisson) +
                                  shear_factor_ * m.e * c.dot(r) * shapes);
        }
      }
      const auto at = nodes(i);
      for (int a = 0; a < 6; ++a) {
        const int row = at[static_cast<std::size_t>(a)];
        loads.row(row) += load.row(a);
        for (int b = 0; b < 6; ++b) {
          const int column = at[static_cast<std::size_t>(b)];
          if (column > 0 && row >= column)
            entries.emplace_back(row - 1, column - 1, stiffness(a, b));
        }
      }
    });
    Eigen::SparseMatrix<double> matrix(n - 1, n - 1);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::CholmodSimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky(matrix);
    if (cholesky.info() != Eigen::Success)
      throw std::runtime_error("section_properties: the factorisation failed");
    values_ = Eigen::MatrixX3d::Zero(n, 3);
    const Eigen::MatrixX3d held = loads.bottomRows(n - 1);
    values_.bottomRows(n - 1) = cholesky.solve(held);
  }

  const TriangleMesh& mesh_;
  EdgeNumbers edges_;
  double shear_factor_;  // E_ref / G_ref
  std::vector<Moduli> moduli_;
  Vector2d origin_;      // centroid [m]
  double length_ = 1.0;  // √A [m]
  double area_ = 0.0, shear_area_ = 0.0, mass_ = 0.0;
  Eigen::Matrix2d moments_, flexure_;
  Eigen::MatrixX3d values_;  // ω, ψ_y, ψ_z at the nodes
};

/// Number of rings around re-entrant corners in the first mesh.
constexpr int kRings = 3;

int nodes_of(const TriangleMesh& mesh) {
  return static_cast<int>(mesh.points.size() + number_edges(mesh).ends.size());
}

SectionErrors change(const SectionProperties& coarse, const SectionProperties& fine) {
  const auto share = [](double a, double b, double least) {
    return std::abs(a - b) / std::max(std::abs(b), least);
  };
  const SecondMoments& i = fine.second_moments;
  const double polar = i.yy + i.zz;
  const ShearFlexibility &a = coarse.shear_flexibility, &b = fine.shear_flexibility;
  const double gyration = std::sqrt(polar / fine.area);
  return {.torsion_constant = share(coarse.torsion_constant, fine.torsion_constant, 0.0),
          .warping_constant = share(coarse.warping_constant, fine.warping_constant,
                                    1e-4 * polar * polar / fine.area),
          .shear_centre = (coarse.shear_centre - fine.shear_centre).norm() /
                          std::max(fine.shear_centre.norm(), 0.1 * gyration),
          .shear_flexibility = std::max({share(a.yy, b.yy, 0.0), share(a.zz, b.zz, 0.0),
                                         share(a.yz, b.yz, 0.05 * std::sqrt(b.yy * b.zz))})};
}

/// True if the last two changes, extrapolated to the largest allowed mesh, stay far above the
/// tolerance. The solution on this mesh would take most of a minute without convergence.
bool cannot_converge(double before, double now, int nodes, const SectionAnalysisOptions& options) {
  constexpr double kFar = 10.0;
  const double left = std::floor(std::log(options.most_nodes / static_cast<double>(nodes)) /
                                 std::log(4.0));  // number of halvings of the element size
  return now * std::pow(std::min(now / before, 1.0), left) > kFar * options.tolerance;
}

}  // namespace

bool SectionAnalysis::finite() const {
  const SectionProperties& p = properties;
  const SecondMoments& i = p.second_moments;
  const ShearFlexibility& s = p.shear_flexibility;
  return std::ranges::all_of(
      std::array{p.area, p.geometric_area, p.shear_area, p.mass_per_length, p.centroid.x(),
                 p.centroid.y(), i.yy, i.zz, i.yz, p.torsion_constant, p.warping_constant,
                 p.shear_centre.x(), p.shear_centre.y(), p.trefftz_centre.x(), p.trefftz_centre.y(),
                 s.yy, s.zz, s.yz},
      [](double x) { return std::isfinite(x); });
}

double SectionErrors::largest() const {
  return std::max({torsion_constant, warping_constant, shear_centre, shear_flexibility});
}

PrincipalAxes principal_axes(const SecondMoments& m) {
  const double mean = 0.5 * (m.yy + m.zz), half = 0.5 * (m.yy - m.zz);
  const double radius = std::hypot(half, m.yz);
  // About an axis at angle θ from y: I = mean + half cos 2θ - I_yz sin 2θ.
  double angle = radius <= 1e-9 * mean ? 0.0 : 0.5 * std::atan2(-m.yz, half);
  if (angle < -0.5 * kPi + 1e-9) angle += kPi;  // rounding errors decide between -π/2 and π/2
  return {mean + radius, mean - radius, angle};
}

SectionProperties section_properties(const TriangleMesh& mesh, std::span<const Region> regions,
                                     double reference_poisson) {
  if (mesh.triangles.empty()) throw std::invalid_argument("mesh: has no triangles");
  const int last = *std::ranges::max_element(mesh.regions);
  if (last >= static_cast<int>(regions.size()))
    throw std::invalid_argument("regions: there are " + std::to_string(regions.size()) +
                                ", but a triangle has region index " + std::to_string(last));
  return Scaled(mesh, regions, reference_poisson).run();
}

SectionAnalysis analyse_section(TriangleMesh mesh, std::span<const Region> regions,
                                const SectionAnalysisOptions& options) {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) + ": must be " +
                                allowed);
  };
  if (!(options.tolerance > 0.0)) refuse("tolerance", options.tolerance, "positive");
  if (options.least_levels < 2) refuse("least_levels", options.least_levels, "at least 2");
  if (!(options.reference_poisson > -1.0 && options.reference_poisson <= 0.5))
    refuse("reference_poisson", options.reference_poisson, "above -1 and at most 0.5");
  std::vector<double> shares = split_shares(mesh);
  for (int rings = kRings; rings > 0; --rings) {
    std::vector<double> more = shares;
    TriangleMesh finer = ringed(mesh, more, rings);
    // Uses fewer rings if too few nodes would be left for two refinements.
    if (16.0 * nodes_of(finer) > options.most_nodes) continue;
    mesh = std::move(finer);
    shares = std::move(more);
    break;
  }
  SectionAnalysis result{};
  result.errors = {INFINITY, INFINITY, INFINITY, INFINITY};
  double before = INFINITY;
  while (true) {
    const int nodes = nodes_of(mesh);
    result.levels.push_back(
        {.triangles = static_cast<int>(mesh.triangles.size()),
         .nodes = nodes,
         .properties = section_properties(mesh, regions, options.reference_poisson)});
    result.properties = result.levels.back().properties;
    const std::size_t n = result.levels.size();
    if (n > 1)
      result.errors = change(result.levels[n - 2].properties, result.levels[n - 1].properties);
    const double now = result.errors.largest();
    result.converged = result.finite() && now <= options.tolerance;
    const bool enough = static_cast<int>(n) >= options.least_levels;
    if (!result.finite() || (result.converged && enough) || 4.0 * nodes > options.most_nodes) break;
    if (n > 2 && cannot_converge(before, now, nodes, options)) break;
    before = now;
    mesh = refined(mesh, shares);
  }
  return result;
}

}  // namespace wheeltap::fem
