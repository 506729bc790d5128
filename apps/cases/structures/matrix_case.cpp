#include "apps/cases/structures/matrix_case.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/cases/structures/structure_case.hpp"
#include "apps/cases/structures/structure_parameters.hpp"
#include "io/bytes.hpp"
#include "io/matlab/sparse_matrix.hpp"
#include "io/tables/delimited_text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

const Pointer kMatrixStructure("/structure");

/// Reads the matrix named at `where`; errors in the file refer to this location in the case.
io::SparseMatrix matrix_at(const CaseFile& file, const std::filesystem::path& path,
                           const Pointer& where) {
  try {
    const auto name = file.json.at(where).get<std::string>();
    for (const std::string& one : {name, name + ".mtx"})  // in a folder of Matrix Market files
      file.inputs->add(file.json.at(kMatrixStructure / "matrices").get<std::string>() + "/" + one,
                       path / one);
    io::SparseMatrix matrix = io::read_sparse_matrix(path, name);
    if (matrix.rows() > kMostDegreesOfFreedom)
      file.refuse(where, "has " + std::to_string(matrix.rows()) +
                             " degrees of freedom: must have at most " +
                             std::to_string(kMostDegreesOfFreedom));
    return matrix;
  } catch (const io::FileError& error) {
    if (error.kind() == io::FileError::Kind::missing) throw;
    file.refuse(where, error.what());
  }
}

/// Parses rows "number, place, direction", with numbers from 1. Degrees of freedom without a row
/// keep their numbers.
std::vector<fem::DofName> read_names(const CaseFile& file, Eigen::Index size) {
  const Pointer where = kMatrixStructure / "dofs";
  std::vector<fem::DofName> names;
  for (Eigen::Index i = 0; i < size; ++i)
    names.push_back({"degree of freedom " + std::to_string(i + 1), ""});
  const std::filesystem::path path = file.resolve(file.json.at(where).get<std::string>());
  const io::DelimitedText table(io::read_bytes(path), path, io::FirstRow::header);
  std::vector<std::size_t> columns;
  for (const char* wanted : {"number", "place", "direction"}) {
    const auto found = std::ranges::find(table.headers(), wanted, &io::Column::name);
    if (found == table.headers().end())
      file.refuse(where, std::string("has no column \"") + wanted +
                             "\"; must have the columns number, place and direction");
    columns.push_back(static_cast<std::size_t>(found - table.headers().begin()));
  }
  std::vector<bool> named(names.size(), false);
  std::map<std::pair<std::string, std::string>, int> line_of;
  for (int row = 0; row < table.rows(); ++row) {
    const std::vector<std::string> cells = table.cells(row);
    const auto fail = [&](const std::string& reason) {
      throw io::FileError(io::FileError::Kind::corrupt, path, {.line = table.line(row)}, reason);
    };
    if (cells.size() != table.headers().size())
      fail("has " + std::to_string(cells.size()) + " cells: must have " +
           std::to_string(table.headers().size()));
    const auto number = io::parse_number(cells[columns[0]]);
    if (!number || !(*number >= 1.0) || !(*number <= static_cast<double>(size)) ||
        std::trunc(*number) != *number)
      fail("number '" + cells[columns[0]] + "' must be a whole number from 1 to " +
           std::to_string(size));
    const auto dof = static_cast<std::size_t>(*number) - 1;
    if (named[dof]) fail("number " + cells[columns[0]] + " is listed twice");
    if (cells[columns[1]].empty()) fail("place must not be empty");
    const auto [before, is_new] =
        line_of.emplace(std::pair(cells[columns[1]], cells[columns[2]]), table.line(row));
    if (!is_new)
      fail("place \"" + cells[columns[1]] + "\" with direction \"" + cells[columns[2]] +
           "\" is listed in line " + std::to_string(before->second) +
           " already: give each degree of freedom its own place or direction");
    named[dof] = true;
    names[dof] = {cells[columns[1]], cells[columns[2]]};
  }
  return names;
}

