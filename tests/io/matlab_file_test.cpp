#include "io/matlab/matlab_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "io/formats/formats.hpp"
#include "io/matlab/sparse_matrix.hpp"
#include "tests/emulator/temporary_directory.hpp"

#ifdef WHEELTAP_MATIO
#include <matio.h>
#endif

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;

#ifdef WHEELTAP_MATIO

void put(mat_t* file, const char* name, std::vector<double> values, std::size_t rows,
         std::size_t columns) {
  std::size_t dims[] = {rows, columns};
  matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
  ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(variable);
}

TEST(MatlabFile, VectorsMatricesAndScalars) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "r.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(file, nullptr);
  put(file, "fs", {100.0}, 1, 1);
  put(file, "u", {1, 2, 3}, 1, 3);
  put(file, "X1", {4, 5, 6, 7, 8, 9}, 3, 2);
  put(file, "short", {1, 2}, 2, 1);
  Mat_Close(file);
  Columns t = read_columns(path);
  EXPECT_EQ(t.scalars.at("fs"), 100.0);
  EXPECT_EQ(t.rows(), 3);
  ASSERT_EQ(t.columns.size(), 3U) << "an array shorter than the others is left out";
  EXPECT_EQ(t.columns[static_cast<std::size_t>(t.find("u"))].values,
            (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(t.columns[static_cast<std::size_t>(t.find("X1(:,2)"))].values,
            (std::vector<double>{7, 8, 9}));
  EXPECT_EQ(t.columns[0].digits, -1);
  t = read_matlab_file(path,
                       [](const Columns& c, std::size_t i) { return c.columns[i].name == "u"; });
  EXPECT_TRUE(t.columns[static_cast<std::size_t>(t.find("X1(:,1)"))].values.empty());
  // The first bytes identify the format, not the file name.
  std::filesystem::copy_file(path, directory / "r.csv");
  EXPECT_EQ(read_columns(directory / "r.csv").rows(), 3);
}

TEST(MatlabFile, LongRowsOfAMatrixAreChannels) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "rows.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  put(file, "acc", {1, 5, 2, 6, 3, 7, 4, 8}, 2, 4);
  put(file, "t", {0.0, 0.1, 0.2, 0.3}, 1, 4);
  Mat_Close(file);
  const Columns t = read_columns(path);
  ASSERT_EQ(t.columns.size(), 3U);
  EXPECT_EQ(t.columns[0].name, "acc(1,:)");
  EXPECT_EQ(t.columns[0].values, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(t.columns[1].values, (std::vector<double>{5, 6, 7, 8}));
}

TEST(MatlabFile, ReadsAColumnOfAnotherLengthByName) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "bridge.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  put(file, "idx", {1, 0, 1, 1, 0}, 5, 1);
  put(file, "data", {1, 2, 3, 4, 5, 6, 7, 8}, 4, 2);
  Mat_Close(file);
  Columns t = read_columns(path);
  EXPECT_EQ(t.rows(), 4) << "the length that most numbers have";
  EXPECT_THAT(t.others, testing::ElementsAre(
                            "idx (5 x 1, of another length: to read it, name 'idx' in the case)"));
  t = read_matlab_file(path,
                       [](const Columns& c, std::size_t i) { return c.columns[i].name == "idx"; });
  EXPECT_EQ(t.columns.at(static_cast<std::size_t>(t.find("idx"))).values,
            (std::vector<double>{1, 0, 1, 1, 0}));
}

