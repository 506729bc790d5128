#include "apps/words.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/readable.hpp"
#include "inference/diagnosis/convergence.hpp"

namespace wheeltap::apps {

using namespace identification;

std::string significant(double x, int digits) {
  return base::readable(x, digits);
}

std::string resolved(double x, double width) {
  if (x == 0.0 || !std::isfinite(x)) return significant(x, 3);
  int digits = 3;
  if (width > 0.0) {
    digits = std::clamp(
        static_cast<int>(std::floor(std::log10(std::abs(x))) - std::floor(std::log10(width))) + 2,
        3, 10);
  }
  // Plain notation for numbers of usual size.
  const double size = std::abs(x);
  if (size >= 1000.0 && size < 1e7) {
    return fixed(x, std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size)))));
  }
  return significant(x, digits);
}

std::string rounded_count(double x) {
  if (!(x < 1e15)) return "-";
  const double unit = x < 1000.0 ? 1.0 : std::pow(10.0, std::floor(std::log10(x)) - 2.0);
  return fixed(std::round(x / unit) * unit, 0);
}

std::string percent(double probability) {
  if (probability > 0.999) return "> 99.9 %";
  if (probability < 0.001) return "< 0.1 %";
  return significant(100.0 * probability, probability < 0.0995 ? 2 : 3) + " %";
}

std::string percent(double probability, double error) {
  if (!std::isfinite(error)) return percent(probability);
  if (probability > 0.999 || probability < 0.001) {
    if (2.0 * error <= 0.001) return percent(probability);
    const double least = std::floor(100.0 * std::max(0.0, probability - 2.0 * error));
    const double most = std::ceil(100.0 * std::min(1.0, probability + 2.0 * error));
    return probability > 0.5 ? "> " + fixed(std::min(least, 99.0), 0) + " %"
                             : "< " + fixed(std::max(most, 1.0), 0) + " %";
  }
  return percent(probability) + shown_error(probability, error);
}

std::string shown_error(double probability, double error) {
  if (!std::isfinite(error) || probability > 0.999 || probability < 0.001) return {};
  return " ± " + significant(100.0 * error, 2) + " %";
}

std::string probability_is(double probability) {
  return (probability > 0.999 || probability < 0.001 ? "P " : "P = ") + percent(probability);
}

std::string p_value(double p) {
  return p < 1e-15 ? "p < 1e-15" : "p " + significant(p, 1);
}

std::string duration(double seconds) {
  if (seconds < 9.95) return significant(seconds, 2) + " s";
  if (seconds < 100.0) return fixed(seconds, 0) + " s";
  if (seconds < 6000.0) return fixed(seconds / 60.0, 0) + " min";
  if (seconds < 3.6e5) return fixed(seconds / 3600.0, seconds < 3.6e4 ? 1 : 0) + " h";
  const double days = seconds / 86400.0;
  return (days < 1e6 ? fixed(days, 0) : significant(days, 2)) + " days";
}

std::string share_of_response(double nrmse) {
  return (nrmse < 0.995 ? significant(100.0 * nrmse, 2) : fixed(100.0 * nrmse, 0)) +
         " % of the response";
}

std::vector<std::string> shortened(std::vector<std::string> items, std::size_t most) {
  if (items.size() <= most) return items;
  const std::string rest = std::to_string(items.size() - most) + " more";
  items.resize(most);
  items.push_back(rest);
  return items;
}

std::string in_words(const std::vector<std::string>& items, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " " + last + " " : ", ";
    text += items[i];
  }
  return text;
}

std::string name_modes(const std::vector<int>& modes) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < modes.size();) {
    std::size_t j = i;
    while (j + 1 < modes.size() && modes[j + 1] == modes[j] + 1) ++j;
    if (j > i + 1) {
      parts.push_back(std::to_string(modes[i]) + " to " + std::to_string(modes[j]));
    } else {
      for (std::size_t n = i; n <= j; ++n) parts.push_back(std::to_string(modes[n]));
    }
    i = j + 1;
  }
  return (modes.size() == 1 ? "mode " : "modes ") + in_words(parts);
}

