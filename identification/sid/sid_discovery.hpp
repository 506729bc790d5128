// Discovery of force laws: every subset of a list of terms is a model.
//
// If each of T terms is included with prior probability p, independently of the others, the model
// of subset S has the prior probability
//
//   P(S) = p^|S| (1 - p)^(T - |S|).
//
// The posterior inclusion probability of a term is the sum over the subsets that contain it
// (term_findings.hpp). A coefficient of a term is the same parameter in all subsets.
#pragma once

#include <cstddef>
#include <string>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Largest number of terms, which gives 2^10 models. Each model has a mode search, so more terms
/// would take hours instead of minutes.
inline constexpr std::size_t kMostTerms = 10;

/// "cubic", "contact closing"; "cubic 0-1" if `several` links have optional terms.
[[nodiscard]] std::string term_name(const dynamics::Law& law, const dynamics::Link& link,
                                    bool several);
/// Name of a coefficient's parameter: the term's name if the law has one coefficient, otherwise
/// with the coefficient's name: "contact gap", "contact gap closing", "contact gap 0-1".
[[nodiscard]] std::string term_parameter(const dynamics::Law& law, std::size_t coefficient,
                                         const dynamics::Link& link, bool several);

/// Replaces the only model by one model per subset of the terms; the previous model is that of the
/// empty subset. Subsets with fewer terms come first. Names list the base and the terms: "linear +
/// cubic + coulomb". Throws InvalidInput (models) unless there is one model and at most kMostTerms
/// terms.
void add_subsets(SidCase& sid_case);

/// Estimates the motion of the base model's links from the record. Responses are converted to
/// displacement, velocity and acceleration by their spectra, over the band that holds 99 % of the
/// displacement's power. A mass without a sensor gets the motion of the mass that moves most. The
/// tension of a link balances the inertia of, and the forces on, the masses that it connects to the
/// ground, in that band; their RMS values are added in quadrature. For a link in a loop, the larger
/// of the values at its two ends is used. The largest extension is measured; without a measured
/// displacement, it is three times the RMS. Throws InvalidInput (models) if the responses are
/// constant.
[[nodiscard]] std::vector<LinkMotion> link_motions(const SidCase& sid_case);

/// The default prior of a coefficient. With e, ė and T the link's motion, a coefficient c of a
/// tension c eᵖ ėᵍ has the scale
///
///   s = T / (eᵖ ėᵍ),
///
/// at which the term alone has the RMS tension of the link. The prior is N(0, s²), or half-normal
/// |N(0, s²)| for laws that resist motion (friction, drag, hysteresis). For a stop, which is
/// stiffer than its link, it is a half-normal with scale 10 s, and the gap is uniform up to the
/// largest extension. A yield extension is log-normal about e with a factor of e¹ for one sd. The
/// evidence depends on these widths: the Bayes factor against an unnecessary term is about the
/// ratio of the widths of its prior and its posterior. Throws std::invalid_argument for a
/// coefficient whose role (dynamics::LawRole) has no scale.
[[nodiscard]] inference::Prior default_prior(const dynamics::LawInfo& law, std::size_t coefficient,
                                             dynamics::Side side, const LinkMotion& motion);

/// Sets SidDiscovery::motions and the default priors. Also bounds trajectories at 30 times the
/// motion in the record (SimulatorOptions::displacement_bound): with draws of these priors, the
/// motion of softening springs may diverge, and drag may require shorter and shorter steps.
void set_term_priors(SidCase& sid_case);

}  // namespace wheeltap::identification
