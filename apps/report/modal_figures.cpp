#include "apps/report/modal_figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "apps/cases/records/modal_geometry.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

using Eigen::Index;

constexpr double kInterval = 1.96;
constexpr double kSmall = 170.0;  // width and height of a small figure

std::string stroke(const char* kind, double x0, double y0, double x1, double y1) {
  return svg_line("class=\"" + std::string(kind) + "\"", x0, y0, x1, y1);
}

std::string opened(const std::string& label, double width, double height) {
  return "<svg role=\"img\" aria-label=\"" + escaped(label) + "\" viewBox=\"0 0 " +
         fixed(width, 0) + " " + fixed(height, 0) + "\">\n";
}

std::string titled(const ModesFile& modes, Index m) {
  return "mode " + std::to_string(m + 1) + ", " + significant(modes.frequencies_hz[m], 4) + " Hz";
}

const char* kind_of(const ModesFile& modes, Index m) {
  return modes.doubtful[static_cast<std::size_t>(m)] ? "doubt" : "line";
}

double mac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  std::complex<double> product = 0.0;
  double aa = 0.0, bb = 0.0;
  for (Index i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i].real()) || !std::isfinite(b[i].real())) continue;
    product += std::conj(a[i]) * b[i];
    aa += std::norm(a[i]);
    bb += std::norm(b[i]);
  }
  return aa * bb > 0.0 ? std::norm(product) / (aa * bb) : 0.0;
}

/// Real part of a rotated shape entry, and its standard deviation (NaN without covariances).
struct Bar {
  double value = 0.0, sd = 0.0;
};
Bar spectrum_bar(const ModesFile& modes, Index m, Index channel, double angle) {
  const std::complex<double> entry = modes.shapes(channel, m);
  const double c = std::cos(angle), s = std::sin(angle);
  Bar out{.value = c * entry.real() + s * entry.imag(), .sd = std::nan("")};
  if (modes.shape_covariance.empty()) return out;
  const Eigen::MatrixXd& all = modes.shape_covariance[static_cast<std::size_t>(m)];
  const Index i = channel, j = channel + modes.shapes.rows();
  out.sd =
      std::sqrt(std::max(0.0, c * c * all(i, i) + 2.0 * c * s * all(i, j) + s * s * all(j, j)));
  return out;
}

}  // namespace

std::string mac_figure(const ModesFile& modes) {
  constexpr double kLeft = 26.0;
  const Index n = modes.frequencies_hz.size();
  const double cell = std::clamp(320.0 / static_cast<double>(n), 8.0, 40.0);
  const double size = kLeft + cell * static_cast<double>(n) + 4.0;
  std::string out = opened("modal assurance criterion between modes", size, size);
  for (Index i = 0; i < n; ++i) {
    const double at = kLeft + cell * static_cast<double>(i);
    const bool shown = cell >= 12.0 || i % 5 == 4;
    if (shown) out += svg_text(at + 0.5 * cell, kLeft - 6.0, std::to_string(i + 1), kMiddle);
    if (shown) out += svg_text(kLeft - 5.0, at + 0.5 * cell + 4.0, std::to_string(i + 1), kEnd);
    for (Index j = 0; j < n; ++j) {
      const double value = mac(modes.shapes.col(i), modes.shapes.col(j));
      const double x = kLeft + cell * static_cast<double>(j);
      out += "<rect class=\"cell\" x=\"" + fixed(x, 1) + "\" y=\"" + fixed(at, 1) + "\" width=\"" +
             fixed(cell - 1.0, 1) + "\" height=\"" + fixed(cell - 1.0, 1) +
             "\" style=\"fill-opacity:" + fixed(0.04 + 0.51 * value, 3) + "\"><title>modes " +
             std::to_string(i + 1) + " and " + std::to_string(j + 1) + ": " + fixed(value, 3) +
             "</title></rect>\n";
      if (cell >= 26.0)
        out += svg_text(x + 0.5 * cell, at + 0.5 * cell + 4.0, fixed(value, 2), kMiddle);
    }
  }
  return "<div style=\"max-width:" + fixed(size, 0) + "px\">" + out + "</svg></div>\n";
}

