#pragma once
// The list of messages (message_list.h) at compile time: APID, place and route of each, visitors of all of them; and
// whether the numbers of a message are finite.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include <vbar/fields.h>

#include "fsw/packets/packet.h"

namespace vbar::fsw::packets {

/// APID and route of every message that is a packet. Undefined for any other type.
template <class Message>
struct MessageTraits;

#define VBAR_MESSAGE(type, enumerator, number, message_route) \
  template <>                                                 \
  struct MessageTraits<type> {                                \
    static constexpr Apid kApid = Apid::enumerator;           \
    static constexpr Route kRoute = message_route;            \
  };
VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE

/// Calls visit.template operator()<Message>() for every message that is a packet.
template <class Visitor>
constexpr void for_each_message(Visitor&& visit) {
#define VBAR_MESSAGE(type, enumerator, number, route) visit.template operator()<type>();
  VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE
}

/// Calls the visitor for every message of telemetry.
template <class Visitor>
constexpr void for_each_telemetry(Visitor&& visit) {
  for_each_message([&]<class Message>() {
    if constexpr (is_telemetry(MessageTraits<Message>::kApid)) visit.template operator()<Message>();
  });
}

/// Calls the visitor for every telecommand.
template <class Visitor>
constexpr void for_each_telecommand(Visitor&& visit) {
  for_each_message([&]<class Message>() {
    if constexpr (is_telecommand(MessageTraits<Message>::kRoute)) visit.template operator()<Message>();
  });
}

/// A tuple of Of<Message> for each message whose route is selected, in the order of the list: storage derived from the
/// list, without an entry for the other messages.
template <bool (*kSelects)(const Route&), template <class> class Of>
struct TupleOfRoute {
  template <class Message>
  using Entry = std::conditional_t<kSelects(MessageTraits<Message>::kRoute), std::tuple<Of<Message>>, std::tuple<>>;
#define VBAR_MESSAGE(type, enumerator, number, route) , std::declval<Entry<type>>()
  using Type = decltype(std::tuple_cat(std::tuple<>() VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)));
#undef VBAR_MESSAGE
};

/// Returns false if any floating-point field, inner messages and all elements included, is a NaN or an infinity. The
/// bits are examined, so that no compiler option for fast mathematics can make the result always true.
template <class Value>
[[nodiscard]] bool all_finite(const Value& value) {
  if constexpr (std::is_array_v<Value>) {
    for (const auto& element : value) {
      if (!all_finite(element)) return false;
    }
    return true;
  } else if constexpr (std::is_floating_point_v<Value>) {
    constexpr std::uint64_t kExponentMask = 0x7FF0'0000'0000'0000U;
    return (std::bit_cast<std::uint64_t>(static_cast<double>(value)) & kExponentMask) != kExponentMask;
  } else if constexpr (std::is_class_v<Value>) {
    bool finite = true;
    visit_fields(value,
                 [&finite](const Field& /*field*/, const auto& member) { finite = finite && all_finite(member); });
    return finite;
  } else {
    return true;
  }
}

/// Returns the message's name in vbar.lcm (also its LCM type name); null for an APID without a message.
[[nodiscard]] const char* message_name(Apid apid);

}  // namespace vbar::fsw::packets
