// The competing models, their parameters and their priors.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::inference {

struct Parameter {
  std::string name;
  Prior prior;
};

/// A kind of exchangeable component, e.g. a damage with a location and a stiffness reduction. A
/// state contains a set of components of one kind, sorted by their first parameter. The prior
/// density of an ordered set of k components is
///
///   P(k) · k! · ∏ p(component),
///
/// because k! labelled vectors represent the same set. A birth inserts a component at its position
/// in the order. A death removes one of the k + 1 components, chosen uniformly. The probability
/// 1/(k+1) of this choice cancels the ratio (k+1)!/k! of the prior densities.
struct ComponentKind {
  std::string name;                   ///< name in the singular, as in "1 damage"
  std::string plural;                 ///< name in the plural, as in "2 damages"
  std::vector<Parameter> parameters;  ///< parameters of one component
};

/// A competing model. The layout of the parameter vector is
///   [ parameters of the model itself | components of kind 0 | components of kind 1 | … ].
struct Model {
  std::string name;
  double log_prior;             ///< log prior probability, normalised over the space
  std::vector<int> parameters;  ///< indices into ModelSpace::parameters()
  std::vector<int> counts;      ///< number of components of each kind
  int dimension = 0;
  std::vector<int> offsets;  ///< index of each kind's first component parameter
};

/// Range of one component's parameters within a model's parameter vector: [first, first + width).
struct ComponentRange {
  std::size_t first = 0, width = 0;

  /// The entries of one component in a vector with the layout of Model.
  template <class T>
  [[nodiscard]] std::span<T> of(std::span<T> x) const {
    return x.subspan(first, width);
  }
  template <class T>
  [[nodiscard]] std::span<T> of(std::vector<T>& x) const {
    return of(std::span<T>(x));
  }
  template <class T>
  [[nodiscard]] std::span<const T> of(const std::vector<T>& x) const {
    return of(std::span<const T>(x));
  }
};

/// A finite list of models that share a table of named parameters; each model has counts of
/// exchangeable components.
class ModelSpace {
 public:
  struct ListedModel {
    std::string name;
    double weight;  ///< prior weight, >= 0, normalised by the space
    /// Parameter names; models that use the same name share the parameter
    std::vector<std::string> parameters;
  };
  struct Counts {
    std::vector<int> counts;  ///< one per kind
    double weight;
  };

  /// Creates a space of arbitrary models that share a table of parameters. Throws
  /// std::invalid_argument for a name that is not in the table, a parameter that no model uses,
  /// duplicate names, or prior weights that are negative or all zero.
  [[nodiscard]] static ModelSpace of_models(std::vector<Parameter> parameters,
                                            const std::vector<ListedModel>& models);
  /// Creates a space of models with component sets: one model per entry of `counts`, all with the
  /// `common` parameters. The names of the models have the form "2 damages" or "1 damage, 1
  /// support".
  [[nodiscard]] static ModelSpace of_components(std::vector<Parameter> common,
                                                std::vector<ComponentKind> kinds,
                                                const std::vector<Counts>& counts);

  [[nodiscard]] int size() const { return static_cast<int>(models_.size()); }
  [[nodiscard]] const Model& operator[](int m) const {
    return models_[static_cast<std::size_t>(m)];
  }
  [[nodiscard]] const std::vector<Model>& models() const { return models_; }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] const std::vector<ComponentKind>& kinds() const { return kinds_; }
  [[nodiscard]] int max_dimension() const { return max_dimension_; }

  /// Number of parameters of one component.
  [[nodiscard]] std::size_t width(int kind) const {
    return kinds_[static_cast<std::size_t>(kind)].parameters.size();
  }
  /// Range of component c of `kind` in the parameter vector of model m. c may equal the number of
  /// components; the result is then the range of an additional component.
  [[nodiscard]] ComponentRange component(int m, int kind, int c) const {
    const std::size_t each = width(kind);
    const int begin = (*this)[m].offsets[static_cast<std::size_t>(kind)];
    return {static_cast<std::size_t>(begin) + static_cast<std::size_t>(c) * each, each};
  }

  /// Prior of parameter i of model m. The model's own parameters come first, then the parameters of
  /// the components.
  [[nodiscard]] const Prior& prior(int m, int i) const;
  /// Name of parameter i of model m: "k", "location[2]" …
  [[nodiscard]] std::string parameter_name(int m, int i) const;
  /// Index of the model with this name. Throws std::invalid_argument with a list of the names if no
  /// model has this name.
  [[nodiscard]] int find(std::string_view name) const;
  /// Index of the model with the given component counts, or -1 if there is no such model.
  [[nodiscard]] int find(std::span<const int> counts) const;
  /// Index of the model with one component of `kind` more (step = +1) or fewer (step = -1) than m,
  /// or -1 if there is no such model.
  [[nodiscard]] int neighbour(int m, int kind, int step) const;

 private:
  void finish(const std::vector<double>& weights);

  std::vector<Model> models_;
  std::vector<Parameter> parameters_;
  std::vector<ComponentKind> kinds_;
  std::vector<std::vector<Prior>> priors_;  ///< copies of the priors, so that a space can be copied
  std::vector<int> neighbours_;
  int max_dimension_ = 0;
};

}  // namespace wheeltap::inference
