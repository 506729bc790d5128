#include "identification/structural/damage/findings/merged_damages.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace wheeltap::identification {
namespace {

using Component = DamageProblem::Component;

constexpr double kToleratedLoss = 2.0;     // tolerated loss of ln likelihood
constexpr double kLongestMerged = 0.25;    // length relative to the member
constexpr std::size_t kMergedDraws = 200;  // per model
constexpr double kImprobable = 1e-4;       // less probable models do not affect the counts

/// A loss of stiffness over a length of a member or beam [m].
struct Stretched {
  int stretch;
  double middle, length, reduction;
  bool merged = false;

  [[nodiscard]] double flexibility() const { return length * reduction / (1.0 - reduction); }
};

/// One damage with the same total flexibility, centre and spread as both damages; empty if it would
/// be too long.
std::optional<Stretched> joined(const Stretched& a, const Stretched& b, double longest) {
  if (a.stretch != b.stretch) return {};
  const bool same_place = std::abs(a.middle - b.middle) < 1e-9 * a.length && a.length == b.length;
  Stretched out{.stretch = a.stretch, .middle = a.middle, .length = a.length, .reduction = 0.0};
  out.merged = true;
  if (same_place) {
    out.reduction = 1.0 - (1.0 - a.reduction) * (1.0 - b.reduction);
    return out;
  }
  const double ca = a.flexibility(), cb = b.flexibility(), sum = ca + cb;
  if (!(sum > 0.0)) return out;
  out.middle = (ca * a.middle + cb * b.middle) / sum;
  const auto spread = [&](const Stretched& one) {
    return std::pow(one.middle - out.middle, 2) + one.length * one.length / 12.0;
  };
  out.length = std::sqrt(12.0 * (ca * spread(a) + cb * spread(b)) / sum);
  out.reduction = sum / (sum + out.length);
  if (out.length > longest) return {};
  return out;
}

/// The case with an extent parameter for the kind, and all counts up to the largest.
std::unique_ptr<const DamageProblem> with_extents(const DamageProblem& problem, int kind) {
  DamageCase changed = problem.damage_case;
  changed.emulator.reset();
  changed.simulation.reset();
  for (DefectKind& k : changed.kinds) k.truth.clear();
  DefectKind& k = changed.kinds[static_cast<std::size_t>(kind)];
  double longest = 0.0;
  for (const SiteLine::Stretch& s : k.line.stretches()) longest = std::max(longest, s.size);
  k.extent.reset();
  k.extent_prior = inference::Uniform{0.0, longest};
  k.min_count = 0;
  k.weights.clear();
  return make_damage_problem(std::move(changed), {});
}

class Merger {
 public:
  Merger(const UnpackedDraws& draws, int kind)
      : draws_(draws),
        kind_(draws.problem().damage_case.kinds[static_cast<std::size_t>(kind)]),
        kind_index_(kind),
        problem_(with_extents(draws.problem(), kind)),
        likelihood_(problem_->problem.likelihood()) {}

  struct Outcome {
    std::vector<Stretched> damages;
    int before = 0;
    double gain = 0.0;  ///< ln likelihood
  };

  Outcome operator()(std::size_t chain, std::size_t draw) {
    const auto all = draws_.at(chain, draw);
    const auto width = static_cast<std::size_t>(draws_.posterior().dimension);
    common_.assign(
        draws_.posterior().chains[chain].theta.begin() + static_cast<std::ptrdiff_t>(draw * width),
        draws_.posterior().chains[chain].theta.begin() + static_cast<std::ptrdiff_t>(draw * width) +
            draws_.problem().common);
    others_.clear();
    Outcome out;
    for (const Component& c : all) {
      if (c.kind != kind_index_)
        others_.push_back(c);
      else
        out.damages.push_back(stretched(c));
    }
    out.before = static_cast<int>(out.damages.size());
    const double apart = log_likelihood(out.damages);
    double now = apart;
    while (out.damages.size() > 1) {
      std::ranges::sort(out.damages, [](const Stretched& a, const Stretched& b) {
        return std::pair(a.stretch, a.middle) < std::pair(b.stretch, b.middle);
      });
      const auto best = nearest(out.damages);
      if (!best) break;
      std::vector<Stretched> fewer = out.damages;
      fewer[*best] = *joined(fewer[*best], fewer[*best + 1], longest(fewer[*best].stretch));
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(*best) + 1);
      const double then = log_likelihood(fewer);
      if (!(then >= apart - kToleratedLoss)) break;
      out.damages = std::move(fewer);
      now = then;
    }
    out.gain = now - apart;
    return out;
  }

