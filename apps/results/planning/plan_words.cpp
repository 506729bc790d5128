// Sentences and terminal output of a plan.
#include <algorithm>
#include <ostream>

#include "apps/results/planning/plan_summary.hpp"
#include "apps/results/terminal.hpp"
#include "base/number.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

namespace {

std::string chance(const Report& design, const char* key) {
  return percent(design.at(key).get<double>(), design.at("mcse").at(key).get<double>());
}

std::string share_error(const Report& design, const char* key) {
  return significant(design.at(key).get<double>(), 3) + " ± " +
         significant(design.at("mcse").at(key).get<double>(), 1);
}

std::vector<std::string> names_of(const Report& list) {
  std::vector<std::string> out;
  for (const Report& name : list) out.push_back(name.get<std::string>());
  return out;
}

/// Sentence: "frame, 0 to 0.4 m cannot be told apart from …".
std::string regions_in_words(const Report& regions, const std::string& by) {
  if (regions.empty()) return {};
  std::vector<std::string> pairs;
  const auto is_exact = [](const Report& r) { return r.at("exact").get<bool>(); };
  const bool exact = std::ranges::all_of(regions, is_exact);
  for (const Report& r : regions)
    if (pairs.size() < 3)
      pairs.push_back(r.at("first").get<std::string>() + " and " +
                      r.at("second").get<std::string>() +
                      (is_exact(r) && !exact ? " (mirror images)" : ""));
  std::string out = by + " cannot distinguish these locations: ";
  for (std::size_t i = 0; i < pairs.size(); ++i) out += (i > 0 ? "; " : "") + pairs[i];
  if (regions.size() > pairs.size())
    out += "; and " + std::to_string(regions.size() - pairs.size()) + " more pairs of regions";
  return out + (exact ? ". These locations are mirror images." : ".");
}

std::string separation_in_words(const Report& separation, bool none_yet) {
  std::string out;
  const auto share = [](const Report& s) {
    return s.at("separated") == s.at("of")
               ? std::string("all compared pairs")
               : std::to_string(s.at("separated").get<int>()) + " of " +
                     std::to_string(s.at("of").get<int>()) + " compared pairs";
  };
  if (const Report& s = separation.at("sensors"); !s.is_null())
    out = std::string(none_yet
                          ? "The cheapest sensors that distinguish the locations are "
                          : "The cheapest further sensor that distinguishes these locations is ") +
          in_words(names_of(s.at("sensor_names"))) + " (" + share(s) + ")" +
          (none_yet ? "; two are needed, because shapes have no scale." : ".");
  if (const Report& m = separation.at("mass"); !m.is_null())
    out += (out.empty() ? "" : " ") + std::string("The added mass of ") +
           m.at("mass").get<std::string>() + ", in a second test configuration, distinguishes " +
           share(m) + " by frequencies.";
  return out.empty() ? "No candidate sensor or added mass distinguishes the locations." : out;
}

/// Sentence on the fewest sensors that lose less than the fraction `kWorth` of the total
/// information.
std::string stopping_in_words(const Report& path) {
  constexpr double kWorth = 0.02;
  if (path.size() < 3) return {};
  const auto information = [&](std::size_t i) { return path[i].at("information").get<double>(); };
  const double all = information(path.size() - 1);
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (all - information(i) < kWorth * all)
      return (i == 0 ? std::string("Frequencies alone")
                     : std::to_string(path[i].at("sensors").size()) + " sensors") +
             " give " + percent(information(i) / all) + " of the information of " +
             std::to_string(path[path.size() - 1].at("sensors").size()) + " sensors.";
  return {};
}

std::string smallest_in_words(const Report& plan) {
  std::size_t found = 0, all = 0;
  const Report *least = nullptr, *most = nullptr;
  std::string key;
  const std::string first_kind =
      plan.at("smallest_detectable").empty()
          ? std::string()
          : plan.at("smallest_detectable")[0].at("kind").get<std::string>();
  for (std::size_t i = 0; i < plan.at("smallest_detectable").size(); ++i) {
    const Report& row = plan.at("smallest_detectable")[i];
    if (row.at("kind") != first_kind) continue;
    ++all;
    key = plan.at("detection_map")[i].at("severity").get<std::string>();
    if (row.at(key).is_null()) continue;
    ++found;
    if (least == nullptr || row.at(key).get<double>() < least->at(key).get<double>()) least = &row;
    if (most == nullptr || row.at(key).get<double>() > most->at(key).get<double>()) most = &row;
  }
  if (all == 0) return {};
  if (found == 0)
    return "Even for the largest " + key +
           " that the prior allows, the probability of detection is below 0.9 at every location.";
  std::string out = "The smallest " + key + " detected with probability 0.9 is " +
                    significant(least->at(key).get<double>(), 2) + " at " +
                    least->at("place").get<std::string>();
  if (most != least)
    out += " and " + significant(most->at(key).get<double>(), 2) + " at " +
           most->at("place").get<std::string>();
  out += ".";
  if (found < all)
    out += " At " + std::to_string(all - found) + " of " + std::to_string(all) +
           " locations, the probability of detection is below 0.9 even for the largest " + key +
           " that the prior allows.";
  return out;
}

}  // namespace

