#include "io/matlab/sparse_matrix.hpp"

#include <gmock/gmock.h>

#include "tests/emulator/temporary_directory.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>
#endif

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;
using testing::HasSubstr;

Eigen::MatrixXd market(const std::string& text) {
  return Eigen::MatrixXd(parse_matrix_market(text, "m.mtx"));
}

Eigen::MatrixXd rows(std::initializer_list<std::initializer_list<double>> list) {
  return Eigen::MatrixXd(list);
}

template <class Work>
void expect_refused(const Work& work, const std::string& message, Kind kind = Kind::corrupt) {
  try {
    work();
    FAIL() << "accepted; expected: " << message;
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr(message));
    EXPECT_EQ(error.kind(), kind) << error.what();
  }
}

void expect_market_refused(const std::string& text, const std::string& message,
                           Kind kind = Kind::corrupt) {
  expect_refused([&] { (void)parse_matrix_market(text, "m.mtx"); }, message, kind);
}

TEST(MatrixMarket, FormatsFieldsAndSymmetries) {
  EXPECT_EQ(market("%%MatrixMarket matrix coordinate real general\n% who wrote it\n\n2 3 3\n"
                   "1 1 1.5\n2 3 -2e3\n1 2 4\n"),
            rows({{1.5, 4, 0}, {0, 0, -2000}}));
  EXPECT_EQ(market("%%matrixmarket MATRIX Coordinate Integer Symmetric\r\n2 2 2\r\n1 1 3\r\n"
                   "2 1 -1\r\n"),
            rows({{3, -1}, {-1, 0}}));
  EXPECT_EQ(market("%%MatrixMarket matrix coordinate pattern general\n2 2 1\n2 1\n"),
            rows({{0, 0}, {1, 0}}));
  EXPECT_EQ(market("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n"),
            rows({{1, 3}, {2, 4}}));
  EXPECT_EQ(market("%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n"),
            rows({{1, 2}, {2, 3}}));
}

TEST(MatrixMarket, AddsDuplicateEntries) {
  EXPECT_EQ(market("%%MatrixMarket matrix coordinate real general\n1 1 2\n1 1 1\n1 1 2\n"),
            rows({{3}}));
}

TEST(MatrixMarket, RejectsInvalidTextWithItsLine) {
  const std::string head = "%%MatrixMarket matrix coordinate real general\n";
  expect_market_refused("1 1 2\n", "line 1: is not a Matrix Market file", Kind::foreign);
  expect_market_refused("%%MatrixMarket matrix coordinate complex general\n1 1 0\n", "'complex'");
  expect_market_refused("%%MatrixMarket matrix array pattern general\n1 1\n", "'pattern'");
  expect_market_refused("%%MatrixMarket matrix coordinate real hermitian\n1 1 0\n", "'hermitian'");
  expect_market_refused(head + "2 2\n", "line 2: must be \"rows columns entries\"");
  expect_market_refused(head + "2 0 0\n", "the number of columns '0'");
  // Regression: 63 bytes allocated 440 MB.
  expect_market_refused(head + "2 110008000 0\n", "columns '110008000' must be a whole number");
  expect_market_refused(head + "2 2 1\n3 1 1\n",
                        "line 3: the row '3' must be a whole number from 1 to 2");
  expect_market_refused(head + "2 2 1\n1 0 1\n", "the column '0'");
  expect_market_refused(head + "2 2 1\n1 1.5 1\n", "the column '1.5'");
  expect_market_refused(head + "2 2 1\n1 1 nan\n", "'nan' must be a finite number");
  expect_market_refused(head + "2 2 1\n1 1\n", "has 2 numbers: must have 3");
  expect_market_refused(head + "2 2 2\n1 1 1\n", "ends after 1 of 2 entries");
  expect_market_refused(head + "2 2 1\n1 1 1\n1 2 1\n", "line 4: more entries than the 1 declared");
  expect_market_refused("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n",
                        "above the diagonal");
  expect_market_refused("%%MatrixMarket matrix coordinate real symmetric\n2 3 0\n", "as many rows");
}

TEST(SparseMatrix, FoldersHoldMatrixMarketFiles) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "K.mtx",
                  "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 7\n");
  EXPECT_EQ(read_sparse_matrix(directory / "", "K").coeff(0, 0), 7.0);
  EXPECT_EQ(read_sparse_matrix(directory / "", "K.mtx").coeff(0, 0), 7.0);
  expect_refused([&] { (void)read_sparse_matrix(directory / "", "M"); },
                 "has no file M.mtx; its files: K");
  expect_refused([&] { (void)read_sparse_matrix(directory / "none", "M"); }, "no such file",
                 Kind::missing);
  expect_refused([&] { (void)read_sparse_matrix(directory / "K.mtx", "K"); }, "MATLAB",
                 Kind::foreign);
}

#ifdef WHEELTAP_MATIO

struct Stored {
  std::vector<mat_uint32_t> rows, starts;
  std::vector<double> values;
};