 private:
  [[nodiscard]] double longest(int stretch) const {
    return kLongestMerged * kind_.line.stretches()[static_cast<std::size_t>(stretch)].size;
  }

  // Index of the adjacent pair whose merged damage is shortest; empty if no pair can be merged.
  [[nodiscard]] std::optional<std::size_t> nearest(const std::vector<Stretched>& sorted) const {
    std::optional<std::size_t> best;
    double shortest = 0.0;
    for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
      const auto one = joined(sorted[i], sorted[i + 1], longest(sorted[i].stretch));
      if (!one || (best && one->length >= shortest)) continue;
      best = i;
      shortest = one->length;
    }
    return best;
  }

  [[nodiscard]] Stretched stretched(const Component& c) const {
    const SiteLine& line = kind_.line;
    const SiteLine::Spot spot = line.spot(c.location);
    Stretched out{.stretch = spot.stretch,
                  .middle = spot.s,
                  .length = fixed_extent(kind_, c.location),
                  .reduction = c.severity};
    if (kind_.extent) return out;
    const SiteLine::Stretch& on = line.stretches()[static_cast<std::size_t>(spot.stretch)];
    const int cell = line.cell_at(c.location);
    const double scale = on.size / (on.end - on.start);
    out.middle = scale * (0.5 * (line.cell_start(cell) + line.cell_start(cell + 1)) - on.start);
    return out;
  }

  double log_likelihood(const std::vector<Stretched>& damages) {
    const inference::ModelSpace& space = problem_->problem.space;
    const std::vector<DefectKind>& kinds = problem_->damage_case.kinds;
    std::vector<int> counts(kinds.size(), 0);
    for (const Component& c : others_) ++counts[static_cast<std::size_t>(c.kind)];
    counts[static_cast<std::size_t>(kind_index_)] = static_cast<int>(damages.size());
    const int model = space.find(counts);
    if (model < 0) return -std::numeric_limits<double>::infinity();
    std::vector<double> x = common_;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      if (static_cast<int>(k) == kind_index_) {
        for (const Stretched& d : damages) {
          const SiteLine::Stretch& on = kind_.line.stretches()[static_cast<std::size_t>(d.stretch)];
          x.push_back(kind_.line.x_of(on.site, std::clamp(d.middle, 0.0, on.size)));
          if (kinds[k].severity_prior()) x.push_back(d.reduction);
          x.push_back(d.length);
        }
        continue;
      }
      for (const Component& c : others_) {
        if (c.kind != static_cast<int>(k)) continue;
        x.push_back(c.location);
        if (kinds[k].severity_prior()) x.push_back(c.severity);
        if (kinds[k].extent_prior) x.push_back(c.extent);
      }
    }
    return likelihood_->log_likelihood(model, x);
  }

  const UnpackedDraws& draws_;
  const DefectKind& kind_;
  int kind_index_;
  std::unique_ptr<const DamageProblem> problem_;
  std::unique_ptr<inference::Likelihood> likelihood_;
  std::vector<double> common_;
  std::vector<Component> others_;
};

/// Draws of a model, evenly spaced over its chains.
std::vector<std::pair<std::size_t, std::size_t>> some_draws(const UnpackedDraws& draws, int model) {
  std::size_t all = 0;
  draws.for_each([&](std::size_t c, std::size_t i) { all += draws.model(c, i) == model ? 1 : 0; });
  const std::size_t n = std::min(all, kMergedDraws);
  std::vector<std::pair<std::size_t, std::size_t>> out;
  std::size_t number = 0;
  draws.for_each([&](std::size_t c, std::size_t i) {
    if (draws.model(c, i) != model) return;
    if (out.size() < n && number == out.size() * all / n) out.emplace_back(c, i);
    ++number;
  });
  return out;
}

template <class Of>
Marginal over(const std::vector<Stretched>& list, const Of& of) {
  std::vector<double> values;
  for (const Stretched& one : list) values.push_back(of(one));
  return marginal({values});
}