std::string entered_in_words(long entered, long proposed) {
  if (proposed == 0 && entered == 0) return "no jump proposed";
  const std::string of = grouped(proposed) + (proposed == 1 ? " proposal" : " proposals");
  if (entered == 0) return "no jump accepted in " + of;
  return "jump accepted " + (entered == 1 ? std::string("once") : grouped(entered) + " times") +
         " in " + of + ", but no draw kept";
}

std::string told_by_evidence(const ModelFinding& model) {
  const inference::ModelStanding& s = model.standing;
  const bool known = s.basis == inference::Basis::evidence;
  if (s.passed_over)
    return s.entered > 0
               ? entered_in_words(s.entered, s.proposed) + "; its evidence was not evaluated"
               : "not evaluated: the models with one term fewer or more are improbable";
  if (s.visited != 0 && !known) return {};
  std::string text = s.visited != 0
                         ? "drawn by only " + std::to_string(s.visited) + " of the chains; "
                         : entered_in_words(s.entered, s.proposed) + "; ";
  if (!known) return text + "its evidence is not known";
  if (model.prior == 0.0) return "has no prior probability";
  if (!(s.probability > 1e-300)) return text + "its evidence implies P < 1e-300";
  text += "its evidence implies P ≈ " + significant(s.probability, 3);
  if (std::isfinite(s.mcse) && s.mcse > 0.0) text += " ± " + significant(s.mcse, 1);
  return text;
}

std::string resolution_in_words(const inference::Verdict& verdict) {
  if (!(verdict.resolution > 0.0 && verdict.resolution < 1.0)) return {};
  std::string text = "posterior modes with a basin of attraction below " +
                     significant(100.0 * verdict.resolution, 2) +
                     " % of the prior probability may have been missed";
  if (verdict.resolved_width > 0.0) {
    text += ". This limit increases as 1 / width for posterior modes narrower than " +
            significant(verdict.resolved_width, 1) +
            " standard deviations of the prior; posterior modes narrower than " +
            significant(verdict.resolution * verdict.resolved_width, 1) +
            " standard deviations may have been missed, whatever their basin";
  }
  if (verdict.glanced > 0) {
    text += ". This resolution applies to models with a probability of " +
            significant(100.0 * inference::kLimits.searched_model, 1) + " % or more; " +
            (verdict.glanced == 1 ? "1 other" : std::to_string(verdict.glanced) + " others") +
            " had only a short search, started from the posterior modes of models with a subset of "
            "their terms";
  }
  if (verdict.passed_over > 0) {
    text += "; " +
            (verdict.passed_over == 1 ? "1 model was"
                                      : std::to_string(verdict.passed_over) + " models were") +
            " not evaluated, because the models with one term fewer or more are improbable";
  }
  return text;
}

std::string symmetry_statement(bool emulated) {
  const std::string start =
      "The intact beam is symmetric, so its frequencies cannot distinguish a location x from its "
      "mirror image L - x";
  return emulated
             ? start +
                   ". If the posterior prefers one side, the cause is the emulator, not the data."
             : start + ": each reported location represents both.";
}

std::string baseline_statement(const identification::Baseline& baseline) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < baseline.model_hz.size(); ++i) {
    const double off = 100.0 * (baseline.measured_hz[i] / baseline.model_hz[i] - 1.0);
    if (std::isnan(off)) continue;
    low = std::min(low, off);
    high = std::max(high, off);
  }
  return "the measured frequencies of the undamaged structure differ from the model by " +
         significant(low, 2) + " to " + significant(high, 2) +
         " %; Wheeltap evaluates changes from the baseline and scales the "
         "reported frequencies to the model.";
}

std::string images_statement(const std::vector<std::vector<std::string>>& alike,
                             const std::vector<std::string>& turned) {
  static constexpr std::size_t kNamed = 8;
  const auto some = [](const std::vector<std::string>& names) {
    return in_words(shortened(names, kNamed));
  };
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(alike.size(), kNamed); ++i)
    parts.push_back((i == 0 ? "" : "nor ") + some(alike[i]));
  if (alike.size() > kNamed)
    parts.push_back("nor " + std::to_string(alike.size() - kNamed) + " more such groups");
  if (!turned.empty())
    parts.push_back((parts.empty() ? "" : "nor ") + std::string("a location s on ") + some(turned) +
                    " from L - s");
  std::string text = "The intact structure is symmetric, so its frequencies cannot distinguish ";
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : ", ") + parts[i];
  return text +
         ": a damage at one location represents all locations that are equivalent by symmetry.";
}

