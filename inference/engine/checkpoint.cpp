#include "inference/engine/checkpoint.hpp"

#include <concepts>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/parcel.hpp"
#include "inference/engine/checkpoint_columns.hpp"

namespace wheeltap::inference {
namespace {

// CheckpointFields lists the members once for both writing and reading.
template <class Archive, class T>
using In = std::conditional_t<Archive::kReads, T, const T>;

}  // namespace

struct CheckpointFields {
  template <class T>
  static T make() {
    if constexpr (std::same_as<T, Ladder>) {
      return Ladder({}, 0);
    } else {
      return T();
    }
  }

  template <class A>
  static void of(A& a, In<A, State>& s) {
    a("model", s.model, "z", s.z, "x", s.x, "log_likelihood", s.log_likelihood, "log_screen",
      s.log_screen, "log_prior_factor", s.log_prior_factor, "prediction", s.prediction, "residuals",
      s.residuals, "noise_scale", s.noise_scale, "screened", s.screened, "evaluated", s.evaluated);
  }
  template <class A>
  static void of(A& a, In<A, Target::Tally>& t) {
    a("values", t.values, "impossible", t.impossible);
  }
  template <class A>
  static void of(A& a, In<A, Target::Memory>& m) {
    a("bias", m.bias, "log_model", m.log_model, "evaluations", m.evaluations, "full_evaluations",
      m.full_evaluations, "proper", m.proper, "stand_in", m.stand_in);
  }
  template <class A>
  static void of(A& a, In<A, Ladder>& l) {
    a("betas", l.betas, "states", l.states, "rejection", l.rejection, "tried", l.tried, "direction",
      l.direction, "replica", l.replica, "weights", l.weights, "balancing", l.balancing, "scans",
      l.scans, "round_trips", l.round_trips);
  }
  template <class A>
  static void of(A& a, In<A, PilotSamples::OfModel>& m) {
    a("dimension", m.dimension, "values", m.values, "stride", m.stride);
  }
  template <class A>
  static void of(A& a, In<A, PilotSamples>& s) {
    a("models", s.models_, "visits", s.visits_);
  }
  template <class A>
  static void of(A& a, In<A, KeptDraws::OfModel>& m) {
    a("dimension", m.dimension, "z", m.z, "log_posterior", m.log_posterior, "visits", m.visits,
      "stride", m.stride);
  }
  template <class A>
  static void of(A& a, In<A, KeptDraws>& k) {
    a("models", k.models_);
  }
  template <class A>
  static void of(A& a, In<A, KernelRecord>& r) {
    a("proposed", r.proposed, "accepted", r.accepted, "jumps_proposed", r.jumps_proposed,
      "jumps_accepted", r.jumps_accepted);
  }
  template <class A>
  static void of(A& a, In<A, MoveStatistics>& m) {
    a("name", m.name, "proposed", m.proposed, "accepted", m.accepted);
  }
  template <class A>
  static void of(A& a, In<A, AdaptationState>& l) {
    a("steps", l.steps, "begun", l.begun, "ended", l.ended, "round_scans", l.round_scans, "scans",
      l.scans, "barrier", l.barrier, "learnt", l.learnt);
  }
  template <class A>
  static void of(A& a, In<A, ChainState>& c) {
    a("state", c.state, "iteration", c.iteration, "target", c.target, "ladder", c.ladder, "by_rung",
      c.by_rung, "models", c.models, "records", c.records, "kept", c.kept, "at_mode", c.at_mode,
      "moves", c.moves, "proposed", c.proposed, "accepted", c.accepted, "adaptation", c.adaptation);
  }
  template <class A>
  static void of(A& a, In<A, Mode>& m) {
    a("z", m.z, "log_posterior", m.log_posterior, "covariance", m.covariance, "log_mass",
      m.log_mass, "climbs", m.climbs);
  }
  template <class A>
  static void of(A& a, In<A, CountedModes>& w) {
    a("modes", w.modes, "precisions", w.precisions, "shares", w.shares);
  }
  template <class A>
  static void of(A& a, In<A, EvidenceWarning>& w) {
    a("kind", w.kind, "value", w.value, "error", w.error);
  }
  template <class A>
  static void of(A& a, In<A, Evidence>& e) {
    a("log_evidence", e.log_evidence, "standard_error", e.standard_error, "likelihood_evaluations",
      e.likelihood_evaluations, "warnings", e.warnings);
  }
  template <class A>
  static void of(A& a, In<A, ParetoTail>& t) {
    a("shape", t.shape, "log_excess", t.log_excess);
  }
  template <class A>
  static void of(A& a, In<A, ExplorationCalls>& c) {
    a("search", c.search, "anneal", c.anneal, "weigh", c.weigh);
  }
  template <class A>
  static void of(A& a, In<A, ModelExploration>& m) {
    a("modes", m.modes, "shares", m.shares, "climbs", m.climbs, "spacing", m.spacing, "left_out",
      m.left_out, "left_out_share", m.left_out_share, "pareto", m.pareto, "glanced", m.glanced,
      "passed_over", m.passed_over, "population", m.population, "annealed_draws", m.annealed_draws,
      "annealed_log_posterior", m.annealed_log_posterior, "annealed", m.annealed, "sampled",
      m.sampled, "effective_draws", m.effective_draws, "efficiency", m.efficiency, "calls",
      m.calls);
  }
  template <class A>
  static void of(A& a, In<A, NormalMixture::Component>& c) {
    a("weight", c.weight, "mean", c.mean, "factor", c.factor);
  }
  template <class A>
  static void of(A& a, In<A, RandomWalk::Block>& b) {
    a("first", b.first, "factor", b.factor, "adaptations", b.adaptations);
  }
  template <class A>
  static void of(A& a, In<A, Chain>& c) {
    a.chain(c.size());
    a.by_draw("model", c.model);
    a.by_draw("theta", c.theta);
    a.by_draw("log_prior", c.log_prior);
    a.by_draw("log_likelihood", c.log_likelihood);
    a.by_draw("move", c.move);
    a.by_draw("accepted", c.accepted);
    a.by_draw("prediction", c.prediction);
  }
  template <class A>
  static void of(A& a, In<A, Calls>& c) {
    a("explore", c.explore, "search", c.search, "anneal", c.anneal, "weigh", c.weigh, "tune",
      c.tune, "sample", c.sample, "evidence", c.evidence);
  }
  template <class A>
  static void of(A& a, In<A, Posterior>& p) {
    a("chains", p.chains, "log_weight", p.log_weight, "draws", p.draws, "warmup", p.warmup, "thin",
      p.thin, "dimension", p.dimension, "warmup_evaluations", p.warmup_evaluations, "calls",
      p.calls, "wall_seconds", p.wall_seconds, "quick", p.quick, "tempered_draws", p.tempered_draws,
      "barrier", p.barrier, "impossible_models", p.impossible_models, "choices", p.choices);
  }
  template <class A>
  static void of(A& a, In<A, Position>& p) {
    a("stage", p.stage, "tempering", p.tempering, "explore", p.explore, "models", p.models, "model",
      p.model, "best", p.best, "look", p.look, "looks_left", p.looks_left, "before", p.before,
      "round", p.round, "tuned", p.tuned, "sample", p.sample, "goal", p.goal, "refits", p.refits,
      "first_part", p.first_part, "part_chains", p.part_chains);
  }
  // A mixture is immutable, so a checkpoint stores its components.
  struct Mixture {
    double degrees_of_freedom = 0.0;
    std::vector<NormalMixture::Component> components;  // empty: no mixture
  };
  template <class A>
  static void of(A& a, In<A, Mixture>& m) {
    a("degrees_of_freedom", m.degrees_of_freedom, "components", m.components);
  }
  struct PilotParts {
    bool fitted = false;
    std::vector<Mixture> density;
    std::vector<double> weight;
    Archive archive;
  };
  static PilotParts parts_of(const Pilot& pilot) {
    PilotParts parts;
    if (!pilot.fit) return parts;
    parts.fitted = true;
    for (const auto& density : pilot.fit->density) {
      Mixture& mixture = parts.density.emplace_back();
      if (!density) continue;
      mixture.degrees_of_freedom = density->degrees_of_freedom();
      for (int k = 0; k < density->size(); ++k) mixture.components.push_back((*density)[k]);
    }
    parts.weight = pilot.fit->weight;
    parts.archive = *pilot.archive;
    return parts;
  }
  static void put(PilotParts parts, Pilot& pilot) {
    if (!parts.fitted) return;
    auto fit = std::make_shared<PilotFit>();
    for (Mixture& mixture : parts.density) {
      auto& density = fit->density.emplace_back();
      if (mixture.components.empty()) continue;
      density = std::make_unique<NormalMixture>(
          NormalMixture::restored(std::move(mixture.components), mixture.degrees_of_freedom));
    }
    fit->weight = std::move(parts.weight);
    pilot.fit = std::move(fit);
    pilot.archive = std::make_shared<const Archive>(std::move(parts.archive));
  }
  template <class A>
  static void of(A& a, In<A, PilotParts>& p) {
    a("fitted", p.fitted, "density", p.density, "weight", p.weight, "archive", p.archive);
  }
  template <class A>
  static void of(A& a, In<A, Pilot>& p) {
    PilotParts parts = parts_of(p);
    a("fit", parts);
    if constexpr (A::kReads) put(std::move(parts), p);
    a("scales", p.scales, "efficiencies", p.efficiencies);
  }
  template <class A>
  static void of(A& a, In<A, RunState>& s) {
    a("at", s.at, "chains", s.chains, "explorations", s.explorations, "log_probability",
      s.log_probability, "probability", s.probability, "by_rung", s.by_rung, "pilot", s.pilot,
      "tuning_bias", s.tuning_bias, "sampling_bias", s.sampling_bias, "weighty_modes",
      s.weighty_modes, "at_mixture", s.at_mixture, "posterior", s.posterior, "shared_evaluations",
      s.shared_evaluations);
  }
};

namespace {

using Writer = columns::Writer<CheckpointFields>;
using Reader = columns::Reader<CheckpointFields>;

template <std::size_t I = 0>
Checkpoint::Column empty_column(std::size_t type) {
  if constexpr (I + 1 < std::variant_size_v<Checkpoint::Column>) {
    if (type != I) return empty_column<I + 1>(type);
  }
  return Checkpoint::Column(std::in_place_index<I>);
}

void expect(bool holds, const char* what) {
  if (!holds) throw CheckpointError(std::string("it belongs to a problem with different ") + what);
}

// Checks that all indices of the run state are in range.
void check(const RunState& state, const ModelSpace& space, int chains) {
  const auto models = static_cast<std::size_t>(space.size());
  const auto fits = [&](const State& at) {
    return at.model >= 0 && at.model < space.size() &&
           (at.z.empty() || at.z.size() == static_cast<std::size_t>(space[at.model].dimension));
  };
  expect(state.chains.size() == static_cast<std::size_t>(chains) &&
             state.posterior.chains.size() == state.chains.size(),
         "chains");
  expect(state.explorations.size() == models, "models");
  expect(!state.pilot.fit ||
             (state.pilot.fit->density.size() == models &&
              state.pilot.fit->weight.size() == models && state.pilot.archive->size() == models),
         "models");
  expect(state.posterior.dimension == space.max_dimension(), "parameters");
  for (const ChainState& chain : state.chains) {
    expect(fits(chain.state), "parameters");
    if (chain.ladder) {
      for (const State& at : chain.ladder->states) expect(fits(at), "parameters");
    }
  }
  for (std::size_t m = 0; m < models && state.pilot.fit; ++m) {
    const auto& density = state.pilot.fit->density[m];
    expect((density ? density->dimension() : 0) == space[static_cast<int>(m)].dimension,
           "parameters");
  }
  for (const int m : state.at.models) expect(m >= 0 && m < space.size(), "models");
  for (const int c : state.at.part_chains) expect(c >= 0 && c < chains, "chains");
}

}  // namespace

Checkpoint checkpoint_of(const RunState& state, std::vector<std::size_t> without) {
  Checkpoint checkpoint;
  Writer writer(checkpoint, std::move(without));
  CheckpointFields::of(writer, state);
  return checkpoint;
}

Checkpoint draws_of(const Chain& chain, std::size_t first, std::size_t last) {
  Checkpoint part;
  Writer writer(part, {first}, last);
  CheckpointFields::of(writer, chain);
  return part;
}

Chain draws_in(const Checkpoint& part, std::size_t n) {
  Chain chain;
  Reader reader(part);
  CheckpointFields::of(reader, chain);
  reader.end();
  if (n == 0 || chain.size() != n || chain.log_prior.size() != n ||
      chain.log_likelihood.size() != n || chain.move.size() != n || chain.accepted.size() != n ||
      chain.theta.size() % n != 0 || chain.prediction.size() % n != 0)
    throw CheckpointError("a separate part does not have " + std::to_string(n) + " draws");
  return chain;
}

std::pair<long, long> parts_of(const Checkpoint& checkpoint) {
  Position at;
  Reader reader(checkpoint);
  reader("at", at);
  return {at.first_part, static_cast<long>(at.part_chains.size())};
}

std::string packed_state(const ChainState& chain, const Chain& draws) {
  Checkpoint checkpoint;
  Writer writer(checkpoint);
  writer("chain", chain);
  writer("draws", draws);
  base::Packer parcel;
  for (const auto& [name, column] : checkpoint.columns) {
    parcel(name, column.index());
    std::visit([&](const auto& numbers) { parcel(numbers); }, column);
  }
  return std::move(parcel).bytes();
}

void unpack(std::string_view bytes, ChainState& chain, Chain& draws) {
  Checkpoint checkpoint;
  base::Unpacker parcel(bytes);
  while (!parcel.empty()) {
    std::string name;
    std::size_t type = 0;
    parcel(name, type);
    Checkpoint::Column& column = checkpoint.columns[name];
    column = empty_column(type);
    std::visit([&](auto& numbers) { parcel(numbers); }, column);
  }
  chain = ChainState();
  draws.clear();
  Reader reader(checkpoint);
  reader("chain", chain);
  reader("draws", draws);
}

RunState state_of(const Checkpoint& checkpoint, const ModelSpace& space, int chains) {
  RunState state;
  Reader reader(checkpoint);
  try {
    CheckpointFields::of(reader, state);
  } catch (const std::invalid_argument& impossible) {  // the stored mixture is invalid
    throw CheckpointError(impossible.what());
  }
  reader.end();
  check(state, space, chains);
  state.posterior.space = std::make_shared<const ModelSpace>(space);
  if (state.pilot.fit) {
    for (std::size_t j = 0; j < space.kinds().size(); ++j) {
      state.pilot.conditionals.push_back(std::make_shared<const ConditionalMixtures>(
          space, *state.pilot.fit, static_cast<int>(j)));
    }
  }
  return state;
}

}  // namespace wheeltap::inference
