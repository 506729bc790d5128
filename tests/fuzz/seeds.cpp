// Sound files of the kinds that are not text, from which fuzzing starts: seeds FOLDER writes
// FOLDER/<target>/….
#include <netcdf.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#ifdef WHEELTAP_MATIO
#include <matio.h>
#endif

namespace {

namespace fs = std::filesystem;

void require(bool done, const fs::path& path) {
  if (done) return;
  std::fprintf(stderr, "seeds: cannot write %s\n", path.c_str());
  std::exit(1);
}

#ifdef WHEELTAP_MATIO

class MatlabSeed {
 public:
  MatlabSeed(const fs::path& path, mat_ft version, matio_compression how)
      : path_(path), file_(Mat_CreateVer(path.c_str(), nullptr, version)), how_(how) {}
  MatlabSeed(const MatlabSeed&) = delete;
  MatlabSeed& operator=(const MatlabSeed&) = delete;
  ~MatlabSeed() {
    if (file_ != nullptr) Mat_Close(file_);
  }
  /// False for MATLAB 7.3 with a libmatio without HDF5.
  [[nodiscard]] bool possible() const { return file_ != nullptr; }

  template <class T>
  matvar_t* array(const char* name, std::vector<T> values, std::size_t rows, matio_classes shown,
                  matio_types type) const {
    std::size_t dims[] = {rows, values.size() / rows};
    return Mat_VarCreate(name, shown, type, 2, dims, values.data(), 0);
  }
  matvar_t* doubles(const char* name, std::vector<double> values, std::size_t rows) const {
    return array(name, std::move(values), rows, MAT_C_DOUBLE, MAT_T_DOUBLE);
  }
  void write(matvar_t* variable) {
    require(variable != nullptr && Mat_VarWrite(file_, variable, how_) == 0, path_);
    Mat_VarFree(variable);
  }
  void write_sparse(const char* name) {
    std::vector<mat_uint32_t> rows = {0, 1, 0, 1, 2, 1, 2}, starts = {0, 2, 5, 7};
    std::vector<double> values = {2, -1, -1, 2, -1, -1, 2};
    mat_sparse_t sparse{};
    sparse.nzmax = sparse.nir = sparse.ndata = static_cast<mat_uint32_t>(values.size());
    sparse.ir = rows.data();
    sparse.jc = starts.data();
    sparse.njc = static_cast<mat_uint32_t>(starts.size());
    sparse.data = values.data();
    std::size_t dims[] = {3, 3};
    write(Mat_VarCreate(name, MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims, &sparse, MAT_F_DONT_COPY_DATA));
  }
  void write_struct(const char* name) {
    const char* fields[] = {"fs", "acceleration"};
    std::size_t dims[] = {1, 1};
    matvar_t* one = Mat_VarCreateStruct(name, 2, dims, fields, 2);
    require(one != nullptr, path_);
    Mat_VarSetStructFieldByName(one, "fs", 0, doubles("fs", {256.0}, 1));
    Mat_VarSetStructFieldByName(one, "acceleration", 0,
                                doubles("acceleration", {1, 2, 3, 4, 5, 6, 7, 8}, 4));
    write(one);
  }

 private:
  fs::path path_;
  mat_t* file_;
  matio_compression how_;
};

void write_matlab(const fs::path& folder) {
  fs::create_directories(folder);
  struct Kind {
    const char* name;
    mat_ft version;
    matio_compression how;
  };
  for (const Kind& kind : {Kind{"v4.mat", MAT_FT_MAT4, MAT_COMPRESSION_NONE},
                           Kind{"v5.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                           Kind{"v5z.mat", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                           Kind{"v73.mat", MAT_FT_MAT73, MAT_COMPRESSION_NONE}}) {
    MatlabSeed seed(folder / kind.name, kind.version, kind.how);
    if (!seed.possible()) continue;
    seed.write(seed.doubles("fs", {100.0}, 1));
    seed.write(seed.doubles("X1", {4, 5, 6, 7, 8, 9}, 3));
    seed.write(seed.doubles("M", {1, 0, 0, 1}, 2));
    if (kind.version == MAT_FT_MAT4) continue;  // it has matrices only
    seed.write(seed.array<std::int16_t>("raw", {1, -2, 3}, 3, MAT_C_INT16, MAT_T_INT16));
    seed.write(seed.array<float>("u", {1.5F, 2.5F, 3.5F}, 3, MAT_C_SINGLE, MAT_T_SINGLE));
    seed.write(seed.array<char>("note", {'r', 'i', 'g'}, 1, MAT_C_CHAR, MAT_T_UINT8));
    seed.write_struct("Data");
    seed.write_sparse("K");
  }
}

#else

void write_matlab(const fs::path&) {}

#endif

void write_arrays(const fs::path& folder) {
  fs::create_directories(folder);
  struct Kind {
    const char* name;
    int format;
  };
  for (const Kind& kind : {Kind{"classic.nc", NC_CLOBBER}, Kind{"offset64.nc", NC_64BIT_OFFSET},
                           Kind{"hdf5.nc", NC_NETCDF4}}) {
    const fs::path path = folder / kind.name;
    int file = 0, rows = 0, channels = 0, time = 0, acceleration = 0, raw = 0;
    require(nc_create(path.c_str(), kind.format, &file) == NC_NOERR, path);
    nc_def_dim(file, "sample", 4, &rows);
    nc_def_dim(file, "channel", 3, &channels);
    const int flat[] = {rows, channels};
    nc_def_var(file, "time", NC_DOUBLE, 1, &rows, &time);
    nc_def_var(file, "acceleration", NC_FLOAT, 2, flat, &acceleration);
    nc_def_var(file, "raw", NC_SHORT, 1, &rows, &raw);
    nc_put_att_text(file, time, "units", 1, "s");
    const double scale = 0.5;
    nc_put_att_double(file, raw, "scale_factor", NC_DOUBLE, 1, &scale);
    nc_enddef(file);
    const double times[] = {0.0, 0.1, 0.2, 0.3};
    const double values[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    nc_put_var_double(file, time, times);
    nc_put_var_double(file, acceleration, values);
    nc_put_var_double(file, raw, values);
    require(nc_close(file) == NC_NOERR, path);
  }
}

void write_matrix_market(const fs::path& folder) {
  fs::create_directories(folder);
  const auto put = [&](const char* name, const char* text) {
    std::ofstream(folder / name) << text;
  };
  put("symmetric.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n% a chain\n3 3 5\n1 1 2.0\n2 1 -1.0\n"
      "2 2 2.0\n3 2 -1.0\n3 3 1.0\n");
  put("general.mtx", "%%MatrixMarket matrix coordinate integer general\n2 2 2\n1 1 3\n2 2 4\n");
  put("dense.mtx", "%%MatrixMarket matrix array real general\n2 2\n1.0\n0.5\n0.5\n1e-3\n");
  put("pattern.mtx", "%%MatrixMarket matrix coordinate pattern skew-symmetric\n2 2 1\n2 1\n");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
    return 64;
  }
  const fs::path folder = arguments[1];
  write_matlab(folder / "matlab_file");
  write_arrays(folder / "array_file");
  write_matrix_market(folder / "matrix_market");
  return 0;
}
