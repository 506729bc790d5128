// Sentences of remarks, and the list of warnings that terminal, summary and report show.
#include <algorithm>
#include <cmath>

#include "apps/cases/records/record_reading.hpp"
#include "apps/structure_words.hpp"
#include "apps/text/damage_words.hpp"
#include "apps/text/fit_words.hpp"
#include "apps/text/sid_words.hpp"
#include "apps/text/verdict_words.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

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

// Converts remarks to sentences, with one overload per type of remark.
class Speaker {
 public:
  explicit Speaker(const Context& context) : context_(context) {}

  std::string operator()(const remark::ImpossibleLikelihoods& r) const {
    return "The likelihood was NaN or infinite at " + grouped(r.places) + " of " +
           grouped(r.evaluated) +
           " parameter vectors: Wheeltap assigns zero likelihood to these vectors.";
  }
  std::string operator()(const remark::EvidenceFailed& r) const {
    const bool failed = r.why.kind == inference::EvidenceWarning::Kind::failed;
    return "Evidence of " + r.model + " by " + method_name(r.method) + (failed ? " " : ": ") +
           describe(r.why) + ". The run itself is not affected.";
  }
  std::string operator()(const remark::EvidenceDisagrees& r) const {
    return method_name(r.method) + ": model '" + r.model + "': sampled probability " +
           probability_with_error(r.sampled, r.sampled_error) + ", but the evidences imply " +
           probability_with_error(r.implied, r.implied_error) +
           "; use more draws before you trust either probability";
  }

  std::string operator()(const remark::NearlyPrior& r) const {
    constexpr std::size_t kNamed = 6, kLongNames = 60;
    // Models that share a parameter form one entry.
    std::vector<std::string> names, loose;
    for (const auto& p : r.parameters)
      if (std::ranges::find(names, p.name) == names.end()) names.push_back(p.name);
    for (const std::string& name : names) {
      std::vector<std::string> models;
      std::vector<double> overlaps;
      for (const auto& p : r.parameters) {
        if (p.name != name) continue;
        models.push_back("\"" + p.model + "\"");
        overlaps.push_back(p.overlap);
      }
      const auto [low, high] = std::ranges::minmax(overlaps);
      std::string said = percent(low), of = in_words(models);
      if (percent(high) != said) said += " to " + percent(high);
      if (models.size() > 1 && of.size() > kLongNames)
        of = std::to_string(models.size()) + " models";
      loose.push_back(name + " under " + of + " (overlap " + said + ")");
    }
    return "The posterior nearly equals the prior: the data contain little information about " +
           in_words(shortened(std::move(loose), kNamed)) +
           ". Such a posterior repeats the assumptions of the case; do not report it as a result.";
  }

