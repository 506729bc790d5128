// Chains with force laws as Python functions, for many parameter vectors at once.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace wheeltap::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
/// Masses × motions.
using Motions = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Link {
  int a = 0, b = 0;  ///< masses from 1; 0 is the ground or the base
  py::object tension;
};

/// Integrates M z̈ = f(t) - M ÿ_b(t) + link forces by the classical Runge-Kutta method
///
///     0   |
///     1/2 | 1/2
///     1/2 |  0   1/2
///     1   |  0    0   1
///         | 1/6  1/3 1/3 1/6
///
/// with f and ÿ_b linear between samples, from rest. Always holds the GIL.
class Integrator {
 public:
  Integrator(const Array& mass, std::vector<Link> links, const Array& push, const Array& base)
      : mass_(Eigen::Map<const Motions>(mass.data(), mass.shape(0), mass.shape(1))),
        links_(std::move(links)),
        push_(Eigen::Map<const Motions>(push.data(), push.shape(0), push.shape(1))),
        base_(Eigen::Map<const Eigen::ArrayXd>(base.data(), base.shape(0))) {}

  /// z, ż, and z̈ + ÿ_b at the samples: 3 × samples × masses × motions.
  py::array run(double step, int steps) {
    const Eigen::Index samples = base_.size(), size = mass_.size();
    std::vector<double> out(static_cast<std::size_t>(3 * samples * size));
    Motions z = Motions::Zero(mass_.rows(), mass_.cols()), v = z, a1, a2, a3, a4, v2, v3, v4;
    for (Eigen::Index i = 0; i < samples; ++i) {
      accelerations(i, 0.0, z, v, a1);
      const auto keep = [&](Eigen::Index of, const Motions& what) {
        Eigen::Map<Motions>(out.data() + (of * samples + i) * size, z.rows(), z.cols()) = what;
      };
      keep(0, z);
      keep(1, v);
      keep(2, a1 + base_[i]);
      if (i + 1 == samples) break;
      for (int j = 0; j < steps; ++j) {
        const double t = static_cast<double>(j), n = static_cast<double>(steps);
        if (j > 0) accelerations(i, t / n, z, v, a1);
        v2 = v + 0.5 * step * a1;
        accelerations(i, (t + 0.5) / n, z + 0.5 * step * v, v2, a2);
        v3 = v + 0.5 * step * a2;
        accelerations(i, (t + 0.5) / n, z + 0.5 * step * v2, v3, a3);
        v4 = v + step * a3;
        accelerations(i, (t + 1.0) / n, z + step * v3, v4, a4);
        z += step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
        v += step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      }
    }
    return owned(std::move(out), {3, samples, mass_.rows(), mass_.cols()});
  }

 private:
  // Accelerations at sample i + t, with linearly interpolated excitation.
  void accelerations(Eigen::Index i, double t, const Motions& z, const Motions& v, Motions& out) {
    const Eigen::Index next = std::min(i + 1, base_.size() - 1);
    const Eigen::ArrayXd push = ((1.0 - t) * push_.row(i) + t * push_.row(next)).transpose();
    const double base = (1.0 - t) * base_[i] + t * base_[next];
    out = push.replicate(1, mass_.cols());
    for (const Link& link : links_) {
      const Array tension = pulled(link, across(link, z), across(link, v));
      const auto pull =
          Eigen::Map<const Eigen::ArrayXd>(tension.data(), tension.size()).transpose();
      if (link.a > 0) out.row(link.a - 1) += pull;
      if (link.b > 0) out.row(link.b - 1) -= pull;
    }
    out = out / mass_ - base;
  }

  // y_b - y_a, in a new array each time, because the function may keep it.
  [[nodiscard]] Array across(const Link& link, const Motions& y) const {
    Array out(y.cols());
    Eigen::Map<Eigen::ArrayXd> e(out.mutable_data(), y.cols());
    e.setZero();
    if (link.b > 0) e += y.row(link.b - 1).transpose();
    if (link.a > 0) e -= y.row(link.a - 1).transpose();
    return out;
  }

  static Array pulled(const Link& link, const Array& e, const Array& rate) {
    const Array out = Array::ensure(link.tension(e, rate));
    if (out && out.size() == e.size()) return out;
    PyErr_Clear();
    throw py::value_error("tension of the link from " + std::to_string(link.a) + " to " +
                          std::to_string(link.b) + ": must return " + std::to_string(e.size()) +
                          " numbers for " + std::to_string(e.size()) + " motions");
  }

  Motions mass_;
  std::vector<Link> links_;
  Motions push_;  // samples × masses
  Eigen::ArrayXd base_;
};

py::array integrate(const Array& mass, const std::vector<std::array<int, 2>>& between,
                    const std::vector<py::object>& tensions, const Array& push, const Array& base,
                    double step, int steps) {
  std::vector<Link> links;
  for (std::size_t i = 0; i < between.size(); ++i)
    links.push_back({between[i][0], between[i][1], tensions[i]});
  return Integrator(mass, std::move(links), push, base).run(step, steps);
}

}  // namespace

void bind_rig(py::module_& m) {
  m.def("integrate", &integrate, py::arg("mass"), py::arg("between"), py::arg("tensions"),
        py::arg("push"), py::arg("base"), py::arg("step"), py::arg("steps"));
}

}  // namespace wheeltap::python
