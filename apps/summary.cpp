#include "apps/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>

#include "apps/verdict_words.hpp"
#include "base/parallel.hpp"

namespace wheeltap::apps {
namespace {

using inference::ChainsOf;
using inference::Posterior;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastDraws = 100;  // of a chain, for its convergence to be judged

// JSON has no infinity.
Report finite(double x) {
  return std::isfinite(x) ? Report(x) : Report();
}

// The midpoint of the fullest bin, bins by Freedman & Diaconis's rule (1981). `weights` beside
// `values`, or none.
double histogram_mode(const std::vector<double>& values, const std::vector<double>& weights,
                      double low, double high, double interquartile) {
  if (!(high > low)) return low;
  const double width = 2.0 * interquartile / std::cbrt(static_cast<double>(values.size()));
  const double bins_wanted = width > 0.0 ? std::ceil((high - low) / width) : 200.0;
  const auto bins = static_cast<std::size_t>(std::clamp(bins_wanted, 10.0, 400.0));
  std::vector<double> counts(bins);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto at =
        static_cast<std::size_t>((values[i] - low) / (high - low) * static_cast<double>(bins));
    counts[std::min(at, bins - 1)] += weights.empty() ? 1.0 : weights[i];
  }
  const auto fullest = std::ranges::max_element(counts) - counts.begin();
  return low + (static_cast<double>(fullest) + 0.5) * (high - low) / static_cast<double>(bins);
}

// Chains cut to one length, evenly over the run; chains with too few draws are left out.
ChainsOf equal_lengths(const ChainsOf& chains) {
  std::size_t n = std::numeric_limits<std::size_t>::max();
  for (const auto& chain : chains) {
    if (chain.size() >= kLeastDraws) n = std::min(n, chain.size());
  }
  ChainsOf out;
  for (const auto& chain : chains) {
    if (chain.size() < kLeastDraws) continue;
    out.emplace_back(n);
    for (std::size_t i = 0; i < n; ++i) out.back()[i] = chain[i * chain.size() / n];
  }
  return out;
}

double probability(const Posterior& posterior, int model) {
  long visits = 0, draws = 0;
  for (const auto& chain : posterior.chains) {
    visits += std::ranges::count(chain.model, model);
    draws += static_cast<long>(chain.model.size());
  }
  return draws > 0 ? static_cast<double>(visits) / static_cast<double>(draws) : 0.0;
}

std::vector<std::vector<int>> total_counts(const Posterior& posterior) {
  std::vector<std::vector<int>> out;
  for (const auto& chain : posterior.chains) {
    out.emplace_back();
    for (const int m : chain.model) {
      const auto& counts = (*posterior.space)[m].counts;
      out.back().push_back(counts.empty() ? m : std::accumulate(counts.begin(), counts.end(), 0));
    }
  }
  return out;
}

}  // namespace

