#pragma once
// Conversion of an LCM message to a packet and back, with every check that hostile input requires.
//   encode(header, message, out)   -> Result<size>      header.apid is set from the message's type
//   decode<vbar::tick>(view)       -> Result<message>   kWrongType (APID or type hash), kTooShort, kTooLong, kNotFinite
// A payload must have exactly the size of its message. Only types listed in message_list.h are packets.

#include "fsw/packets/message_traits.h"
#include "fsw/packets/packet.h"

namespace vbar::fsw::packets {

template <class Message>
Result<std::size_t> encode(PacketHeader header, const Message& message, std::span<std::uint8_t> out);

template <class Message>
Result<Message> decode(const PacketView& packet);

}  // namespace vbar::fsw::packets

#include "fsw/packets/messages_inl.h"
