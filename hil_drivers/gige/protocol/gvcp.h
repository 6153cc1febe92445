#pragma once
// GVCP, the control protocol of GigE Vision 1.2: commands to a device and its acknowledges, one UDP datagram each.
//
//   command      u8 42h, u8 flags (bit 0: an acknowledge is wanted), u16 command, u16 bytes that follow, u16 id
//   acknowledge  u16 status, u16 command + 1, u16 bytes that follow, u16 id of the command

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hil_drivers/gige/protocol/big_endian.h"

namespace vbar::gige::wire {

inline constexpr std::uint16_t kGvcpPort = 3956;
inline constexpr std::size_t kGvcpHeaderBytes = 8;
/// Largest body of a command or acknowledge: 576 bytes of IP datagram less IP, UDP and GVCP headers.
inline constexpr std::size_t kMaxGvcpBody = 540;
/// Largest payload of a read or write of memory besides its address.
inline constexpr std::size_t kMaxMemoryBytes = kMaxGvcpBody - 4;

enum class Command : std::uint16_t {
  kDiscovery = 0x0002,
  kPacketResend = 0x0040,
  kReadRegister = 0x0080,
  kWriteRegister = 0x0082,
  kReadMemory = 0x0084,
  kWriteMemory = 0x0086,
};

enum class Status : std::uint16_t {
  kSuccess = 0x0000,
  kPacketResend = 0x0100,  ///< a stream packet is sent again
  kNotImplemented = 0x8001,
  kInvalidParameter = 0x8002,
  kInvalidAddress = 0x8003,
  kWriteProtect = 0x8004,
  kBadAlignment = 0x8005,
  kAccessDenied = 0x8006,
  kBusy = 0x8007,
  kPacketUnavailable = 0x800C,
  kInvalidHeader = 0x800E,
};

struct Discovery {
  friend bool operator==(const Discovery&, const Discovery&) = default;
};
struct ReadRegisters {
  std::vector<std::uint32_t> addresses;
  friend bool operator==(const ReadRegisters&, const ReadRegisters&) = default;
};
struct WriteRegisters {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> values;  ///< address, value
  friend bool operator==(const WriteRegisters&, const WriteRegisters&) = default;
};
struct ReadMemory {
  std::uint32_t address = 0;
  std::uint16_t count = 0;
  friend bool operator==(const ReadMemory&, const ReadMemory&) = default;
};
struct WriteMemory {
  std::uint32_t address = 0;
  Bytes bytes;
  friend bool operator==(const WriteMemory&, const WriteMemory&) = default;
};
struct PacketResend {
  std::uint16_t channel = 0, block = 0;
  std::uint32_t first = 0, last = 0;  ///< both included; last FFFFFFh: to the end of the block
  friend bool operator==(const PacketResend&, const PacketResend&) = default;
};

using CommandBody = std::variant<Discovery, ReadRegisters, WriteRegisters, ReadMemory, WriteMemory, PacketResend>;

struct CommandMessage {
  bool acknowledge = true;
  std::uint16_t id = 0;
  CommandBody body;
  friend bool operator==(const CommandMessage&, const CommandMessage&) = default;
};

/// Holds a command with a valid header and an invalid body or number, which is answered with `status`.
struct RefusedCommand {
  bool acknowledge = true;
  std::uint16_t command = 0, id = 0;
  Status status = Status::kInvalidHeader;
  std::string reason;
};

/// Marks a datagram that is not a GVCP command; it is not answered.
struct ForeignDatagram {};

/// Decodes bytes from the network; any input is accepted.
[[nodiscard]] std::variant<CommandMessage, RefusedCommand, ForeignDatagram> decode_command(ByteSpan datagram);
/// Throws std::length_error if the body exceeds kMaxGvcpBody.
[[nodiscard]] Bytes encode_command(const CommandMessage& message);
[[nodiscard]] std::uint16_t command_number(const CommandBody& body);

struct Acknowledge {
  Status status = Status::kSuccess;
  std::uint16_t command = 0;  ///< that is answered
  std::uint16_t id = 0;
  Bytes body;
};

[[nodiscard]] Bytes encode_acknowledge(const Acknowledge& acknowledge);
/// Throws std::invalid_argument with the position of the error.
[[nodiscard]] Acknowledge decode_acknowledge(ByteSpan datagram);

}  // namespace vbar::gige::wire