void put_sparse(mat_t* file, const char* name, Stored s, std::size_t rows) {
  mat_sparse_t sparse{};
  sparse.nzmax = static_cast<mat_uint32_t>(s.values.size());
  sparse.ir = s.rows.data();
  sparse.nir = static_cast<mat_uint32_t>(s.rows.size());
  sparse.jc = s.starts.data();
  sparse.njc = static_cast<mat_uint32_t>(s.starts.size());
  sparse.ndata = static_cast<mat_uint32_t>(s.values.size());
  sparse.data = s.values.data();
  std::size_t dims[] = {rows, s.starts.size() - 1};
  matvar_t* variable =
      Mat_VarCreate(name, MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims, &sparse, MAT_F_DONT_COPY_DATA);
  ASSERT_NE(variable, nullptr);
  ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(variable);
}

template <class T>
void put_full(mat_t* file, const char* name, std::vector<T> values, std::size_t rows,
              matio_classes shown, matio_types type) {
  std::size_t dims[] = {rows, values.size() / rows};
  matvar_t* variable = Mat_VarCreate(name, shown, type, 2, dims, values.data(), 0);
  ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(variable);
}

class MatlabMatrices : public testing::TestWithParam<mat_ft> {};

TEST_P(MatlabMatrices, ReadsSparseAndFullMatricesByName) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "model.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, GetParam());
  if (file == nullptr) GTEST_SKIP() << "libmatio has no such version";
  put_sparse(file, "K", {.rows = {0, 2, 1}, .starts = {0, 2, 2, 3}, .values = {1, -2, 5}}, 3);
  put_full<double>(file, "M", {4, 0, 0, 6}, 2, MAT_C_DOUBLE, MAT_T_DOUBLE);
  put_full<std::int32_t>(file, "whole", {1, 2, 3, 4, 5, 6}, 2, MAT_C_INT32, MAT_T_INT32);
  put_full<double>(file, "bad", {1, NAN}, 1, MAT_C_DOUBLE, MAT_T_DOUBLE);
  std::size_t dims[] = {1, 1};
  double seven = 7.0;
  const char* fields[] = {"K"};
  matvar_t* model = Mat_VarCreateStruct("model", 2, dims, fields, 1);
  Mat_VarSetStructFieldByName(model, "K", 0,
                              Mat_VarCreate("K", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &seven, 0));
  ASSERT_EQ(Mat_VarWrite(file, model, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(model);
  Mat_Close(file);
  EXPECT_EQ(Eigen::MatrixXd(read_sparse_matrix(path, "model.K")), rows({{7}}));
  expect_refused([&] { (void)read_sparse_matrix(path, "model.M"); },
                 "has no matrix \"model.M\"; its matrices: ");
  expect_refused([&] { (void)read_sparse_matrix(path, "K.K"); }, "has no matrix \"K.K\"");
  const SparseMatrix k = read_sparse_matrix(path, "K");
  EXPECT_EQ(Eigen::MatrixXd(k), rows({{1, 0, 0}, {0, 0, 5}, {-2, 0, 0}}));
  EXPECT_EQ(k.nonZeros(), 3);
  const SparseMatrix m = read_sparse_matrix(path, "M");
  EXPECT_EQ(Eigen::MatrixXd(m), rows({{4, 0}, {0, 6}}));
  EXPECT_EQ(m.nonZeros(), 2) << "zeros are not stored";
  EXPECT_EQ(Eigen::MatrixXd(read_sparse_matrix(path, "whole")), rows({{1, 3, 5}, {2, 4, 6}}));
  expect_refused([&] { (void)read_sparse_matrix(path, "K0"); },
                 "has no matrix \"K0\"; its matrices: ");
  expect_refused([&] { (void)read_sparse_matrix(path, "bad"); },
                 "\"bad\" has an entry that is not finite at row 1, column 2");
}

INSTANTIATE_TEST_SUITE_P(Versions, MatlabMatrices, testing::Values(MAT_FT_MAT5, MAT_FT_MAT73),
                         [](const auto& version) {
                           return version.param == MAT_FT_MAT5 ? "v5" : "v7_3";
                         });

TEST(MatlabMatrix, RejectsDamagedIndices) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "model.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(file, nullptr);
  put_sparse(file, "row", {.rows = {0, 3}, .starts = {0, 1, 2}, .values = {1, 2}}, 2);
  put_sparse(file, "start", {.rows = {0, 1}, .starts = {0, 3, 2}, .values = {1, 2}}, 2);
  Mat_Close(file);
  expect_refused([&] { (void)read_sparse_matrix(path, "row"); }, "row 4 of 2");
  expect_refused([&] { (void)read_sparse_matrix(path, "start"); }, "is corrupt");
}

TEST(MatlabMatrix, RejectsComplexMatrices) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "model.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(file, nullptr);
  double re = 1.0, im = 2.0;
  mat_complex_split_t both{&re, &im};
  std::size_t dims[] = {1, 1};
  matvar_t* variable =
      Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &both, MAT_F_COMPLEX);
  ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(variable);
  Mat_Close(file);
  expect_refused([&] { (void)read_sparse_matrix(path, "z"); }, "is complex");
}

#endif

}  // namespace
}  // namespace wheeltap::io
