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
    return "the residual of " + quoted_channel(r.channel) + " is " + share_of_response(r.share) +
           " and not noise";
  }
  std::string operator()(const misfit::WorseBeyond& r) const {
    return "after the window the error of " + quoted_channel(r.channel) + " grows from " +
           significant(100.0 * r.inside, 2) + " to " + significant(100.0 * r.beyond, 2) + " %";
  }
  std::string operator()(const misfit::BeyondNoise& r) const { return "predictive " + p_is(r.p); }
  std::string operator()(const misfit::WithinNoise& r) const { return "predictive " + p_is(r.p); }
};

// One sentence for all reasons of one kind; each reason belongs to one response.
struct Sentence {
  template <class Reason>
  using All = std::vector<Reason>;

  std::string operator()(const All<misfit::Unexplained>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all)
      parts.push_back(quoted_channel(r.channel) + " (R² " + fixed(r.r2, 2) + ")");
    return "The model does not explain most of " + in_words(parts) +
           ", and the residual is not noise. Do not use parameters and credible intervals of this "
           "fit. "
           "Check channels, signs, units, the initial state and the sides of one-sided force laws "
           "against the record. Then check the models.";
  }
  std::string operator()(const All<misfit::NotNoise>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all) {
      std::string text = parts.empty() ? "The residual of " : "of ";
      text += quoted_channel(r.channel) + (parts.empty()
                                               ? " is " + share_of_response(r.share)
                                               : " " + significant(100.0 * r.share, 2) + " %");
      std::vector<std::string> more;
      if (r.lag > 0)
        more.push_back("correlation " + fixed(r.autocorrelation, 2) + " at lag " +
                       std::to_string(r.lag));
      if (std::isfinite(r.share_of_free))
        more.push_back("a chain of masses with free cubic springs leaves a residual of " +
                       significant(100.0 * r.share_of_free, 2) + " %");
      for (std::size_t i = 0; i < more.size(); ++i) text += (i == 0 ? " (" : "; ") + more[i];
      parts.push_back(text + (more.empty() ? "" : ")"));
    }
    return in_words(parts) +
           ", and not noise. The credible intervals do not include a model error of this size: add "
           "a model that explains more of the response.";
  }
  std::string operator()(const All<misfit::WorseBeyond>& all) const {
    std::vector<std::string> parts;
    for (const auto& r : all) {
      parts.push_back(quoted_channel(r.channel) + " by " + significant(100.0 * r.beyond, 2) +
                      (parts.empty() ? " % of the response, against " : " % against ") +
                      significant(100.0 * r.inside, 2) + " % within the window");
    }
    return "In the " + std::to_string(all.front().samples) +
           " samples after the window, the response of every draw differs from " + in_words(parts) +
           ": the model is valid within the window only.";
  }
  std::string operator()(const All<misfit::BeyondNoise>& all) const {
    const misfit::BeyondNoise& r = all.front();
    const std::string checks = p_is(r.p) + what_to_check(r.modes, r.emulated).insert(0, ")");
    if (r.chains_agree)
      return "No number of damages explains the frequencies within the stated noise (predictive " +
             checks;
    return "The Markov chains disagree and may have missed damages that explain the frequencies: "
           "run longer, without --quick. The draws so far do not explain the frequencies within "
           "the stated noise (predictive " +
           checks;
  }
  std::string operator()(const All<misfit::WithinNoise>& all) const {
    const misfit::WithinNoise& r = all.front();
    return "The frequencies agree with the model far more closely than the stated noise" +
           stated(r.cv) + " allows (predictive " + p_is(r.p) +
           "): the stated noise is too large (perhaps a number in per cent) and hides information "
           "in the data. Correct the stated noise, or infer the noise: \"cov\": "
           "{\"log_uniform\": [1e-4, 1e-1]}.";
  }
};

template <class Reason>
bool said_together(const Reason& /*first*/, const Reason& /*other*/) {
  return true;
}

bool said_together(const misfit::WorseBeyond& first, const misfit::WorseBeyond& other) {
  return first.samples == other.samples;  // different numbers: different records
}

}  // namespace

std::string stated(double cv) {
  return std::isfinite(cv) ? " of " + significant(100.0 * cv, 3) + " %" : "";
}

std::string what_to_check(const std::vector<int>& modes, bool emulated) {
  return (modes.empty() ? std::string()
                        : " (frequencies with errors above 3 sd: " + name_modes(modes) + ")") +
         (emulated ? ". The emulator error may be larger here than on average over the training "
                     "domain: try \"predictor\": \"fe\". If the misfit remains, check"
                   : ". Check") +
         " the model's properties, the mode numbering and data.cov before you use the locations; "
         "or infer the noise: \"cov\": {\"log_uniform\": [1e-4, 1e-1]}.";
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