  std::string operator()(const remark::UncertainSpread& r) const {
    constexpr std::size_t kNamed = 6;
    std::vector<std::string> loose;
    for (const auto& p : r.parameters)
      loose.push_back(p.name + " under \"" + p.model + "\" (Monte Carlo error " + percent(p.error) +
                      ")");
    return "Rare draws far from the others determine the standard deviation of " +
           in_words(shortened(std::move(loose), kNamed)) +
           ". A second solution of small probability causes such draws. Report quantiles, or use "
           "more --draws.";
  }
  std::string operator()(const remark::ImplausibleMaterial& r) const { return sentence(r); }
  std::string operator()(const remark::DeepSection& r) const { return sentence(r); }
  std::string operator()(const remark::TwinMembers& r) const { return sentence(r); }
  std::string operator()(const remark::UnusedNodes& r) const { return sentence(r); }
  std::string operator()(const remark::CrossingMembers& r) const { return sentence(r); }
  std::string operator()(const remark::SensorsAtOnePlace& r) const { return sentence(r); }
  std::string operator()(const remark::FrequenciesOutOfReach& r) const {
    return "No damage within the priors gives frequencies near the measured ones: mode " +
           std::to_string(r.mode) + " is measured at " + significant(r.measured, 4) +
           " Hz and predicted at " + significant(r.lowest, 4) + " to " + significant(r.highest, 4) +
           " Hz. Over all modes, measured frequencies are " + significant(r.ratio, 3) +
           " times the predicted ones. Check units (m, Pa, kg/m³, Hz), dimensions, supports and "
           "the numbering of the modes: a length in mm gives a factor of 10^6.";
  }
  std::string operator()(const remark::NoiseHidesDamage& r) const {
    return "The stated noise" + stated(r.cv) +
           " hides the effect of any damage: the largest damage that the prior allows shifts a "
           "frequency by " +
           significant(r.effect, 2) +
           " standard deviations of its noise. Frequencies are commonly known to 0.01 to 1 % "
           "(\"cov\": 0.0001 to 0.01); is the stated number in per cent?";
  }
  std::string operator()(const remark::MirrorImages& r) const {
    return symmetry_statement(r.emulated) +
           " To distinguish mirror images, measure mode shapes or add a small mass off the middle.";
  }
  std::string operator()(const remark::StructureImages& r) const {
    return images_statement(r.alike, r.turned) +
           " To distinguish symmetric locations, measure mode shapes or add a small mass that "
           "breaks the "
           "symmetry.";
  }
  std::string operator()(const remark::RivalPlaces& r) const {
    static constexpr std::size_t kNamed = 8;
    const bool one_kind = std::ranges::all_of(
        r.places, [&](const auto& place) { return place.kind == r.places.front().kind; });
    std::vector<std::string> list;
    double sum = 0.0;
    for (const auto& place : r.places) {
      sum += place.probability;
      if (list.size() == kNamed) continue;
      const std::string kind = one_kind && !list.empty() ? "" : kind_of(place.kind).name + " ";
      list.push_back(kind + "at " + place.name + " (" + percent(place.probability) + ")");
    }
    if (r.places.size() > kNamed)
      list.push_back("at one of " + std::to_string(r.places.size() - kNamed) + " more");
    return "The data do not distinguish between these locations: " + in_words(list, "or") +
           ". One of these locations is damaged (" + probability_is(std::min(sum, 1.0)) +
           "), very rarely more than one. To distinguish them, measure mode shapes or more "
           "modes, or "
           "inspect these locations.";
  }
  std::string operator()(const remark::CommonFactor& r) const {
    return "Without damage, one factor of " + significant(r.factor, 4) +
           " on all frequencies of the model fits the " + frequencies_of(r.frequencies) +
           " within their noise (p = " + significant(r.p, 2) +
           "). A wrong Young's modulus, a wrong mass or another temperature has this effect. If "
           "these values are uncertain, the data do not show damage: infer them (Young's modulus: "
           "\"young\": \"E\", with a prior of E in \"parameters\"), or add frequencies measured "
           "on the intact structure (\"baseline\").";
  }
  std::string operator()(const remark::FittedNotTested& r) const {
    return "The " + unknowns_of(r.unknowns) + " of " + r.model + " are fitted to " +
           frequencies_of(r.frequencies) +
           ", so the data cannot test the model: a wrong model would fit equally well, and the "
           "priors dominate "
           "the intervals. Measure more frequencies.";
  }
  std::string operator()(const remark::CannotExclude& r) const {
    std::string text =
        frequencies_of(r.frequencies) + " cannot exclude " + r.model + " (" +
        probability_is(r.probability) + "): with " + unknowns_of(r.unknowns) +
        ", this model has at least as many unknowns as there are data and fits any data";
    for (const auto& hidden : r.hidden) {
      text += ". With this model, a further " + hidden.kind + " could lie between " +
              said(hidden.below) + " and " + said(hidden.above) + ", at " +
              significant(hidden.from, 2) + " to " + significant(hidden.to, 2) + " m (95 %)";
    }
    return text +
           ". Measure more frequencies. If an inspection excludes this model, lower "
           "damage.count.max.";
  }
  std::string operator()(const remark::NoModelFits& r) const {
    return "No model here fits the data well within the stated noise" +
           what_to_check(r.off, r.emulated);
  }
  std::string operator()(const remark::NeighbouringDamages& r) const {
    const DefectKind& kind = kind_of(r.kind);
    const MergedFinding& merged = *context_.damage->merged_of(r.kind);
    const MergedModel& most = merged.models.front();
    const auto& model = context_.damage->models[static_cast<std::size_t>(most.model)];
    const int damages = model.counts[static_cast<std::size_t>(r.kind)];
    double longest = 0.0;
    for (const SiteLine::Stretch& s : kind.line.stretches()) longest = std::max(longest, s.size);
    return "If " + model.name + ": " + longer_in_words(kind, damages, most) + " Neighbouring " +
           kind.plural + " counted as one: " + merged_counts_in_words(kind, merged) +
           ". The case fixes the length that one " + kind.name + " covers (" +
           length_in_words(most.fixed) + (kind.extent ? "" : ", one element") +
           "), and the count depends on that length. Infer the length: \"extent\": "
           "{\"uniform\": [0, " +
           significant(0.2 * longest, 2) + "]} in " +
           context_.kinds[static_cast<std::size_t>(r.kind)] + ".";
  }
  std::string operator()(const remark::LargestCount& r) const {
    const DefectKind& kind = kind_of(r.kind);
    return "The largest number of " + kind.plural + " that the case allows, " +
           std::to_string(kind.max_count) + ", has " + probability_is(r.probability) +
           ". The run did not consider larger numbers" +
           (r.untested ? ", which these data cannot test: measure more frequencies before you "
                         "increase "
                       : ": increase ") +
           context_.kinds[static_cast<std::size_t>(r.kind)] + ".count.max.";
  }
  std::string operator()(const remark::SeverityAtBound& r) const {
    const DefectKind& kind = kind_of(r.kind);
    return "The posterior of the " + kind.severity_name() +
           " piles up at the upper bound of its prior, " + kind.severity_prior()->describe() +
           ": larger values would fit equally well. Widen the prior if larger values are possible.";
  }
  std::string operator()(const remark::EmulatorBlind& r) const {
    return emulator_warning(r.damages, r.modes);
  }
  std::string operator()(const remark::EmulatorMoved&) const {
    const DamageFindings& found = *context_.damage;
    const EmulatorCheck& check = *found.emulator->check;
    const auto& worst = check.error_to_noise[static_cast<std::size_t>(check.worst_mode - 1)];
    const std::string ending = "At these draws, the largest emulator error is " +
                               significant(worst.rms, 2) + " times the sd of the noise, in mode " +
                               std::to_string(check.worst_mode) +
                               ". Use \"predictor\": \"fe\", add \"exact\": true, or choose a "
                               "better emulator (docs/emulators.md).";
    if (!check.conclusive) {
      return "The emulator error changed the results by more than these draws can measure: of " +
             std::to_string(check.draws) +
             " draws checked with the FE solution, the effective sample size is only about " +
             rounded_count(std::max(1.0, check.effective_share * check.draws)) + ". " + ending;
    }
    std::string text;
    for (std::size_t i = 0; i < check.moved.size() && i < 4; ++i) {
      const EmulatorCheck::Moved& moved = check.moved[i];
      const ModelFinding& model = found.models[static_cast<std::size_t>(moved.model)];
      text += i > 0 ? "; " : "";
      if (moved.parameter < 0) {
        text += "P(" + model.name + ") is " + percent(moved.shift.fe) + ", not " +
                percent(moved.shift.emulator);
      } else {
        const auto p = static_cast<std::size_t>(moved.parameter);
        text += "the mean of " + model.parameters[p].unknown.label + " with " + model.name +
                " is " + significant(moved.shift.fe, 3) + ", not " +
                significant(moved.shift.emulator, 3);
      }
    }
    return "The emulator error changed the results. With the FE solution, " + text + " (" +
           std::to_string(check.draws) + " draws checked). " + ending;
  }

