#pragma once
// File of the key that telecommands need, for the flight computer and for the host that signs them.

#include "fsw/packets/security_trailer.h"

namespace vbar::boards::posix {

/// Reads the key, 64 hexadecimal digits, and begins its sequence numbers with the present time of this computer's
/// clock. Returns null, or else the reason why there is none: also for a file that others than its owner may access.
const char* read_telecommand_key(const char* path, fsw::packets::TelecommandSecurity& security);

}  // namespace vbar::boards::posix
