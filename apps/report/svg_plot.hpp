// SVG for pages and files without scripts: axes, lines, marks.
#pragma once

#include <string>
#include <vector>

namespace wheeltap::apps {

/// Returns text for HTML, on one printable line.
[[nodiscard]] std::string escaped(const std::string& text);

/// Returns the beginning of a page in the design of the reports: headline, paragraphs below it, and
/// the styles that Plot uses.
[[nodiscard]] std::string page_head(const std::string& title, const std::string& headline,
                                    const std::vector<std::string>& details);
[[nodiscard]] std::string page_end();

/// Text anchors, used as attributes of svg_text.
inline constexpr const char* kMiddle = " text-anchor=\"middle\"";
inline constexpr const char* kEnd = " text-anchor=\"end\"";

/// Returns a text element. `words` is markup: escape plain text. `attributes` begin with a blank.
[[nodiscard]] std::string svg_text(double x, double y, const std::string& words,
                                   const std::string& attributes = "");
[[nodiscard]] std::string svg_line(const std::string& attributes, double x0, double y0, double x1,
                                   double y1);
[[nodiscard]] std::string svg_dot(const std::string& attributes, double x, double y, double radius);
/// Returns a complete file with `body` on a white background; `title` is markup.
[[nodiscard]] std::string svg_sheet(double width, double height, const std::string& title,
                                    const std::string& body);
/// Returns the smallest number of the form 1, 2 or 5 times a power of ten that is at least `least`
/// > 0.
[[nodiscard]] double round_step(double least);

/// Axes over a range. The constructor widens a range of zero extent.
class Plot {
 public:
  Plot(double x0, double x1, double y0, double y1, double height = 200.0);

  /// The x or y coordinate of a value on the drawing.
  [[nodiscard]] double x(double value) const;
  [[nodiscard]] double y(double value) const;
  /// Returns axes with labels around `inside` (SVG).
  [[nodiscard]] std::string framed(const std::string& label, const std::string& horizontal,
                                   const std::string& vertical, const std::string& inside) const;
  /// Returns axes with a line (its SVG `path`) and vertical marks.
  [[nodiscard]] std::string drawn(const std::string& label, const std::string& horizontal,
                                  const std::string& vertical, const std::string& path,
                                  const std::vector<double>& marks) const;
  [[nodiscard]] std::string hairs(const std::vector<double>& marks) const;

 private:
  double x0_, x1_, y0_, y1_, height_;
};

}  // namespace wheeltap::apps