TEST(MatlabFile, ComplexArraysAreTwoColumns) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "frf.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::vector<double> real = {1, 2, 3, 4, 5, 6}, imaginary = {-1, -2, -3, -4, -5, -6};
  mat_complex_split_t parts{real.data(), imaginary.data()};
  std::size_t dims[] = {3, 2};
  matvar_t* h = Mat_VarCreate("H", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &parts, MAT_F_COMPLEX);
  ASSERT_EQ(Mat_VarWrite(file, h, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(h);
  Mat_Close(file);
  const Columns t = read_columns(path);
  ASSERT_EQ(t.columns.size(), 4U);
  EXPECT_EQ(t.columns[static_cast<std::size_t>(t.find("H(:,2), real"))].values,
            (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(t.columns[static_cast<std::size_t>(t.find("H(:,1), imaginary"))].values,
            (std::vector<double>{-1, -2, -3}));
}

matvar_t* array(const char* name, std::vector<double> values) {
  std::size_t dims[] = {values.size(), 1};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
}

// data.acc, data.rig.fs: more common in MATLAB than plain arrays.
TEST(MatlabFile, FieldsOfStructures) {
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    const test::TemporaryDirectory directory;
    const auto path = directory / "s.mat";
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
    if (file == nullptr && version == MAT_FT_MAT73) continue;  // a libmatio without HDF5
    ASSERT_NE(file, nullptr);
    const char* fields[] = {"acc", "rig"};
    const char* inner[] = {"fs"};
    std::size_t one[] = {1, 1};
    matvar_t* rig = Mat_VarCreateStruct("rig", 2, one, inner, 1);
    Mat_VarSetStructFieldByName(rig, "fs", 0, array("fs", {200.0}));
    matvar_t* data = Mat_VarCreateStruct("data", 2, one, fields, 2);
    Mat_VarSetStructFieldByName(data, "acc", 0, array("acc", {1, 2, 3}));
    Mat_VarSetStructFieldByName(data, "rig", 0, rig);
    ASSERT_EQ(Mat_VarWrite(file, data, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(data);
    Mat_Close(file);
    const Columns t = read_columns(path);
    ASSERT_EQ(t.columns.size(), 1U);
    EXPECT_EQ(t.columns[0].name, "data.acc");
    EXPECT_EQ(t.columns[0].values, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(t.scalars.at("data.rig.fs"), 200.0);
  }
}

TEST(MatlabFile, ElementsOfStructureArraysAndCells) {
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    const test::TemporaryDirectory directory;
    const auto path = directory / "runs.mat";
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
    if (file == nullptr && version == MAT_FT_MAT73) continue;  // a libmatio without HDF5
    ASSERT_NE(file, nullptr);
    const char* fields[] = {"acc", "fs"};
    std::size_t two[] = {1, 2};
    matvar_t* run = Mat_VarCreateStruct("run", 2, two, fields, 2);
    matvar_t* cells = Mat_VarCreate("c", MAT_C_CELL, MAT_T_CELL, 2, two, nullptr, 0);
    for (std::size_t i = 0; i < 2; ++i) {
      const double x = 10.0 * static_cast<double>(i);
      Mat_VarSetStructFieldByName(run, "acc", i, array("acc", {x + 1, x + 2, x + 3}));
      Mat_VarSetStructFieldByName(run, "fs", i, array("fs", {100.0 + x}));
      Mat_VarSetCell(cells, static_cast<int>(i), array(nullptr, {x + 4, x + 5, x + 6}));
    }
    ASSERT_EQ(Mat_VarWrite(file, run, MAT_COMPRESSION_NONE), 0);
    ASSERT_EQ(Mat_VarWrite(file, cells, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(run);
    Mat_VarFree(cells);
    Mat_Close(file);
    const Columns t = read_columns(path);
    EXPECT_EQ(t.columns.at(static_cast<std::size_t>(t.find("run(2).acc"))).values,
              (std::vector<double>{11, 12, 13}));
    EXPECT_EQ(t.columns.at(static_cast<std::size_t>(t.find("c{1}"))).values,
              (std::vector<double>{4, 5, 6}));
    EXPECT_EQ(t.scalars.at("run(2).fs"), 110.0);
  }
}

// A table or a datetime is an object of a class, which libmatio cannot read.
TEST(MatlabFile, ListsObjectsWithTheRemedy) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "table.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  put(file, "acc", {1, 2, 3}, 3, 1);
  Mat_Close(file);
  const auto word = [](std::uint32_t x) {
    return std::string(reinterpret_cast<const char*>(&x), sizeof x);
  };
  const auto text = [&](const std::string& x) {
    std::string out = word(1) + word(static_cast<std::uint32_t>(x.size())) + x;
    out.resize((out.size() + 7) / 8 * 8, '\0');
    return out;
  };
  const auto object = [&](const std::string& name, const std::string& type) {
    const std::string body = word(6) + word(8) + word(17) + word(0) + text(name) + text("MCOS") +
                             text(type) + word(5) + word(0);
    return word(14) + word(static_cast<std::uint32_t>(body.size())) + body;
  };
  const std::string whole = test::bytes_of(path);
  const std::string header = whole.substr(0, 128), array = whole.substr(128);
  for (const std::string& content :
       {array + object("Data", "table") + object("when", "datetime"),
        object("Data", "table") + object("when", "datetime") + array}) {
    test::put_bytes(path, header + content);
    const Columns t = read_columns(path);
    EXPECT_THAT(t.others, testing::ElementsAre(
                              testing::HasSubstr("Data = table2struct(Data, 'ToScalar', true)"),
                              testing::HasSubstr("when = posixtime(when)")));
    EXPECT_EQ(t.columns.at(static_cast<std::size_t>(t.find("acc"))).values,
              (std::vector<double>{1, 2, 3}));
  }
}

TEST(MatlabFile, RowsAreChannelsIfStated) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "rows.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  put(file, "X", {1, 4, 2, 5, 3, 6, 7, 8}, 4, 2);  // 4 channels of 2 samples
  Mat_Close(file);
  Columns t = read_columns(path, {}, formats(), {}, {.rows_are_channels = true});
  ASSERT_EQ(t.columns.size(), 4U);
  EXPECT_EQ(t.columns[0].name, "X(1,:)");
  EXPECT_EQ(t.columns[0].values, (std::vector<double>{1, 3}));
  t = read_columns(path);
  EXPECT_EQ(t.columns.size(), 2U) << "along the longer dimension unless stated";
}

TEST(MatlabFile, ListsVariablesThatAreNotArrays) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "text.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::string words = "words";
  std::size_t dims[] = {1, words.size()};
  matvar_t* text = Mat_VarCreate("note", MAT_C_CHAR, MAT_T_UTF8, 2, dims, words.data(), 0);
  ASSERT_EQ(Mat_VarWrite(file, text, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(text);
  Mat_Close(file);
  try {
    (void)read_columns(path);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("no arrays of numbers; the file has note (text)"),
              std::string::npos)
        << error.what();
  }
}

// A truncated HDF5 file: the library's own messages must not be printed.
TEST(MatlabFile, RejectsATruncatedFileInOneLine) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "cut.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT73);
  if (file == nullptr) GTEST_SKIP() << "this libmatio was built without HDF5";
  put(file, "u", std::vector<double>(1000, 1.0), 1000, 1);
  Mat_Close(file);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  testing::internal::CaptureStderr();
  EXPECT_THROW((void)read_columns(path), FileError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// libmatio stops at the first unreadable variable, as at the end of the file.
TEST(MatlabFile, VariablesAreNotLostSilently) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "r.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  put(file, "u", {1, 2, 3}, 3, 1);
  put(file, "w", {4, 5, 6}, 3, 1);
  put(file, "fs", {100.0}, 1, 1);
  Mat_Close(file);
  const std::string whole = test::bytes_of(path);
  ASSERT_EQ(read_columns(path).columns.size(), 2U);
  const auto refusal = [&](const std::string& bytes) -> std::string {
    test::put_bytes(path, bytes);
    try {
      (void)read_columns(path);
      return "";
    } catch (const FileError& error) {
      return error.reason();
    }
  };
  EXPECT_THAT(refusal(whole.substr(0, whole.size() - 8)), testing::HasSubstr("is truncated"));
  int hit = 0;
  for (std::size_t first = 136; first < whole.size() - 16; first += 8) {
    if (whole.compare(first, 4, std::string("\x0e\0\0\0", 4)) != 0) continue;
    std::string damaged = whole;
    damaged[first] = '\x7f';  // an invalid type
    EXPECT_THAT(refusal(damaged), testing::HasSubstr("of its 3 variables")) << first;
    ++hit;
  }
  EXPECT_EQ(hit, 2);
}

// libmatio returns the corrupted decompressed data and does not check the checksum.
TEST(MatlabFile, RejectsAChangedBitInACompressedFile) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "z.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const char* name : {"u", "K"}) {
    std::vector<double> values(900);
    for (double& v : values) v = normal(random);
    std::size_t dims[] = {30, 30};
    matvar_t* one = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
    ASSERT_EQ(Mat_VarWrite(file, one, MAT_COMPRESSION_ZLIB), 0);
    Mat_VarFree(one);
  }
  Mat_Close(file);
  const std::string whole = test::bytes_of(path);
  const Columns sound = read_columns(path);
  const SparseMatrix k = read_sparse_matrix(path, "K");
  int refused = 0, refused_k = 0;
  constexpr int kTimes = 100;
  for (int i = 0; i < kTimes; ++i) {
    std::string damaged = whole;
    const std::size_t at = 136 + random() % (whole.size() - 136);
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    test::put_bytes(path, damaged);
    try {
      const Columns t = read_columns(path);
      ASSERT_EQ(t.columns.size(), sound.columns.size()) << at;
      for (std::size_t c = 0; c < t.columns.size(); ++c)
        EXPECT_EQ(t.columns[c].values, sound.columns[c].values) << at;
    } catch (const FileError&) {
      ++refused;
    }
    try {
      EXPECT_EQ((read_sparse_matrix(path, "K") - k).norm(), 0.0) << at;
    } catch (const FileError&) {
      ++refused_k;
    }
  }
  EXPECT_GT(refused, kTimes / 2);
  EXPECT_EQ(refused_k, refused);
}

// HDF5 and libmatio crash on some files, but only in the reader's child process.
TEST(MatlabFile, SurvivesDamagedFiles) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "r.mat";
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
    if (file == nullptr && version == MAT_FT_MAT73) continue;  // a libmatio without HDF5
    put(file, "fs", {100.0}, 1, 1);
    put(file, "X1", {4, 5, 6, 7, 8, 9}, 3, 2);
    Mat_Close(file);
    const std::string whole = test::bytes_of(path);
    std::mt19937_64 random(2);
    const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (int i = 0; i < 300; ++i) {
      std::string damaged = whole;
      for (std::size_t n = 1 + below(4); n > 0; --n) {
        const std::size_t at = below(damaged.size() - 4);
        if (below(2) == 0)
          damaged[at] = static_cast<char>(below(256));
        else
          damaged.replace(at, 4, below(2) == 0 ? std::string(4, '\xff') : std::string(4, '\0'));
      }
      test::put_bytes(path, damaged);
      try {
        (void)read_matlab_file(path);
      } catch (const FileError&) {
      }
    }
  }
}

TEST(MatlabFile, RejectsOtherFiles) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "text.mat", "x\n1\n");
  EXPECT_THROW((void)read_columns(directory / "text.mat"), FileError);
  const auto path = directory / "empty.mat";
  Mat_Close(Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5));
  try {
    (void)read_columns(path);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), Kind::corrupt);
  }
}

#else

TEST(MatlabFile, RejectsWithoutLibmatio) {
  EXPECT_THROW((void)read_matlab_file("r.mat"), FileError);
}

#endif

}  // namespace
}  // namespace wheeltap::io
