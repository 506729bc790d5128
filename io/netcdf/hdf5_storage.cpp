#include "io/netcdf/hdf5_storage.hpp"

#include <hdf5.h>

#include <string>

#include "io/file_error.hpp"
#include "io/netcdf/netcdf_library.hpp"
#include "io/text/text.hpp"

namespace wheeltap::io {
namespace {

/// Closes an object opened by HDF5.
class Opened {
 public:
  Opened(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t id() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Turns off HDF5's error printing: a failure is an expected result here.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// The first object that refers to another file: name of the object and kind of the reference.
struct ExternalReference {
  std::string name, how;
};

void check_object(hid_t group, const char* name, ExternalReference& out) {
  const Opened object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
  if (!object || H5Iget_type(object.id()) != H5I_DATASET) return;
  const Opened created(H5Dget_create_plist(object.id()), H5Pclose);
  if (!created) return;
  if (H5Pget_external_count(created.id()) > 0)
    out = {name, "keeps its numbers in another file (external storage)"};
  else if (H5Pget_layout(created.id()) == H5D_VIRTUAL)
    out = {name, "takes its numbers from other files (a virtual dataset)"};
}

herr_t visit(hid_t group, const char* name, const H5L_info_t* link, void* data) {
  auto& out = *static_cast<ExternalReference*>(data);
  if (link->type == H5L_TYPE_HARD)
    check_object(group, name, out);
  else if (link->type != H5L_TYPE_SOFT)
    out = {name, "is a link to another file"};
  return out.how.empty() ? 0 : 1;
}

void require(hid_t file, const std::filesystem::path& name) {
  ExternalReference out;
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &out);
  if (out.how.empty()) return;
  throw FileError(
      FileError::Kind::corrupt, name,
      "\"" + in_utf8(out.name) + "\" " + out.how +
          ": Wheeltap reads only numbers in the file itself; write the numbers into this file");
}

}  // namespace

void require_own_storage(const std::filesystem::path& path) {
  const Silence silence;
  if (H5Fis_hdf5(path.c_str()) <= 0) return;
  const Opened access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Use the access mode of NetCDF, because HDF5 cannot open a file in two modes at once.
  if (access) H5Pset_fclose_degree(access.id(), H5F_CLOSE_SEMI);
  const Opened file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (file) require(file.id(), path);
}

void require_own_storage(std::string_view bytes, const std::filesystem::path& name) {
  if (!bytes.starts_with(kNetcdfMagic)) return;
  const Silence silence;
  const Opened access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t kGrow = 1 << 16;
  if (!access || H5Pset_fapl_core(access.id(), kGrow, false) < 0) return;
  // HDF5 needs a copy of the bytes.
  std::string copy(bytes);
  if (H5Pset_file_image(access.id(), copy.data(), copy.size()) < 0) return;
  // No file can have this name; HDF5 would reject the name of an existing file.
  const Opened file(H5Fopen("/dev/null/image", H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (file) require(file.id(), name);
}

}  // namespace wheeltap::io