double quantile(const std::vector<double>& sorted, double p) {
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double weighted_quantile(std::vector<std::pair<double, double>> draws, double p) {
  std::ranges::sort(draws);
  // The middle of each draw's weight, from that of the first (0) to that of the last (1).
  const double first = 0.5 * draws.front().second;
  double total = -first - 0.5 * draws.back().second;
  for (const auto& [x, w] : draws) total += w;
  double before = -first, last_x = draws.front().first, last_at = 0.0;
  for (const auto& [x, w] : draws) {
    const double at = before + 0.5 * w;
    if (at >= p * total) {
      return at > last_at ? last_x + (p * total - last_at) / (at - last_at) * (x - last_x) : x;
    }
    before += w;
    last_x = x, last_at = at;
  }
  return draws.back().first;
}

std::vector<double> model_weights(const Posterior& posterior) {
  const auto n = static_cast<std::size_t>(posterior.space->size());
  if (posterior.log_weight.empty()) return std::vector<double>(n, 1.0);
  const double top = std::ranges::max(posterior.log_weight);
  std::vector<double> weights;
  for (const double l : posterior.log_weight) weights.push_back(std::exp(l - top));
  double sum = 0.0, draws = 0.0;
  for (const auto& chain : posterior.chains) {
    for (const int m : chain.model) sum += weights[static_cast<std::size_t>(m)];
    draws += static_cast<double>(chain.model.size());
  }
  for (double& w : weights) w *= draws / sum;
  return weights;
}

ChainsOf draw_weights(const Posterior& posterior) {
  if (posterior.log_weight.empty()) return {};
  const std::vector<double> of_model = model_weights(posterior);
  return all_draws(posterior, [&](std::size_t c, std::size_t i) {
    return of_model[static_cast<std::size_t>(posterior.chains[c].model[i])];
  });
}

Report summarise(const ChainsOf& chains, const ChainsOf& weights) {
  std::vector<double> values, weight;
  for (const auto& chain : chains) values.insert(values.end(), chain.begin(), chain.end());
  for (const auto& chain : weights) weight.insert(weight.end(), chain.begin(), chain.end());
  const auto n = static_cast<double>(values.size());
  const auto w = [&](std::size_t i) { return weight.empty() ? 1.0 : weight[i]; };
  double total = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) total += w(i), mean += w(i) * values[i];
  mean /= total;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) squares += w(i) * std::pow(values[i] - mean, 2.0);
  std::vector<double> q;
  const std::vector<double> levels = {0.0, 0.025, 0.25, 0.5, 0.75, 0.975, 1.0};
  if (weight.empty()) {
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    for (const double p : levels) q.push_back(quantile(sorted, p));
  } else {
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t i = 0; i < values.size(); ++i) pairs.emplace_back(values[i], weight[i]);
    for (const double p : levels) q.push_back(weighted_quantile(pairs, p));
  }
  inference::Convergence judged{kNaN, kNaN, kNaN, kNaN, kNaN};
  if (const ChainsOf equal = equal_lengths(chains); !equal.empty()) {
    judged = inference::convergence(equal);
  }
  return {{"mean", mean},
          {"sd", n > 1.0 ? std::sqrt(squares / total * n / (n - 1.0)) : 0.0},
          {"q2.5", q[1]},
          {"q50", q[3]},
          {"q97.5", q[5]},
          {"mode", histogram_mode(values, weight, q.front(), q.back(), q[4] - q[2])},
          {"ess_bulk", finite(judged.ess_bulk)},
          {"ess_tail", finite(judged.ess_tail)},
          {"rhat", finite(judged.rhat)}};
}

std::string parameter_label(const inference::ModelSpace& space, int model, int i) {
  const std::string name = space.parameter_name(model, i);
  const auto& kinds = space.kinds();
  const auto& m = space[model];
  if (i < static_cast<int>(m.parameters.size()) || kinds.size() < 2) return name;
  std::size_t kind = kinds.size() - 1;
  while (i < m.offsets[kind]) --kind;
  const std::string bare = name.substr(0, name.find('['));
  int users = 0;
  for (const auto& k : kinds) {
    users += static_cast<int>(std::ranges::count(k.parameters, bare, &inference::Parameter::name));
  }
  return users > 1 ? kinds[kind].name + " " + name : name;
}

Report model_table(const Posterior& posterior, const inference::Verdict& verdict) {
  const auto& space = *posterior.space;
  Report table = Report::array();
  for (int m = 0; m < space.size(); ++m) {
    const inference::ModelStanding& s = verdict.models[static_cast<std::size_t>(m)];
    table.push_back({{"name", space[m].name},
                     {"prior", std::exp(space[m].log_prior)},
                     {"probability", s.probability},
                     {"mcse", finite(s.mcse)},
                     {"visited", s.visited},
                     {"proposed", s.proposed},
                     {"entered", s.entered},
                     {"log_evidence", finite(s.log_evidence)},
                     {"log_evidence_se", finite(s.log_evidence_se)},
                     {"basis", s.basis == inference::Basis::draws ? "draws" : "evidence"}});
  }
  return table;
}

