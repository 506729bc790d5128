#include "apps/text/fit_words.hpp"

#include <algorithm>
#include <cmath>

#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

std::string p_is(double p) {
  return p < 0.5 ? p_value(p) : "p " + (1.0 - p < 1e-4 ? std::string("> 0.9999") : fixed(p, 4));
}

std::string quoted_channel(const std::string& name) {
  return "\"" + name + "\"";
}

struct Brief {
  std::string operator()(const misfit::Unexplained& r) const {
    return "R² " + fixed(r.r2, 2) + " for " + quoted_channel(r.channel);
  }
  std::string operator()(const misfit::NotNoise& r) const {
    return "what is left of " + quoted_channel(r.channel) + " is " + share_of_response(r.share) +
           ", and no noise";
  }
  std::string operator()(const misfit::WorseBeyond& r) const {
    return "beyond the window the error of " + quoted_channel(r.channel) + " grows from " +
           significant(100.0 * r.inside, 2) + " to " + significant(100.0 * r.beyond, 2) + " %";
  }
  std::string operator()(const misfit::BeyondNoise& r) const { return "predictive " + p_is(r.p); }
  std::string operator()(const misfit::WithinNoise& r) const { return "predictive " + p_is(r.p); }
};

// Reasons of one kind, a response each, in one sentence.
struct Sentence {
  template <class Reason>
  using All = std::vector<Reason>;

  std::string operator()(const All<misfit::Unexplained>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all)
      parts.push_back(quoted_channel(r.channel) + " (R² " + fixed(r.r2, 2) + ")");
    return "The model misses most of " + in_words(parts) +
           " and what is left is no noise. Check that channels, signs, units, the initial state "
           "and the "
           "sides of one-sided laws are those of this record; then the models. Parameters and "
           "intervals mean nothing until "
           "then.";
  }
  std::string operator()(const All<misfit::NotNoise>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all) {
      std::string text = parts.empty() ? "What the model leaves of " : "of ";
      text += quoted_channel(r.channel) + (parts.empty()
                                               ? " is " + share_of_response(r.share)
                                               : " " + significant(100.0 * r.share, 2) + " %");
      std::vector<std::string> more;
      if (r.lag > 0)
        more.push_back("correlation " + fixed(r.autocorrelation, 2) + " at lag " +
                       std::to_string(r.lag));
      if (std::isfinite(r.share_of_free))
        more.push_back("a chain with free cubic springs leaves " +
                       significant(100.0 * r.share_of_free, 2) + " %");
      for (std::size_t i = 0; i < more.size(); ++i) text += (i == 0 ? " (" : "; ") + more[i];
      parts.push_back(text + (more.empty() ? "" : ")"));
    }
    return in_words(parts) +
           ", and no noise. Intervals here are those of a model that is wrong by so much: offer "
           "one that explains more.";
  }
  std::string operator()(const All<misfit::WorseBeyond>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all) {
      parts.push_back((parts.empty() ? "" : "of ") + quoted_channel(r.channel) + " by " +
                      significant(100.0 * r.beyond, 2) +
                      (parts.empty() ? " % of the response, against " : " % against ") +
                      significant(100.0 * r.inside, 2) + " % within");
    }
    return "Run on beyond its window, the model misses the next " +
           std::to_string(all.front().samples) + " samples of " + in_words(parts) +
           ", whichever draw is taken: it is fitted to the window, not to the rig.";
  }
  std::string operator()(const All<misfit::BeyondNoise>& all) const {
    const misfit::BeyondNoise& r = all.front();
    return "No number of damages explains the frequencies within the stated noise (predictive " +
           p_is(r.p) + what_to_check(r.modes, r.emulated).insert(0, ")");
  }
  std::string operator()(const All<misfit::WithinNoise>& all) const {
    const misfit::WithinNoise& r = all.front();
    return "The frequencies agree with the model far more closely than the stated noise" +
           stated(r.cv) + " would have them (predictive " + p_is(r.p) +
           "): it is too large, perhaps in per cent. With it the data decide less than they could; "
           "or infer it: \"cov\": {\"log_uniform\": [1e-4, 1e-1]}.";
  }
};

template <class Reason>
bool said_together(const Reason& /*first*/, const Reason& /*other*/) {
  return true;
}

bool said_together(const misfit::WorseBeyond& first, const misfit::WorseBeyond& other) {
  return first.samples == other.samples;  // of another record where they differ
}

}  // namespace

std::string stated(double cv) {
  return std::isfinite(cv) ? " of " + significant(100.0 * cv, 3) + " %" : "";
}

std::string what_to_check(const std::vector<int>& modes, bool emulated) {
  return (modes.empty() ? std::string() : " (off by more than 3 sd: " + name_modes(modes) + ")") +
         (emulated ? ". The emulator's error may be larger here than on average over its box: try "
                     "\"predictor\": \"fe\". Otherwise check"
                   : ". Check") +
         " the model's properties, the mode numbering and data.cov before believing the locations; "
         "or "
         "infer the noise: \"cov\": {\"log_uniform\": [1e-4, 1e-1]}.";
}

std::vector<std::string> in_words(const FitVerdict& verdict) {
  std::vector<std::string> out;
  std::vector<bool> said(verdict.why.size(), false);
  for (std::size_t i = 0; i < verdict.why.size(); ++i) {
    if (said[i]) continue;
    std::visit(
        [&]<class Reason>(const Reason& first) {
          std::vector<Reason> all;
          for (std::size_t j = i; j < verdict.why.size(); ++j) {
            const auto* one = std::get_if<Reason>(&verdict.why[j]);
            if (one == nullptr || !said_together(first, *one)) continue;
            all.push_back(*one);
            said[j] = true;
          }
          out.push_back(Sentence{}(all));
        },
        verdict.why[i]);
  }
  return out;
}

std::string in_brief(const FitVerdict& verdict) {
  return in_brief(verdict.why.front());
}

std::string in_brief(const misfit::Reason& reason) {
  return std::visit(Brief{}, reason);
}

}  // namespace wheeltap::apps
