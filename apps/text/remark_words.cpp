// Remarks in words, and the one list that terminal, summary and report show.
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

// One overload a remark.
class Speaker {
 public:
  explicit Speaker(const Context& context) : context_(context) {}

  std::string operator()(const remark::ImpossibleLikelihoods& r) const {
    return "The likelihood was NaN or infinite at " + grouped(r.places) + " of " +
           grouped(r.evaluated) + " places: these count as impossible.";
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
           "; sample for longer before trusting either";
  }

  std::string operator()(const remark::NearlyPrior& r) const {
    constexpr std::size_t kNamed = 6, kLongNames = 60;
    // One of several models: by its name if it is the only one, else all that have it together.
    std::vector<std::string> names, loose;
    for (const auto& p : r.parameters)
      if (std::ranges::find(names, p.name) == names.end()) names.push_back(p.name);
    for (const std::string& name : names) {
      if (loose.size() == kNamed) {
        loose.push_back(std::to_string(names.size() - kNamed) + " more");
        break;
      }
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
    return "Nearly the prior: the data say little about " + in_words(loose) +
           ". Such a posterior repeats what the case assumed; do not report it as a finding.";
  }

  std::string operator()(const remark::ImplausibleMaterial& r) const { return sentence(r); }
  std::string operator()(const remark::DeepSection& r) const { return sentence(r); }
  std::string operator()(const remark::TwinMembers& r) const { return sentence(r); }
  std::string operator()(const remark::UnusedNodes& r) const { return sentence(r); }
  std::string operator()(const remark::CrossingMembers& r) const { return sentence(r); }
  std::string operator()(const remark::SensorsAtOnePlace& r) const { return sentence(r); }
  std::string operator()(const remark::FrequenciesOutOfReach& r) const {
    return "The measured frequencies are far from anything that this model does, whatever its "
           "damage: mode " +
           std::to_string(r.mode) + " is measured at " + significant(r.measured, 4) +
           " Hz and predicted at " + significant(r.lowest, 4) + " to " + significant(r.highest, 4) +
           " Hz, and over the modes measured frequencies are " + significant(r.ratio, 3) +
           " times those predicted. Check units (m, Pa, kg/m³, Hz), dimensions, supports and the "
           "numbering of the modes: a length in mm makes a factor of 10^6.";
  }
  std::string operator()(const remark::NoiseHidesDamage& r) const {
    return "The stated noise" + stated(r.cv) +
           " hides whatever damage may do: of all damages that the prior allows, the largest moves "
           "a frequency by " +
           significant(r.effect, 2) +
           " of its noise. Frequencies are commonly known to 0.01 to 1 % (\"cov\": 0.0001 to "
           "0.01); is the number in per cent?";
  }
  std::string operator()(const remark::MirrorImages& r) const {
    return symmetry_statement(r.emulated) +
           " To tell them apart, measure mode shapes or add a small mass off the middle.";
  }
  std::string operator()(const remark::StructureImages& r) const {
    return images_statement(r.alike, r.turned) +
           " To tell them apart, measure mode shapes or add a small mass that breaks the symmetry.";
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
    return "The data do not say which: " + in_words(list, "or") + ". It is one of these with " +
           probability_is(std::min(sum, 1.0)) +
           ", hardly ever two at once. To tell them apart, measure mode shapes or more "
           "modes, or look there.";
  }
  std::string operator()(const remark::FittedNotTested& r) const {
    return "The " + unknowns_of(r.unknowns) + " of " + r.model + " are fitted to " +
           frequencies_of(r.frequencies) +
           ", not tested by them: how bad the fit of a wrong model would be cannot be seen, and "
           "the intervals are dominated by the priors. Measure more frequencies.";
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
           ". The case fixes what one " + kind.name + " covers (" + length_in_words(most.fixed) +
           (kind.extent ? "" : ", one element") +
           "), so that its count depends on that length. Infer the length: \"extent\": "
           "{\"uniform\": [0, " +
           significant(0.2 * longest, 2) + "]} in " +
           context_.kinds[static_cast<std::size_t>(r.kind)] + ".";
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
    return "The posterior of the " + kind.severity_name() +
           " piles up at the upper bound of its prior, " + kind.severity_prior()->describe() +
           ": larger values would fit as well. Widen the prior if they are possible.";
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

  std::string operator()(const remark::TruthOutsidePriors& r) const {
    std::vector<std::string> list;
    for (const auto& p : r.parameters)
      list.push_back("\"" + p.name + "\" = " + significant(p.value, 6) + " (" + p.prior + ")");
    return "The true model has parameters that their priors exclude, so that no run can find it: " +
           in_words(list) + ". Are they in SI units?";
  }
  std::string operator()(const remark::ResponsesOutOfReach& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" (measured " + significant(channel.measured, 3) +
                     ", predicted " + significant(channel.lowest, 3) + " to " +
                     significant(channel.highest, 3) + ", root mean squares in SI units)");
    }
    return "No parameters that the priors allow give a response of the measured size: " +
           in_words(list) + ". Check the units and scales of the channels, masses and priors.";
  }
  std::string operator()(const remark::NoiseAboveResponse& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" (noise " + significant(channel.noise, 3) +
                     ", response " + significant(channel.response, 3) + " RMS)");
    }
    return "The stated noise is larger than the response itself: " + in_words(list) +
           ". Is it in other units than the response?";
  }
  std::string operator()(const remark::PeculiarWindow& r) const {
    const auto decibel = [](double x) { return fixed(x, 0) + " dB"; };
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" by " + decibel(channel.difference_db) +
                     " (scatter alone gives " + decibel(channel.scatter_db) + ")");
    }
    return "The window is not like the rest of the record: its spectra differ, " + in_words(list) +
           ". What is found holds for the window; try another, or a longer one.";
  }
  std::string operator()(const remark::LinearExcitation& r) const {
    return "The excitation \"" + r.channel +
           "\" is taken as linear between its samples; if it was measured behind an anti-alias "
           "filter this loses " +
           fixed(100.0 * r.loss, 0) +
           " % of its amplitude. Then set \"between_samples\": \"band-limited\" in the record.";
  }
  std::string operator()(const remark::UnknownUnits& r) const {
    std::vector<std::string> list;
    for (const auto& channel : r.channels) {
      list.push_back("\"" + channel.name + "\" in " + channel.unit + " (known units of " +
                     channel.dimension + ": " + channel.known + ")");
    }
    return "Channels without \"scale\" whose units are not known are used as they are, as if they "
           "were in SI units: " +
           in_words(list) + ".";
  }
  std::string operator()(const remark::UnevenTime& r) const { return jitter_in_words(r.sampling); }
  std::string operator()(const remark::BaseIntegrated&) const {
    return "Responses are absolute and only the base's acceleration was measured, so its motion "
           "was integrated, less a drift of second order in time that the responses do not have: "
           "slower drifts of the rig itself are taken for the base's.";
  }
  std::string operator()(const remark::MostProbableFails& r) const {
    std::string why;
    for (const auto& reason : r.why) why += (why.empty() ? "" : "; ") + in_brief(reason);
    return "\"" + r.model + "\", the most probable model, does not explain the record (" + why +
           "); \"" + r.other +
           "\", which the window leaves possible, does. A window in which they "
           "differ would decide between them.";
  }
  std::string operator()(const remark::MostlyNoise& r) const {
    return "Under \"" + r.model + "\" most of \"" + r.channel + "\" is noise (R² " +
           significant(r.r2, 2) +
           ", what is left is white): the record says little of the response.";
  }
  std::string operator()(const remark::InitialStateInferred& r) const {
    return "The window does not start at rest (the responses begin at " + percent(r.share) +
           " of their root mean square), so the initial state is inferred, with normal priors of "
           "the responses' size; \"initial\": \"rest\" in the record would hold it at rest.";
  }
  std::string operator()(const remark::StepsTooLong& r) const {
    return "Under \"" + r.model + "\" steps a quarter as long change the best draw's response by " +
           significant(r.error, 2) +
           " of the noise (root of the sum of squares): parameters may be off by up to " +
           significant(r.error, 2) + " standard deviations for the steps alone. " +
           (r.fixed ? "Leave \"integration\" out of the case, and the run is repeated with better "
                      "ones; or lower its \"step_limit\"."
                    : "A run that is neither quick nor stopped is repeated with better ones, twice "
                      "at most; a lower \"step_limit\" (\"integration\") goes further.");
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
      coloured += (coloured.empty() ? "\"" : ", \"") + channel.name + "\" (" +
                  share_of_response(channel.share) + ", correlation " +
                  fixed(channel.autocorrelation, 2) + " at lag " + std::to_string(channel.lag) +
                  ", " + p_value(channel.p_value) + ")";
    }
    return "Under \"" + r.model + "\" the residuals are not white: " + coloured + ". " +
           (!r.residual_model.empty()
                ? "The " + r.residual_model + " does not take up all of it: " + r.remedy +
                      (r.remedy.empty() ? "" : ", or ") + "offer a model that explains more."
                : "The likelihood takes them for independent, so its probabilities and intervals "
                  "are too sure; add \"residuals\": {\"" +
                      std::string(residual_kinds().front()->key) +
                      "\": \"auto\"} to the case, or a model that explains more.") +
           (r.others.empty()       ? ""
            : r.others.size() == 1 ? " Under \"" + r.others[0] + "\" they are much the same."
                                   : " Under " + std::to_string(r.others.size()) +
                                         " other models they are much the same.");
  }
  std::string operator()(const remark::ParameterAtBound& r) const {
    return "Under \"" + r.model + "\" the posterior of " + r.parameter + " piles up at the " +
           (r.upper ? "upper" : "lower") + " bound of its prior, " + r.prior +
           ": widen the prior unless that bound is certain.";
  }
  std::string operator()(const remark::StopNotReached& r) const {
    const auto end = [](int mass) {
      return mass == 0 ? std::string("the ground") : "mass " + std::to_string(mass);
    };
    return "Under \"" + r.model + "\" the motion does not come to where " + r.law + " (" +
           (r.opening ? "opening" : "closing") + ") between " + end(r.a) + " and " + end(r.b) +
           " begins to act: it goes to " + significant(r.reach, 3) + " m to that side, and in " +
           percent(r.share) + " of the draws that is too little. The data say nothing else of " +
           r.law + ".";
  }
  std::string operator()(const remark::ScatterBetweenWindows& r) const { return sentence(r); }
  std::string operator()(const remark::WindowsUnsound& r) const { return sentence(r); }
  std::string operator()(const remark::ChangesTakenForExact& r) const {
    return "The model's frequencies are off by some " + percent(r.discrepancy) +
           " in every state, and what it says of their changes is taken for exact all the same: "
           "place and size of the damage look better known than they are. \"stiffness\": "
           "{\"log_uniform\": [0.01, 0.5]} in \"discrepancy\" (of matrices \"mixing\": 0.7) takes "
           "it in.";
  }
  std::string operator()(const remark::SpuriousMode& r) const {
    const std::string mode = "Mode " + std::to_string(r.mode) +
                             (std::isnan(r.hz) ? "" : " (" + significant(r.hz, 4) + " Hz)");
    return r.probability > 0.5
               ? mode + " is taken for none of the structure's (P " + percent(r.probability) +
                     "): it says next to nothing here. Look at it again, or leave it out."
               : mode + " may be none of the structure's (P " + percent(r.probability) +
                     "): it counts the less.";
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

// What to doubt first: answers that are wrong, then ones that are too sure, then what the data
// leave open, then what the case may mean otherwise.
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
  int operator()(const remark::FittedNotTested&) const { return 3; }
  int operator()(const remark::CannotExclude&) const { return 3; }
  int operator()(const remark::MirrorImages&) const { return 3; }
  int operator()(const remark::StructureImages&) const { return 3; }
  int operator()(const remark::RivalPlaces&) const { return 2; }
  int operator()(const remark::WindowsUnsound&) const { return 3; }
  int operator()(const remark::NearlyPrior&) const { return 4; }
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