std::string sensors_in_words(const Report& plan, const Report& design) {
  static_cast<void>(plan);
  if (design.at("sensors").empty()) return "no sensors for shapes";
  return in_words(names_of(design.at("sensor_names")));
}

std::string plan_headline(const Report& plan) {
  const Report& best = plan.at("designs")[0];
  const std::size_t n = best.at("sensors").size();
  const Report& seconds = plan.at("seconds");
  return (seconds.is_null() ? std::string("A test with ")
                            : "A test of " + significant(seconds.get<double>(), 6) + " s with ") +
         (n < 2 ? "frequencies alone" : "shapes at " + std::to_string(n) + " sensors") +
         " detects " + chance(best, "detection") +
         " of the damages drawn from the prior, at a false-alarm probability of " +
         percent(plan.at("false_alarm").get<double>()) +
         ". It identifies the number and location of the damages correctly in " +
         chance(best, "right_place") + " of these damages.";
}

std::vector<std::string> plan_details(const Report& plan) {
  std::vector<std::string> out;
  const Report& best = plan.at("designs")[0];
  if (!best.at("sensors").empty()) out.push_back("Sensors: " + sensors_in_words(plan, best) + ".");
  if (const std::string words = smallest_in_words(plan); !words.empty()) out.push_back(words);
  if (!best.at("sensors").empty()) {
    const Report& alone = plan.at("frequencies_alone");
    out.push_back("Frequencies alone detect " + chance(alone, "detection") +
                  " and identify the number and location of damages in " +
                  chance(alone, "right_place") + ".");
  }
  const Report& alone = plan.at("alone");
  if (!alone.at("indistinguishable").empty()) {
    out.push_back(regions_in_words(alone.at("indistinguishable"), "Frequencies alone"));
    out.push_back(separation_in_words(alone.at("separation"), true));
  }
  if (!best.at("sensors").empty() && !plan.at("indistinguishable").empty()) {
    out.push_back(regions_in_words(plan.at("indistinguishable"), "The recommended sensors"));
    out.push_back(separation_in_words(plan.at("separation"), false));
  }
  for (const Report& r : plan.at("resolution"))
    out.push_back("In " + r.at("member").get<std::string>() +
                  ", the test cannot distinguish locations within about " +
                  significant(r.at("metres").get<double>(), 2) + " m.");
  if (const std::string words = stopping_in_words(plan.at("by_sensors")); !words.empty())
    out.push_back(words);
  return out;
}

std::string check_sentence(const Report& plan) {
  if (!plan.contains("check")) return {};
  const Report& check = plan.at("check");
  const int missed = check.at("missed").get<int>();
  if (check.at("rms_probability_damaged").is_null())
    return "The full engine missed the true damage in all of the " + std::to_string(missed) +
           " checked tests.";
  std::string out =
      "The full engine analysed " + std::to_string(check.at("tests").get<int>()) +
      " of the simulated tests. " +
      (missed > 0
           ? "In " + std::to_string(missed) +
                 " of these tests, the search missed the true damage; these tests are not counted. "
           : std::string()) +
      "In the counted tests, " + std::to_string(check.at("damaged").get<int>()) +
      " of them with damage, P(at least one damage) of the engine differs by " +
      significant(check.at("rms_probability_damaged").get<double>(), 2) +
      " (root mean square) from the approximation of the plan.";
  // With fewer tests, the error is too large for a correction.
  constexpr int kFewestChecked = 20;
  if (check.at("damaged").get<int>() < kFewestChecked)
    return out + " These are too few tests to correct the probabilities of the plan: use --check " +
           std::to_string(2 * kFewestChecked) + " or more.";
  const auto corrected = [&](const char* key, const char* words) {
    const Report& c = check.at(key);
    if (c.at("corrected").is_null()) return;
    out += std::string(" Corrected by the mean difference in these tests, ") + words + " is " +
           percent(c.at("corrected").get<double>(), c.at("se").get<double>()) + ".";
  };
  corrected("detection", "the probability of detection");
  corrected("right_place", "the probability of the right number and location");
  return out;
}

