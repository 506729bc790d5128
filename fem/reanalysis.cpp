#include "fem/reanalysis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fem/assembly.hpp"
#include "fem/defect.hpp"
#include "fem/full_spectrum.hpp"
#include "fem/secular.hpp"

namespace wheeltap::fem {
namespace {

using detail::kLanes;
using detail::Pack;
using detail::Secular;
using detail::SecularSteps;

/// Added supports may raise root i as far as intact eigenvalue i + their number; this many are
/// served by a short sum over the near modes, more by the sum over all.
constexpr int kFewSupports = 8;
/// Modes above kFarRatio · cap enter through the Chebyshev series.
constexpr double kFarRatio = 3.0;
/// Truncation of that series, relative.
constexpr double kSeriesError = 1e-17;
/// Predicted relative error in λ at which a root is accepted.
constexpr double kRootError = 2e-13;
/// Evaluations after which a root is left to bisection by the inertia count.
constexpr int kPatience = 20;
/// Rigid supports whose rows nearly depend on each other (relative norm left) count once.
constexpr double kDependentRow = 1e-9;
/// A spring stiffer than this multiple of the beam's own stiffness at its place is rigid.
constexpr double kRigidSpring = 1e14;
/// Half the difference, in elements, by which a support's slope is taken.
constexpr double kSupportStep = 1e-3;

std::size_t index(Eigen::Index i) {
  return static_cast<std::size_t>(i);
}

void require_size(const char* name, std::size_t size, std::size_t expected) {
  if (size != 0 && size != expected)
    throw std::invalid_argument(std::string(name) + " has size " + std::to_string(size) +
                                ": must be empty or " + std::to_string(expected));
}

/// The range of λ and how F is summed over it.
struct Window {
  int near = 0;
  int terms = 0;
  double cap = 0.0;
  std::vector<double> series;   // terms × (modes - near)
  std::vector<int> series_end;  // per term: modes beyond do not matter

  /// 1/(ξ - x) = (1 + 2 Σ_p ρ^-p T_p(x)) / √(ξ² - 1), ρ = ξ + √(ξ² - 1), for |x| <= 1 < ξ.
  Window(const std::vector<double>& eigenvalues, int modes, int highest_root) {
    if (highest_root + 2 >= modes) {
      near = std::max(modes, 2);
      cap = std::numeric_limits<double>::infinity();
      return;
    }
    cap = eigenvalues[index(highest_root)];
    near = highest_root + 2;
    while (near < modes && eigenvalues[index(near)] < kFarRatio * cap) ++near;
    const int far = modes - near;
    if (far == 0) return;
    const auto ratio = [&](int j) {
      const double xi = 2.0 * eigenvalues[index(near + j)] / cap - 1.0;
      return std::pair{xi, std::sqrt(xi * xi - 1.0)};
    };
    const auto [xi0, root0] = ratio(0);
    terms = 2 + static_cast<int>(-std::log(kSeriesError) / std::log(xi0 + root0));
    series.resize(index(terms) * index(far));
    series_end.assign(index(terms), 0);
    for (int j = 0; j < far; ++j) {
      const auto [xi, root] = ratio(j);
      double weight = 2.0 / cap / root;
      for (int p = 0; p < terms; ++p) {
        series[index(p) * index(far) + index(j)] = weight;
        if (weight * cap > kSeriesError) series_end[index(p)] = j + 1;
        weight *= (p == 0 ? 2.0 : 1.0) / (xi + root);
      }
    }
  }
};

}  // namespace

struct Reanalysis::Impl {
  Beam beam;
  TimoshenkoElement<double> element;
  int wanted;                        // lowest modes that may be asked for
  int modes;                         // all modes of the mesh, n
  int rigid;                         // of them at λ = 0
  std::size_t stride;                // n, and at least two
  std::vector<double> eigenvalues;   // stride
  std::vector<double> compliances;   // 1 / (λ_j + λ_ref), λ_ref the lowest elastic eigenvalue
  std::vector<double> frequencies;   // wanted
  std::vector<double> element_rows;  // 2 elements × stride: b·φ_j, a·φ_j of each element
  std::vector<double> element_flexibility;  // 2 elements: Σ_j c_j² / λ_j
  std::vector<double> dof_rows;             // 2 nodes × stride: φ_j at each degree of freedom
  std::vector<Window> windows;              // for no, few, and any number of supports

