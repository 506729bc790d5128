// Discovery of force laws: every subset of a list of terms is a model.
//
// A priori, each of T terms is included with probability p, independently of the other terms. The
// model of subset S then has the prior probability
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

/// Largest number of terms, which gives 2^10 models. Each model needs a search for its posterior
/// modes, so that more terms would take hours instead of minutes.
inline constexpr std::size_t kMostTerms = 10;

/// Name of a term: "cubic", "contact closing", or "cubic 0-1" if `several` links have optional
/// terms.
[[nodiscard]] std::string term_name(const dynamics::Law& law, const dynamics::Link& link,
                                    bool several);
/// Name of the parameter of a coefficient. If the force law has one coefficient, the parameter has
/// the name of the term. If the force law has several coefficients, the name also contains the name
/// of the coefficient: "contact gap", "contact gap closing", "contact gap 0-1".
[[nodiscard]] std::string term_parameter(const dynamics::Law& law, std::size_t coefficient,
                                         const dynamics::Link& link, bool several);

/// Replaces the single model of the case by one model per subset of the terms. The original model
/// becomes the model of the empty subset. Subsets with fewer terms come first. Names list the base
/// and the terms: "linear + cubic + coulomb". Throws InvalidInput (models) unless there is one
/// model and at most kMostTerms terms.
void add_subsets(SidCase& sid_case);

/// Estimates the motion of the base model's links from the record. The spectra of the responses
/// give displacement, velocity and acceleration in the band with 99 % of the displacement's power.
/// A mass without a sensor is assigned the largest response of the measured masses. In this band,
/// the tension of a link balances the inertia forces and external forces of the masses that the
/// link connects to the ground. The squares of the RMS values of these forces are added. If the
/// link is in a loop, its tension is the larger of the RMS forces on the masses at its two ends.
/// The largest extension of a link is the measured extension or, without measured displacements,
/// three times the RMS extension. Throws InvalidInput (models) if the responses are constant.
[[nodiscard]] std::vector<LinkMotion> link_motions(const SidCase& sid_case);

/// The default prior of a coefficient. Let e, ė and T be the RMS extension, rate and tension of the
/// link (LinkMotion). A coefficient c of the tension c eᵖ ėᵍ then has the scale
///
///   s = T / (eᵖ ėᵍ),
///
/// with which the term alone produces the RMS tension of the link. The prior is N(0, s²), or
/// half-normal |N(0, s²)| for force laws that resist motion (friction, drag, hysteresis). A stop is
/// stiffer than its link: the prior of its stiffness is half-normal with the scale 10 s. The prior
/// of the gap is uniform up to the largest extension. The prior of a yield extension is log-normal
/// about e, with sd 1 of the logarithm. The evidence depends on the widths of these priors: the
/// Bayes factor against an unnecessary term is about the prior width of its coefficient divided by
/// the posterior width. Throws std::invalid_argument for a coefficient whose role
/// (dynamics::LawRole) has no scale.
[[nodiscard]] inference::Prior default_prior(const dynamics::LawInfo& law, std::size_t coefficient,
                                             dynamics::Side side, const LinkMotion& motion);

/// Sets SidDiscovery::motions and the default priors. The function also limits simulated
/// displacements to 30 times the motion in the record (SimulatorOptions::displacement_bound). With
/// draws of the default priors, the motion of softening springs may diverge, and drag may require
/// ever shorter time steps.
void set_term_priors(SidCase& sid_case);
/// The displacement [m] that no posterior draw reaches: 30 times the motion of the record, or the
/// bound of the case if that is smaller. Beyond it, a predicted motion counts as unstable.
[[nodiscard]] double runaway_bound(const SidCase& sid_case);

}  // namespace wheeltap::identification