/// Summary of the merged draws of a model.
MergedModel summarised(int model, const std::vector<Merger::Outcome>& outcomes,
                       const DamageProblem& problem, const DefectKind& kind) {
  const double beam_length = problem.damage_case.beam.length;
  MergedModel out{.model = model};
  std::map<int, int> counts, stretches;
  std::vector<Stretched> longest;
  int merged = 0;
  for (const Merger::Outcome& one : outcomes) {
    if (static_cast<int>(one.damages.size()) == one.before) continue;
    ++merged;
    ++counts[static_cast<int>(one.damages.size())];
    out.gain += one.gain;
    Stretched most = one.damages.front();
    for (const Stretched& d : one.damages)
      if (d.merged && (!most.merged || d.length > most.length)) most = d;
    if (problem.symmetric) most.middle = std::min(most.middle, beam_length - most.middle);
    ++stretches[most.stretch];
    longest.push_back(most);
  }
  if (merged == 0) return out;
  const auto most_of = [](const std::map<int, int>& tally) {
    return std::ranges::max_element(tally, {}, [](const auto& entry) { return entry.second; })
        ->first;
  };
  out.merged = static_cast<double>(merged) / static_cast<double>(outcomes.size());
  out.gain /= merged;
  out.count = most_of(counts);
  out.stretch = most_of(stretches);
  std::erase_if(longest, [&](const Stretched& d) { return d.stretch != out.stretch; });
  const SiteLine::Stretch& on = kind.line.stretches()[static_cast<std::size_t>(out.stretch)];
  out.fixed = fixed_extent(kind, 0.5 * (on.start + on.end));
  out.location = over(longest, [](const Stretched& d) { return d.middle; });
  out.length = over(longest, [](const Stretched& d) { return d.length; });
  out.reduction = over(longest, [](const Stretched& d) { return d.reduction; });
  return out;
}

}  // namespace

const MergedModel* MergedFinding::of(int model) const {
  const auto found = std::ranges::find(models, model, &MergedModel::model);
  return found == models.end() ? nullptr : &*found;
}

bool has_fixed_extent(const DefectKind& kind) {
  return kind.type->compounds && !kind.extent_prior && !kind.line.empty() &&
         kind.line.stretches().front().size > 0.0;
}

double fixed_extent(const DefectKind& kind, double location) {
  if (kind.extent) return *kind.extent;
  const int cell = kind.line.cell_at(location);
  const SiteLine::Stretch& on =
      kind.line.stretches()[static_cast<std::size_t>(kind.line.stretch_of_cell(cell))];
  return (kind.line.cell_start(cell + 1) - kind.line.cell_start(cell)) * on.size /
         (on.end - on.start);
}

std::optional<MergedFinding> merged_damages(const UnpackedDraws& draws,
                                            const std::vector<ModelFinding>& models, int kind) {
  const DamageProblem& problem = draws.problem();
  const auto at = static_cast<std::size_t>(kind);
  const DefectKind& of = problem.damage_case.kinds[at];
  if (!has_fixed_extent(of) || !problem.as_case) return {};
  const auto matters = [&](const ModelFinding& model) {
    return model.counts[at] > 1 && model.drawn() && model.probability() > kImprobable;
  };
  if (std::ranges::none_of(models, matters)) return {};
  MergedFinding out{.kind = kind, .count = {}, .models = {}};
  out.count.resize(static_cast<std::size_t>(of.max_count) + 1);
  Merger merge(draws, kind);
  double known = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const double p = models[m].probability();
    known += p;
    if (!matters(models[m])) {
      out.count[static_cast<std::size_t>(models[m].counts[at])] += p;
      continue;
    }
    std::vector<Merger::Outcome> outcomes;
    for (const auto& [c, i] : some_draws(draws, static_cast<int>(m)))
      outcomes.push_back(merge(c, i));
    for (const Merger::Outcome& one : outcomes)
      out.count[one.damages.size()] += p / static_cast<double>(outcomes.size());
    const MergedModel merged = summarised(static_cast<int>(m), outcomes, problem, of);
    out.merged += p * merged.merged;
    if (merged.merged > 0.0) out.models.push_back(merged);
  }
  for (const inference::Chain& chain : draws.posterior().chains) chain.let_go();
  if (known > 0.0) {
    for (double& p : out.count) p /= known;
    out.merged /= known;
  }
  std::ranges::stable_sort(out.models, std::greater{}, [&](const MergedModel& m) {
    return models[static_cast<std::size_t>(m.model)].probability();
  });
  return out;
}

}  // namespace wheeltap::identification