std::vector<std::string> value_sentences(const Report& plan) {
  if (!plan.contains("value")) return {};
  const Report& value = plan.at("value");
  std::vector<std::string> out;
  const std::string without =
      "Without a test, the expected cost is " +
      significant(value.at("without_test").get<double>(), 4) +
      (value.at("inspects_without_test").get<bool>() ? " with an inspection."
                                                     : " without an inspection.");
  if (value.at("best").is_null()) {
    out.push_back("No compared test reduces the expected cost. " + without);
  } else {
    const Report& best = value.at("options")[value.at("best").get<std::size_t>()];
    out.push_back("The best test is " + best.at("name").get<std::string>() +
                  ". It reduces the expected cost by " +
                  significant(best.at("saving").get<double>(), 3) + " ± " +
                  significant(best.at("mcse").get<double>(), 1) +
                  " if alarms have a false-alarm probability of " +
                  percent(best.at("false_alarm").get<double>()) + ". " + without);
  }
  std::vector<std::string> changes;
  for (const Report& s : value.at("sensitivity"))
    if (s.at("best") != value.at("best_name"))
      changes.push_back(s.at("cost").get<std::string>() +
                        (s.at("factor").get<double>() > 1.0 ? " doubled: " : " halved: ") +
                        (s.at("best").is_null() ? "no test" : s.at("best").get<std::string>()));
  if (changes.empty()) {
    out.push_back("The best test stays the same if any one cost is halved or doubled.");
  } else {
    std::string list;
    for (const std::string& change : changes) list += (list.empty() ? "" : "; ") + change;
    out.push_back("The best test changes with the costs. " + list + ".");
  }
  return out;
}

namespace {

/// "2: 0.34 m, 0.68 m", or "2: candidates 0, 3, 8, 12" if the names would make the table too wide.
std::string layout_in_words(const Report& design, int rank) {
  constexpr std::size_t kWidest = 32;
  std::string names, numbers;
  for (const std::string& name : names_of(design.at("sensor_names")))
    names += (names.empty() ? "" : ", ") + name;
  for (const Report& sensor : design.at("sensors"))
    numbers += (numbers.empty() ? "candidates " : ", ") + std::to_string(sensor.get<int>());
  if (names.empty()) names = "frequencies";
  return std::to_string(rank) + ": " + (names.size() > kWidest ? numbers : names);
}

void print_designs(const Page& page, const Report& plan) {
  std::vector<std::vector<std::string>> rows = {
      {"design", "information [nat]", "detected", "right location"}};
  const auto add = [&](const std::string& name, const Report& d) {
    rows.push_back({io::printable(name), share_error(d, "information"), chance(d, "detection"),
                    chance(d, "right_place")});
  };
  int rank = 0;
  for (const Report& d : plan.at("designs")) {
    ++rank;
    add(layout_in_words(d, rank), d);
    if (rank == 5) break;
  }
  for (const Report& d : plan.at("others")) add(d.at("name").get<std::string>(), d);
  if (!plan.at("designs")[0].at("sensors").empty())
    add("frequencies alone", plan.at("frequencies_alone"));
  page.table(rows);
}

void print_variations(const Page& page, const Report& plan) {
  std::vector<std::vector<std::string>> rows = {
      {"variation", "information [nat]", "detected", "right location"}};
  for (const char* key : {"by_sensors", "by_length", "by_modes", "by_mass"})
    for (const Report& d : plan.at(key))
      rows.push_back({io::printable(d.at("name").get<std::string>()), share_error(d, "information"),
                      chance(d, "detection"), chance(d, "right_place")});
  if (rows.size() > 1) page.table(rows);
}

}  // namespace

void print_plan(std::ostream& out, const Report& summary, bool colour) {
  const Page page{out, colour};
  const Report& plan = summary.at("plan");
  out << page.bold(io::printable(summary.at("title").get<std::string>())) << "\n\n";
  page.wrapped(plan_headline(plan), "", "");
  for (const std::string& text : plan_details(plan)) page.wrapped(io::printable(text), "", "");
  for (const std::string& text : value_sentences(plan)) page.wrapped(io::printable(text), "", "");
  out << "\n";
  print_designs(page, plan);
  out << "\n";
  print_variations(page, plan);
  const Report& search = plan.at("search");
  page.wrapped(std::string(search.at("exhaustive").get<bool>() ? "All layouts were compared: "
                                                               : "The search compared ") +
                   base::grouped(search.at("compared").get<long>()) + " designs with up to " +
                   base::grouped(search.at("scenarios").get<long>()) +
                   " simulated tests per design. The table of designs uses " +
                   base::grouped(plan.at("scenarios").get<long>()) +
                   " simulated tests, the table of variations uses " +
                   base::grouped(plan.at("variation_scenarios").get<long>()) + ".",
               "", "");
  if (const std::string words = check_sentence(plan); !words.empty()) page.wrapped(words, "", "");
  for (const Report& text : summary.at("diagnostics").at("warnings"))
    page.wrapped(io::printable(text.get<std::string>()), "! ", "  ");
}

}  // namespace wheeltap::apps
