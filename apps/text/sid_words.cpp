#include "apps/text/sid_words.hpp"

#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

std::string sentence(const remark::ScatterBetweenWindows& r) {
  std::vector<std::string> parts;
  for (const auto& parameter : r.parameters) {
    parts.push_back(
        parameter.name + (parts.empty() ? " scatters by " : " by ") +
        significant(parameter.factor, 2) +
        (parts.empty() ? " times the standard deviation that its interval implies" : " times"));
  }
  return "Under \"" + r.model + "\", between the " + std::to_string(r.windows) + " windows, " +
         in_words(parts) + ". Use the " + (parts.size() == 1 ? "interval" : "intervals") +
         " between windows.";
}

std::string sentence(const remark::WindowsUnsound& r) {
  std::string text = "Under \"" + r.model + "\", ";
  if (r.failed > 0) {
    text += std::to_string(r.failed) + " of the " + std::to_string(r.windows) +
            " windows could not be fitted";
  }
  if (!r.rough.empty()) {
    text += std::string(r.failed > 0 ? ", and " : "") +
            "in more than a quarter of the fitted windows, the likelihood is far from normal as a "
            "function of " +
            in_words(r.rough);
  }
  return text + ": the intervals between windows are inaccurate. Use fewer, longer windows.";
}

std::string residuals_note(const SidModel& model) {
  const SidResiduals& residuals = model.residuals;
  if (residuals.chosen_kind == nullptr) return {};
  const ResidualWords words = residuals.model->words();
  const std::string chosen = "Under \"" + model.name + "\", the residuals are modelled as " +
                             std::string(words.article) + (words.article.empty() ? "" : " ") +
                             std::string(words.name) + words.detail + ", ";
  return chosen + (residuals.model->is_white()
                       ? "like the residuals of its best fit."
                       : "chosen by " + std::string(residuals.chosen_kind->criterion) +
                             " from the residuals of its best fit with white noise.");
}

}  // namespace wheeltap::apps
