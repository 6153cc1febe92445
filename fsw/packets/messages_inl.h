#pragma once
// The templates of messages.h are instantiated once, in messages.cpp, for every message of message_list.h.

#include "fsw/packets/messages.h"

namespace vbar::fsw::packets {

#define VBAR_MESSAGE(type, enumerator, number, route)                                                   \
  extern template Result<std::size_t> encode<type>(PacketHeader, const type&, std::span<std::uint8_t>); \
  extern template Result<type> decode<type>(const PacketView&);
VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE

}  // namespace vbar::fsw::packets
