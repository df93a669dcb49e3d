#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace tactoid {

/// A number by which processes tell whether they have the same data: a hash (FNV-1a over words, mixed).
class Fingerprint {
 public:
  ///@{
  /// Takes a word, or the bits of a number, in.
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001B3ull, hash_ ^= hash_ >> 29; }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  ///@}
  [[nodiscard]] std::string text() const { return std::to_string(hash_); }  ///< for Ranks::require_same

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ull;
};

}  // namespace tactoid