  std::string operator()(const remark::TruthOutsidePriors& r) const {
    std::vector<std::string> list;
    for (const auto& p : r.parameters)
      list.push_back("\"" + p.name + "\" = " + significant(p.value, 6) + " (" + p.prior + ")");
    return "The priors exclude parameters of the true model, so that the run cannot find it: " +
           in_words(list) + ". Are these values and priors in SI units?";
  }
  std::string operator()(const remark::ResponsesOutOfReach& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" (measured " + significant(channel.measured, 3) +
                     ", predicted " + significant(channel.lowest, 3) + " to " +
                     significant(channel.highest, 3) + ", root mean squares in SI units)");
    }
    return "No parameters within the priors give a response of the measured size: " +
           in_words(list) + ". Check the units and scales of the channels, masses and priors.";
  }
  std::string operator()(const remark::NoiseAboveResponse& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" (noise " + significant(channel.noise, 3) +
                     ", response " + significant(channel.response, 3) + " RMS)");
    }
    return "The stated noise is larger than the response itself: " + in_words(list) +
           ". Is the noise in other units than the response?";
  }
  std::string operator()(const remark::PeculiarWindow& r) const {
    const auto decibel = [](double x) { return fixed(x, 0) + " dB"; };
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" by " + decibel(channel.difference_db) +
                     " (random variability alone gives " + decibel(channel.scatter_db) + ")");
    }
    return "The window differs from the rest of the record in the spectra of " + in_words(list) +
           ". The results are valid for the window only; try another window or a longer window.";
  }
  std::string operator()(const remark::LinearExcitation& r) const {
    return "Wheeltap interpolates the excitation \"" + r.channel +
           "\" linearly between its samples. If an anti-alias filter was used, the interpolation "
           "loses " +
           fixed(100.0 * r.loss, 0) +
           " % of the amplitude. In that case set \"between_samples\": \"band-limited\" in the "
           "record.";
  }
  std::string operator()(const remark::UnknownUnits& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" in " + channel.unit + " (known units of " +
                     channel.dimension + ": " + channel.known + ")");
    }
    return "Wheeltap does not know the units of these channels without \"scale\" and treats the "
           "units as SI units: " +
           in_words(list) + ".";
  }
  std::string operator()(const remark::UnevenTime& r) const { return jitter_in_words(r.sampling); }
  std::string operator()(const remark::BaseIntegrated&) const {
    return "Responses are absolute and only the acceleration of the base was measured. Wheeltap "
           "integrated this acceleration and removed a quadratic drift that the responses do not "
           "have: a slow drift of the structure itself then appears as a drift of the base.";
  }
  std::string operator()(const remark::MostProbableFails& r) const {
    std::string why;
    for (const auto& reason : r.why) why += (why.empty() ? "" : "; ") + in_brief(reason);
    return "\"" + r.model + "\", the most probable model, does not explain the record (" + why +
           "); \"" + r.other +
           "\" explains the record, and the window does not exclude this model. Use a window in "
           "which the predictions of both models differ.";
  }
  std::string operator()(const remark::MostlyNoise& r) const {
    return "Under \"" + r.model + "\", most of \"" + r.channel + "\" is noise (R² " +
           significant(r.r2, 2) +
           ", white residual): the record has little information about the response.";
  }
  std::string operator()(const remark::InitialStateInferred& r) const {
    const std::string share =
        r.share > 1.0 ? significant(r.share, 2) + " times" : percent(r.share) + " of";
    return "The window does not start at rest (the responses begin at " + share +
           " their root mean square). Wheeltap infers the initial state, with normal priors "
           "scaled by the responses. To fix the initial state at rest, write \"initial\": \"rest\" "
           "in the record.";
  }
  std::string operator()(const remark::StepsTooLong& r) const {
    return "Under \"" + r.model +
           "\", a quarter of the time step changes the response of the best draw by " +
           significant(r.error, 2) +
           " times the noise sd (norm over all samples): the time-step error may shift "
           "parameters "
           "by up to " +
           significant(r.error, 2) + " standard deviations. " +
           (r.fixed ? "Remove \"integration\" from the case, so that Wheeltap repeats the run with "
                      "smaller time steps, or lower \"step_limit\" in \"integration\"."
                    : "Wheeltap repeats a complete run with smaller time steps, at most twice. For "
                      "shorter time steps, lower \"step_limit\" in \"integration\".");
  }
  std::string operator()(const remark::MeansDoNotGoTogether& r) const {
    std::string errors;
    for (const auto& channel : r.channels) {
      errors += (errors.empty() ? "" : ", ") + channel.name + " " +
                significant(100.0 * channel.of_means, 3) + " % against " +
                significant(100.0 * channel.of_best, 3) + " %";
    }
    return "Under \"" + r.model +
           "\", the mean values of the parameters do not fit the record: the response computed "
           "with the mean values differs from the record by more than the response of the best "
           "draw (" +
           errors + "). Use draws, or \"best_draw\" in summary.json, not the mean values.";
  }
  std::string operator()(const remark::NoiseMisstated& r) const {
    std::string off;
    for (const auto& channel : r.channels) {
      off += (off.empty() ? "\"" : ", \"") + channel.name + "\" by a factor of " +
             significant(channel.factor, 3);
    }
    return "Under \"" + r.model + "\", the RMS residuals differ from the stated noise: " + off +
           ". Either the stated noise is wrong (make it a parameter), or no model here explains "
           "the record.";
  }
  std::string operator()(const remark::ColouredResiduals& r) const {
    std::string coloured;
    for (const auto& channel : r.channels) {
      coloured += (coloured.empty() ? "\"" : ", \"") + channel.name + "\" (" +
                  share_of_response(channel.share) + ", correlation " +
                  fixed(channel.autocorrelation, 2) + " at lag " + std::to_string(channel.lag) +
                  ", " + p_value(channel.p_value) + ")";
    }
    return "Under \"" + r.model + "\", the residuals are not white: " + coloured + ". " +
           (!r.residual_model.empty()
                ? "The " + r.residual_model + " does not represent all of their correlation: " +
                      r.remedy + (r.remedy.empty() ? "" : ", or ") + "add a model that fits better."
                : "The likelihood assumes independent residuals, so that probabilities are too "
                  "extreme and intervals too narrow; add \"residuals\": {\"" +
                      std::string(residual_kinds().front()->key) +
                      "\": \"auto\"} to the case, or a model that fits better.") +
           (r.others.empty()       ? ""
            : r.others.size() == 1 ? " Under \"" + r.others[0] + "\", the residuals are similar."
                                   : " Under " + std::to_string(r.others.size()) +
                                         " other models, the residuals are similar.");
  }
  std::string operator()(const remark::ParameterAtBound& r) const {
    return "Under \"" + r.model + "\", the posterior of " + r.parameter + " piles up at the " +
           (r.upper ? "upper" : "lower") + " bound of its prior, " + r.prior +
           ": widen the prior unless this bound is certain.";
  }
  std::string operator()(const remark::StopNotReached& r) const {
    const auto end = [](int mass) {
      return mass == 0 ? std::string("the ground") : "mass " + std::to_string(mass);
    };
    return "Under \"" + r.model + "\", the gap of " + r.law + " (" +
           (r.opening ? "opening" : "closing") + ") between " + end(r.a) + " and " + end(r.b) +
           " does not close in this record: the motion towards the stop is at most " +
           significant(r.reach, 3) + " m, less than the gap in " + percent(r.share) +
           " of the draws. The data have no other information about " + r.law + ".";
  }
  std::string operator()(const remark::ScatterBetweenWindows& r) const { return sentence(r); }
  std::string operator()(const remark::WindowsUnsound& r) const { return sentence(r); }
  std::string operator()(const remark::ChangesTakenForExact& r) const {
    return "The frequencies of the model are wrong by about " + percent(r.discrepancy) +
           " in every state, but the likelihood assumes that the model predicts changes exactly: "
           "the credible intervals of location and severity of the damage are too narrow. To "
           "include this error, "
           "set \"stiffness\": {\"log_uniform\": [0.01, 0.5]} in \"discrepancy\" (for matrices "
           "\"mixing\": 0.7).";
  }
  std::string operator()(const remark::SpuriousMode& r) const {
    const std::string mode = "Mode " + std::to_string(r.mode) +
                             (std::isnan(r.hz) ? "" : " (" + significant(r.hz, 4) + " Hz)");
    return r.probability > 0.5
               ? mode + " is probably spurious (P " + percent(r.probability) +
                     ") and has almost no influence. Check this mode, or leave it out of the data."
               : mode + " may be spurious (P " + percent(r.probability) +
                     "), so it has less influence than the other modes.";
  }

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

