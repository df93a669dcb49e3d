#pragma once

// Needs HDF5 (core/hdf5.hpp); neither <tactoid/tactoid.hpp> nor all.hpp includes this header:
//   find_package(HDF5 REQUIRED COMPONENTS C)
//   target_link_libraries(my_program PRIVATE tactoid::tactoid hdf5::hdf5)

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/hdf5.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/read_file.hpp>
#include <tactoid/core/shared_file.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/core/version.hpp>
#include <tactoid/output/block_hash.hpp>
#include <tactoid/output/file.hpp>
#include <tactoid/output/shared_rows.hpp>

namespace tactoid {

/// What a run needs to go on: the state of everything that has one, and who wrote it.
struct Checkpoint {
  std::string program;     ///< name of the program, or of what was composed
  std::string parameters;  ///< its parameters, as it reads them itself
  SavedState state;        ///< as save_state gives it
};

/// Version of the files that write_checkpoint writes; read_checkpoint reads this one.
inline constexpr int checkpoint_format = 2;

namespace detail {

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

/// The first line of a checkpoint says what it is, the next ones how many bytes follow, and their hash: so that a damaged
/// file is known before any of it is believed.
[[nodiscard]] inline std::string checkpoint_head(const BlockHash& body) {
  std::string head = fmt::format("Tactoid checkpoint, format {}\nbytes {}\nhash {:016x}\n", checkpoint_format, body.bytes, body.value);
  head.resize(checkpoint_head_size, '\0');
  return head;
}

inline constexpr const char* checkpoint_mark = "Tactoid checkpoint, format ";
/// Why a file that begins so is no checkpoint of this version; empty where it is one.
[[nodiscard]] inline std::string why_no_checkpoint(std::string_view beginning) {
  const std::string_view mark = checkpoint_mark;
  if (!beginning.starts_with(mark)) return "is no checkpoint of Tactoid";
  const std::string_view format = beginning.substr(mark.size(), beginning.substr(0, 64).find('\n') - mark.size());
  if (format == fmt::format("{}", checkpoint_format)) return "";
  return fmt::format("is a checkpoint of format {}, but this version of Tactoid, {}, reads format {}", in_quotes(format.substr(0, 8)), version, checkpoint_format);
}

inline void write_about(hid_t file, const Checkpoint& checkpoint) {
  write_attribute(file, "program", checkpoint.program);
  write_attribute(file, "parameters", checkpoint.parameters);
  write_attribute(file, "version", version);
}
/// An empty data set of the state.
[[nodiscard]] inline hid_t create_set(hid_t file, const std::string& name, const std::vector<hsize_t>& shape, hid_t type, hid_t creation = H5P_DEFAULT) {
  const Hdf5 links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  hdf5_succeeded(H5Pset_create_intermediate_group(links, 1));
  const Hdf5 space(shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const hid_t set = H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT);
  const std::string_view unit = unit_of(name);
  if (set >= 0 && !unit.empty()) write_attribute(set, "unit", unit);
  return set;
}
/// A data set that one process has.
inline void write_set(hid_t file, const std::string& name, const StateArray& array) {
  const Hdf5 set(create_set(file, name, {array.shape.begin(), array.shape.end()}, array.whole ? H5T_STD_I64LE : H5T_IEEE_F64LE), H5Dclose);
  if (!array.values.empty()) hdf5_succeeded(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
}

/// A data set of which several processes will write rows; returns where in the file it begins.
[[nodiscard]] inline std::uint64_t make_room(hid_t file, const std::string& name, const StateArray& array) {
  std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  shape[0] = array.length;
  const Hdf5 creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  hdf5_succeeded(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY));
  hdf5_succeeded(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER));
  const Hdf5 set(create_set(file, name, shape, array.whole ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, creation), H5Dclose);
  const haddr_t offset = H5Dget_offset(set);
  if (offset == HADDR_UNDEF) throw FileError("HDF5 refused a part of a checkpoint.");
  return offset;
}

/// Writes a checkpoint of which several processes have rows each: the first one makes the file with room for them, then all write. Collective; throws FileError on all of them.
inline void write_checkpoint_in_rows(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  Ranks* const ranks = Ranks::current;
  std::optional<AtomicFile> out;
  std::string temporary, offsets;  // of the lists, in their order, with blanks between them
  const auto by_first_rank = [&](const auto& work) {
    std::string failure;
    if (is_first_rank()) {
      try {
        work();
      } catch (const std::exception& error) {
        failure = error.what();
      }
    }
    if (ranks != nullptr) failure = ranks->first_failure(failure);
    if (!failure.empty()) throw FileError(failure);
  };
  by_first_rank([&] {
    out.emplace(path);
    temporary = out->temporary().string();
    const QuietHdf5 quiet;
    const Hdf5 creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    hdf5_succeeded(H5Pset_userblock(creation, checkpoint_head_size));
    const Hdf5 file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT), H5Fclose);
    write_about(file, checkpoint);
    for (const auto& [name, array] : checkpoint.state) {
      if (array.length == 0) write_set(file, name, array);
      else offsets += fmt::format("{} ", make_room(file, name, array));
    }
    hdf5_succeeded(H5Fflush(file, H5F_SCOPE_GLOBAL));
  });
  if (ranks != nullptr) temporary = ranks->text_of(0, temporary), offsets = ranks->text_of(0, offsets);

  const std::unique_ptr<SharedFile> file = ranks != nullptr ? ranks->open_shared(temporary) : std::make_unique<FileOfOne>(temporary);
  std::istringstream next(offsets);
  for (const auto& [name, array] : checkpoint.state) {
    std::uint64_t offset = 0;
    if (array.length > 0 && next >> offset) write_rows(*file, offset, array);
  }
  file->close();
  const BlockHash hash = block_hash(temporary, checkpoint_head_size);
  by_first_rank([&] {
    out->write(checkpoint_head(hash));  // at the beginning, which HDF5 has left free
    out->commit(true);
  });
}

}  // namespace detail

