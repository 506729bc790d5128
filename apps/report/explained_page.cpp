#include "apps/report/explained_page.hpp"

#include <algorithm>
#include <vector>

#include "apps/report/svg_plot.hpp"
#include "apps/results/monitoring/explained_change.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

std::string cause_table(const Report& explanation) {
  std::string out =
      "<div class=\"scroll\"><table><tr><th>damage</th><th>added mass</th><th>sensor fault</th>"
      "<th>none of these</th></tr>\n<tr>";
  for (const char* key : {"probability_damage", "probability_added_mass",
                          "probability_sensor_fault", "probability_other"})
    out += "<td>" + percent(explanation.at(key).get<double>()) + "</td>";
  return out + "</tr></table></div>\n";
}

/// Chart of the probability of each element, as steps.
std::string element_chart(const Report& defect) {
  const auto shares = defect.at("by_element").get<std::vector<double>>();
  const double top = *std::ranges::max_element(shares);
  const auto n = static_cast<double>(shares.size());
  const Plot plot(0.0, n, 0.0, top > 0.0 ? 1.05 * top : 1.0, 200.0);
  std::string path;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto from = static_cast<double>(i);
    path += (i == 0 ? "M" : "L") + fixed(plot.x(from), 1) + " " + fixed(plot.y(shares[i]), 1) +
            "H" + fixed(plot.x(from + 1.0), 1);
  }
  const std::string name = defect.at("name").get<std::string>();
  const std::string site = defect.at("site").get<std::string>();
  const bool elements = site == "beam" || site == "member";
  return plot.framed("location of the " + name + ", if it is the cause",
                     elements ? "element" : site, "probability",
                     "<path class=\"line\" d=\"" + path + "\"/>\n");
}

}  // namespace

std::string explanation_section(const Report& monitor) {
  std::string out;
  const auto time = [](const Report& t) {
    return t.is_string() ? t.get<std::string>() : base::significant(t.get<double>(), 8);
  };
  for (const Report& alarm : monitor.at("alarms")) {
    if (!alarm.contains("explanation")) continue;
    const Report& explanation = alarm.at("explanation");
    out += "<h3>Alarm at " + escaped(time(alarm.at("time"))) + "</h3>\n" + cause_table(explanation);
    for (const std::string& text : explanation_in_words(alarm))
      out += "<p>" + escaped(text) + "</p>\n";
    for (const Report& defect : explanation.at("defects"))
      if (defect.at("probability").get<double>() >= 0.05) out += element_chart(defect);
  }
  return out.empty() ? out : "<h2>Causes</h2>\n" + out;
}

}  // namespace wheeltap::apps