namespace {

// Order of warnings: wrong answers, too narrow intervals, questions that the data leave open,
// ambiguities of the case.
struct Rank {
  int operator()(const remark::ImplausibleMaterial&) const { return 0; }
  int operator()(const remark::DeepSection&) const { return 0; }
  int operator()(const remark::TwinMembers&) const { return 5; }
  int operator()(const remark::UnusedNodes&) const { return 5; }
  int operator()(const remark::CrossingMembers&) const { return 5; }
  int operator()(const remark::SensorsAtOnePlace&) const { return 5; }
  int operator()(const remark::FrequenciesOutOfReach&) const { return 0; }
  int operator()(const remark::NoiseHidesDamage&) const { return 0; }
  int operator()(const remark::ResponsesOutOfReach&) const { return 0; }
  int operator()(const remark::TruthOutsidePriors&) const { return 0; }
  int operator()(const remark::NoiseAboveResponse&) const { return 0; }
  int operator()(const remark::ImpossibleLikelihoods&) const { return 1; }
  int operator()(const remark::StepsTooLong&) const { return 1; }
  int operator()(const remark::EmulatorMoved&) const { return 1; }
  int operator()(const remark::EmulatorBlind&) const { return 1; }
  int operator()(const remark::EvidenceDisagrees&) const { return 1; }
  int operator()(const remark::NoModelFits&) const { return 2; }
  int operator()(const remark::NoiseMisstated&) const { return 2; }
  int operator()(const remark::MostProbableFails&) const { return 1; }
  int operator()(const remark::ColouredResiduals&) const { return 2; }
  int operator()(const remark::ScatterBetweenWindows&) const { return 2; }
  int operator()(const remark::MeansDoNotGoTogether&) const { return 3; }
  int operator()(const remark::MostlyNoise&) const { return 3; }
  int operator()(const remark::CommonFactor&) const { return 1; }
  int operator()(const remark::FittedNotTested&) const { return 3; }
  int operator()(const remark::CannotExclude&) const { return 3; }
  int operator()(const remark::MirrorImages&) const { return 3; }
  int operator()(const remark::StructureImages&) const { return 3; }
  int operator()(const remark::RivalPlaces&) const { return 2; }
  int operator()(const remark::WindowsUnsound&) const { return 3; }
  int operator()(const remark::NearlyPrior&) const { return 4; }
  int operator()(const remark::UncertainSpread&) const { return 4; }
  int operator()(const remark::NeighbouringDamages&) const { return 1; }
  int operator()(const remark::LargestCount&) const { return 4; }
  int operator()(const remark::SeverityAtBound&) const { return 4; }
  int operator()(const remark::SpuriousMode&) const { return 2; }
  int operator()(const remark::ChangesTakenForExact&) const { return 2; }
  int operator()(const remark::ParameterAtBound&) const { return 4; }
  int operator()(const remark::StopNotReached&) const { return 4; }
  int operator()(const remark::InitialStateInferred&) const { return 5; }
  int operator()(const remark::BaseIntegrated&) const { return 5; }
  int operator()(const remark::UnevenTime&) const { return 5; }
  int operator()(const remark::UnknownUnits&) const { return 5; }
  int operator()(const remark::LinearExcitation&) const { return 5; }
  int operator()(const remark::PeculiarWindow&) const { return 5; }
  int operator()(const remark::EvidenceFailed&) const { return 6; }
};

}  // namespace

std::vector<std::string> warnings(const Findings& findings, const Context& context) {
  std::vector<std::string> out =
      in_words(findings.sampling.verdict.not_established, *findings.space);
  for (std::string& sentence : in_words(findings.fit_verdict)) out.push_back(std::move(sentence));
  std::vector<const Remark*> ranked;
  for (const Remark& remark : findings.remarks) ranked.push_back(&remark);
  std::ranges::stable_sort(ranked, {}, [](const Remark* r) { return std::visit(Rank{}, *r); });
  for (const Remark* remark : ranked) out.push_back(sentence(*remark, context));
  return out;
}

}  // namespace wheeltap::apps
