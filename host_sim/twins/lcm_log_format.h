#pragma once
// The header of an event in LCM's log format, in big-endian order: the channel's name and the data follow it.

#include <cstddef>
#include <cstdint>

namespace vbar::twins::lcm_log {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr std::size_t kSyncAt = 0;
inline constexpr std::size_t kNumberAt = 4;  ///< number of the event: 8 bytes
inline constexpr std::size_t kTimeAt = 12;   ///< us: 8 bytes
inline constexpr std::size_t kChannelBytesAt = 20;
inline constexpr std::size_t kDataBytesAt = 24;
inline constexpr std::size_t kHeaderBytes = 28;

}  // namespace vbar::twins::lcm_log
