// Stream packets written by hand from the tables of GigE Vision 1.2.

#include "hil_drivers/gige/wire/gvsp.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/gige/wire/hex.h"

namespace vbar::gige::wire {
namespace {

using test::hex;

const char* const kLeader =
    "0000 0001 01 000000 0000 0001 0000000102030405 01100007 000001f4 00000350 000002c6 00000098 0000 0000";

TEST(Gvsp, Leader) {
  const Leader leader{PayloadType::kImage, 0x102030405, PixelFormat::kMono16, 500, 848, 710, 152};
  Bytes datagram;
  encode_leader(Status::kSuccess, 1, leader, datagram);
  EXPECT_EQ(datagram, hex(kLeader));
  const StreamPacket packet = decode_stream_packet(datagram);
  EXPECT_EQ(packet.header, (StreamHeader{Status::kSuccess, 1, PacketKind::kLeader, 0}));
  EXPECT_EQ(std::get<Leader>(packet.body), leader);
}

TEST(Gvsp, DataAndTrailer) {
  Bytes datagram;
  encode_data(Status::kPacketResend, 0xFFFF, 0x010203, hex("f0ff 1000"), datagram);
  EXPECT_EQ(datagram, hex("0100 ffff 03 010203 f0ff 1000"));
  const StreamPacket data = decode_stream_packet(datagram);
  const ByteSpan bytes = std::get<Data>(data.body).bytes;
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), hex("f0ff 1000"));
  EXPECT_EQ(data.header.packet, 0x010203U);

  encode_trailer(Status::kSuccess, 2, 623, {PayloadType::kImage, 848}, datagram);
  EXPECT_EQ(datagram, hex("0000 0002 02 00026f 0000 0001 00000350"));
  EXPECT_EQ(std::get<Trailer>(decode_stream_packet(datagram).body), (Trailer{PayloadType::kImage, 848}));
}

TEST(Gvsp, UnavailablePacketHasNoPayload) {
  Bytes datagram;
  encode_unavailable(3, 5, datagram);
  EXPECT_EQ(datagram, hex("800c 0003 03 000005"));
  EXPECT_TRUE(std::holds_alternative<NoPayload>(decode_stream_packet(datagram).body));
}

TEST(Gvsp, HostilePacketsAreRefused) {
  for (const char* wrong : {"", "0000 0001 03 0000", "0000 0000 03 000001 00", "0000 0001 09 000001 00",
                            "0000 0001 01 000000 0000 0001", "0000 0001 02 000001 0000",
                            "0000 0001 01 000000 0000 0009 0000000102030405 01100007 000001f4 00000350 000002c6 "
                            "00000098 0000 0000",
                            "0000 0001 01 000000 0000 0001 0000000102030405 ffffffff 000001f4 00000350 000002c6 "
                            "00000098 0000 0000"})
    EXPECT_THROW((void)decode_stream_packet(hex(wrong)), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace vbar::gige::wire
