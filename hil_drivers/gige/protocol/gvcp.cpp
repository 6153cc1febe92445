#include "hil_drivers/gige/protocol/gvcp.h"

#include <optional>
#include <stdexcept>

namespace vbar::gige::wire {
namespace {

constexpr std::uint8_t kCommandKey = 0x42;
constexpr std::uint8_t kAcknowledgeFlag = 0x01;

struct Problem {
  Status status;
  std::string reason;
};

Problem wrong_length(ByteSpan body) {
  return {Status::kInvalidHeader, "a body of " + std::to_string(body.size()) + " bytes"};
}

using Decoded = std::variant<CommandBody, Problem>;

Decoded decode_read_registers(ByteSpan body) {
  if (body.empty() || body.size() % 4 != 0) return wrong_length(body);
  ReadRegisters read;
  for (std::size_t at = 0; at < body.size(); at += 4) read.addresses.push_back(load_u32(body, at));
  return read;
}

Decoded decode_write_registers(ByteSpan body) {
  if (body.empty() || body.size() % 8 != 0) return wrong_length(body);
  WriteRegisters write;
  for (std::size_t at = 0; at < body.size(); at += 8)
    write.values.emplace_back(load_u32(body, at), load_u32(body, at + 4));
  return write;
}

Decoded decode_read_memory(ByteSpan body) {
  if (body.size() != 8) return wrong_length(body);
  const ReadMemory read{load_u32(body, 0), load_u16(body, 6)};
  if (read.count == 0 || read.count > kMaxMemoryBytes)
    return Problem{Status::kInvalidParameter, "a read of " + std::to_string(read.count) + " bytes"};
  if (read.address % 4 != 0 || read.count % 4 != 0) return Problem{Status::kBadAlignment, "not in words of 4 bytes"};
  return read;
}

Decoded decode_write_memory(ByteSpan body) {
  if (body.size() <= 4) return wrong_length(body);
  WriteMemory write{load_u32(body, 0), Bytes(body.begin() + 4, body.end())};
  if (write.address % 4 != 0 || write.bytes.size() % 4 != 0)
    return Problem{Status::kBadAlignment, "not in words of 4 bytes"};
  return write;
}

Decoded decode_resend(ByteSpan body) {
  if (body.size() != 12) return wrong_length(body);
  const PacketResend resend{load_u16(body, 0), load_u16(body, 2), load_u24(body, 5), load_u24(body, 9)};
  if (resend.first > resend.last) return Problem{Status::kInvalidParameter, "first packet behind the last"};
  return resend;
}

Decoded decode_body(std::uint16_t command, ByteSpan body) {
  switch (static_cast<Command>(command)) {
    case Command::kDiscovery:
      if (!body.empty()) return wrong_length(body);
      return Discovery{};
    case Command::kPacketResend:
      return decode_resend(body);
    case Command::kReadRegister:
      return decode_read_registers(body);
    case Command::kWriteRegister:
      return decode_write_registers(body);
    case Command::kReadMemory:
      return decode_read_memory(body);
    case Command::kWriteMemory:
      return decode_write_memory(body);
  }
  return Problem{Status::kNotImplemented, "command " + std::to_string(command)};
}

struct BodyEncoder {
  Bytes& bytes;

