// Structures with measured modes for several tests.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "fem/structures/lumped_chain.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/defects/storey.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::identification::modal {

/// A chain from the ground: masses [kg], and one stiffness parameter per link.
inline std::shared_ptr<const StructureModel> chain(const std::vector<double>& masses,
                                                   const std::vector<inference::Prior>& priors) {
  fem::LumpedChain chain{.masses = masses, .links = {}};
  auto model = std::make_shared<StructureModel>();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    chain.links.push_back({.name = "storey " + number,
                           .between = {static_cast<int>(i), static_cast<int>(i) + 1},
                           .stiffness = priors[i].from_standard_normal(0.0)});
    model->parameters.push_back({"k" + number, priors[i]});
    model->setters.emplace_back(
        [i](AnyStructure& s, double x) { std::get<fem::LumpedChain>(s).links[i].stiffness = x; });
  }
  model->nominal = std::move(chain);
  return model;
}

/// Sensors at the masses with these numbers, from 1.
inline std::vector<Sensor> at_masses(const std::vector<int>& numbers) {
  std::vector<Sensor> sensors;
  for (const int i : numbers)
    sensors.push_back({"mass " + std::to_string(i), {.dofs = {i - 1}, .coefficients = {1.0}}});
  return sensors;
}

inline Eigen::MatrixXd diagonal(const std::vector<double>& sds) {
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(sds.size()),
                                            static_cast<Eigen::Index>(sds.size()));
  for (std::size_t i = 0; i < sds.size(); ++i)
    c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = sds[i] * sds[i];
  return c;
}

/// The two-storey chain of the tests, with noise `cov` of its frequencies and, if `shape_sd` > 0,
/// shapes at both floors.
inline UpdateCase two_storeys(double cov, double shape_sd) {
  UpdateCase out{.title = "two storeys",
                 .structure = chain({2.0, 1.0}, {inference::Uniform{500.0, 3000.0},
                                                 inference::Uniform{300.0, 2500.0}})};
  out.data.sensors = at_masses({1, 2});
  out.simulation = ModalSimulation{
      .parameters = {1400.0, 900.0}, .modes = 2, .cov = cov, .shape_sd = shape_sd, .seed = 4};
  simulate(out, 4);
  return out;
}

/// A portal: posts that are clamped or elastically supported at their feet, and a beam.
inline fem::Structure portal(int elements) {
  const fem::Material steel{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const fem::MemberSection section{
      .area = 5e-3, .second_moment_y = 1.7e-5, .shear_coefficient_z = 0.85, .depth = 0.2};
  fem::Structure s{
      .dimension = 2,
      .nodes = {{"A", {0, 0, 0}}, {"B", {0, 3, 0}}, {"C", {4, 3, 0}}, {"D", {4, 0, 0}}},
      .members = {}};
  const auto add = [&](std::string name, int a, int b, double length) {
    s.members.push_back({.name = std::move(name),
                         .nodes = {a, b},
                         .elements = elements,
                         .pieces = {{.to = length, .material = steel, .section = section}}});
  };
  add("left", 0, 1, 3.0);
  add("beam", 1, 2, 4.0);
  add("right", 2, 3, 3.0);
  s.supports.push_back({.node = 0, .fix = {true, true, false, false, false, true}});
  s.supports.push_back({.node = 3, .fix = {true, true}, .stiffness = {0, 0, 0, 0, 0, 1e6}});
  return s;
}

/// A chain from the ground, with a standard deviation of 20 % of each stiffness.
inline std::shared_ptr<const StructureModel> three_storeys() {
  const inference::Prior k = inference::LogNormal{std::log(1000.0), 0.2};
  return chain({1.0, 1.2, 0.8}, {k, k, k});
}

/// At most one soft storey, anywhere.
inline DefectKind soft_storey() {
  SiteLine line = SiteLine::of_points({0, 1, 2}, {"storey 1", "storey 2", "storey 3"});
  DefectKind kind{.type = &defects::kStorey,
                  .name = "storey",
                  .plural = "storeys",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, line.length()},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.9})};
  kind.line = std::move(line);
  return kind;
}

}  // namespace wheeltap::identification::modal
