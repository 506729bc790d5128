// What may be wrong with a beam or a structure: the types of defect that there are, and so many of
// one of them as a case allows.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fem/beam/defect.hpp"
#include "fem/structures/defects/structure_defects.hpp"
#include "identification/structural/defects/site_line.hpp"
#include "inference/model/prior.hpp"

namespace wheeltap::identification {

struct DefectKind;

/// What defects do to a structure: places on members, nodes and the like, and what is a change of
/// strains already.
struct StructureEffects {
  fem::StructureDefects defects = {};
  fem::StructureChange change = {};
};

/// A type of defect: somewhere on the beam or structure, and so severe. Everything that is
/// particular to it stands here; identification/defects/ has a file for each, and `defect_types`
/// lists them.
struct DefectType {
  std::string_view name;            ///< "kind" in a case
  std::string_view noun;            ///< what it is called where the case does not say
  std::string_view several = {};    ///< of them; the noun and an s where not given
  std::string_view severity;        ///< name of its severity, a key in a case
  std::string_view severity_words;  ///< heads a column: "stiffness lost"
  std::string_view effect_words;    ///< before the severity in a sentence: "stiffness reduced by"
  bool percent = false;             ///< a share, shown in per cent
  double lower = 0.0;               ///< bounds of the severity
  double upper = std::numeric_limits<double>::infinity();
  std::string_view bounds_words;  ///< "a reduction is in [0, 1)"
  /// The severity may be a number, or missing (rigid, ∞), rather than a prior.
  bool may_be_known = false;
  bool may_be_rotational = false;
  /// Unit of the severity, "" for a share.
  std::string_view (*unit)(const DefectKind&);
  /// Adds what a defect at `location` [m] of this severity does to a beam; none where it is not for
  /// beams.
  void (*place)(const DefectKind&, double location, double severity, fem::Defects& out) = nullptr;
  /// The same of a structure; none where it is not for structures.
  void (*place_in_structure)(const DefectKind&, const SiteLine::Spot&, double severity,
                             StructureEffects& out) = nullptr;
  /// What it may be found on in a structure.
  enum class Sites { members, nodes, links, substructures };
  Sites sites = Sites::members;
  /// A beam has no nodes or links that a case names.
  [[nodiscard]] std::string noun_plural() const {
    return several.empty() ? std::string(noun) + "s" : std::string(several);
  }
  [[nodiscard]] bool is_for_beams() const { return sites == Sites::members; }
  /// `place` adds exactly one fem::Damage {location, severity}, or one fem::SpringSupport: the
  /// solver's gradients are those of the defect.
  bool is_elementary = false;
  /// What it does to a structure is of low rank: the reanalysis takes it. What it is not is solved
  /// by StatesLikelihood.
  bool has_low_rank = true;
  /// Two in one element compound, 1 - r = (1 - r₁)(1 - r₂): they can be split and merged.
  bool compounds = false;
};

/// Every type that a case may name. A new one is a file in identification/defects/ and a line in
/// defect_kind.cpp.
[[nodiscard]] const std::vector<const DefectType*>& defect_types();
/// nullptr where there is none of this name.
[[nodiscard]] const DefectType* find_defect_type(std::string_view name);

/// A kind of defect that a case allows: so many of a type, each somewhere, each so severe.
struct DefectKind {
  struct Rigid {};
  using Severity = std::variant<Rigid, double, inference::Prior>;
  struct True {
    double location;      ///< [m]
    double severity;      ///< ∞: rigid
    double extent = 0.0;  ///< [m], where the kind's is unknown
  };

  const DefectType* type = nullptr;
  std::string name = {}, plural = {};  ///< "damage", "damages"
  int min_count = 0;
  int max_count = 0;
  std::vector<double> weights = {};  ///< prior of min_count … max_count, sums to 1
  inference::Prior location;         ///< [m]
  Severity severity = Rigid{};
  bool rotation = false;  ///< a support that holds the rotation
  SiteLine line = {};     ///< where it may be; `location` is a prior on it
  const fem::CrackLaw* crack_law = &fem::crack_laws()[0];
  std::optional<double> extent = {};  ///< of a reduction [m]; an element where there is none
  std::optional<inference::Prior> extent_prior = {};  ///< in place of it, where it is unknown
  fem::Direction direction = fem::Direction::y;       ///< of a support in a structure
  /// Members of each substructure, where its parts are members.
  std::vector<std::vector<int>> groups = {};
  std::vector<True> truth = {};  ///< what simulations use, by increasing location

  [[nodiscard]] const inference::Prior* severity_prior() const {
    return std::get_if<inference::Prior>(&severity);
  }
  /// "member", "node", "link" or "substructure": what its line consists of, in a structure.
  [[nodiscard]] std::string site_name() const {
    switch (type->sites) {
      case DefectType::Sites::nodes:
        return "node";
      case DefectType::Sites::links:
        return "link";
      case DefectType::Sites::substructures:
        return "substructure";
      default:
        return "member";
    }
  }
  [[nodiscard]] std::string severity_name() const { return std::string(type->severity); }
  [[nodiscard]] std::string severity_unit() const { return std::string(type->unit(*this)); }
  /// Parameters of one defect: its location, its severity and its extent where they are unknown.
  [[nodiscard]] int parameters() const {
    return 1 + (severity_prior() ? 1 : 0) + (extent_prior ? 1 : 0);
  }
  /// The severity where it is known: a number, or ∞.
  [[nodiscard]] double known_severity() const {
    const double* number = std::get_if<double>(&severity);
    return number ? *number : std::numeric_limits<double>::infinity();
  }
};

}  // namespace wheeltap::identification