std::string complexity_figures(const ModesFile& modes) {
  constexpr double kCentre = 0.5 * kSmall, kRadius = 0.5 * kSmall - 22.0;
  std::string out = "<div class=\"small\">\n";
  for (Index m = 0; m < modes.frequencies_hz.size(); ++m) {
    const std::complex<double> turn = std::polar(1.0, -principal_angle(modes.shapes.col(m)));
    out += opened(titled(modes, m) + ", entries in the complex plane", kSmall, kSmall);
    out += svg_dot("class=\"grid\"", kCentre, kCentre + 8, kRadius);
    out += stroke("grid", kCentre - kRadius, kCentre + 8, kCentre + kRadius, kCentre + 8);
    out += stroke("grid", kCentre, kCentre + 8 - kRadius, kCentre, kCentre + 8 + kRadius);
    for (Index c = 0; c < modes.shapes.rows(); ++c) {
      const std::complex<double> entry = turn * modes.shapes(c, m);
      if (!std::isfinite(entry.real())) continue;
      out += stroke(kind_of(modes, m), kCentre, kCentre + 8, kCentre + kRadius * entry.real(),
                    kCentre + 8 - kRadius * entry.imag());
    }
    out += svg_text(kCentre, 11.0, titled(modes, m), kMiddle) + "</svg>\n";
  }
  return out + "</div>\n";
}

std::string bar_figures(const ModesFile& modes) {
  constexpr double kTop = 18.0, kHeight = 150.0, kLeft = 8.0;
  const Index channels = modes.shapes.rows();
  const double width = std::max(kSmall, 6.0 * static_cast<double>(channels) + 2.0 * kLeft);
  const double step = (width - 2.0 * kLeft) / static_cast<double>(channels);
  const double zero = 0.5 * (kTop + kHeight - 14.0), scale = 0.42 * (kHeight - kTop - 14.0);
  const auto y = [&](double value) { return zero - scale * std::clamp(value, -1.3, 1.3); };
  std::string out = "<div class=\"small\">\n";
  for (Index m = 0; m < modes.frequencies_hz.size(); ++m) {
    const double angle = principal_angle(modes.shapes.col(m));
    out += opened(titled(modes, m) + ", shape by channel", width, kHeight);
    out += stroke("grid", kLeft, zero, width - kLeft, zero);
    for (Index c = 0; c < channels; ++c) {
      const double x = kLeft + step * (static_cast<double>(c) + 0.5);
      if (step >= 12.0 || c % 5 == 4)
        out += svg_text(x, kHeight - 3.0, std::to_string(c + 1), kMiddle);
      const Bar b = spectrum_bar(modes, m, c, angle);
      if (!std::isfinite(b.value)) continue;
      out += "<rect class=\"" + std::string(kind_of(modes, m)) + " bar\" x=\"" +
             fixed(x - 0.35 * step, 1) + "\" y=\"" + fixed(std::min(y(b.value), zero), 1) +
             "\" width=\"" + fixed(0.7 * step, 1) + "\" height=\"" +
             fixed(std::abs(y(b.value) - zero), 1) + "\"/>\n";
      if (std::isfinite(b.sd) && b.sd > 0.0)
        out +=
            stroke("whisker", x, y(b.value - kInterval * b.sd), x, y(b.value + kInterval * b.sd));
    }
    out += svg_text(0.5 * width, 11.0, titled(modes, m), kMiddle) + "</svg>\n";
  }
  std::string names;
  for (Index c = 0; c < channels; ++c) {
    const MeasuredSensor& s = modes.sensors[static_cast<std::size_t>(c)];
    names += (c > 0 ? ", " : "") + std::to_string(c + 1) + " " + s.name;
    if (!s.node.empty())
      names += " (" + s.node + (s.direction.empty() ? "" : " " + s.direction) + ")";
  }
  return out + "</div>\n<p>Channels: " + escaped(names) + ".</p>\n";
}

}  // namespace wheeltap::apps