std::string told_by_evidence(const Report& row) {
  const bool known = row.value("basis", "draws") == std::string("evidence");
  if (!row.contains("visited") || (row["visited"] != 0 && !known)) return {};
  const long proposed = row.value("proposed", 0L);
  std::string text = row["visited"] != 0
                         ? "drawn by " + row["visited"].dump() + " of the chains only; "
                     : proposed > 0 ? "not entered in " + grouped(proposed) + " proposals; "
                                    : "never entered; ";
  if (!known) return text + "nothing is known of its evidence";
  if (row.value("prior", 1.0) == 0.0) return "has no prior probability";
  text += "its evidence puts it at P ≈ " + significant(row["probability"], 3);
  if (row["mcse"].is_number()) text += " ± " + significant(row["mcse"], 1);
  return text;
}

std::string resolution_in_words(const Report& diagnosed) {
  const auto at = diagnosed.find("resolution");
  if (at == diagnosed.end() || !at->is_number() || at->get<double>() >= 1.0) return {};
  if (at->get<double>() <= 0.0) return {};
  return "a mode that less than " + significant(100.0 * at->get<double>(), 2) +
         " % of the prior climbs to would probably not have been seen";
}

Report parameter_tables(const Posterior& posterior) {
  const auto& space = *posterior.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  Report tables = Report::object();
  for (int m = 0; m < space.size(); ++m) {
    if (probability(posterior, m) == 0.0) continue;
    Report& table = tables[space[m].name] = Report::object();
    for (int p = 0; p < space[m].dimension; ++p) {
      table[parameter_label(space, m, p)] =
          summarise(draws_in_model(posterior, m, [&](std::size_t c, std::size_t i) {
            return posterior.chains[c].theta[i * width + static_cast<std::size_t>(p)];
          }));
    }
  }
  return tables;
}

Report diagnostics(const Posterior& posterior, const inference::Verdict& verdict,
                   std::uint64_t seed, std::vector<std::string> warnings) {
  const auto& space = *posterior.space;
  Report rhats = Report::object();
  for (const auto& [what, r] : verdict.rhats) rhats[what] = finite(r);
  if (posterior.impossible > 0) {
    warnings.push_back("The likelihood was NaN or infinite at " + grouped(posterior.impossible) +
                       " of " + grouped(posterior.likelihood_evaluations) +
                       " places: these count as impossible.");
  }
  const std::vector<std::string> not_established = in_words(verdict.not_established, space);
  warnings.insert(warnings.begin(), not_established.begin(), not_established.end());

  std::vector<std::vector<int>> model_chains;
  for (const auto& chain : posterior.chains) model_chains.push_back(chain.model);
  const auto stationary =
      inference::stationary_model_probabilities(model_chains, space.size(), seed);
  const auto counts = total_counts(posterior);
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const auto& chain : counts) {
    for (const int n : chain) lowest = std::min(lowest, n), highest = std::max(highest, n);
  }

  Report moves = Report::object();
  for (const auto& move : posterior.moves) {
    moves[move.name] = {{"proposed", move.proposed},
                        {"accepted", move.accepted},
                        {"rate", move.proposed > 0 ? Report(static_cast<double>(move.accepted) /
                                                            static_cast<double>(move.proposed))
                                                   : Report()}};
  }
  Report jumps = Report::object();
  for (std::size_t a = 0; a < posterior.jumps_proposed.size(); ++a) {
    for (std::size_t b = 0; b < posterior.jumps_proposed[a].size(); ++b) {
      const long proposed = posterior.jumps_proposed[a][b];
      if (a == b || proposed == 0) continue;
      jumps[space[static_cast<int>(a)].name + " -> " + space[static_cast<int>(b)].name] = {
          {"proposed", proposed},
          {"accepted", posterior.jumps_accepted[a][b]},
          {"rate",
           static_cast<double>(posterior.jumps_accepted[a][b]) / static_cast<double>(proposed)}};
    }
  }
  Report transitions = Report::array();
  for (Eigen::Index a = 0; a < stationary.transitions.rows(); ++a) {
    const Eigen::VectorXd row = stationary.transitions.row(a);
    transitions.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return {
      {"converged", verdict.converged},
      {"not_established", not_established},
      {"resolution", verdict.resolution},
      {"ess_model", finite(verdict.ess_model)},
      {"ess_log_posterior", finite(verdict.ess_log_posterior)},
      {"round_trips", inference::round_trips(counts, lowest, highest)},
      {"rhat_max", finite(verdict.rhat_max)},
      {"rhat", rhats},
      {"acceptance", {{"moves", moves}, {"models", jumps}}},
      {"transitions",
       {{"counts", transitions},
        {"stationary_mean", stationary.mean},
        {"stationary_sd", stationary.sd},
        {"effective_draws", finite(stationary.effective_draws)}}},
      {"ladder",
       {{"while_drawing", posterior.tempered_draws},
        {"round_trips", posterior.tempered_draws ? Report(posterior.ladder_round_trips) : Report()},
        {"barrier", posterior.barrier > 0.0 ? finite(posterior.barrier) : Report()}}},
      {"impossible", posterior.impossible},
      {"balanced", !posterior.log_weight.empty()},
      {"stopped_early", posterior.stopped_early},
      {"notes", posterior.notes},
      {"warnings", warnings}};
}