  void operator()(const Discovery& /*body*/) const {}
  void operator()(const ReadRegisters& body) const {
    for (const std::uint32_t address : body.addresses) append_u32(bytes, address);
  }
  void operator()(const WriteRegisters& body) const {
    for (const auto& [address, value] : body.values) {
      append_u32(bytes, address);
      append_u32(bytes, value);
    }
  }
  void operator()(const ReadMemory& body) const {
    append_u32(bytes, body.address);
    append_u16(bytes, 0);
    append_u16(bytes, body.count);
  }
  void operator()(const WriteMemory& body) const {
    append_u32(bytes, body.address);
    bytes.insert(bytes.end(), body.bytes.begin(), body.bytes.end());
  }
  void operator()(const PacketResend& body) const {
    append_u16(bytes, body.channel);
    append_u16(bytes, body.block);
    append_u32(bytes, body.first & 0xFFFFFFU);
    append_u32(bytes, body.last & 0xFFFFFFU);
  }
};

struct NumberOf {
  Command operator()(const Discovery& /*body*/) const { return Command::kDiscovery; }
  Command operator()(const ReadRegisters& /*body*/) const { return Command::kReadRegister; }
  Command operator()(const WriteRegisters& /*body*/) const { return Command::kWriteRegister; }
  Command operator()(const ReadMemory& /*body*/) const { return Command::kReadMemory; }
  Command operator()(const WriteMemory& /*body*/) const { return Command::kWriteMemory; }
  Command operator()(const PacketResend& /*body*/) const { return Command::kPacketResend; }
};

}  // namespace

std::uint16_t command_number(const CommandBody& body) {
  return static_cast<std::uint16_t>(std::visit(NumberOf{}, body));
}

std::variant<CommandMessage, RefusedCommand, ForeignDatagram> decode_command(ByteSpan datagram) {
  if (datagram.size() < kGvcpHeaderBytes || datagram[0] != kCommandKey) return ForeignDatagram{};
  const bool acknowledge = (datagram[1] & kAcknowledgeFlag) != 0;
  const std::uint16_t command = load_u16(datagram, 2);
  const std::size_t length = load_u16(datagram, 4);
  const std::uint16_t id = load_u16(datagram, 6);
  const ByteSpan body = datagram.subspan(kGvcpHeaderBytes);
  if (id == 0) return RefusedCommand{acknowledge, command, id, Status::kInvalidHeader, "id 0"};
  if (length != body.size() || length > kMaxGvcpBody)
    return RefusedCommand{acknowledge, command, id, Status::kInvalidHeader, "a length other than that of its body"};
  Decoded decoded = decode_body(command, body);
  if (Problem* problem = std::get_if<Problem>(&decoded))
    return RefusedCommand{acknowledge, command, id, problem->status, std::move(problem->reason)};
  return CommandMessage{acknowledge, id, std::move(std::get<CommandBody>(decoded))};
}

Bytes encode_command(const CommandMessage& message) {
  Bytes body;
  std::visit(BodyEncoder{body}, message.body);
  if (body.size() > kMaxGvcpBody) throw std::length_error("a GVCP command of more than 540 bytes");
  Bytes bytes{kCommandKey, message.acknowledge ? kAcknowledgeFlag : std::uint8_t{0}};
  append_u16(bytes, command_number(message.body));
  append_u16(bytes, static_cast<std::uint16_t>(body.size()));
  append_u16(bytes, message.id);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Bytes encode_acknowledge(const Acknowledge& acknowledge) {
  Bytes bytes;
  bytes.reserve(kGvcpHeaderBytes + acknowledge.body.size());
  append_u16(bytes, static_cast<std::uint16_t>(acknowledge.status));
  append_u16(bytes, static_cast<std::uint16_t>(acknowledge.command + 1));
  append_u16(bytes, static_cast<std::uint16_t>(acknowledge.body.size()));
  append_u16(bytes, acknowledge.id);
  bytes.insert(bytes.end(), acknowledge.body.begin(), acknowledge.body.end());
  return bytes;
}

Acknowledge decode_acknowledge(ByteSpan datagram) {
  if (datagram.size() < kGvcpHeaderBytes)
    throw std::invalid_argument("GVCP acknowledge: " + std::to_string(datagram.size()) +
                                " bytes are less than a header");
  const std::size_t length = load_u16(datagram, 4);
  const ByteSpan body = datagram.subspan(kGvcpHeaderBytes);
  if (length != body.size())
    throw std::invalid_argument("GVCP acknowledge, byte 4: length " + std::to_string(length) + " of a body of " +
                                std::to_string(body.size()) + " bytes");
  const std::uint16_t number = load_u16(datagram, 2);
  if (number == 0 || number % 2 == 0)
    throw std::invalid_argument("GVCP acknowledge, byte 2: " + std::to_string(number) + " is not an acknowledge");
  return {static_cast<Status>(load_u16(datagram, 0)), static_cast<std::uint16_t>(number - 1), load_u16(datagram, 6),
          Bytes(body.begin(), body.end())};
}

}  // namespace vbar::gige::wire
