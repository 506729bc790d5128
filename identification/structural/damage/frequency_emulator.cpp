#include "identification/structural/damage/frequency_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using emulator::Design;
using emulator::Factor;
using emulator::InterpolantType;
using emulator::RowMatrix;
using emulator::Table;

std::string number_in_words(double x) {
  return base::significant(x, 6);
}

// True if each list of sites is mirror-symmetric; the emulator then is so without averaging.
bool has_symmetric_sites(const std::vector<Factor>& box, double length) {
  for (std::size_t i = 0; i < box.size(); i += 2) {
    const auto& levels = box[i].levels;
    for (std::size_t j = 0; j < levels.size(); ++j) {
      if (std::abs(levels[j] + levels[levels.size() - 1 - j] - length) > 1e-9 * length)
        return false;
    }
    if (levels != box[0].levels) return false;
  }
  return true;
}

// The interpolant type of a table. Tables of the first version lack this attribute.
const InterpolantType& type_of(const Table& table, InterpolantTypes types) {
  const auto written = table.attributes.find("interpolation");
  const std::string name = written == table.attributes.end() ? "multilinear" : written->second;
  const InterpolantType* type = find_interpolant_type(name, types);
  if (type == nullptr) {
    throw std::invalid_argument("interpolation \"" + name + "\" is unknown");
  }
  return *type;
}

}  // namespace

void FrequencyEmulator::add(const InterpolantType& type, Table table, int threads) {
  const auto count = static_cast<int>(table.factors.size()) / 2;
  modes_ = static_cast<int>(table.values.cols());
  std::shared_ptr<const emulator::Interpolant> made =
      type.train(table, {.threads = threads, .waves = waves(count)});
  parts_.push_back({&type, std::move(table), std::move(made)});
}

void FrequencyEmulator::add_anova(emulator::Additive additive) {
  additive_ = additive;
  const auto answers = [this](int count) {
    return [f = part(count).interpolant](std::span<const double> x, std::span<double> out) {
      f->evaluate(x, out);
    };
  };
  anova_ = std::make_shared<const emulator::AnovaEmulator>(intact_frequencies(part(2).table), 2,
                                                           answers(1), answers(2), additive);
}

FrequencyEmulator FrequencyEmulator::train(const fem::Reanalysis& reanalysis,
                                           const EmulatorSpec& spec, const DefectKind& kind,
                                           int modes, const RunOptions& options) {
  const fem::Beam& beam = reanalysis.beam();
  FrequencyEmulator trained(beam);
  const int max_count = kind.max_count;
  for (int count = 1; count <= spec.tables(max_count); ++count) {
    Table table = run_table(reanalysis, spec, kind, modes, count, options, trained.trained_runs_);
    table.attributes["interpolation"] = spec.interpolant->name;
    trained.symmetrised_ =
        spec.symmetrise && !(table.is_grid() && has_symmetric_sites(table.factors, beam.length));
    table.attributes["symmetrised"] = trained.symmetrised_ ? "true" : "false";
    if (count == 2 && spec.anova) {
      table.attributes["anova"] = emulator::name(*spec.anova);
      std::vector<double> intact(static_cast<std::size_t>(modes));
      model_of(reanalysis, options)()({}, intact);
      keep_intact_frequencies(table, intact);
    }
    trained.add(*spec.interpolant, std::move(table), options.threads);
  }
  if (spec.anova && max_count > 2) trained.add_anova(*spec.anova);
  if (const auto outside = trained.reaches_outside(kind);
      outside && !trained.part(1).table.is_grid()) {
    throw std::invalid_argument(outside->message);
  }
  for (int count = 1; count <= max_count; ++count) {
    trained.measure(reanalysis, count, spec.holdout, options);
  }
  return trained;
}

void FrequencyEmulator::measure(const fem::Reanalysis& reanalysis, int count, Index runs,
                                const RunOptions& options) {
  const auto width = static_cast<std::size_t>(2 * count);
  std::vector<Factor> box;
  for (std::size_t i = 0; i < width; ++i) {
    box.push_back(factor(count, i));
    box.back().name = "factor_" + std::to_string(i);
  }
  Design fresh = emulator::random_design(box, runs, options.seed);
  Index kept = 0;
  for (Index i = 0; i < fresh.runs(); ++i) {
    if (contains(sorted_damages(fresh.point(i)))) fresh.points.row(kept++) = fresh.points.row(i);
  }
  if (kept < 2) {
    throw std::invalid_argument(
        "the training runs cover all possible points, so no further runs can measure the error");
  }
  fresh.points.conservativeResize(kept, Eigen::NoChange);
  const RowMatrix truth = emulator::run_experiment(fresh, modes_, model_of(reanalysis, options),
                                                   {.threads = options.threads});
  fresh_runs_ += kept;
  const auto modes = static_cast<std::size_t>(modes_);
  EmulatorError unscaled;
  unscaled.scale.assign(modes, 1.0);
  errors_.resize(std::max(errors_.size(), static_cast<std::size_t>(count)));
  EmulatorError& error = errors_[static_cast<std::size_t>(count - 1)] = unscaled;
  RowMatrix predicted(kept, modes_), variance(kept, modes_);
  for (Index i = 0; i < kept; ++i) {
    evaluate(sorted_damages(fresh.point(i)), {predicted.row(i).data(), modes},
             {variance.row(i).data(), modes});
  }
  const bool has_variance = count <= tables() && part(count).type->has_variance;
  error = measured_error(truth, std::move(predicted), std::move(variance), has_variance);
  if (count > tables()) return;
  const RowMatrix others = part(count).interpolant->leave_one_out().mean;
  if (others.rows() == 0) return;
  const RowMatrix residual = others - part(count).table.values;
  for (Index mode = 0; mode < modes_; ++mode) {
    error.leave_one_out.push_back(std::sqrt(residual.col(mode).array().square().mean()));
  }
}

