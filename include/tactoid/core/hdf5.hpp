#pragma once

// Needs HDF5, as what includes it: output/checkpoint.hpp and input/cloud_file.hpp; no other header of the library does.
//   find_package(HDF5 REQUIRED COMPONENTS C)
//   target_link_libraries(my_program PRIVATE tactoid::tactoid hdf5::hdf5)

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <hdf5.h>

#include <tactoid/core/errors.hpp>

namespace tactoid::detail {

/// Closes an HDF5 identifier.
class Hdf5 {
 public:
  Hdf5(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw FileError("HDF5 refused a part of the file.");
  }
  Hdf5(const Hdf5&) = delete;
  Hdf5& operator=(const Hdf5&) = delete;
  ~Hdf5() { close_(id_); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};
inline void hdf5_succeeded(herr_t result) {
  if (result < 0) throw FileError("HDF5 refused a part of the file.");
}
/// HDF5 tells its errors here, not on the error output.
struct QuietHdf5 {
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function, data); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
};

inline void write_attribute(hid_t object, const char* name, std::string_view text) {
  const Hdf5 type(H5Tcopy(H5T_C_S1), H5Tclose);
  hdf5_succeeded(H5Tset_size(type, text.empty() ? 1 : text.size()));
  hdf5_succeeded(H5Tset_cset(type, H5T_CSET_UTF8));
  const Hdf5 space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5 attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  hdf5_succeeded(H5Awrite(attribute, type, text.empty() ? "" : text.data()));
}
[[nodiscard]] inline std::string read_attribute(hid_t object, const char* name) {
  const Hdf5 attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5 type(H5Aget_type(attribute), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  hdf5_succeeded(H5Aread(attribute, type, text.data()));
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

/// Rows [first, first + count) of a data set of lists.
struct SetRows {
  std::vector<hsize_t> start, extent;
  SetRows(std::size_t first, std::size_t count, std::size_t width, bool vectors) : start{first}, extent{count} {
    if (vectors) start.push_back(0), extent.push_back(width);
  }
  /// Writes them with H5Dwrite, or reads them with H5Dread; `type` of the numbers.
  template <class Transfer, class Numbers>
  void transfer(hid_t set, const Transfer& how, hid_t type, Numbers* numbers) const {
    const Hdf5 space(H5Dget_space(set), H5Sclose), memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
    hdf5_succeeded(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr));
    hdf5_succeeded(how(set, type, memory, space, H5P_DEFAULT, numbers));
  }
};
/// So many rows of a list are in the memory of one process at a time.
inline constexpr std::size_t rows_at_a_time = std::size_t{1} << 16;

}  // namespace tactoid::detail