/// Writes a checkpoint: an HDF5 file behind a head of 512 bytes, which Python's h5py opens as it is. Names of the state are
/// groups and data sets, those of bodies with their units; `program`, `parameters`, `version` are attributes. The file appears
/// whole or not at all; a former one at this path stays until then. The first of several processes writes. Where these have parts of the state, all must call it, and
/// all write at once, each some rows of every list (Ranks::open_shared); the file is as that of one process. Throws FileError.
inline void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  if (std::any_of(checkpoint.state.begin(), checkpoint.state.end(), [](const auto& named) { return named.second.length > 0; })) return detail::write_checkpoint_in_rows(path, checkpoint);
  if (!is_first_rank()) return;  // the state is whole on all of several processes
  using detail::Hdf5, detail::hdf5_succeeded;
  const detail::QuietHdf5 quiet;
  std::string image;
  {
    const Hdf5 creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    hdf5_succeeded(H5Pset_userblock(creation, detail::checkpoint_head_size));
    const Hdf5 access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5_succeeded(H5Pset_fapl_core(access, std::size_t{1} << 22, 0));  // in memory
    const Hdf5 file(H5Fcreate("checkpoint", H5F_ACC_TRUNC, creation, access), H5Fclose);
    detail::write_about(file, checkpoint);
    for (const auto& [name, array] : checkpoint.state) detail::write_set(file, name, array);
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
  out.write(detail::checkpoint_head(detail::block_hash(image)));
  out.write(image);
  out.commit(true);
}