std::string emulator_warning(int damages, const std::vector<int>& blind) {
  if (blind.empty()) return {};
  return "With " + std::to_string(damages) + (damages == 1 ? " damage" : " damages") +
         " the emulator cannot predict " + name_modes(blind) +
         ": the emulator error for these modes is a third of the damage effect or more (Q2 < 0.9). "
         "Use more sites "
         "(\"sites\": \"every-element\"), \"coordinate\": \"compliance\", or "
         "\"predictor\": \"fe\".";
}

std::string in_words(inference::Choice choice) {
  switch (choice) {
    case inference::Choice::restarted_tempered:
      return "The chains disagreed, so Wheeltap restarted them with parallel tempering in warm-up "
             "and sampling.";
    case inference::Choice::started_on_first_samples:
      return "The record is long, so the chains started near posterior modes found in its first "
             "samples, and Wheeltap tracked these modes as more samples were added.";
    case inference::Choice::drawn_by_searches:
      return "The run stopped before each chain had 100 draws. The reported draws lie in the "
             "neighbourhood of the posterior modes "
             "that the searches found.";
  }
  return {};
}

std::string impossible_in_words(const std::string& model) {
  return "The likelihood of model '" + model +
         "' is zero for every draw from its prior, so its probability is 0. If this model "
         "should be possible, check its priors.";
}

std::string in_words(const Look& look) {
  return "The quick run used only the first " + std::to_string(look.samples) + " of " +
         std::to_string(look.of) + " samples.";
}

std::string repeat_note(const StepsRefined& refined) {
  const std::string limit = "the step limit " + significant(refined.step_limit, 2);
  const bool shorter = refined.step_limit < dynamics::SimulatorOptions{}.step_limit;
  return "The integrator's time steps were too long for the noise of this record, so the run was "
         "repeated with " +
         (refined.by_series ? shorter ? "Taylor series and " + limit : "Taylor series" : limit) +
         ".";
}

std::string coefficients_in_words(const TermFinding& term) {
  std::string text;
  for (const ParameterFinding& p : term.parameters) {
    const Marginal& e = p.estimate;
    text += text.empty() ? "" : ", ";
    if (term.parameters.size() > 1) text += p.unknown.label + " ";
    text += resolved(e.q50, e.width()) + " (" + resolved(e.q2_5, e.width()) + " to " +
            resolved(e.q97_5, e.width()) + ")";
  }
  return text.empty() ? "-" : text;
}

std::string terms_in_words(const std::vector<TermFinding>& terms) {
  std::string text;
  for (std::size_t first = 0; first < terms.size();) {
    std::size_t last = first;
    std::vector<const TermFinding*> of_link;
    for (;
         last < terms.size() && terms[last].a == terms[first].a && terms[last].b == terms[first].b;
         ++last) {
      of_link.push_back(&terms[last]);
    }
    std::ranges::stable_sort(of_link, std::ranges::greater{}, &TermFinding::inclusion);
    std::vector<std::string> in, open, out;
    for (const TermFinding* term : of_link) {
      std::string name = term->name;
      std::ranges::replace(name, '_', ' ');
      (term->is_in()    ? in
       : term->is_out() ? out
                        : open)
          .push_back(name + " (" + percent(term->inclusion) + ")");
    }
    const std::string link = std::to_string(terms[first].a) + "-" + std::to_string(terms[first].b);
    std::string sentence;
    if (!in.empty()) {
      sentence = "The link " + link + " has " + in_words(in) +
                 (in.size() == 1 ? " as a term" : " as terms");
    } else {
      sentence =
          "The link " + link + (open.empty() ? " needs none of the terms" : " has no certain term");
    }
    if (!open.empty()) sentence += "; undecided: " + in_words(open);
    if (!out.empty()) sentence += "; no evidence for " + in_words(out, "or");
    text += (text.empty() ? "" : " ") + sentence + ".";
    first = last;
  }
  return text;
}

}  // namespace wheeltap::apps
