#pragma once
// Where the numbers of a converter stand in 16-bit pixels. Cameras put them left-aligned (12 bits: FFF0h), and how many
// bits the converter has depends on the camera's mode: the padding is found in the data.

#include <bitset>
#include <cstdint>
#include <span>

namespace vbar::gige {

class PixelPadding {
 public:
  /// Until the data decide, pixels are taken for those of a converter of `expected_bits`, left-aligned.
  explicit PixelPadding(int expected_bits);

  /// Takes the raw pixels of an image into account.
  void observe(std::span<const std::uint16_t> pixels);

  /// Returns the number of bits of the converter.
  [[nodiscard]] int bits() const;
  /// Right-aligned number = pixel >> shift().
  [[nodiscard]] int shift() const;
  /// False while the pixels seen have too few values to exclude an accident.
  [[nodiscard]] bool is_decided() const { return values_ >= kDecidingValues; }

 private:
  // That so many different numbers are multiples of four by accident has a probability of 4^-16.
  static constexpr std::size_t kDecidingValues = 16;

  int expected_bits_;
  std::uint16_t set_bits_ = 0;
  std::bitset<65536> seen_;
  std::size_t values_ = 0;
};

}  // namespace vbar::gige
