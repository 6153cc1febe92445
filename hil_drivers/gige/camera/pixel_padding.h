#pragma once
// Place of a converter's numbers in 16-bit pixels. Cameras put them left-aligned (12 bits: FFF0h), and the number of
// bits the converter has depends on the camera's mode: the padding is found in the data.

#include <bitset>
#include <cstdint>
#include <span>

namespace vbar::gige {

class PixelPadding {
 public:
  /// Starts with a converter of `expected_bits`, left-aligned, until the data decide.
  explicit PixelPadding(int expected_bits);

  /// Takes the raw pixels of an image into account.
  void observe(std::span<const std::uint16_t> pixels);

  /// Returns the number of bits of the converter.
  [[nodiscard]] int bits() const;
  /// Returns the shift: right-aligned number = pixel >> shift().
  [[nodiscard]] int shift() const;
  /// Returns false while the pixels seen have too few values to exclude an accident.
  [[nodiscard]] bool is_decided() const { return values_ >= kDecidingValues; }

 private:
  // Number of different values. That all of them are multiples of four by accident has a probability of 4^-16.
  static constexpr std::size_t kDecidingValues = 16;

  int expected_bits_;
  std::uint16_t set_bits_ = 0;
  std::bitset<65536> seen_;
  std::size_t values_ = 0;
};

}  // namespace vbar::gige