std::string machine() {
  std::string processor = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    processor = line.substr(colon + 2);
    break;
  }
  const int cores = base::thread_count(0);
  return processor + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores");
}

Report about(const std::string& command, const RunInfo& info, const CaseFile& file) {
  return {{"version", WHEELTAP_VERSION},
          {"command", command},
          {"command_line", info.command_line},
          {"seed", info.seed},
          {"machine", machine()},
          {"case_file", file.path.string()},
          {"case", Report::parse(file.json.dump())}};
}

Report cost(const Posterior& posterior) {
  return {{"likelihood_evaluations", posterior.likelihood_evaluations},
          {"full_model_calls", posterior.full_evaluations > 0 ? posterior.full_evaluations
                                                              : posterior.likelihood_evaluations},
          {"warmup_evaluations", posterior.warmup_evaluations},
          {"wall_seconds", posterior.wall_seconds},
          {"chains", posterior.chains.size()},
          {"draws_a_chain", posterior.draws},
          {"thin", posterior.thin},
          {"warmup_iterations_a_chain", posterior.warmup}};
}

std::string significant(double x, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

std::string resolved(double x, double width) {
  if (x == 0.0 || !std::isfinite(x)) return significant(x, 3);
  int digits = 3;
  if (width > 0.0) {
    digits = std::clamp(
        static_cast<int>(std::floor(std::log10(std::abs(x))) - std::floor(std::log10(width))) + 2,
        3, 10);
  }
  // No exponent where people would not write one.
  const double size = std::abs(x);
  if (size >= 1000.0 && size < 1e7) {
    return fixed(x, std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size)))));
  }
  return significant(x, digits);
}

std::string fixed(double x, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  return text;
}

std::string grouped(long n) {
  std::string text = std::to_string(n);
  for (auto at = static_cast<long>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), " ");
  }
  return text;
}

std::string rounded_count(double x) {
  if (!(x < 1e15)) return "-";
  const double unit = x < 1000.0 ? 1.0 : std::pow(10.0, std::floor(std::log10(x)) - 2.0);
  return fixed(std::round(x / unit) * unit, 0);
}

std::string percent(double probability) {
  if (probability > 0.999) return "> 99.9 %";
  if (probability < 0.001) return "< 0.1 %";
  return significant(100.0 * probability, probability < 0.0995 ? 2 : 3) + " %";
}

std::string probability_is(double probability) {
  const std::string text = percent(probability);
  return text[0] == '<' || text[0] == '>' ? "P " + text : "P = " + text;
}

}  // namespace wheeltap::apps
