#pragma once
// An exposure as bytes, for a log: with the camera's settings and the seed it determines the image.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/twins/camera/exposure.h"

namespace vbar::twins::camera {

/// Limits of an LCM message vbar_host.image_recipe.
inline constexpr std::size_t kMaxObjectsInView = 8;
inline constexpr std::size_t kMaxNameBytes = 63;

/// Returns whether a number of a logged message fits its field in the header of a packet.
constexpr bool fits_header(std::int16_t number) {
  return number >= 0 && number <= std::numeric_limits<std::uint8_t>::max();
}

/// An exposure, and the headers of its packets.
struct ImageRecipe {
  std::uint8_t spacecraft = 0;
  std::uint8_t unit = 0;
  Exposure exposure;
};

/// Encodes the LCM message. Throws std::invalid_argument for more than kMaxObjectsInView objects and for a name of an
/// object or a model longer than kMaxNameBytes.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const ImageRecipe& recipe);

/// Decodes the recipe, every number to the last bit; empty if the bytes are not exactly one such message.
[[nodiscard]] std::optional<ImageRecipe> recipe_of(std::span<const std::uint8_t> bytes);

}  // namespace vbar::twins::camera
