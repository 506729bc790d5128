#include "apps/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>

#include "inference/parallel.hpp"

namespace wheeltap::apps {
namespace {

using inference::ChainsOf;
using inference::Posterior;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastDraws = 100;  // of a chain, for its convergence to be judged
constexpr double kDominant = 0.999;
constexpr double kMaxRhat = 1.01;
constexpr double kMinEss = 400.0;

// JSON has no infinity.
Report finite(double x) {
  return std::isfinite(x) ? Report(x) : Report();
}

// The midpoint of the fullest bin, bins by Freedman & Diaconis's rule (1981).
double histogram_mode(const std::vector<double>& sorted) {
  const double low = sorted.front(), high = sorted.back();
  if (!(high > low)) return low;
  const double width = 2.0 * (quantile(sorted, 0.75) - quantile(sorted, 0.25)) /
                       std::cbrt(static_cast<double>(sorted.size()));
  const double bins_wanted = width > 0.0 ? std::ceil((high - low) / width) : 200.0;
  const auto bins = static_cast<std::size_t>(std::clamp(bins_wanted, 10.0, 400.0));
  std::vector<std::size_t> counts(bins);
  for (const double x : sorted) {
    const auto at = static_cast<std::size_t>((x - low) / (high - low) * static_cast<double>(bins));
    ++counts[std::min(at, bins - 1)];
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

ChainsOf counts_of_kind(const Posterior& posterior, std::size_t kind) {
  return all_draws(posterior, [&](std::size_t c, std::size_t i) {
    return static_cast<double>((*posterior.space)[posterior.chains[c].model[i]].counts[kind]);
  });
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

Report summarise(const ChainsOf& chains) {
  std::vector<double> sorted;
  for (const auto& chain : chains) sorted.insert(sorted.end(), chain.begin(), chain.end());
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  const double mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / n;
  double squares = 0.0;
  for (const double x : sorted) squares += (x - mean) * (x - mean);
  inference::Convergence judged{kNaN, kNaN, kNaN, kNaN, kNaN};
  if (const ChainsOf equal = equal_lengths(chains); !equal.empty()) {
    judged = inference::convergence(equal);
  }
  return {{"mean", mean},
          {"sd", n > 1.0 ? std::sqrt(squares / (n - 1.0)) : 0.0},
          {"q2.5", quantile(sorted, 0.025)},
          {"q50", quantile(sorted, 0.5)},
          {"q97.5", quantile(sorted, 0.975)},
          {"mode", histogram_mode(sorted)},
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

double ess_of_model(const Posterior& posterior) {
  const auto& space = *posterior.space;
  double least = std::numeric_limits<double>::infinity();
  if (!space.kinds().empty()) {
    for (std::size_t k = 0; k < space.kinds().size(); ++k) {
      least = std::min(least, inference::ess_mean(counts_of_kind(posterior, k)));
    }
    return least;
  }
  for (int m = 0; m < space.size(); ++m) {
    if (probability(posterior, m) == 0.0) continue;
    least = std::min(least, inference::ess_mean(all_draws(posterior, [&](auto c, auto i) {
                       return posterior.chains[c].model[i] == m ? 1.0 : 0.0;
                     })));
  }
  return least;
}

Report model_table(const Posterior& posterior, double ess_model) {
  const auto& space = *posterior.space;
  Report table = Report::array();
  for (int m = 0; m < space.size(); ++m) {
    const ChainsOf indicator = all_draws(
        posterior, [&](auto c, auto i) { return posterior.chains[c].model[i] == m ? 1.0 : 0.0; });
    const double mcse = inference::mcse_mean(indicator);
    const double floor = 1.0 / (ess_model + 2.0);
    table.push_back({{"name", space[m].name},
                     {"prior", std::exp(space[m].log_prior)},
                     {"probability", probability(posterior, m)},
                     {"mcse", finite(std::max(mcse, floor))}});
  }
  return table;
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

Report diagnostics(const Posterior& posterior, const std::vector<Watched>& watched,
                   double ess_model, std::uint64_t seed, std::vector<std::string> warnings) {
  const auto& space = *posterior.space;
  double most_probable = 0.0;
  for (int m = 0; m < space.size(); ++m) {
    most_probable = std::max(most_probable, probability(posterior, m));
  }
  const bool dominant = most_probable > kDominant;

  const ChainsOf log_posterior = all_draws(posterior, [&](std::size_t c, std::size_t i) {
    return posterior.chains[c].log_prior[i] + posterior.chains[c].log_likelihood[i];
  });
  const auto of_log_posterior = inference::convergence(log_posterior);
  Report rhats = {{"log posterior", finite(of_log_posterior.rhat)}};
  std::string worst = "log posterior";
  double rhat_max = of_log_posterior.rhat;
  for (const Watched& w : watched) {
    const double r = inference::rhat(w.draws);
    rhats[w.name] = finite(r);
    if (w.is_count && dominant) continue;
    if (!(r <= rhat_max)) rhat_max = r, worst = w.name;
  }
  const double ess_log_posterior = std::min(of_log_posterior.ess_bulk, of_log_posterior.ess_tail);
  const bool converged = rhat_max < kMaxRhat && ess_log_posterior > kMinEss &&
                         (dominant || ess_model > kMinEss) && !posterior.stopped_early;
  if (!converged) {
    std::string why;
    if (posterior.stopped_early) why = "it was stopped early";
    if (!(rhat_max < kMaxRhat)) {
      why += (why.empty() ? "" : ", ") + std::string("R-hat of ") + worst + " is " +
             significant(rhat_max, 4) + " (must be below 1.01)";
    }
    if (!(ess_log_posterior > kMinEss)) {
      why += (why.empty() ? "" : ", ") +
             std::string("the effective sample size of the log posterior is ") +
             significant(ess_log_posterior, 3) + " (must exceed 400)";
    }
    if (!dominant && !(ess_model > kMinEss)) {
      why += (why.empty() ? "" : ", ") + std::string("the effective sample size of the count is ") +
             significant(ess_model, 3) + " (must exceed 400)";
    }
    warnings.insert(warnings.begin(),
                    "The chains have not converged: " + why +
                        ". Do not trust these numbers yet; run longer with --draws and --warmup.");
  }

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
  return {{"converged", converged},
          {"ess_model", finite(ess_model)},
          {"ess_log_posterior", finite(ess_log_posterior)},
          {"round_trips", inference::round_trips(counts, lowest, highest)},
          {"rhat_max", finite(rhat_max)},
          {"rhat", rhats},
          {"acceptance", {{"moves", moves}, {"models", jumps}}},
          {"transitions",
           {{"counts", transitions},
            {"stationary_mean", stationary.mean},
            {"stationary_sd", stationary.sd},
            {"effective_draws", finite(stationary.effective_draws)}}},
          {"ladder",
           {{"while_drawing", posterior.tempered_draws},
            {"round_trips",
             posterior.tempered_draws ? Report(posterior.ladder_round_trips) : Report()}}},
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
  const int cores = inference::thread_count(0);
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
