// Stream packets and pixels on arbitrary bytes. Promises: std::invalid_argument or a packet which is the same when it
// is written and read again; pixels of twelve bits survive packing.

#include <algorithm>
#include <stdexcept>

#include "hil_drivers/gige/protocol/gvsp.h"
#include "hil_drivers/gige/protocol/stream_setup.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::gige;

struct Encoder {
  const wire::StreamHeader& header;

  wire::Bytes operator()(const wire::NoPayload& /*body*/) const { return {}; }
  wire::Bytes operator()(const wire::Leader& body) const {
    wire::Bytes bytes;
    wire::encode_leader(header.status, header.block, body, bytes);
    return bytes;
  }
  wire::Bytes operator()(const wire::Trailer& body) const {
    wire::Bytes bytes;
    wire::encode_trailer(header.status, header.block, header.packet, body, bytes);
    return bytes;
  }
  wire::Bytes operator()(const wire::Data& body) const {
    wire::Bytes bytes;
    wire::encode_data(header.status, header.block, header.packet, body.bytes, bytes);
    return bytes;
  }
};

bool is_same(const wire::StreamPacket& a, const wire::StreamPacket& b) {
  if (a.body.index() != b.body.index()) return false;
  if (const auto* leader = std::get_if<wire::Leader>(&a.body)) return *leader == std::get<wire::Leader>(b.body);
  if (!(a.header == b.header)) return false;
  if (const auto* trailer = std::get_if<wire::Trailer>(&a.body)) return *trailer == std::get<wire::Trailer>(b.body);
  const auto* data = std::get_if<wire::Data>(&a.body);
  return data == nullptr || std::ranges::equal(data->bytes, std::get<wire::Data>(b.body).bytes);
}

void read_packet(wire::ByteSpan bytes) {
  const wire::StreamPacket packet = wire::decode_stream_packet(bytes);
  const wire::Bytes again = std::visit(Encoder{packet.header}, packet.body);
  if (!again.empty()) VBAR_FUZZ_EXPECT(is_same(wire::decode_stream_packet(again), packet));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const wire::ByteSpan bytes(data, size);
  try {
    read_packet(bytes);
  } catch (const std::invalid_argument&) {
  }
  const auto dn = wire::unpack_pixels(wire::PixelFormat::kMono12Packed, size * 2 / 3, bytes);
  const auto packed = wire::pack_pixels(wire::PixelFormat::kMono12Packed, 12, dn);
  VBAR_FUZZ_EXPECT(wire::unpack_pixels(wire::PixelFormat::kMono12Packed, dn.size(), packed) == dn);
  PixelPadding padding(12);
  padding.observe(wire::unpack_pixels(wire::PixelFormat::kMono16, size / 2, bytes));
  VBAR_FUZZ_EXPECT(padding.shift() >= 0 && padding.shift() <= 8 && padding.bits() >= 8 && padding.bits() <= 16);
  return 0;
}
