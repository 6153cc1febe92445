#include "boards/zynq7000/telecommand_key.h"

#include <algorithm>

#include "fsw/packets/big_endian.h"

namespace vbar::boards::zynq7000 {

std::optional<fsw::packets::TelecommandSecurity> telecommand_security(const TelecommandKeySettings& settings,
                                                                      std::uint64_t retained_sequence) {
  const auto index = fsw::packets::read_big_endian<std::uint16_t>(settings.index, 0);
  if (index == 0) return std::nullopt;
  const auto sequence = fsw::packets::read_big_endian<std::uint64_t>(settings.sequence, 0);
  return fsw::packets::TelecommandSecurity{
      .key = settings.key, .index = index, .sequence = std::max(sequence, retained_sequence)};
}

}  // namespace vbar::boards::zynq7000
