// What a run would take, as far as its case and its options say, before it starts.
#pragma once

#include <filesystem>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::apps {

/// An estimate, not a promise: within a factor of three of nine in ten runs where likelihoods were
/// measured (docs/scale.md), else within a factor of ten.
struct RunCost {
  double bytes = 0.0;                 ///< of memory, at the most at one time
  double disk = 0.0;                  ///< bytes in the folder of the results, likewise
  double likelihoods = 0.0;           ///< evaluations, or FE runs of a table
  double seconds = 0.0;               ///< of them, on the threads asked for
  double preparation = 0.0;           ///< of these, before the first likelihood
  double seconds_a_likelihood = 0.0;  ///< 0: not said
};

/// "about 0.02 GB of memory, 120 000 likelihoods or FE runs of 0.3 ms each, 10 s".
[[nodiscard]] std::string in_words(const RunCost& cost);

/// Says so of a "run", a "table", on standard output: CommonOptions::dry_run of one case.
void print_estimate(const std::string& what, const RunCost& cost);

/// The same as JSON text: "what", "memory_bytes", "disk_bytes", "likelihoods", "seconds".
[[nodiscard]] std::string estimate_json(const std::string& what, const RunCost& cost);

/// Throws Failure (65) at `where` for what takes more than --max-memory, --max-hours or --max-disk
/// allow, with the estimate in words.
void require_affordable(const CaseFile& file, const Pointer& where, const RunCost& cost,
                        const CommonOptions& common);

/// Throws io::FileError (unwritable) where the folder of the results, which is there, has not so
/// much room, unless --max-disk says how much may be taken. What a checkpoint has is there already.
void require_room(const RunCost& cost, const CommonOptions& common);

/// What there is to sample.
struct Sampled {
  double models = 1.0;
  double dimensions = 0.0;   ///< of all models together
  double largest = 0.0;      ///< dimension of a model
  double predictions = 0.0;  ///< numbers that a draw keeps besides its parameters
  double explored = 0.0;     ///< likelihoods a dimension before the first draw
  double seconds_a_likelihood = 0.0;
  bool records = false;  ///< the engine tunes half as long and thins half as much
};

/// Of draws. Engines that stop when they have converged are taken to do so in their first round.
[[nodiscard]] RunCost cost_of_sampling(const Sampled& sampled, const CommonOptions& common,
                                       const SamplingOptions& options);

/// Takes likelihoods and seconds from the engine's plan and from what a likelihood takes, which is
/// measured for about so many seconds. `cost.preparation` stays as it is.
void measure(RunCost& cost, const inference::Problem& problem, const inference::Options& engine,
             double seconds);
/// Half a second where that is all that is asked for, else a tenth.
[[nodiscard]] inline double probe_seconds(const CommonOptions& common) {
  return common.dry_run ? 0.5 : 0.1;
}

/// The most that this process has held so far [bytes].
[[nodiscard]] double bytes_held();

/// Of a damage case, FE solutions throughout: emulators take less. Its model space and its beam's
/// spectrum are not built for that.
[[nodiscard]] RunCost cost_of_damages(const identification::DamageCase& damage_case,
                                      const CommonOptions& common, const SamplingOptions& options);

/// Of modes from so many measured numbers.
[[nodiscard]] RunCost cost_of_modes(double numbers);

/// Of a record that is simulated from the truth, from a case that its schema has passed; none
/// without a truth.
[[nodiscard]] RunCost cost_of_truth(const CaseFile& file);

/// Of the FE runs for a predictor that is to be trained; none for "fe" and finished tables.
[[nodiscard]] RunCost cost_of_tables(const identification::DamageCase& damage_case);

}  // namespace wheeltap::apps
