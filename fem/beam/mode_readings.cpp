#include "fem/beam/mode_readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/index.hpp"

namespace wheeltap::fem::detail {
void require_size(const char* name, std::size_t size, std::size_t expected) {
  if (size != 0 && size != expected)
    throw std::invalid_argument(std::string(name) + " has size " + std::to_string(size) +
                                ": must be empty or " + std::to_string(expected));
}

void ModeReadings::set(const IntactModes& intact, const SecularKernel& kernel,
                       const DefectColumns& columns, std::span<const Damage> damages,
                       const Reanalysis::Results& results) {
  intact_ = &intact;
  kernel_ = &kernel;
  columns_ = &columns;
  damages_ = damages;
  results_ = &results;
  const std::size_t n = results.frequencies_hz.size();
  require_size("damage_gradients_hz", results.damage_gradients_hz.size(), n * damages.size());
  require_size("element_gradients_hz", results.element_gradients_hz.size(),
               n * index(intact.beam.elements));
  require_size("shapes", results.shapes.size(), n * results.points.size());
  require_size("support_gradients_hz", results.support_gradients_hz.size(),
               n * columns.support_column().size());
  wanted_ = !results.damage_gradients_hz.empty() || !results.element_gradients_hz.empty() ||
            !results.shapes.empty() || !results.support_gradients_hz.empty();
  if (!wanted_) return;
  need_coordinates_ = !results.element_gradients_hz.empty() || !results.shapes.empty() ||
                      std::any_of(columns.elements().begin(), columns.elements().end(),
                                  [](const DefectColumns::Element& e) { return e.lost == 0.0; });
  column_strains_.assign(index(columns.count()), 0.0);
  coordinates_.resize(intact.stride);
  if (results.shapes.empty()) return;
  point_rows_.resize(results.points.size() * intact.stride);
  for (std::size_t i = 0; i < results.points.size(); ++i)
    intact.motion(results.points[i].at, results.points[i].rotation,
                  point_rows_.data() + i * intact.stride);
}

void ModeReadings::read(const RootSearch& search, const RootSearch::Mode& mode) {
  if (need_coordinates_) search.coordinates(mode, coordinates_.data());
  std::copy(mode.eta.begin(), mode.eta.end(), column_strains_.begin());
  columns_->strains(column_strains_);
  write(mode.root, mode.lambda);
}

void ModeReadings::read_unchanged(int root) {
  std::fill(coordinates_.begin(), coordinates_.end(), 0.0);
  std::fill(column_strains_.begin(), column_strains_.end(), 0.0);
  coordinates_[index(root)] = 1.0;
  const int rigid = columns_->rigid_body_modes();
  if (root < rigid && rigid < intact_->rigid) {
    // The supports restrain one of two rigid motions. The other is a rotation about the restrained
    // location, or a translation.
    double held0 = 0.0, held1 = 0.0;
    for (int a = 0; a < columns_->supports(); ++a) {
      const double* c = columns_->columns() + index(a) * intact_->stride;
      if (std::hypot(c[0], c[1]) > std::hypot(held0, held1)) held0 = c[0], held1 = c[1];
    }
    const double size = std::hypot(held0, held1);
    coordinates_[0] = -held1 / size;
    coordinates_[1] = held0 / size;
  }
  write(root, root < rigid ? 0.0 : intact_->eigenvalues[index(root)]);
}

/// Writes the requested results of one mode, φ = Σ_j coordinates[j] φ_j.
void ModeReadings::write(int root, double lambda) {
  const int n = static_cast<int>(intact_->stride);
  const double* q = coordinates_.data();
  // ∂f/∂λ = 1 / (8 π² f)
  const double per_lambda = lambda > 0.0 ? 1.0 / (4.0 * std::numbers::pi * std::sqrt(lambda)) : 0.0;
  const auto gradient = [&](const double* strains) {  // b·φ, a·φ
    return -per_lambda * (strains[0] * strains[0] + strains[1] * strains[1]);
  };
  if (!results_->damage_gradients_hz.empty()) {
    const std::size_t count = damages_.size();
    for (std::size_t d = 0; d < count; ++d) {
      const int e = intact_->beam.element_at(damages_[d].location);
      double strain[2];
      const double* of = strain;
      auto a = index(columns_->supports());
      auto element = columns_->elements().begin();
      for (; element->element != e; ++element) a += element->lost > 0.0 ? 2 : 0;
      if (need_coordinates_)
        kernel_->project(intact_->element_rows.data() + 2 * index(e) * intact_->stride, 2,
                         intact_->stride, q, n, strain);
      else
        of = column_strains_.data() + a;
      results_->damage_gradients_hz[index(root) * count + d] =
          gradient(of) * element->remaining / (1.0 - damages_[d].reduction);
    }
  }
  if (!results_->support_gradients_hz.empty()) {
    const auto columns = columns_->support_column();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      // A rigid support does not move, and a rigid-body mode deforms no spring.
      const double motion =
          columns[i] < 0 || per_lambda == 0.0 ? 0.0 : column_strains_[index(columns[i])];
      results_->support_gradients_hz[index(root) * columns.size() + i] =
          per_lambda * motion * motion;
    }
  }
  if (!results_->element_gradients_hz.empty()) {
    const int count = intact_->beam.elements;
    element_strains_.resize(2 * index(count));
    kernel_->project(intact_->element_rows.data(), 2 * count, intact_->stride, q, n,
                     element_strains_.data());
    double* to = results_->element_gradients_hz.data() + index(root) * index(count);
    for (std::size_t e = 0; e < index(count); ++e) to[e] = gradient(&element_strains_[2 * e]);
    for (const DefectColumns::Element& e : columns_->elements()) to[e.element] *= e.remaining;
  }
  if (!results_->shapes.empty()) write_shape(root);
}

void ModeReadings::write_shape(int root) {
  const std::size_t count = results_->points.size();
  double* to = results_->shapes.data() + index(root) * count;
  kernel_->project(point_rows_.data(), static_cast<int>(count), intact_->stride,
                   coordinates_.data(), static_cast<int>(intact_->stride), to);
  const std::span<double> shape(to, count);
  double largest = 0.0;
  for (const double w : shape) largest = std::max(largest, std::abs(w));
  const auto first = std::find_if(shape.begin(), shape.end(),
                                  [&](double w) { return std::abs(w) >= (1.0 - 1e-6) * largest; });
  if (*first < 0.0)
    for (double& w : shape) w = -w;
}

}  // namespace wheeltap::fem::detail