  Impl(const Beam& b, int wanted_modes) : beam(b), element((validate(b), b)), wanted(wanted_modes) {
    const FullSpectrum spectrum = full_spectrum(beam);
    modes = static_cast<int>(spectrum.eigenvalues.size());
    rigid = spectrum.rigid_body_modes;
    if (wanted < 1 || wanted > modes)
      throw std::invalid_argument("modes = " + std::to_string(wanted) + ": must be between 1 and " +
                                  std::to_string(modes) +
                                  ", the free degrees of freedom of the mesh");
    stride = index(std::max(modes, 2));
    eigenvalues.resize(stride);
    for (int j = 0; j < modes; ++j)
      eigenvalues[index(j)] = static_cast<double>(spectrum.eigenvalues[j]);
    // A beam of one mode gets a second one, out of reach and unmoved by any defect.
    if (modes < 2) eigenvalues[1] = 1e6 * eigenvalues[0] + 1.0;
    for (const double value : eigenvalues)
      compliances.push_back(1.0 / (value + eigenvalues[index(std::min(rigid, modes - 1))]));
    for (int j = 0; j < wanted; ++j)
      frequencies.push_back(std::sqrt(eigenvalues[index(j)]) / (2.0 * std::numbers::pi));

    const TimoshenkoElement<long double> exact(beam);
    const auto bending = exact.bending(), shear = exact.shear();
    element_rows.assign(2 * index(beam.elements) * stride, 0.0);
    element_flexibility.assign(2 * index(beam.elements), 0.0);
    dof_rows.assign(2 * index(beam.nodes()) * stride, 0.0);
    for (int j = 0; j < modes; ++j) {
      const auto shape = spectrum.shapes.col(j);
      for (Eigen::Index dof = 0; dof < shape.size(); ++dof)
        dof_rows[index(dof) * stride + index(j)] = static_cast<double>(shape[dof]);
      if (j < rigid) continue;  // rigid motions do not strain elements: exactly zero
      for (int e = 0; e < beam.elements; ++e)
        for (const bool is_shear : {false, true}) {
          const std::size_t r = 2 * index(e) + is_shear;
          const auto c =
              static_cast<double>((is_shear ? shear : bending).dot(shape.segment<4>(2 * e)));
          element_rows[r * stride + index(j)] = c;
          element_flexibility[r] += c * c / eigenvalues[index(j)];
        }
    }
    for (const int supports : {0, kFewSupports, modes})
      windows.emplace_back(eigenvalues, modes, std::min(wanted - 1 + supports, modes));
  }
};

struct Reanalysis::Workspace::Impl {
  std::vector<std::pair<int, double>> lost;  // element, fraction of stiffness lost
  std::vector<int> support_column;           // of each support; -1 where it has none
  std::vector<Damage> damages;
  bool need_coordinates = false;  // of modes, for more than gradients of the damages
  std::vector<double> columns, inverse_gamma, flexibility, product, pairs;
  std::vector<double> eta, coordinates, strains, point_rows;  // one mode and what is seen of it
  std::vector<double> lambda;                                 // roots
  Defects moved;                                              // with one defect aside
  std::vector<double> before, after;                          // frequencies on either side of it
  std::vector<Pack> packs;
  detail::SecularScratch scratch;  // parts of `packs`
  Secular secular;
  int damage_columns = 0, support_columns = 0;
  int rigid = 0;  // rigid-body modes that the defects leave
  double largest_loss = 0.0;
  double added_stiffness =
      0.0;  // Σ k Σ_j c_j²: bounds the rise of any eigenvalue; infinite if rigid