FrequencyEmulator FrequencyEmulator::load(const std::filesystem::path& path, const fem::Beam& beam,
                                          int max_count, int modes, InterpolantTypes types) {
  FrequencyTables stored = read_frequency_tables(path, beam, max_count, modes);
  FrequencyEmulator loaded(beam);
  loaded.symmetrised_ = stored.symmetrised;
  loaded.errors_ = std::move(stored.errors);
  try {
    for (Table& table : stored.tables) {
      const InterpolantType& type = type_of(table, types);
      loaded.add(type, std::move(table), 1);
    }
  } catch (const std::invalid_argument& fault) {
    throw io::FileError(io::FileError::Kind::corrupt, path, fault.what());
  }
  if (stored.anova) loaded.add_anova(*stored.anova);
  return loaded;
}

void FrequencyEmulator::save(const std::filesystem::path& path,
                             std::map<std::string, std::string> attributes) const {
  FrequencyTables tables{
      .tables = {}, .errors = errors_, .symmetrised = symmetrised_, .anova = additive_};
  for (const Part& one : parts_) tables.tables.push_back(one.table);
  write_frequency_tables(path, beam_, std::move(tables), std::move(attributes));
}

const Factor& FrequencyEmulator::factor(int count, std::size_t i) const {
  // ANOVA combines both tables, which have the same factors.
  return count <= tables() ? part(count).table.factors[i] : part(tables()).table.factors[i % 2];
}

Eigen::Index FrequencyEmulator::runs(int count) const {
  return count <= tables() ? part(count).table.values.rows()
                           : part(1).table.values.rows() + part(2).table.values.rows();
}

std::string FrequencyEmulator::describe(int count) const {
  const Part& one = part(std::min(count, tables()));
  const std::vector<Factor>& factors = one.table.factors;
  std::string text = std::string(one.type->words) + " in " +
                     (factors[1].scale == emulator::Scale::compliance ? "1/(1-r)" : "r");
  if (one.type->runs == InterpolantType::Runs::grid) {
    text += ", " + std::to_string(factors[0].levels.size()) + " sites x " +
            std::to_string(factors[1].levels.size()) + " levels";
  }
  if (count > tables()) {
    text = "ANOVA in the " + std::string(emulator::name(*additive_)) + ", " + text;
  }
  if (symmetrised_) text += ", mean of both mirror images";
  return text;
}

bool FrequencyEmulator::is_slow() const {
  return std::ranges::any_of(parts_, [](const Part& one) { return one.type->slow; });
}

double FrequencyEmulator::midpoint(double location, const Factor& factor) const {
  // The box ends at the midpoints of the outermost elements; priors may extend beyond them.
  return std::clamp(beam_.element_midpoint(beam_.element_at(location)), factor.low(),
                    factor.high());
}

bool FrequencyEmulator::contains(std::span<const fem::Damage> damages) const {
  const auto bounded = [](const Part& one) { return one.type->within_hull; };
  if (std::ranges::none_of(parts_, bounded)) return true;
  const int count = static_cast<int>(damages.size());
  const auto inside = [&](int n, std::span<const fem::Damage> some) {
    if (!bounded(part(n))) return true;
    std::vector<double> x;
    for (std::size_t i = 0; i < some.size(); ++i) {
      x.push_back(midpoint(some[i].location, factor(n, 2 * i)));
      x.push_back(some[i].reduction);
    }
    return part(n).interpolant->contains(x);
  };
  if (count <= tables()) return inside(count, damages);
  for (std::size_t i = 0; i < damages.size(); ++i) {
    if (!inside(1, damages.subspan(i, 1))) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (!inside(2, std::vector<fem::Damage>{damages[j], damages[i]})) return false;
    }
  }
  return true;
}

