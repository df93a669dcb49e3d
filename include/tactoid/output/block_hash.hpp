#pragma once

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/read_file.hpp>

namespace tactoid::detail {

/// The FNV-1a hash of the hashes of the blocks of a text (1 MiB each): so that several processes find it together.
struct BlockHash {
  static constexpr std::size_t block = std::size_t{1} << 20;
  std::uint64_t bytes = 0;  ///< that were hashed
  std::uint64_t value = 0;  ///< the hash
  friend bool operator==(const BlockHash&, const BlockHash&) = default;
};

[[nodiscard]] inline std::uint64_t hash_of_bytes(std::string_view bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  return hash;
}

/// `halves`: of the hashes of the blocks, the lower one first.
[[nodiscard]] inline BlockHash hash_of_blocks(std::uint64_t bytes, const std::vector<Index>& halves) {
  std::string text;
  for (const Index half : halves)
    for (int byte = 0; byte < 4; ++byte) text.push_back(static_cast<char>(half >> (8 * byte)));
  return {bytes, hash_of_bytes(text)};
}

/// Of a text.
[[nodiscard]] inline BlockHash block_hash(std::string_view text) {
  std::vector<Index> halves;
  for (std::size_t at = 0; at < text.size(); at += BlockHash::block) {
    const std::uint64_t hash = hash_of_bytes(text.substr(at, BlockHash::block));
    halves.push_back(static_cast<Index>(hash)), halves.push_back(static_cast<Index>(hash >> 32));
  }
  return hash_of_blocks(text.size(), halves);
}

/// Of a file from byte `begin` on, of which each of the processes that share a simulation reads some blocks. Collective; throws FileError on all.
[[nodiscard]] inline BlockHash block_hash(const std::filesystem::path& path, std::uint64_t begin) {
  Ranks* const ranks = Ranks::current;
  const auto size = static_cast<std::size_t>(ranks != nullptr ? ranks->size() : 1), rank = static_cast<std::size_t>(ranks != nullptr ? ranks->rank() : 0);
  std::string failure;
  std::uint64_t bytes = 0;
  if (rank == 0) {
    std::error_code error;
    const std::uint64_t all = std::filesystem::file_size(path, error);
    if (error) failure = fmt::format("Cannot read {}: {}.", in_quotes(path.string()), error.message());
    bytes = all > begin && !error ? all - begin : 0;
  }
  if (ranks != nullptr) bytes = std::stoull(ranks->text_of(0, std::to_string(bytes)));
  const std::size_t blocks = static_cast<std::size_t>((bytes + BlockHash::block - 1) / BlockHash::block);
  std::vector<std::size_t> first(size + 1);
  for (std::size_t r = 0; r <= size; ++r) first[r] = blocks * r / size * 2;
  std::vector<Index> halves(2 * blocks);
  try {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (file == nullptr || std::fseek(file.get(), static_cast<long>(begin + first[rank] / 2 * BlockHash::block), SEEK_SET) != 0) fail_file("read", path, errno);
    std::string text(BlockHash::block, '\0');
    for (std::size_t k = first[rank]; k < first[rank + 1]; k += 2) {
      const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(BlockHash::block, bytes - k / 2 * BlockHash::block));
      if (std::fread(text.data(), 1, wanted, file.get()) != wanted) fail_file("read", path, std::ferror(file.get()) != 0 ? errno : EIO);
      const std::uint64_t hash = hash_of_bytes(std::string_view(text).substr(0, wanted));
      halves[k] = static_cast<Index>(hash), halves[k + 1] = static_cast<Index>(hash >> 32);
    }
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (ranks != nullptr) {
    failure = ranks->first_failure(failure);
    if (failure.empty()) ranks->gather(halves, first);
  }
  if (!failure.empty()) throw FileError(failure);
  return hash_of_blocks(bytes, halves);
}

}  // namespace tactoid::detail
