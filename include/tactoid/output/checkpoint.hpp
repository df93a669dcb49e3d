#pragma once

// Needs HDF5; no other header of the library does, and neither <tactoid/tactoid.hpp> nor all.hpp includes this one:
//   find_package(HDF5 REQUIRED COMPONENTS C)
//   target_link_libraries(my_program PRIVATE tactoid::tactoid hdf5::hdf5)

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <hdf5.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/core/version.hpp>
#include <tactoid/output/file.hpp>

namespace tactoid {

/// What a run needs to go on: the state of everything that has one, and who wrote it.
struct Checkpoint {
  std::string program;     ///< name of the program, or of what was composed
  std::string parameters;  ///< its parameters, as it reads them itself
  SavedState state;        ///< as save_state gives it
};

/// Version of the files that write_checkpoint writes; read_checkpoint reads this one.
inline constexpr int checkpoint_format = 1;

namespace detail {

/// Closes an HDF5 identifier.
class Hdf5 {
 public:
  Hdf5(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw FileError("HDF5 refused a part of a checkpoint.");
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
  if (result < 0) throw FileError("HDF5 refused a part of a checkpoint.");
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

/// SI units of what users read out of a checkpoint, by the last part of the name; empty where there is none to tell.
[[nodiscard]] inline std::string_view unit_of(std::string_view name) {
  name.remove_prefix(name.rfind('/') + 1);  // npos + 1 is 0
  struct Unit {
    std::string_view name, unit;
  };
  static constexpr std::array units{
      Unit{"time", "s"},       Unit{"last_step", "s"},  Unit{"step_before", "s"}, Unit{"run_start", "s"},   Unit{"reference", "m"},
      Unit{"position", "m"},   Unit{"displacement", "m"}, Unit{"velocity", "m/s"},  Unit{"force", "N"},       Unit{"director", "1"},
      Unit{"gaps", "m"},       Unit{"kinetic", "J"},    Unit{"strain", "J"},      Unit{"stabilization", "J"}, Unit{"adhesion", "J"},
      Unit{"surface", "J"},    Unit{"dissipated", "J"}, Unit{"external_work", "J"}, Unit{"initial", "J"},   Unit{"largest_work", "J"}};
  for (const Unit& u : units)
    if (u.name == name) return u.unit;
  return "";
}

constexpr std::size_t checkpoint_head_size = 512;  // a user block of HDF5

/// The first line of a checkpoint says what it is, the next ones how many bytes follow, and their hash (FNV-1a): so that a damaged
/// file is known before any of it is believed.
[[nodiscard]] inline std::string checkpoint_head(std::string_view body) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const char c : body) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  std::string head = fmt::format("Tactoid checkpoint, format {}\nbytes {}\nhash {:016x}\n", checkpoint_format, body.size(), hash);
  head.resize(checkpoint_head_size, '\0');
  return head;
}

}  // namespace detail

/// Writes a checkpoint: an HDF5 file behind a head of 512 bytes, which Python's h5py opens as it is. Names of the state are
/// groups and data sets, those of bodies with their units; `program`, `parameters`, `version` are attributes. The file appears
/// whole or not at all; a former one at this path stays until then. The first of several processes writes. Throws FileError.
inline void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  if (!is_first_rank()) return;  // a state that was saved is whole on all of several processes
  using detail::Hdf5, detail::hdf5_succeeded;
  const detail::QuietHdf5 quiet;
  std::string image;
  {
    const Hdf5 creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    hdf5_succeeded(H5Pset_userblock(creation, detail::checkpoint_head_size));
    const Hdf5 access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5_succeeded(H5Pset_fapl_core(access, std::size_t{1} << 22, 0));  // in memory
    const Hdf5 file(H5Fcreate("checkpoint", H5F_ACC_TRUNC, creation, access), H5Fclose);
    detail::write_attribute(file, "program", checkpoint.program);
    detail::write_attribute(file, "parameters", checkpoint.parameters);
    detail::write_attribute(file, "version", version);
    const Hdf5 links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    hdf5_succeeded(H5Pset_create_intermediate_group(links, 1));
    for (const auto& [name, array] : checkpoint.state) {
      const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
      const Hdf5 space(shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
      const Hdf5 set(H5Dcreate2(file, name.c_str(), array.whole ? H5T_STD_I64LE : H5T_IEEE_F64LE, space, links, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
      if (!array.values.empty()) hdf5_succeeded(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
      const std::string_view unit = detail::unit_of(name);
      if (!unit.empty()) detail::write_attribute(set, "unit", unit);
    }
    hdf5_succeeded(H5Fflush(file, H5F_SCOPE_GLOBAL));
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size <= 0) throw FileError("HDF5 refused a part of a checkpoint.");
    image.resize(static_cast<std::size_t>(size));
    if (H5Fget_file_image(file, image.data(), image.size()) != size) throw FileError("HDF5 refused a part of a checkpoint.");
  }
  // The image comes with the place of its user block, or without.
  const std::string_view signature("\211HDF\r\n\032\n", 8);
  if (image.compare(0, signature.size(), signature) != 0) image.erase(0, detail::checkpoint_head_size);
  AtomicFile out(path);
  out.write(detail::checkpoint_head(image));
  out.write(image);
  out.commit(true);
}

/// Reads a checkpoint. Throws FileError, with the path and one reason, for a file that cannot be read, is no checkpoint, is of
/// another format, or is damaged.
[[nodiscard]] inline Checkpoint read_checkpoint(const std::filesystem::path& path) {
  using detail::Hdf5, detail::hdf5_succeeded;
  const auto refuse = [&](std::string_view why) { throw FileError(fmt::format("{} {}.", in_quotes(path.string()), why)); };
  std::string bytes = read_file(path);  // HDF5 takes it as if it might change it
  const std::string_view mark = "Tactoid checkpoint, format ";
  if (!std::string_view(bytes).starts_with(mark)) refuse("is no checkpoint of Tactoid");
  const std::string_view format = std::string_view(bytes).substr(mark.size(), bytes.substr(0, 64).find('\n') - mark.size());
  if (format != fmt::format("{}", checkpoint_format))
    refuse(fmt::format("is a checkpoint of format {}, but this version of Tactoid, {}, reads format {}", in_quotes(format.substr(0, 8)), version, checkpoint_format));
  if (bytes.size() <= detail::checkpoint_head_size ||
      bytes.substr(0, detail::checkpoint_head_size) != detail::checkpoint_head(std::string_view(bytes).substr(detail::checkpoint_head_size)))
    refuse("is a damaged checkpoint: it is cut off, or some of its bytes have changed");

  try {
    const detail::QuietHdf5 quiet;
    const Hdf5 access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5_succeeded(H5Pset_fapl_core(access, std::size_t{1} << 22, 0));
    hdf5_succeeded(H5Pset_file_image(access, bytes.data(), bytes.size()));
    const Hdf5 file(H5Fopen("checkpoint", H5F_ACC_RDONLY, access), H5Fclose);
    Checkpoint checkpoint{detail::read_attribute(file, "program"), detail::read_attribute(file, "parameters"), {}};
#if H5_VERSION_GE(1, 12, 0)
    using ObjectInfo = H5O_info1_t;
    constexpr auto visit_all = [](auto... arguments) { return H5Ovisit1(arguments...); };
#else
    using ObjectInfo = H5O_info_t;
    constexpr auto visit_all = [](auto... arguments) { return H5Ovisit(arguments...); };
#endif
    const auto visit = [](hid_t root, const char* name, const ObjectInfo* info, void* data) -> herr_t {
      if (info->type != H5O_TYPE_DATASET) return 0;
      try {
        const Hdf5 set(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
        const Hdf5 space(H5Dget_space(set), H5Sclose);
        const Hdf5 type(H5Dget_type(set), H5Tclose);
        std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
        if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
        StateArray array{std::vector<std::size_t>(shape.begin(), shape.end()), {}, H5Tget_class(type) == H5T_INTEGER};
        array.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
        if (!array.values.empty()) hdf5_succeeded(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
        static_cast<SavedState*>(data)->emplace(name, std::move(array));
        return 0;
      } catch (const std::exception&) {
        return -1;
      }
    };
    hdf5_succeeded(visit_all(hid_t(file), H5_INDEX_NAME, H5_ITER_INC, +visit, static_cast<void*>(&checkpoint.state)));
    return checkpoint;
  } catch (const FileError&) {
    refuse("is a checkpoint that HDF5 cannot read");
  }
  return {};
}

}  // namespace tactoid
