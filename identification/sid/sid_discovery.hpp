// Laws found, not only chosen: every subset of a list of terms is a model.
//
// With T terms of which each is there with probability p a priori, independently of the others, the
// model of subset S has the prior probability
//
//   P(S) = p^|S| (1 - p)^(T - |S|),
//
// and a term's inclusion probability given the data is the sum over the subsets that hold it
// (term_findings.hpp). A coefficient of a term is one parameter, whichever subset it stands in.
#pragma once

#include <cstddef>
#include <string>

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// 2^10 models: each of them is searched, so more would take hours where a few take a minute.
inline constexpr std::size_t kMostTerms = 10;

/// "cubic", "contact closing"; "cubic 0-1" where `link` is one of several.
[[nodiscard]] std::string term_name(const dynamics::Law& law, const dynamics::Link& link,
                                    bool several);
/// Of one coefficient: the term's own name where its law has one only, else with the coefficient's:
/// "contact gap", "contact gap closing", "contact gap 0-1".
[[nodiscard]] std::string term_parameter(const dynamics::Law& law, std::size_t coefficient,
                                         const dynamics::Link& link, bool several);

/// A model for every subset of the terms beside the only model there is, which is the empty one.
/// Subsets with fewer terms come first; "linear + cubic + coulomb" is called after the base and its
/// terms. Throws InvalidInput (models) unless there is one model and at most kMostTerms terms.
void add_subsets(SidCase& sid_case);

/// How the links of the base model move in the record. Responses are taken to displacement,
/// velocity and acceleration by their spectra, over the band that holds 99 % of the displacement's
/// power; a mass without a sensor moves as the mass that moves most. The tension is what the
/// accelerations of the masses that the link holds to the ground, and the forces on them in that
/// band, ask for, added in quadrature; in a loop, those of the larger of its two ends. Largest
/// extensions are those measured; three times the RMS where no displacement is. Throws InvalidInput
/// (models) where the responses are constant.
[[nodiscard]] std::vector<LinkMotion> link_motions(const SidCase& sid_case);

/// The prior of a coefficient where the case gives none. With e, ė and T the link's motion, a
/// coefficient c of a tension c eᵖ ėᵍ has the scale
///
///   s = T / (eᵖ ėᵍ),
///
/// the value at which the term alone carries as much as the whole link, RMS. It is N(0, s²), or
/// half-normal |N(0, s²)| for laws that resist motion (friction, drag, hysteresis). A stop is a
/// half-normal of 10 s, being stiffer than what it stops, with its gap uniform up to the largest
/// extension; a yield extension is log-normal about e with a factor of e¹ for one sd. Evidence
/// depends on these widths: a term that the data do not need is held against by about the ratio of
/// its posterior's width to its prior's. Throws std::invalid_argument for a coefficient whose role
/// (dynamics::LawRole) has no scale.
[[nodiscard]] inference::Prior default_prior(const dynamics::LawInfo& law, std::size_t coefficient,
                                             dynamics::Side side, const LinkMotion& motion);

/// Sets SidDiscovery::motions and the priors that the case leaves to the record. Springs that
/// soften without end run away under their priors, in ever shorter steps where something drags: a
/// trajectory that goes 30 times as far as the record counts as grown beyond bounds
/// (SimulatorOptions::displacement_bound).
void set_term_priors(SidCase& sid_case);

}  // namespace wheeltap::identification
