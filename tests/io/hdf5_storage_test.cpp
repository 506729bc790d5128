#include "io/netcdf/hdf5_storage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <fstream>
#include <functional>
#include <vector>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/netcdf/array_file.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

using testing::HasSubstr;

constexpr hsize_t kLength = 4;

/// An HDF5 file with a valid dataset "t" and the objects that `add` creates.
template <class Add>
void write(const std::filesystem::path& path, const Add& add) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t space = H5Screate_simple(1, &kLength, nullptr);
  const hid_t time =
      H5Dcreate2(file, "t", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const double values[kLength] = {0.0, 0.1, 0.2, 0.3};
  H5Dwrite(time, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  H5Dclose(time);
  add(file, space);
  H5Sclose(space);
  H5Fclose(file);
}

/// A dataset "x" in a group, created with this property list.
void create(hid_t file, hid_t space, hid_t created) {
  const hid_t group = H5Gcreate2(file, "daq", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t data =
      H5Dcreate2(group, "x", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, created, H5P_DEFAULT);
  ASSERT_GE(data, 0);
  H5Dclose(data);
  H5Gclose(group);
  H5Pclose(created);
}

class Hdf5Storage : public testing::Test {
 protected:
  Hdf5Storage() { std::ofstream(secret_) << "thirty-two bytes of someone else"; }

  void rejects(const std::string& words) const {
    int which = 0;
    for (const auto& read : std::vector<std::function<void()>>{
             [this] { static_cast<void>(read_array_file(path_, {})); },
             [this] { static_cast<void>(NetcdfReader(path_)); },
             [this] { static_cast<void>(NetcdfReader(read_bytes(path_), path_)); }}) {
      ++which;
      try {
        read();
        ADD_FAILURE() << "read by the reader " << which;
      } catch (const FileError& error) {
        EXPECT_EQ(error.kind(), FileError::Kind::corrupt);
        EXPECT_THAT(error.what(), HasSubstr(words));
      }
    }
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_ / "record.h5", secret_ = directory_ / "secret";
};

TEST_F(Hdf5Storage, RejectsExternalStorage) {
  write(path_, [this](hid_t file, hid_t space) {
    const hid_t created = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(created, secret_.c_str(), 0, kLength * sizeof(double));
    create(file, space, created);
  });
  rejects("\"daq/x\" keeps its numbers in another file (external storage)");
}

TEST_F(Hdf5Storage, RejectsAVirtualDataset) {
  write(path_, [this](hid_t file, hid_t space) {
    const hid_t created = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_virtual(created, space, secret_.c_str(), "x", space);
    create(file, space, created);
  });
  rejects("\"daq/x\" takes its numbers from other files (a virtual dataset)");
}

TEST_F(Hdf5Storage, RejectsALinkToAnotherFile) {
  write(path_, [this](hid_t file, hid_t) {
    H5Lcreate_external(secret_.c_str(), "/x", file, "x", H5P_DEFAULT, H5P_DEFAULT);
  });
  rejects("\"x\" is a link to another file");
}

TEST_F(Hdf5Storage, TakesAFileThatHoldsItsOwnNumbers) {
  write(path_, [](hid_t file, hid_t space) {
    create(file, space, H5Pcreate(H5P_DATASET_CREATE));
    H5Lcreate_soft("/t", file, "again", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_NO_THROW(require_own_storage(path_));
  EXPECT_NO_THROW(require_own_storage(read_bytes(path_), path_));
  EXPECT_NO_THROW(require_own_storage(secret_));
  EXPECT_NO_THROW(require_own_storage("no HDF5", "name"));
}

}  // namespace
}  // namespace wheeltap::io
