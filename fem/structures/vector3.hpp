// Three-dimensional vectors as plain arrays. Internal to fem/structures/.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace wheeltap::fem {

using Vector3 = std::array<double, 3>;

[[nodiscard]] inline Vector3 difference(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline double norm(const Vector3& a) {
  return std::hypot(a[0], a[1], a[2]);
}
[[nodiscard]] inline Vector3 scaled(const Vector3& a, double factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}
[[nodiscard]] inline Vector3 unit_vector(std::size_t axis) {
  Vector3 e{};
  e[axis] = 1.0;
  return e;
}

}  // namespace wheeltap::fem