  /// Shares out the memory that `secular` needs.
  void reserve() {
    const std::size_t m = index(secular.columns), rows = index(secular.rows());
    const std::size_t pairs_count = index(secular.chunks()) * detail::kPairChunk;
    const std::size_t needed = 2 * rows + 2 * pairs_count + 4 * m;
    if (packs.size() < needed) packs.resize(needed);
    Pack* next = packs.data();
    const auto take = [&next](std::size_t count) { return std::exchange(next, next + count); };
    scratch.weights = take(rows);
    scratch.slopes = take(rows);
    scratch.matrix = take(pairs_count);
    scratch.slope_matrix = take(pairs_count);
    scratch.forward = take(2 * m);
    scratch.forces = take(2 * m);
    if (pairs.size() < pairs_count * rows) pairs.resize(pairs_count * rows);
  }
};

Reanalysis::Workspace::Workspace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reanalysis::Workspace::Workspace(Workspace&&) noexcept = default;
Reanalysis::Workspace& Reanalysis::Workspace::operator=(Workspace&&) noexcept = default;
Reanalysis::Workspace::~Workspace() = default;

Reanalysis::Reanalysis(const Beam& beam, int modes)
    : impl_(std::make_unique<const Impl>(beam, modes)) {}
Reanalysis::~Reanalysis() = default;
Reanalysis::Reanalysis(Reanalysis&&) noexcept = default;
Reanalysis& Reanalysis::operator=(Reanalysis&&) noexcept = default;

int Reanalysis::modes() const {
  return impl_->wanted;
}
int Reanalysis::rigid_body_modes() const {
  return impl_->rigid;
}
const Beam& Reanalysis::beam() const {
  return impl_->beam;
}
std::span<const double> Reanalysis::intact_frequencies_hz() const {
  return impl_->frequencies;
}

Reanalysis::Workspace Reanalysis::make_workspace() const {
  return Workspace(std::make_unique<Workspace::Impl>());
}

/// One call: puts the defects into the workspace, then follows each root.
struct Reanalysis::Solver {
  const Reanalysis::Impl& intact;
  Workspace::Impl& work;
  const detail::SecularKernel& kernel = detail::secular_kernel();

  /// One root being refined in one lane.
  struct Search {
    int root = -1;   // 0-based index among the damaged eigenvalues; -1 when idle
    double z = 0.0;  // where the secular function is evaluated next
    double low = 0.0, high = 0.0;
    double last_step = 0.0;
    int evaluations = 0;
    bool settled = false;  // at the root: one more evaluation there gives the mode
  };

  const Results* results = nullptr;  // where modes are wanted too

  double* add_column(double inverse_gamma) {
    const std::size_t m = work.inverse_gamma.size();
    work.inverse_gamma.push_back(inverse_gamma);
    work.flexibility.push_back(0.0);
    if (work.columns.size() < (m + 1) * intact.stride) work.columns.resize((m + 1) * intact.stride);
    return work.columns.data() + m * intact.stride;
  }

  void set_damages(std::span<const Damage> damages) {
    work.lost.clear();
    for (const Damage& d : damages) {
      validate(intact.beam, d);
      const int e = intact.beam.element_at(d.location);
      const auto same = std::find_if(work.lost.begin(), work.lost.end(),
                                     [e](const auto& l) { return l.first == e; });
      if (same == work.lost.end())
        work.lost.emplace_back(e, d.reduction);
      else
        same->second += d.reduction - same->second * d.reduction;
    }
    std::sort(work.lost.begin(), work.lost.end());  // the order of the damages must not matter
    work.largest_loss = 0.0;
    for (const auto& [e, loss] : work.lost) {
      if (loss == 0.0) continue;
      work.largest_loss = std::max(work.largest_loss, loss);
      for (std::size_t r = 2 * index(e); r < 2 * index(e) + 2; ++r) {
        double* column = add_column(1.0 / loss);
        std::copy_n(intact.element_rows.data() + r * intact.stride, intact.stride, column);
        work.flexibility.back() = intact.element_flexibility[r];
      }
    }
    work.damage_columns = static_cast<int>(work.inverse_gamma.size());
  }

  void set_supports(std::span<const SpringSupport> supports) {
    work.added_stiffness = 0.0;
    work.support_column.assign(supports.size(), -1);
    for (const bool rigid_ones : {false, true})
      for (std::size_t i = 0; i < supports.size(); ++i) {
        if (!rigid_ones) validate(intact.beam, supports[i]);
        const std::size_t column = work.inverse_gamma.size();
        add_support(supports[i], rigid_ones);
        if (work.inverse_gamma.size() > column) work.support_column[i] = static_cast<int>(column);
      }
    work.support_columns = static_cast<int>(work.inverse_gamma.size()) - work.damage_columns;
  }

