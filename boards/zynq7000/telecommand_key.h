#pragma once
// Key that telecommands need: part of the image, in which boards/zynq7000/set_telecommand_key.py writes it. An image of
// a build has none. For the laboratory: who has the image has the key, and whoever prepares an image chooses it.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/packets/security_trailer.h"

namespace vbar::boards::zynq7000 {

/// Key as it lies in the image: no padding, numbers with their high byte first. The script finds it by the first eight
/// bytes.
struct TelecommandKeySettings {
  std::array<char, 8> label;
  std::array<std::uint8_t, 2> index;     ///< 0: no key
  std::array<std::uint8_t, 8> sequence;  ///< telecommands must exceed it after a start
  fsw::packets::TelecommandKey key;
};
static_assert(sizeof(TelecommandKeySettings) == 50);

/// Key of this image, defined in a source of its own: a compiler that saw the values would not read them from the
/// image.
extern const TelecommandKeySettings kTelecommandKeySettings;

/// Returns what the settings state, with the sequence number of a flight before a reset if that is greater; nothing
/// without a key.
std::optional<fsw::packets::TelecommandSecurity> telecommand_security(const TelecommandKeySettings& settings,
                                                                      std::uint64_t retained_sequence);

}  // namespace vbar::boards::zynq7000