void FrequencyEmulator::call(std::span<const fem::Damage> damages, std::span<double> out,
                             std::span<double> variance) const {
  const int count = static_cast<int>(damages.size());
  thread_local std::vector<double> x;
  x.resize(2 * damages.size());
  for (std::size_t i = 0; i < damages.size(); ++i) {
    x[2 * i] = midpoint(damages[i].location, factor(count, 2 * i));
    x[2 * i + 1] = damages[i].reduction;
  }
  if (count > tables()) {
    anova_->evaluate(x, out);
  } else {
    const Part& one = part(count);
    if (one.type->has_variance && !variance.empty()) {
      one.interpolant->evaluate(x, out, variance);
      const auto& scale = error(count).scale;
      for (std::size_t i = 0; i < variance.size(); ++i) variance[i] *= scale[i];
      return;
    }
    one.interpolant->evaluate(x, out);
  }
  if (!variance.empty()) error_variance(error(count), damages, variance);
}

void FrequencyEmulator::evaluate(std::span<const fem::Damage> damages, std::span<double> out,
                                 std::span<double> variance) const {
  thread_local std::vector<double> all, all_variance, mirrored, mirrored_variance;
  thread_local std::vector<fem::Damage> image;
  const auto modes = static_cast<std::size_t>(modes_);
  const bool direct = out.size() == modes;
  std::span<double> f = out, v = variance;
  if (!direct) {
    all.resize(modes);
    f = all;
    if (!variance.empty()) {
      all_variance.resize(modes);
      v = all_variance;
    }
  }
  call(damages, f, v);
  if (symmetrised_) {
    const int count = static_cast<int>(damages.size());
    image.clear();
    bool inside = true;
    for (std::size_t i = damages.size(); i-- > 0;) {
      image.push_back({beam_.length - damages[i].location, damages[i].reduction});
      const Factor& box = factor(count, 2 * (image.size() - 1));
      const double x = beam_.element_midpoint(beam_.element_at(image.back().location));
      const double slack = 1e-6 * beam_.element_length();
      inside = inside && x >= box.low() - slack && x <= box.high() + slack;
    }
    if (inside && contains(image)) {
      mirrored.resize(modes);
      mirrored_variance.resize(v.size());
      call(image, mirrored, mirrored_variance);
      for (std::size_t i = 0; i < modes; ++i) f[i] = 0.5 * (f[i] + mirrored[i]);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = 0.5 * (v[i] + mirrored_variance[i]);
    }
  }
  if (!direct) {
    std::copy_n(f.begin(), out.size(), out.begin());
    std::copy_n(v.begin(), variance.size(), variance.begin());
  }
}

std::optional<FrequencyEmulator::Outside> FrequencyEmulator::reaches_outside(
    const DefectKind& kind) const {
  const inference::Prior& reduction = *kind.severity_prior();
  const double h = beam_.element_length();
  const auto [first, last] = elements_of(kind.location, beam_);
  for (int count = 1; count <= std::min(kind.max_count, tables()); ++count) {
    const auto& box = part(count).table.factors;
    for (std::size_t i = 0; i < box.size(); i += 2) {
      const std::string who = count == 1 ? ""
                                         : " (damage " + std::to_string(i / 2 + 1) + " of " +
                                               std::to_string(count) + ")";
      if (beam_.element_midpoint(first) < box[i].low() - 1e-6 * h ||
          beam_.element_midpoint(last) > box[i].high() + 1e-6 * h) {
        return Outside{InvalidInput::Part::location,
                       "location prior " + kind.location.describe() +
                           " exceeds the training domain, " + number_in_words(box[i].low()) +
                           " to " + number_in_words(box[i].high()) + " m" + who};
      }
      if (reduction.lower() < box[i + 1].low() || reduction.upper() > box[i + 1].high()) {
        return Outside{InvalidInput::Part::severity,
                       "reduction prior " + reduction.describe() +
                           " exceeds the training domain, " + number_in_words(box[i + 1].low()) +
                           " to " + number_in_words(box[i + 1].high()) + who};
      }
    }
    if (!part(count).type->within_hull) continue;
    // If the corners of the priors' box (damages sorted) are inside the table, the whole box is.
    for (unsigned corner = 0; corner < 1U << static_cast<unsigned>(2 * count); ++corner) {
      std::vector<double> point;
      for (int i = 0; i < count; ++i) {
        const auto bit = [&](int n) { return (corner >> static_cast<unsigned>(n) & 1U) != 0; };
        point.push_back(beam_.element_midpoint(bit(2 * i) ? last : first));
        point.push_back(bit(2 * i + 1) ? reduction.upper() : reduction.lower());
      }
      const auto damages = sorted_damages(point);
      if (!contains(damages)) {
        std::string where;
        for (const fem::Damage& d : damages) {
          where += (where.empty() ? "" : ", ") + ("location " + number_in_words(d.location)) +
                   " m, reduction " + number_in_words(d.reduction);
        }
        return Outside{InvalidInput::Part::location,
                       "the priors reach outside the convex hull of the training runs, at " +
                           where + (count == 1 ? "" : " (two damages)")};
      }
    }
  }
  return {};
}

}  // namespace wheeltap::identification
