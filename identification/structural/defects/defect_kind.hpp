// Types of defects of beams and structures, and the kinds of defects that a case allows.
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

/// Effects of defects on a structure: defects on members and nodes, and direct changes of the
/// stiffness of strain components.
struct StructureEffects {
  fem::StructureDefects defects = {};
  fem::StructureChange change = {};
};

/// A type of defect with its properties. Every defect has a location and a severity.
/// identification/structural/defects/ contains one file per type, and `defect_types` lists the
/// types.
struct DefectType {
  std::string_view name;            ///< "kind" in a case
  std::string_view noun;            ///< default name
  std::string_view several = {};    ///< plural; default: the noun and an s
  std::string_view severity;        ///< name of the severity, a key in a case
  std::string_view severity_words;  ///< column heading: "stiffness lost"
  std::string_view effect_words;    ///< words before a severity: "stiffness reduced by"
  bool percent = false;             ///< true: the severity is a fraction, shown in per cent
  double lower = 0.0;               ///< bounds of the severity
  double upper = std::numeric_limits<double>::infinity();
  std::string_view bounds_words;  ///< "a reduction is in [0, 1)"
  /// True if the case may give the severity as a number instead of a prior, or omit it (rigid, ∞).
  bool may_be_known = false;
  bool may_be_rotational = false;
  /// Unit of the severity; "" if the severity is a fraction.
  std::string_view (*unit)(const DefectKind&);
  /// Adds the effect of a defect at `location` [m] to a beam; null if the type is not for beams.
  void (*place)(const DefectKind&, double location, double severity, fem::Defects& out) = nullptr;
  /// Adds the effect of a defect to a structure; null if the type is not for structures.
  void (*place_in_structure)(const DefectKind&, const SiteLine::Spot&, double severity,
                             StructureEffects& out) = nullptr;
  /// Parts of a structure in which this type of defect is possible.
  enum class Sites { members, nodes, links, substructures };
  Sites sites = Sites::members;
  [[nodiscard]] std::string noun_plural() const {
    return several.empty() ? std::string(noun) + "s" : std::string(several);
  }
  [[nodiscard]] bool is_for_beams() const { return sites == Sites::members; }
  /// True if `place` adds exactly one fem::Damage {location, severity}, or one fem::SpringSupport,
  /// so that the solver's gradients apply.
  bool is_elementary = false;
  /// True if the change of the structure has a low rank, as the reanalysis requires;
  /// StatesLikelihood solves structures with other changes.
  bool has_low_rank = true;
  /// True if two defects in one element combine as 1 - r = (1 - r₁)(1 - r₂), so that proposals can
  /// split and merge defects.
  bool compounds = false;
};

/// All types that a case may name. To add a type, write a file in
/// identification/structural/defects/ and add a line to defect_kind.cpp.
[[nodiscard]] const std::vector<const DefectType*>& defect_types();
/// Returns the type with this name, or nullptr if no type has this name.
[[nodiscard]] const DefectType* find_defect_type(std::string_view name);

/// A kind of defect in a case: its type, and the priors of its number, location and severity.
struct DefectKind {
  struct Rigid {};
  using Severity = std::variant<Rigid, double, inference::Prior>;
  struct True {
    double location;      ///< [m]
    double severity;      ///< ∞: rigid
    double extent = 0.0;  ///< [m], if the extent of the kind is unknown
  };

  const DefectType* type = nullptr;
  std::string name = {}, plural = {};  ///< "damage", "damages"
  int min_count = 0;
  int max_count = 0;
  std::vector<double> weights = {};  ///< prior probabilities of counts min_count … max_count
  inference::Prior location;         ///< location on the line [m]
  Severity severity = Rigid{};
  bool rotation = false;  ///< for a support: true if it restrains the rotation
  SiteLine line = {};     ///< possible locations; `location` is a prior on this line
  const fem::CrackLaw* crack_law = &fem::crack_laws()[0];
  std::optional<double> extent = {};  ///< length of a reduction [m]; empty: one element
  std::optional<inference::Prior> extent_prior = {};  ///< if set, replaces `extent`
  fem::Direction direction = fem::Direction::y;       ///< direction of a support in a structure
  /// Members of each substructure, if substructures are groups of members.
  std::vector<std::vector<int>> groups = {};
  std::vector<True> truth = {};  ///< true defects for simulations, by increasing location

  [[nodiscard]] const inference::Prior* severity_prior() const {
    return std::get_if<inference::Prior>(&severity);
  }
  /// Name of a site on the line of a structure: "member", "node", "link" or "substructure".
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
  /// Number of parameters of one defect: location, and severity and extent if unknown.
  [[nodiscard]] int parameters() const {
    return 1 + (severity_prior() ? 1 : 0) + (extent_prior ? 1 : 0);
  }
  /// The severity of a kind with known severity: a number, or ∞.
  [[nodiscard]] double known_severity() const {
    const double* number = std::get_if<double>(&severity);
    return number ? *number : std::numeric_limits<double>::infinity();
  }
};

}  // namespace wheeltap::identification