/// Rejects a matrix that is named twice: the structure would contain its stiffness twice.
void refuse_repeated_matrices(const CaseFile& file) {
  std::map<std::string, Pointer> place_of;
  const auto take = [&](const Pointer& where) {
    std::string name = file.json.at(where).get<std::string>();
    if (name.ends_with(".mtx")) name.resize(name.size() - 4);
    const auto [before, is_new] = place_of.emplace(name, where);
    if (!is_new)
      file.refuse(where, "this matrix is given in " + before->second.to_string() +
                             " already, and would count twice: name each matrix once");
  };
  take(kMatrixStructure / "mass");
  for (const auto& [name, matrices] : file.json.at(kMatrixStructure / "stiffness").items()) {
    const Pointer where = kMatrixStructure / "stiffness" / name;
    if (matrices.is_string()) take(where);
    for (std::size_t i = 0; matrices.is_array() && i < matrices.size(); ++i) take(where / i);
  }
}

}  // namespace

StructureModel parse_matrices(const CaseFile& file) {
  const Json& s = file.json.at(kMatrixStructure);
  const std::filesystem::path path = file.resolve(s.at("matrices").get<std::string>());
  for (const char* key : {"mass", "stiffness"})
    if (!s.contains(key))
      file.refuse(kMatrixStructure / key,
                  std::string("is missing: \"matrices\" need mass (a name) and stiffness "
                              "({substructure: name or names})"));
  StructureParameters parameters(file);
  fem::MatrixStructure out;
  refuse_repeated_matrices(file);
  out.mass = matrix_at(file, path, kMatrixStructure / "mass");
  for (const auto& [name, matrices] : s.at("stiffness").items()) {
    const Pointer where = kMatrixStructure / "stiffness" / name;
    fem::MatrixStructure::Part part{.name = name, .stiffness = {}};
    if (matrices.is_string()) {
      part.stiffness = matrix_at(file, path, where);
    } else {
      for (std::size_t i = 0; i < matrices.size(); ++i) {
        const io::SparseMatrix one = matrix_at(file, path, where / i);
        if (i == 0) {
          part.stiffness = one;
        } else if (one.rows() != part.stiffness.rows() || one.cols() != part.stiffness.cols()) {
          file.refuse(where / i,
                      "is " + std::to_string(one.rows()) + " x " + std::to_string(one.cols()) +
                          ": must be " + std::to_string(part.stiffness.rows()) + " x " +
                          std::to_string(part.stiffness.cols()) + ", like the previous matrices");
        } else {
          part.stiffness += one;
        }
      }
    }
    const std::size_t index = out.parts.size();
    const auto change = [&](const char* key, const Bounds& bounds, double less) {
      const Pointer at = kMatrixStructure / key / name;
      if (!file.json.contains(at)) return;
      part.change = parameters.place(at, bounds, [index, less](AnyStructure& any, double x) {
        std::get<fem::MatrixStructure>(any).parts[index].change = x - less;
      }) - less;
    };
    if (file.json.contains(kMatrixStructure / "scale" / name) &&
        file.json.contains(kMatrixStructure / "change" / name))
      file.refuse(kMatrixStructure / "change" / name,
                  "contradicts \"scale\": give only one of the two keys; scale is 1 + change");
    change("scale", kPositive, 1.0);
    change("change", {.lower = -1.0, .open = true, .words = "above -1"}, 0.0);
    out.parts.push_back(std::move(part));
  }
  for (const char* key : {"scale", "change"}) {
    const Json values = s.value(key, Json::object());
    for (const auto& [name, ignored] : values.items())
      if (!s.at("stiffness").contains(name))
        file.refuse(kMatrixStructure / key / name,
                    "\"stiffness\" has no substructure with this name");
  }
  if (s.contains("dofs")) out.names = read_names(file, out.mass.rows());
  try {
    fem::validate(out);
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(file, out, error);
  }
  return std::move(parameters).model(std::move(out));
}

}  // namespace wheeltap::apps
