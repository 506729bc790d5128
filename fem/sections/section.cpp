#include "fem/sections/section.hpp"

#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace wheeltap::fem {
namespace {

void require_dimension(const char* name, double value, double below = INFINITY) {
  if (value > 0.0 && value < below) return;
  std::ostringstream message;
  message.precision(12);
  message << "section." << name << " = " << value << ": must be positive and below " << below;
  throw std::invalid_argument(message.str());
}

void require_poisson(double poisson) {
  if (poisson > -1.0 && poisson < 0.5) return;
  std::ostringstream message;
  message << "poisson = " << poisson << ": must be above -1 and below 0.5";
  throw std::invalid_argument(message.str());
}

/// I = b h³ / 12 of a rectangle b × h.
double second_moment(double b, double h) {
  return b * h * h * h / 12.0;
}

/// Cowper's formulas for the thin-walled I and box have the same form; the box has two webs, each
/// half of `webs`. b and h are distances between wall centrelines, m = (area of both flanges) /
/// (area of the webs), n = b / h.
double cowper_thin_walled(double poisson, double m, double n, bool box) {
  const double plain = 10.0 * (1.0 + poisson) * (1.0 + 3.0 * m) * (1.0 + 3.0 * m);
  const double base = 12.0 + 72.0 * m + 150.0 * m * m + 90.0 * m * m * m;
  const double lateral = 11.0 + 66.0 * m + 135.0 * m * m + 90.0 * m * m * m;
  const double width =
      box ? 10.0 * n * n * ((3.0 + poisson) * m + 3.0 * m * m)
          : 30.0 * n * n * (m + m * m) + 5.0 * poisson * n * n * (8.0 * m + 9.0 * m * m);
  return plain / (base + poisson * lateral + width);
}

}  // namespace

double cowper_rectangle(double poisson) {
  return 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
}

double cowper_circle(double poisson) {
  return 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson);
}

double cowper_tube(double poisson, double radius_ratio) {
  const double m2 = radius_ratio * radius_ratio;
  const double q = (1.0 + m2) * (1.0 + m2);
  return 6.0 * (1.0 + poisson) * q / ((7.0 + 6.0 * poisson) * q + (20.0 + 12.0 * poisson) * m2);
}

double rectangle_torsion_constant(double a, double b) {
  if (a < b) std::swap(a, b);
  const double pi = std::numbers::pi;
  double sum = 0.0;
  for (int n = 1;; n += 2) {
    const double term = std::tanh(n * pi * a / (2.0 * b)) / std::pow(n, 5);
    sum += term;
    if (term < 1e-17 * sum) break;
  }
  return a * (b * b * b) * (1.0 / 3.0 - 64.0 / std::pow(pi, 5) * b / a * sum);
}

Section section(const Rectangle& shape, double poisson) {
  require_dimension("width", shape.width);
  require_dimension("height", shape.height);
  require_poisson(poisson);
  return {.area = shape.width * shape.height,
          .second_moment = second_moment(shape.width, shape.height),
          .shear_coefficient = cowper_rectangle(poisson)};
}

Section section(const Circle& shape, double poisson) {
  require_dimension("diameter", shape.diameter);
  require_poisson(poisson);
  const double d2 = shape.diameter * shape.diameter;
  return {.area = std::numbers::pi * d2 / 4.0,
          .second_moment = std::numbers::pi * d2 * d2 / 64.0,
          .shear_coefficient = cowper_circle(poisson)};
}

Section section(const Tube& shape, double poisson) {
  require_dimension("outer_diameter", shape.outer_diameter);
  require_dimension("thickness", shape.thickness, shape.outer_diameter / 2.0);
  require_poisson(poisson);
  const double outer = shape.outer_diameter, inner = outer - 2.0 * shape.thickness;
  const double sum = outer * outer + inner * inner;
  const double difference = 4.0 * shape.thickness * (outer - shape.thickness);  // outer² - inner²
  return {.area = std::numbers::pi * difference / 4.0,
          .second_moment = std::numbers::pi * difference * sum / 64.0,
          .shear_coefficient = cowper_tube(poisson, inner / outer)};
}

Section section(const ISection& shape, double poisson) {
  require_dimension("height", shape.height);
  require_dimension("width", shape.width);
  require_dimension("flange_thickness", shape.flange_thickness, shape.height / 2.0);
  require_dimension("web_thickness", shape.web_thickness, shape.width);
  require_poisson(poisson);
  const double clear = shape.height - 2.0 * shape.flange_thickness;
  const double h = shape.height - shape.flange_thickness;  // between the flanges' centrelines
  const double m = 2.0 * shape.width * shape.flange_thickness / (h * shape.web_thickness);
  return {.area = 2.0 * shape.width * shape.flange_thickness + clear * shape.web_thickness,
          .second_moment = second_moment(shape.width, shape.height) -
                           second_moment(shape.width - shape.web_thickness, clear),
          .shear_coefficient = cowper_thin_walled(poisson, m, shape.width / h, false)};
}

Section section(const Box& shape, double poisson) {
  require_dimension("height", shape.height);
  require_dimension("width", shape.width);
  require_dimension("flange_thickness", shape.flange_thickness, shape.height / 2.0);
  require_dimension("web_thickness", shape.web_thickness, shape.width / 2.0);
  require_poisson(poisson);
  const double clear = shape.height - 2.0 * shape.flange_thickness;
  const double hollow = shape.width - 2.0 * shape.web_thickness;
  const double h = shape.height - shape.flange_thickness;
  const double b = shape.width - shape.web_thickness;
  const double m = b * shape.flange_thickness / (h * shape.web_thickness);
  return {.area = shape.width * shape.height - hollow * clear,
          .second_moment = second_moment(shape.width, shape.height) - second_moment(hollow, clear),
          .shear_coefficient = cowper_thin_walled(poisson, m, b / h, true)};
}

}  // namespace wheeltap::fem
