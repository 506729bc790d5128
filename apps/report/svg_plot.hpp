// SVG for pages and files that need no script: axes, lines, marks.
#pragma once

#include <string>
#include <vector>

namespace wheeltap::apps {

/// Text for HTML, one printable line.
[[nodiscard]] std::string escaped(const std::string& text);

/// A page in the design of the reports, up to its answer: a headline, and paragraphs below it; and
/// the classes that Plot uses.
[[nodiscard]] std::string page_head(const std::string& title, const std::string& headline,
                                    const std::vector<std::string>& details);
[[nodiscard]] std::string page_end();

/// Where text is anchored, as attributes of svg_text.
inline constexpr const char* kMiddle = " text-anchor=\"middle\"";
inline constexpr const char* kEnd = " text-anchor=\"end\"";

/// `words` are markup: escape what is not; `attributes` begin with a blank.
[[nodiscard]] std::string svg_text(double x, double y, const std::string& words,
                                   const std::string& attributes = "");
[[nodiscard]] std::string svg_line(const std::string& attributes, double x0, double y0, double x1,
                                   double y1);
[[nodiscard]] std::string svg_dot(const std::string& attributes, double x, double y, double radius);
/// A whole file, white behind `body`; `title` is markup.
[[nodiscard]] std::string svg_sheet(double width, double height, const std::string& title,
                                    const std::string& body);
/// The smallest of 1, 2 and 5 times a power of ten that is not below `least` > 0.
[[nodiscard]] double round_step(double least);

/// Axes over a range; a range without extent is widened.
class Plot {
 public:
  Plot(double x0, double x1, double y0, double y1, double height = 200.0);

  /// Places on the drawing.
  [[nodiscard]] double x(double value) const;
  [[nodiscard]] double y(double value) const;
  /// Axes, what is inside them (SVG), and their labels.
  [[nodiscard]] std::string framed(const std::string& label, const std::string& horizontal,
                                   const std::string& vertical, const std::string& inside) const;
  /// A line by its path, and vertical hairs.
  [[nodiscard]] std::string drawn(const std::string& label, const std::string& horizontal,
                                  const std::string& vertical, const std::string& path,
                                  const std::vector<double>& marks) const;
  [[nodiscard]] std::string hairs(const std::vector<double>& marks) const;

 private:
  double x0_, x1_, y0_, y1_, height_;
};

}  // namespace wheeltap::apps