  /// Σ_j a_j b_j / (λ_j + λ_ref): a compliance that exists for free beams too.
  double compliance(const double* a, const double* b) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < intact.stride; ++j) sum += a[j] * b[j] * intact.compliances[j];
    return sum;
  }

  /// row[j] = N(x) · φ_j; returns the compliance of its terms, had they not cancelled.
  double motion(double at, bool rotation, double* row) const {
    const MotionRow<double> motion = motion_row(intact.beam, intact.element, at, rotation);
    std::fill_n(row, intact.stride, 0.0);
    double uncancelled = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double coefficient = motion.coefficients[i];
      if (coefficient == 0.0) continue;
      const double* dof = intact.dof_rows.data() + index(motion.first_dof + i) * intact.stride;
      for (std::size_t j = 0; j < intact.stride; ++j) row[j] += coefficient * dof[j];
      uncancelled += coefficient * coefficient * compliance(dof, dof);
    }
    return uncancelled;
  }

  void add_support(const SpringSupport& s, bool rigid_ones) {
    const MotionRow<double> motion =
        motion_row(intact.beam, intact.element, s.location, s.rotation);
    double* c = add_column(0.0);
    const std::size_t n = intact.stride;
    std::fill_n(c, n, 0.0);
    double uncancelled = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double coefficient = motion.coefficients[i];
      if (coefficient == 0.0) continue;
      const double* row = intact.dof_rows.data() + index(motion.first_dof + i) * n;
      for (std::size_t j = 0; j < n; ++j) c[j] += coefficient * row[j];
      uncancelled += coefficient * coefficient * compliance(row, row);
    }
    const double own = compliance(c, c);
    const bool rigid = s.stiffness * own > kRigidSpring;
    bool keep = rigid == rigid_ones && own > 1e-20 * uncancelled;
    if (keep && rigid) {
      // Only the span of rigid rows matters: orthonormal rows keep it well conditioned.
      const std::size_t mine = work.inverse_gamma.size() - 1;
      for (std::size_t other = index(work.damage_columns); other < mine; ++other) {
        if (work.inverse_gamma[other] != 0.0) continue;
        const double* q = work.columns.data() + other * n;
        const double part = compliance(c, q);
        for (std::size_t j = 0; j < n; ++j) c[j] -= part * q[j];
      }
      const double left = compliance(c, c);
      keep = left > kDependentRow * kDependentRow * own;
      const double scale = 1.0 / std::sqrt(left);
      for (std::size_t j = 0; j < n; ++j) c[j] *= scale;
    }
    if (!keep) {
      work.inverse_gamma.pop_back();
      work.flexibility.pop_back();
      return;
    }
    double sum = 0.0;
    for (std::size_t j = 0; j < n; ++j) sum += c[j] * c[j];
    work.flexibility.back() = compliance(c, c);
    if (rigid) {
      work.added_stiffness = std::numeric_limits<double>::infinity();
    } else {
      work.inverse_gamma.back() = -1.0 / s.stiffness;
      work.added_stiffness += s.stiffness * sum;
    }
  }

  void set(std::span<const Damage> damages, std::span<const SpringSupport> supports, int count) {
    work.inverse_gamma.clear();
    work.flexibility.clear();
    set_damages(damages);
    set_supports(supports);
    work.rigid = rigid_body_freedom(intact.beam, supports);
    const auto held = std::count(work.inverse_gamma.begin(), work.inverse_gamma.end(), 0.0);
    const int available = std::min(intact.wanted, intact.modes - static_cast<int>(held));
    if (count > available)
      throw std::invalid_argument("modes = " + std::to_string(count) + ": must be at most " +
                                  std::to_string(available) + " here");
    if (work.secular.columns = static_cast<int>(work.inverse_gamma.size());
        work.secular.columns > 0)
      prepare();
  }

  void prepare() {
    Secular& s = work.secular;
    const std::size_t which = work.support_columns == 0              ? 0
                              : work.support_columns <= kFewSupports ? 1
                                                                     : 2;
    const Window& window = intact.windows[which];
    s.near = window.near;
    s.terms = window.terms;
    s.cap = window.cap;
    s.eigenvalues = intact.eigenvalues.data();
    s.stride = intact.stride;
    s.c = work.columns.data();
    s.inverse_gamma = work.inverse_gamma.data();
    work.reserve();
    work.product.resize(intact.stride);
    s.pairs = work.pairs.data();
    kernel.fill_pairs(s, static_cast<int>(intact.stride), window.series.data(),
                      window.series_end.data(), work.product.data(), work.pairs.data());
  }

  Search begin(int root) const {
    Search search;
    search.root = root;
    const int lifted = root + work.support_columns;
    const double own = intact.eigenvalues[index(root)];
    const double top = intact.eigenvalues[index(intact.modes - 1)];
    const double floor =
        1e-20 * intact.eigenvalues[index(std::min(intact.rigid, intact.modes - 1))];
    search.low = std::max((1.0 - work.largest_loss) * own * (1.0 - 1e-14), floor);
    search.high = (1.0 + 1e-14) * (lifted < intact.modes ? intact.eigenvalues[index(lifted)]
                                                         : top + work.added_stiffness);
    // Frequencies respond almost linearly to added compliance.
    double softer = 1.0, stiffer = 0.0;
    for (int a = 0; a < work.secular.columns; ++a) {
      const double c = work.columns[index(a) * intact.stride + index(root)];
      const double g = work.inverse_gamma[index(a)], f = work.flexibility[index(a)];
      if (a < work.damage_columns)
        softer += c * c / own / std::max(g - f, 1e-6);
      else
        stiffer += c * c / (f - g);
    }
    search.z = std::clamp((own + stiffer) / softer, search.low, search.high);
    if (std::isnan(search.z)) search.z = 0.5 * (search.low + search.high);
    return search;
  }

  /// The two modes nearest to z.
  int lower_pole(double z, int guess) const {
    const double* value = intact.eigenvalues.data();
    int p = std::clamp(guess, 0, work.secular.near - 2);
    while (p > 0 && z - value[p - 1] < value[p + 1] - z) --p;
    while (p + 2 < work.secular.near && value[p + 2] - z < z - value[p]) ++p;
    return p;
  }

  /// Digests one evaluation; true once the root is found (then search.z holds it).
  bool advance(Search& search, int pole, const SecularSteps& steps, int lane) const {
    const double low_step = steps.low.lane[lane], high_step = steps.high.lane[lane];
    const double* value = intact.eigenvalues.data();
    ++search.evaluations;
    if (!std::isfinite(low_step) || !std::isfinite(high_step)) {
      // A leading block of A was singular just here: look a little aside.
      search.z +=
          1e-3 *
          ((search.z - search.low > search.high - search.z ? search.low : search.high) - search.z);
      return false;
    }
    // Damaged eigenvalues below the two that H follows.
    const int first = pole + static_cast<int>(steps.negative.lane[lane]) - work.support_columns;
    if (search.settled) {
      const bool is_low =
          search.root == first || (search.root != first + 1 && -low_step < high_step);
      capture(search.root, search.z, pole, steps, lane, is_low);
      return true;
    }
    const int below = first + (low_step < 0.0) + (high_step < 0.0);
    (search.root < below ? search.high : search.low) = search.z;

    const double width = search.high - search.low;
    if (width <= 4e-16 * search.high) {
      search.z = 0.5 * (search.high + search.low);
      return settle(search);
    }
    const bool followed = search.root == first || search.root == first + 1;
    if (followed && search.evaluations < kPatience) {
      const double step = search.root == first ? low_step : high_step;
      const double next = std::clamp(search.z + step, search.low, search.high);
      double reach = std::numeric_limits<double>::infinity();  // to the nearest mode in F
      if (pole > 0) reach = search.z - value[pole - 1];
      if (pole + 2 < work.secular.near) reach = std::min(reach, value[pole + 2] - search.z);
      const double last = search.last_step * search.last_step;
      double error = step * step / std::max(reach, std::abs(step));
      if (last > 0.0) error = std::max(error, std::abs(step * step * step) / last);
      if (search.evaluations == 1) error *= 1e3;
      const bool inside = next == search.z + step;
      search.last_step = step;
      if (error <= kRootError * search.z) {
        search.z = next;
        return settle(search);
      }
      if (inside) {
        search.z = next;
        return false;
      }
    }
    search.last_step = 0.0;
    search.z = search.high > 4.0 * search.low ? std::sqrt(search.high * search.low)
                                              : 0.5 * (search.high + search.low);
    return false;
  }

  /// The root is known; where its mode is wanted, one more evaluation follows.
  [[nodiscard]] bool settle(Search& search) const {
    search.settled = results != nullptr;
    return !search.settled;
  }

  /// The mode from H v = 0 at the root: v, then η = A⁻¹ [c_p c_{p+1}] v, then every coordinate.
  void capture(int root, double z, int pole, const SecularSteps& steps, int lane,
               bool is_low) const {
    const auto at = [lane](const Pack& pack) { return pack.lane[lane]; };
    const double d = is_low ? at(steps.low) : at(steps.high);
    const double n11 = at(steps.n11), n12 = at(steps.n12), n22 = at(steps.n22);
    const double r11 = at(steps.h11) - d * n11, r12 = at(steps.h12) - d * n12,
                 r22 = at(steps.h22) - d * n22;
    double v1 = -r12, v2 = r11;
    if (std::abs(r11) < std::abs(r22)) v1 = r22, v2 = -r12;
    if (v1 == 0.0 && v2 == 0.0) {  // a double root: any two N-orthogonal vectors
      v1 = is_low ? 1.0 : -n12;
      v2 = is_low ? 0.0 : n11;
    }
    const double scale = 1.0 / std::sqrt(v1 * v1 * n11 + 2.0 * v1 * v2 * n12 + v2 * v2 * n22);
    v1 *= scale;
    v2 *= scale;
    const auto m = index(work.secular.columns);
    for (std::size_t a = 0; a < m; ++a)
      work.eta[a] = at(work.scratch.forces[a]) * v1 + at(work.scratch.forces[m + a]) * v2;
    if (!work.need_coordinates) {
      report(root, z);
      return;
    }
    kernel.coordinates(work.secular, static_cast<int>(intact.stride), work.eta.data(), z, pole,
                       work.coordinates.data());
    work.coordinates[index(pole)] = v1;
    work.coordinates[index(pole) + 1] = v2;
    report(root, z);
  }

  /// A rigid-body mode that the supports leave, or an intact mode where nothing is wrong.
  void report_unchanged(int root) const {
    std::fill(work.coordinates.begin(), work.coordinates.end(), 0.0);
    work.coordinates[index(root)] = 1.0;
    if (root < work.rigid && work.rigid < intact.rigid) {
      // One of two rigid motions is held: turn about the held place, or translate.
      double held0 = 0.0, held1 = 0.0;
      for (int a = work.damage_columns; a < work.secular.columns; ++a) {
        const double* c = work.columns.data() + index(a) * intact.stride;
        if (std::hypot(c[0], c[1]) > std::hypot(held0, held1)) held0 = c[0], held1 = c[1];
      }
      const double size = std::hypot(held0, held1);
      work.coordinates[0] = -held1 / size;
      work.coordinates[1] = held0 / size;
    }
    report(root, root < work.rigid ? 0.0 : intact.eigenvalues[index(root)]);
  }

  /// Writes what is wanted of one mode, φ = Σ_j coordinates[j] φ_j.
  void report(int root, double lambda) const {
    const int n = static_cast<int>(intact.stride);
    const double* q = work.coordinates.data();
    // ∂f/∂λ = 1 / (8 π² f)
    const double per_lambda =
        lambda > 0.0 ? 1.0 / (4.0 * std::numbers::pi * std::sqrt(lambda)) : 0.0;
    const auto gradient = [&](double bending, double shear) {
      return -per_lambda * (bending * bending + shear * shear);
    };
    const auto loss = [&](int e) {
      for (const auto& [element, lost] : work.lost)
        if (element == e) return lost;
      return 0.0;
    };
    if (!results->damage_gradients_hz.empty()) {
      const std::size_t count = work.damages.size();
      for (std::size_t d = 0; d < count; ++d) {
        const int e = intact.beam.element_at(work.damages[d].location);
        double strain[2];  // b·φ, a·φ
        if (work.need_coordinates) {
          kernel.project(intact.element_rows.data() + 2 * index(e) * intact.stride, 2,
                         intact.stride, q, n, strain);
        } else {  // Cᵀφ = Γ⁻¹ η
          std::size_t a = 0;
          for (auto l = work.lost.begin(); l->first != e; ++l) a += 2;
          for (std::size_t i : {0, 1}) strain[i] = work.inverse_gamma[a + i] * work.eta[a + i];
        }
        results->damage_gradients_hz[index(root) * count + d] =
            gradient(strain[0], strain[1]) * (1.0 - loss(e)) / (1.0 - work.damages[d].reduction);
      }
    }
    if (!results->support_gradients_hz.empty()) {
      const std::size_t count = work.support_column.size();
      for (std::size_t i = 0; i < count; ++i) {
        const int column = work.support_column[i];
        // N(x) φ = η / k; a rigid support's 1/k is 0, and a rigid-body mode moves no spring.
        const double motion = column < 0 || per_lambda == 0.0
                                  ? 0.0
                                  : work.inverse_gamma[index(column)] * work.eta[index(column)];
        results->support_gradients_hz[index(root) * count + i] = per_lambda * motion * motion;
      }
    }
    if (!results->element_gradients_hz.empty()) {
      const int count = intact.beam.elements;
      work.strains.resize(2 * index(count));
      kernel.project(intact.element_rows.data(), 2 * count, intact.stride, q, n,
                     work.strains.data());
      double* to = results->element_gradients_hz.data() + index(root) * index(count);
      for (std::size_t e = 0; e < index(count); ++e)
        to[e] = gradient(work.strains[2 * e], work.strains[2 * e + 1]);
      for (const auto& [e, lost] : work.lost) to[e] *= 1.0 - lost;
    }
    if (!results->shapes.empty()) {
      const std::size_t count = results->points.size();
      double* to = results->shapes.data() + index(root) * count;
      kernel.project(work.point_rows.data(), static_cast<int>(count), intact.stride, q, n, to);
      const std::span<double> shape(to, count);
      double largest = 0.0;
      for (const double w : shape) largest = std::max(largest, std::abs(w));
      const auto first = std::find_if(shape.begin(), shape.end(), [&](double w) {
        return std::abs(w) >= (1.0 - 1e-6) * largest;
      });
      if (*first < 0.0)
        for (double& w : shape) w = -w;
    }
  }

  /// Rows of the intact modes at the points, and room for one mode.
  void want(const Results& wanted, std::span<const Damage> damages) {
    const std::size_t n = wanted.frequencies_hz.size();
    require_size("damage_gradients_hz", wanted.damage_gradients_hz.size(), n * damages.size());
    require_size("element_gradients_hz", wanted.element_gradients_hz.size(),
                 n * index(intact.beam.elements));
    require_size("shapes", wanted.shapes.size(), n * wanted.points.size());
    require_size("support_gradients_hz", wanted.support_gradients_hz.size(),
                 n * work.support_column.size());
    if (wanted.damage_gradients_hz.empty() && wanted.element_gradients_hz.empty() &&
        wanted.shapes.empty() && wanted.support_gradients_hz.empty())
      return;
    results = &wanted;
    work.damages.assign(damages.begin(), damages.end());
    work.eta.assign(index(work.secular.columns), 0.0);
    work.need_coordinates = !wanted.element_gradients_hz.empty() || !wanted.shapes.empty() ||
                            std::any_of(work.lost.begin(), work.lost.end(),
                                        [](const auto& l) { return l.second == 0.0; });
    work.coordinates.resize(intact.stride);
    if (wanted.shapes.empty()) return;
    work.point_rows.resize(wanted.points.size() * intact.stride);
    for (std::size_t i = 0; i < wanted.points.size(); ++i)
      motion(wanted.points[i].at, wanted.points[i].rotation,
             work.point_rows.data() + i * intact.stride);
  }

  void solve(int count) {
    work.lambda.assign(index(count), 0.0);
    const int rigid = work.secular.columns == 0 ? count : std::min(count, work.rigid);
    for (int root = 0; root < rigid; ++root) {
      if (root >= work.rigid) work.lambda[index(root)] = intact.eigenvalues[index(root)];
      if (results) report_unchanged(root);
    }
    int next = rigid, active = 0;
    Search lanes[kLanes];
    int poles[kLanes] = {};
    Pack z;
    for (Search& lane : lanes)
      if (next < count) lane = begin(next), ++next, ++active;
    SecularSteps steps;
    while (active > 0) {
      for (int l = 0; l < kLanes; ++l) {
        const Search& lane = lanes[l].root < 0 ? lanes[0] : lanes[l];
        poles[l] = lower_pole(lane.z, lane.root);
        z.lane[l] = lane.z;
      }
      kernel.evaluate(work.secular, z, poles, work.scratch, steps);
      for (int l = 0; l < kLanes; ++l) {
        Search& lane = lanes[l];
        if (lane.root < 0 || !advance(lane, poles[l], steps, l)) continue;
        work.lambda[index(lane.root)] = lane.z;
        if (next < count)
          lane = begin(next), ++next;
        else
          lane.root = -1, --active;
      }
    }
  }
};
void Reanalysis::frequencies_hz(std::span<const Damage> damages,
                                std::span<const SpringSupport> supports, Workspace& workspace,
                                std::span<double> out) const {
  solve(damages, supports, workspace,
        {.frequencies_hz = out,
         .damage_gradients_hz = {},
         .element_gradients_hz = {},
         .shapes = {},
         .points = {}});
}

