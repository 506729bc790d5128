#include "apps/words.hpp"

#include <algorithm>
#include <cmath>

#include "apps/sid_words.hpp"
#include "apps/verdict_words.hpp"

namespace wheeltap::apps {

using namespace identification;

std::string resolved(double x, double width) {
  if (x == 0.0 || !std::isfinite(x)) return significant(x, 3);
  int digits = 3;
  if (width > 0.0) {
    digits = std::clamp(
        static_cast<int>(std::floor(std::log10(std::abs(x))) - std::floor(std::log10(width))) + 2,
        3, 10);
  }
  // No exponent where people would not write one.
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

std::string probability_is(double probability) {
  const std::string text = percent(probability);
  return text[0] == '<' || text[0] == '>' ? "P " + text : "P = " + text;
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

std::string told_by_evidence(const ModelFinding& model) {
  const inference::ModelStanding& s = model.standing;
  const bool known = s.basis == inference::Basis::evidence;
  if (s.visited != 0 && !known) return {};
  std::string text = s.visited != 0
                         ? "drawn by " + std::to_string(s.visited) + " of the chains only; "
                     : s.proposed > 0 ? "not entered in " + grouped(s.proposed) + " proposals; "
                                      : "never entered; ";
  if (!known) return text + "nothing is known of its evidence";
  if (model.prior == 0.0) return "has no prior probability";
  text += "its evidence puts it at P ≈ " + significant(s.probability, 3);
  if (std::isfinite(s.mcse)) text += " ± " + significant(s.mcse, 1);
  return text;
}

std::string resolution_in_words(const inference::Verdict& verdict) {
  if (!(verdict.resolution > 0.0 && verdict.resolution < 1.0)) return {};
  return "a mode that less than " + significant(100.0 * verdict.resolution, 2) +
         " % of the prior climbs to would probably not have been seen";
}

std::string symmetry_statement(bool emulated) {
  const std::string start =
      "The intact beam is symmetric, so its frequencies cannot tell a place x from its mirror "
      "image L - x";
  return emulated ? start +
                        ". Where the posterior prefers a side all the same, that comes from the "
                        "emulator, not from the data."
                  : start + ": each location named here stands for both.";
}

std::string emulator_warning(int damages, const std::vector<int>& blind) {
  if (blind.empty()) return {};
  return "With " + std::to_string(damages) + (damages == 1 ? " damage" : " damages") +
         " the emulator cannot predict " + name_modes(blind) +
         ": its error there is of the size of the damage effect itself (Q2 < 0.9). Use more "
         "sites (\"sites\": \"every-element\"), \"coordinate\": \"compliance\", or "
         "\"predictor\": \"fe\".";
}

namespace {

std::string unknowns_of(int n) {
  return std::to_string(n) + (n == 1 ? " unknown" : " unknowns");
}

std::string frequencies_of(int n) {
  return std::to_string(n) + (n == 1 ? " frequency" : " frequencies");
}

std::string said(const remark::Landmark& l) {
  using Kind = remark::Landmark::Kind;
  switch (l.kind) {
    case Kind::left_end:
      return "the left end";
    case Kind::right_end:
      return "the right end";
    case Kind::support:
      return "the support at " + significant(l.at, 3) + " m";
    case Kind::clamp:
      return "the clamp at " + significant(l.at, 3) + " m";
    case Kind::defect:
      break;
  }
  return "the " + l.name + " near " + significant(l.at, 3) + " m";
}

std::string probability_with_error(double p, double error) {
  return fixed(p, 4) + " ± " + fixed(error, 4);
}

// One overload a remark.
class Speaker {
 public:
  explicit Speaker(const Context& context) : context_(context) {}

  std::string operator()(const remark::ImpossibleLikelihoods& r) const {
    return "The likelihood was NaN or infinite at " + grouped(r.places) + " of " +
           grouped(r.evaluated) + " places: these count as impossible.";
  }
  std::string operator()(const remark::EvidenceFailed& r) const {
    return "Evidence of " + r.model + " by " + method_name(r.method) + " " + r.reason +
           ". The run itself is not affected.";
  }
  std::string operator()(const remark::EvidenceDisagrees& r) const {
    return method_name(r.method) + ": model '" + r.model + "': sampled probability " +
           probability_with_error(r.sampled, r.sampled_error) + ", but the evidences imply " +
           probability_with_error(r.implied, r.implied_error) +
           "; sample for longer before trusting either";
  }

  std::string operator()(const remark::MirrorImages& r) const {
    return symmetry_statement(r.emulated) +
           " To tell them apart, measure mode shapes or add a small mass off the middle.";
  }
  std::string operator()(const remark::FittedNotTested& r) const {
    return "The " + unknowns_of(r.unknowns) + " of " + r.model + " are fitted to " +
           frequencies_of(r.frequencies) +
           ", not tested by them: how bad the fit of a wrong model would be cannot be seen, and "
           "the intervals lean on the priors. Measure more frequencies.";
  }
  std::string operator()(const remark::CannotExclude& r) const {
    std::string text = frequencies_of(r.frequencies) + " cannot exclude " + r.model + " (" +
                       probability_is(r.probability) + "): with " + unknowns_of(r.unknowns) +
                       " it has as many as there are data, or more, and fits them however they "
                       "fall";
    for (const auto& hidden : r.hidden) {
      text += ". Under it, a further " + hidden.kind + " would hide between " + said(hidden.below) +
              " and " + said(hidden.above) + ", at " + significant(hidden.from, 2) + " to " +
              significant(hidden.to, 2) + " m (95 %)";
    }
    return text +
           ". Measure more frequencies, or rule it out by inspection and lower damage.count.max.";
  }
  std::string operator()(const remark::NoModelFits& r) const {
    return "No model here fits the data within the stated noise" +
           (r.off.empty() ? std::string() : " (off by more than 3 sd: " + name_modes(r.off) + ")") +
           (r.emulated
                ? ". The emulator's error may be larger here than on average over its box: try "
                  "\"predictor\": \"fe\". Otherwise check"
                : ". Check") +
           " the beam's properties, the mode numbering and data.cov before believing the "
           "locations; or infer the noise: \"cov\": {\"log_uniform\": [1e-4, 1e-1]}.";
  }
  std::string operator()(const remark::LargestCount& r) const {
    const DefectKind& kind = kind_of(r.kind);
    return "The largest number of " + kind.plural + " that the case allows, " +
           std::to_string(kind.max_count) + ", has " + probability_is(r.probability) +
           ". More were never asked about: raise " +
           context_.kinds[static_cast<std::size_t>(r.kind)] + ".count.max to ask.";
  }
  std::string operator()(const remark::SeverityAtBound& r) const {
    const DefectKind& kind = kind_of(r.kind);
    return "The " + kind.severity_name() + " leans on the end of its prior, " +
           kind.severity_prior()->describe() +
           ": the data would go beyond it. Widen the prior if that is possible.";
  }
  std::string operator()(const remark::EmulatorBlind& r) const {
    return emulator_warning(r.damages, r.modes);
  }
  std::string operator()(const remark::EmulatorMoved&) const {
    const DamageFindings& found = *context_.damage;
    const EmulatorCheck& check = *found.emulator->check;
    const auto& worst = check.error_to_noise[static_cast<std::size_t>(check.worst_mode - 1)];
    const std::string ending = "At these draws its error is " + significant(worst.rms, 2) +
                               " times the noise in mode " + std::to_string(check.worst_mode) +
                               ", its worst. Use \"predictor\": \"fe\", add \"exact\": true, or "
                               "choose a better emulator (docs/emulators.md).";
    if (!check.conclusive) {
      return "The emulator moved the answer, by more than its draws can tell: of " +
             std::to_string(check.draws) +
             " draws checked with the FE solution, the FE's likelihood puts its weight on some " +
             rounded_count(std::max(1.0, check.effective_share * check.draws)) + ". " + ending;
    }
    std::string text;
    for (std::size_t i = 0; i < check.moved.size() && i < 4; ++i) {
      const EmulatorCheck::Moved& moved = check.moved[i];
      const ModelFinding& model = found.models[static_cast<std::size_t>(moved.model)];
      text += i > 0 ? "; " : "";
      if (moved.parameter < 0) {
        text += "P(" + model.name + ") is " + percent(moved.shift.fe) + " and not " +
                percent(moved.shift.emulator);
      } else {
        const auto p = static_cast<std::size_t>(moved.parameter);
        text += "the mean of " + model.parameters[p].unknown.label + " with " + model.name +
                " is " + significant(moved.shift.fe, 3) + " and not " +
                significant(moved.shift.emulator, 3);
      }
    }
    return "The emulator moved the answer. By the FE solution " + text + " (" +
           std::to_string(check.draws) + " draws checked). " + ending;
  }

  std::string operator()(const remark::StepsTooLong& r) const {
    return "Under \"" + r.model + "\" steps a quarter as long change the best draw's response by " +
           significant(r.error, 2) +
           " of the noise (root of the sum of squares): parameters may be off by up to " +
           significant(r.error, 2) +
           " standard deviations for the steps alone. Leave \"integration\" out of the case, and "
           "the run is repeated with better ones; or lower its \"step_limit\".";
  }
  std::string operator()(const remark::MeansDoNotGoTogether& r) const {
    std::string errors;
    for (const auto& channel : r.channels) {
      errors += (errors.empty() ? "" : ", ") + channel.name + " " +
                significant(100.0 * channel.of_means, 3) + " % against " +
                significant(100.0 * channel.of_best, 3) + " %";
    }
    return "Under \"" + r.model +
           "\" the means of the parameters do not go together: a forward run with them misses the "
           "record by more than the best draw does (" +
           errors + "). Use draws, or \"best_draw\" in summary.json, not the means.";
  }
  std::string operator()(const remark::NoiseMisstated& r) const {
    std::string off;
    for (const auto& channel : r.channels) {
      off += (off.empty() ? "\"" : ", \"") + channel.name + "\" by a factor of " +
             significant(channel.factor, 3);
    }
    return "Under \"" + r.model + "\" the residuals differ from the stated noise: " + off +
           ". Either the noise is not what the case says (make it a parameter), or no model here "
           "explains the record.";
  }
  std::string operator()(const remark::ColouredResiduals& r) const {
    std::string coloured;
    for (const auto& channel : r.channels) {
      coloured += (coloured.empty() ? "\"" : ", \"") + channel.name + "\" (lag-1 " +
                  fixed(channel.lag_1, 2) + ", p " + significant(channel.p_value, 1) + ")";
    }
    return "Under \"" + r.model + "\" the residuals are not white: " + coloured +
           ". The likelihood takes them for independent, so its probabilities and intervals are "
           "too sure; add \"residuals\": {\"ar\": 2} to the case, or a model that explains more.";
  }
  std::string operator()(const remark::ParameterAtBound& r) const {
    return "Under \"" + r.model + "\" the parameter " + r.parameter + " leans on the " +
           (r.upper ? "upper" : "lower") + " end of its prior, " + r.prior +
           ": widen it unless that end is certain.";
  }
  std::string operator()(const remark::ScatterBetweenWindows& r) const { return sentence(r); }
  std::string operator()(const remark::WindowsUnsound& r) const { return sentence(r); }

 private:
  [[nodiscard]] const DefectKind& kind_of(int kind) const {
    return context_.damage_case->kinds[static_cast<std::size_t>(kind)];
  }
  const Context& context_;
};

}  // namespace

std::string sentence(const Remark& remark, const Context& context) {
  return std::visit(Speaker(context), remark);
}

std::string repeat_note(const StepsRefined& refined) {
  return "The integrator's steps were too long for the noise of this record, so the run was "
         "repeated with " +
         (refined.by_series ? "Taylor series."
                            : "a step limit of " + significant(refined.step_limit, 2) + ".");
}

std::vector<std::string> warnings(const Findings& findings, const Context& context,
                                  const std::vector<std::string>& of_case) {
  std::vector<std::string> out =
      in_words(findings.sampling.verdict.not_established, *findings.space);
  out.insert(out.end(), of_case.begin(), of_case.end());
  for (const Remark& remark : findings.remarks) out.push_back(sentence(remark, context));
  return out;
}

}  // namespace wheeltap::apps
