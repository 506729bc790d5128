#include "identification/structural/likelihood/mode_matching.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace wheeltap::identification {

std::vector<int> least_cost_assignment(const Eigen::MatrixXd& costs) {
  const auto rows = static_cast<int>(costs.rows()), columns = static_cast<int>(costs.cols());
  if (rows > columns)
    throw std::invalid_argument("costs has " + std::to_string(rows) + " rows: must be at most " +
                                std::to_string(columns) + ", the number of columns");
  if (costs.hasNaN()) throw std::invalid_argument("costs must not be NaN");
  // A forbidden pair costs more than all other pairs together.
  double most = 1.0;
  for (const double c : costs.reshaped())
    if (std::isfinite(c)) most = std::max(most, std::abs(c));
  const double forbidden = 4.0 * most * (rows + 1);
  const auto cost = [&](int i, int j) {
    const double c = costs(i, j);
    return std::isfinite(c) ? c : forbidden;
  };
  // Column 0 holds the row to assign.
  const auto size = static_cast<std::size_t>(columns) + 1;
  std::vector<double> of_row(static_cast<std::size_t>(rows) + 1), of_column(size);
  std::vector<int> owner(size), before(size);
  for (int row = 1; row <= rows; ++row) {
    owner[0] = row;
    int at = 0;
    std::vector<double> least(size, std::numeric_limits<double>::infinity());
    std::vector<bool> seen(size);
    do {
      const auto here = static_cast<std::size_t>(at);
      seen[here] = true;
      const int i = owner[here];
      double step = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        const auto column = static_cast<std::size_t>(j);
        if (seen[column]) continue;
        const double reduced =
            cost(i - 1, j - 1) - of_row[static_cast<std::size_t>(i)] - of_column[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          before[column] = at;
        }
        if (least[column] < step) {
          step = least[column];
          next = j;
        }
      }
      for (std::size_t j = 0; j < size; ++j) {
        if (seen[j]) {
          of_row[static_cast<std::size_t>(owner[j])] += step;
          of_column[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      at = next;
    } while (owner[static_cast<std::size_t>(at)] != 0);
    while (at != 0) {
      const int previous = before[static_cast<std::size_t>(at)];
      owner[static_cast<std::size_t>(at)] = owner[static_cast<std::size_t>(previous)];
      at = previous;
    }
  }
  std::vector<int> out(static_cast<std::size_t>(rows));
  for (int j = 1; j <= columns; ++j)
    if (const int row = owner[static_cast<std::size_t>(j)]; row > 0)
      out[static_cast<std::size_t>(row) - 1] = j - 1;
  return out;
}

}  // namespace wheeltap::identification