void Reanalysis::solve(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                       Workspace& workspace, const Results& results) const {
  const auto count = static_cast<int>(results.frequencies_hz.size());
  Solver solver{*impl_, *workspace.impl_};
  solver.set(damages, supports, count);
  solver.want(results, damages);
  solver.solve(count);
  std::transform(workspace.impl_->lambda.begin(), workspace.impl_->lambda.end(),
                 results.frequencies_hz.begin(),
                 [](double lambda) { return std::sqrt(lambda) / (2.0 * std::numbers::pi); });
}

void Reanalysis::location_slopes(std::span<const Damage> damages,
                                 std::span<const SpringSupport> supports, Workspace& workspace,
                                 const LocationSlopes& slopes) const {
  const Beam& beam = impl_->beam;
  const std::size_t n = index(slopes.modes);
  require_size("damages_hz_m", slopes.damages_hz_m.size(), n * damages.size());
  require_size("supports_hz_m", slopes.supports_hz_m.size(), n * supports.size());
  for (const Damage& d : damages) validate(beam, d);
  for (const SpringSupport& s : supports) validate(beam, s);
  Workspace::Impl& work = *workspace.impl_;
  work.before.resize(n);
  work.after.resize(n);
  Defects& moved = work.moved;
  moved.damages.assign(damages.begin(), damages.end());
  moved.supports.assign(supports.begin(), supports.end());
  // One column of `out`, from the frequencies with `place` at low and at high.
  const auto differ = [&](double& place, double low, double high, std::size_t columns,
                          double* out) {
    const double here = place;
    place = low;
    frequencies_hz(moved.damages, moved.supports, workspace, work.before);
    place = high;
    frequencies_hz(moved.damages, moved.supports, workspace, work.after);
    place = here;
    for (std::size_t i = 0; i < n; ++i)
      out[i * columns] = high > low ? (work.after[i] - work.before[i]) / (high - low) : 0.0;
  };
  if (!slopes.damages_hz_m.empty())
    for (std::size_t d = 0; d < damages.size(); ++d) {
      const int e = beam.element_at(damages[d].location);
      differ(moved.damages[d].location, beam.element_midpoint(std::max(e - 1, 0)),
             beam.element_midpoint(std::min(e + 1, beam.elements - 1)), damages.size(),
             slopes.damages_hz_m.data() + d);
    }
  if (!slopes.supports_hz_m.empty())
    for (std::size_t s = 0; s < supports.size(); ++s) {
      const double at = supports[s].location, step = kSupportStep * beam.element_length();
      differ(moved.supports[s].location, std::max(at - step, 0.0), std::min(at + step, beam.length),
             supports.size(), slopes.supports_hz_m.data() + s);
    }
}

}  // namespace wheeltap::fem