namespace detail {

/// Reads a data set: all of it, or the rows that are wanted.
[[nodiscard]] inline StateArray read_set(hid_t root, const char* name, const StateArray* wanted) {
  const Hdf5 set(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
  const Hdf5 space(H5Dget_space(set), H5Sclose);
  const Hdf5 type(H5Dget_type(set), H5Tclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  StateArray array{.shape = {shape.begin(), shape.end()}, .values = {}, .whole = H5Tget_class(type) == H5T_INTEGER};
  const bool in_rows = wanted != nullptr && wanted->length > 0 && !shape.empty() && shape[0] == wanted->length;
  if (!in_rows) {
    array.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (!array.values.empty()) hdf5_succeeded(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
    return array;
  }
  array.rows = wanted->rows;
  array.length = wanted->length;
  array.shape[0] = array.rows.size();
  read_rows(set, array);
  return array;
}

/// Everything in an open file; of lists of which `wanted` has rows, these.
[[nodiscard]] inline Checkpoint read_everything(hid_t file, const SavedState* wanted) {
#if H5_VERSION_GE(1, 12, 0)
  using ObjectInfo = H5O_info1_t;
  constexpr auto visit_all = [](auto... arguments) { return H5Ovisit1(arguments...); };
#else
  using ObjectInfo = H5O_info_t;
  constexpr auto visit_all = [](auto... arguments) { return H5Ovisit(arguments...); };
#endif
  struct Visit {
    SavedState state;
    const SavedState* wanted;
  } visited{{}, wanted};
  const auto visit = [](hid_t root, const char* name, const ObjectInfo* info, void* data) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    try {
      auto& [state, rows] = *static_cast<Visit*>(data);
      const StateArray* of_name = nullptr;
      if (rows != nullptr)
        if (const auto at = rows->find(name); at != rows->end()) of_name = &at->second;
      state.emplace(name, read_set(root, name, of_name));
      return 0;
    } catch (const std::exception&) {
      return -1;
    }
  };
  hdf5_succeeded(visit_all(file, H5_INDEX_NAME, H5_ITER_INC, +visit, static_cast<void*>(&visited)));
  return {read_attribute(file, "program"), read_attribute(file, "parameters"), std::move(visited.state)};
}

}  // namespace detail

/// Reads a checkpoint. Throws FileError, with the path and one reason, for a file that cannot be read, is no checkpoint, is of
/// another format, or is damaged.
[[nodiscard]] inline Checkpoint read_checkpoint(const std::filesystem::path& path) {
  using detail::Hdf5, detail::hdf5_succeeded;
  const auto refuse = [&](std::string_view why) { throw FileError(fmt::format("{} {}.", in_quotes(path.string()), why)); };
  std::string bytes = read_file(path);  // HDF5 takes it as if it might change it
  if (const std::string why = detail::why_no_checkpoint(bytes); !why.empty()) refuse(why);
  if (bytes.size() <= detail::checkpoint_head_size ||
      bytes.substr(0, detail::checkpoint_head_size) != detail::checkpoint_head(detail::block_hash(std::string_view(bytes).substr(detail::checkpoint_head_size))))
    refuse("is a damaged checkpoint: it is cut off, or some of its bytes have changed");

  try {
    const detail::QuietHdf5 quiet;
    const Hdf5 access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5_succeeded(H5Pset_fapl_core(access, std::size_t{1} << 22, 0));
    hdf5_succeeded(H5Pset_file_image(access, bytes.data(), bytes.size()));
    const Hdf5 file(H5Fopen("checkpoint", H5F_ACC_RDONLY, access), H5Fclose);
    return detail::read_everything(file, nullptr);
  } catch (const FileError&) {
    refuse("is a checkpoint that HDF5 cannot read");
  }
  return {};
}

/// Reads a checkpoint for something of which each of several processes has a part, on any number of them: of lists of which `like`, a state of it as it is now (save_state), has some entries, those are
/// read, and no process has the whole.
///
///   const SavedState like = save_state(simulation);
///   restore_state(simulation, read_checkpoint("checkpoint.h5", like).state);
///
/// Each process looks at a share of the file for damage, and reads a share of the rows and tells the others. Collective; throws FileError on all of them as above.
[[nodiscard]] inline Checkpoint read_checkpoint(const std::filesystem::path& path, const SavedState& like) {
  Ranks* const ranks = Ranks::current;
  std::string failure;
  const auto refuse = [&](std::string_view why) { failure = fmt::format("{} {}.", in_quotes(path.string()), why); };
  const auto tell = [&] {
    if (ranks != nullptr) failure = ranks->first_failure(failure);
    if (!failure.empty()) throw FileError(failure);
  };
  std::string head;
  if (const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose); file == nullptr) {
    failure = detail::file_failure("read", path, errno);
  } else {
    head.resize(detail::checkpoint_head_size);
    head.resize(std::fread(head.data(), 1, head.size(), file.get()));
    if (std::ferror(file.get()) != 0) failure = detail::file_failure("read", path, errno);
    else if (const std::string why = detail::why_no_checkpoint(head); !why.empty()) refuse(why);
  }
  tell();
  if (head != detail::checkpoint_head(detail::block_hash(path, detail::checkpoint_head_size))) refuse("is a damaged checkpoint: it is cut off, or some of its bytes have changed");
  tell();
  const detail::QuietHdf5 quiet;
  std::optional<detail::Hdf5> file;
  try {
    file.emplace(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  } catch (const FileError&) {
    refuse("is a checkpoint that HDF5 cannot read");
  }
  tell();
  Checkpoint checkpoint;
  try {
    checkpoint = detail::read_everything(*file, &like);
  } catch (const FileError&) {
    refuse("is a checkpoint that HDF5 cannot read");
  }
  tell();
  return checkpoint;
}

}  // namespace tactoid
