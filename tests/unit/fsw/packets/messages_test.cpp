// Messages in packets. Where the fields lie is worked out here from the text of vbar.lcm by LCM's published encoding
// rules (fields in order, big-endian, no padding), independently of the generated code.

#include "fsw/packets/messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "vbar_packets.h"

namespace vbar::fsw::packets {

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Field {
  std::string name;
  std::string type;
  std::size_t offset;  ///< in the payload
  std::size_t size;
};
using Layout = std::vector<Field>;

/// A line "  type name[copies];" of a definition file, or nothing if the line is something else.
struct Declaration {
  std::string type;
  std::string name;
  int copies = 1;
};
std::optional<Declaration> declaration_in(const std::string& line) {
  const std::size_t end = line.find(';');
  const bool is_comment = line.find("//") < end;
  if (!line.starts_with("  ") || line.starts_with("  const ") || is_comment || end == std::string::npos)
    return std::nullopt;
  std::istringstream words(line.substr(0, end));
  Declaration declaration;
  words >> declaration.type >> declaration.name;
  const std::size_t bracket = declaration.name.find('[');
  if (bracket != std::string::npos) {
    declaration.copies = std::stoi(declaration.name.substr(bracket + 1));
    declaration.name.resize(bracket);
  }
  return declaration;
}

/// Scalars of every struct of vbar.lcm, in order; offsets without the type hash.
std::map<std::string, Layout> layouts_of(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  const std::map<std::string, std::size_t> sizes{{"byte", 1},    {"int8_t", 1}, {"int16_t", 2}, {"int32_t", 4},
                                                 {"int64_t", 8}, {"float", 4},  {"double", 8}};
  std::map<std::string, Layout> layouts;
  std::string line;
  std::string name;
  while (std::getline(file, line)) {
    if (line.starts_with("struct ")) name = line.substr(7, line.find(' ', 7) - 7);
    const std::optional<Declaration> declaration = declaration_in(line);
    if (!declaration) continue;
    Layout& layout = layouts[name];
    for (int i = 0; i < declaration->copies; ++i) {
      const std::size_t offset = layout.empty() ? 0 : layout.back().offset + layout.back().size;
      const auto scalar = sizes.find(declaration->type);
      if (scalar != sizes.end()) {
        layout.push_back({declaration->name, declaration->type, offset, scalar->second});
        continue;
      }
      for (const Field& inner : layouts.at(declaration->type)) {
        layout.push_back({inner.name, inner.type, offset + inner.offset, inner.size});
      }
    }
  }
  return layouts;
}

class Messages : public testing::Test {
 protected:
  static constexpr std::size_t kHashBytes = 8;
  std::map<std::string, Layout> layouts_ = layouts_of(vbar::tests::source_path("fsw/packets/vbar.lcm"));

  template <class Message>
  static Bytes packet_of(const Message& message) {
    Bytes out(kMaxPacketBytes);
    const Result<std::size_t> size = encode({}, message, out);
    EXPECT_TRUE(size.ok());
    out.resize(size.value());
    return out;
  }

  template <class Message>
  static Status decode_status(const Bytes& payload, Apid apid = MessageTraits<Message>::kApid) {
    PacketHeader header;
    header.apid = apid;
    return decode<Message>(PacketView{header, payload}).status();
  }

  template <class Message>
  static Bytes zero_payload() {
    const Bytes packet = packet_of(Message{});
    return {packet.begin() + kPacketHeaderBytes, packet.end() - kPacketCrcBytes};
  }

  template <class Message>
  std::size_t payload_size() const {
    const Layout& layout = layouts_.at(Message::getTypeName());
    return kHashBytes + layout.back().offset + layout.back().size;
  }
};

TEST_F(Messages, PayloadHasTheSizeThatTheDefinitionGives) {
  for_each_message([&]<class Message>() {
    EXPECT_EQ(zero_payload<Message>().size(), payload_size<Message>()) << Message::getTypeName();
  });
}

// Longer messages would need segmentation, which the flight software's inputs and outputs do without.
TEST_F(Messages, EveryMessageFitsOnePacket) {
  for_each_message(
      [&]<class Message>() { EXPECT_LE(payload_size<Message>(), kMaxPayloadBytes) << Message::getTypeName(); });
}

TEST_F(Messages, EveryApidNamesOneMessage) {
  std::map<Apid, std::string> names;
  for_each_message([&]<class Message>() {
    constexpr Apid kApid = MessageTraits<Message>::kApid;
    EXPECT_TRUE(names.emplace(kApid, Message::getTypeName()).second) << Message::getTypeName();
    EXPECT_STREQ(message_name(kApid), Message::getTypeName());
  });
  EXPECT_EQ(message_name(static_cast<Apid>(0x7FF)), nullptr);
}

TEST_F(Messages, OneMessageTooLongOrTooShortByAByteIsRefused) {
  for_each_message([&]<class Message>() {
    Bytes payload = zero_payload<Message>();
    EXPECT_EQ(decode_status<Message>(payload), Status::kOk) << Message::getTypeName();
    payload.push_back(0);
    EXPECT_EQ(decode_status<Message>(payload), Status::kTooLong) << Message::getTypeName();
    for (std::size_t size = 0; size + 1 < payload.size(); ++size) {
      const Bytes cut(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_EQ(decode_status<Message>(cut), Status::kTooShort) << Message::getTypeName() << ' ' << size;
    }
  });
}

TEST_F(Messages, AnotherTypeHashOrApidIsTheWrongType) {
  for_each_message([&]<class Message>() {
    Bytes payload = zero_payload<Message>();
    EXPECT_EQ(decode_status<Message>(payload, static_cast<Apid>(0x7FF)), Status::kWrongType);
    for (std::size_t bit = 0; bit < kHashBytes * 8; ++bit) {
      payload[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      EXPECT_EQ(decode_status<Message>(payload), Status::kWrongType) << Message::getTypeName() << ' ' << bit;
      payload[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
  });
}

TEST_F(Messages, ASegmentIsNotAMessage) {
  const Bytes payload = zero_payload<vbar::tick>();
  for (const SequenceFlags flags : {SequenceFlags::kFirst, SequenceFlags::kContinuation, SequenceFlags::kLast}) {
    PacketHeader header;
    header.flags = flags;
    EXPECT_EQ(decode<vbar::tick>(PacketView{header, payload}).status(), Status::kBadSequence);
  }
}

// Every double and float of every message, found by the definition: a NaN or an infinity there is refused, and the same
// bits in an integer are not. So no field can be forgotten when a message grows.
TEST_F(Messages, NoDoubleMayBeNanOrInfinite) {
  const std::vector<double> refused{std::numeric_limits<double>::quiet_NaN(),
                                    std::numeric_limits<double>::signaling_NaN(),
                                    std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  int doubles = 0;
  for_each_message([&]<class Message>() {
    const Bytes zero = zero_payload<Message>();
    for (const Field& field : layouts_.at(Message::getTypeName())) {
      for (const double value : refused) {
        Bytes payload = zero;
        std::uint64_t bits = std::bit_cast<std::uint64_t>(value);
        if (field.type == "float") {
          bits = std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(value))} << 32U;
        }
        for (std::size_t i = 0; i < field.size; ++i) {
          payload[kHashBytes + field.offset + i] = static_cast<std::uint8_t>(bits >> (56U - 8U * i));
        }
        const bool is_number = field.type == "double" || field.type == "float";
        doubles += is_number ? 1 : 0;
        EXPECT_EQ(decode_status<Message>(payload), is_number ? Status::kNotFinite : Status::kOk)
            << Message::getTypeName() << '.' << field.name << " at " << field.offset;
      }
    }
  });
  EXPECT_GT(doubles, 0);
}

TEST_F(Messages, EncodeRefusesWhatDecodeWouldRefuse) {
  Bytes out(kMaxPacketBytes);
  vbar::maneuver_command command{};
  command.dv_rtn[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(encode({}, command, out).status(), Status::kNotFinite);
  command.dv_rtn[1] = std::numeric_limits<double>::max();
  EXPECT_TRUE(encode({}, command, out).ok());
  vbar::waypoint_table table{};
  table.waypoints[15].a_roe_m[5] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(encode({}, table, out).status(), Status::kNotFinite);
}

TEST_F(Messages, EncodeNeedsRoomForTheWholePacket) {
  const Bytes packet = packet_of(vbar::tick{});
  Bytes out(packet.size() - 1);
  EXPECT_EQ(encode({}, vbar::tick{}, out).status(), Status::kTooLong);
  out.resize(packet.size());
  EXPECT_TRUE(encode({}, vbar::tick{}, out).ok());
}

TEST_F(Messages, EncodeSetsApidAndFlagsAndKeepsTheRestOfTheHeader) {
  PacketHeader header;
  header.apid = Apid::kTick;
  header.flags = SequenceFlags::kFirst;
  header.sequence_count = 77;
  header.time = GpsTime{1'400'000'000'000'000'001};
  header.spacecraft = 1;
  header.unit = 2;
  Bytes out(kMaxPacketBytes);
  const Result<std::size_t> size = encode(header, vbar::mode_command{}, out);
  ASSERT_TRUE(size.ok());
  const Result<PacketView> packet = parse_packet(std::span(out).first(size.value()));
  ASSERT_TRUE(packet.ok());
  EXPECT_EQ(packet.value().header.apid, Apid::kModeCommand);
  EXPECT_EQ(packet.value().header.flags, SequenceFlags::kUnsegmented);
  EXPECT_EQ(packet.value().header.sequence_count, 77);
  EXPECT_EQ(packet.value().header.time, header.time);
  EXPECT_EQ(packet.value().header.spacecraft, 1);
  EXPECT_EQ(packet.value().header.unit, 2);
}

TEST_F(Messages, ValuesSurviveTheWireBitForBit) {
  vbar::executed_maneuver sent{};
  sent.maneuver_id = std::numeric_limits<std::int32_t>::min();
  sent.accepted = -1;
  sent.dv_rtn[0] = -0.0;
  sent.dv_rtn[1] = std::numeric_limits<double>::denorm_min();
  sent.dv_rtn[2] = 0.1;
  const Bytes packet = packet_of(sent);
  const Result<PacketView> view = parse_packet(packet);
  ASSERT_TRUE(view.ok());
  const Result<vbar::executed_maneuver> received = decode<vbar::executed_maneuver>(view.value());
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().maneuver_id, sent.maneuver_id);
  EXPECT_EQ(received.value().accepted, sent.accepted);
  EXPECT_EQ(std::memcmp(received.value().dv_rtn, sent.dv_rtn, sizeof sent.dv_rtn), 0);
}

/// The fields that the generated visitor visits, an element of an array each.
template <class Message>
void append_names(const Message& message, std::vector<std::string>& names) {
  visit_fields(message, [&](const vbar::Field& field, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_class_v<std::remove_all_extents_t<Value>>) {
      for (const auto& element : value) append_names(element, names);
    } else {
      for (std::size_t k = 0; k < std::max<std::size_t>(std::extent_v<Value>, 1); ++k) names.emplace_back(field.name);
    }
  });
}

TEST_F(Messages, EveryFieldIsVisitedInOrder) {
  for_each_message([&]<class Message>() {
    std::vector<std::string> visited, expected;
    append_names(Message{}, visited);
    for (const auto& field : layouts_[Message::getTypeName()]) expected.push_back(field.name);
    EXPECT_EQ(visited, expected) << Message::getTypeName();
  });
}

TEST(Fields, TellUnitsElementsAndWordsOfCodes) {
  int seen = 0;
  const telemetry_navigation message{};
  visit_fields(message, [&](const vbar::Field& field, const auto&) {
    if (field.name == std::string("relative_velocity_rtn")) {
      EXPECT_STREQ(field.unit, "mps");
      EXPECT_STREQ(field.elements[1], "t");
      ++seen;
    } else if (field.name == std::string("a_roe_mean_m")) {
      EXPECT_STREQ(field.stem, "a_roe_mean");
      EXPECT_STREQ(field.unit, "m");
      ++seen;
    } else if (field.name == std::string("source")) {
      ASSERT_EQ(field.codes.count, 7);
      EXPECT_EQ(field.codes.codes[4].value, 4);
      EXPECT_STREQ(field.codes.codes[4].word, "gnss_fixed");
      ++seen;
    }
  });
  EXPECT_EQ(seen, 3);
}

}  // namespace

// The packet library in C, generated from vbar.lcm by a program of this project, against the types that lcm-gen makes
// of the same file.

namespace {

PacketView view_of(std::span<const std::uint8_t> bytes) {
  const Result<PacketView> view = parse_packet(bytes);
  EXPECT_TRUE(view.ok());
  return view.value();
}

TEST(CPackets, HaveLcmsHashesAndSizes) {
#define EXPECT_LCM(message, MESSAGE)                                                          \
  EXPECT_EQ(VBAR_HASH_##MESSAGE, static_cast<std::uint64_t>(::vbar::message::getHash()));     \
  EXPECT_EQ(VBAR_BYTES_##MESSAGE, static_cast<unsigned>(::vbar::message{}.getEncodedSize())); \
  EXPECT_EQ(VBAR_APID_##MESSAGE, static_cast<unsigned>(MessageTraits<::vbar::message>::kApid));
  // One of each kind of field: numbers, arrays, bytes, floats, structs in an array.
  EXPECT_LCM(tick, TICK)
  EXPECT_LCM(ideal_navigation, IDEAL_NAVIGATION)
  EXPECT_LCM(gnss_bytes, GNSS_BYTES)
  EXPECT_LCM(image_tile, IMAGE_TILE)
  EXPECT_LCM(waypoint_table, WAYPOINT_TABLE)
  EXPECT_LCM(target_model, TARGET_MODEL)
  EXPECT_LCM(telemetry_pose, TELEMETRY_POSE)
  EXPECT_LCM(telemetry_event, TELEMETRY_EVENT)
#undef EXPECT_LCM
}

TEST(CPackets, AreReadAsLcmReadsThem) {
  ::vbar::waypoint_table table{};
  table.count = 2;
  table.reference_semi_major_axis_m = 7.1e6;
  table.waypoints[1].index = -5;
  table.waypoints[1].control_mode = ::vbar::waypoint::kSolverNone;
  table.waypoints[1].a_roe_m[3] = 0.1;
  table.waypoints[15].keep_out_radius_m = 2.5;
  std::array<std::uint8_t, kMaxPacketBytes> bytes{};
  PacketHeader header;
  header.sequence_count = 16383;
  header.time.ns = -7;
  header.spacecraft = 200;
  header.unit = 1;
  const Result<std::size_t> size = encode(header, table, bytes);
  ASSERT_TRUE(size.ok());
  vbar_packet packet;
  ASSERT_TRUE(vbar_read_packet(bytes.data(), size.value(), &packet));
  EXPECT_EQ(packet.header.apid, VBAR_APID_WAYPOINT_TABLE);
  EXPECT_EQ(packet.header.sequence_count, 16383);
  EXPECT_EQ(packet.header.gps_time_ns, -7);
  EXPECT_EQ(packet.header.spacecraft, 200);
  EXPECT_EQ(packet.header.unit, 1);
  vbar_waypoint_table read;
  ASSERT_TRUE(vbar_read_waypoint_table(&packet, &read));
  EXPECT_EQ(read.count, 2);
  EXPECT_EQ(read.reference_semi_major_axis_m, 7.1e6);
  EXPECT_EQ(read.waypoints[1].index, -5);
  EXPECT_EQ(read.waypoints[1].control_mode, VBAR_WAYPOINT_SOLVER_NONE);
  EXPECT_EQ(read.waypoints[1].a_roe_m[3], 0.1);
  EXPECT_EQ(read.waypoints[15].keep_out_radius_m, 2.5);
  vbar_tick tick;
  EXPECT_FALSE(vbar_read_tick(&packet, &tick)) << "another type";
}

TEST(CPackets, AreWrittenAsLcmWritesThem) {
  vbar_maneuver_command command{};
  command.maneuver_id = -3;
  command.waypoint_index = 8;
  command.solver = VBAR_WAYPOINT_SOLVER_CLOSED_FORM;
  command.dv_rtn[2] = -0.25;
  vbar_packet_header header{};
  header.sequence_count = 12;
  header.gps_time_ns = 1'000'000'000'000'000'001;
  header.spacecraft = 3;
  std::array<std::uint8_t, VBAR_MAX_PACKET_BYTES> bytes{};
  const std::size_t size = vbar_write_maneuver_command(bytes.data(), &header, &command);
  const PacketView view = view_of(std::span(bytes).first(size));
  EXPECT_EQ(view.header.sequence_count, 12);
  EXPECT_EQ(view.header.time.ns, 1'000'000'000'000'000'001);
  const auto message = decode<::vbar::maneuver_command>(view);
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message.value().maneuver_id, -3);
  EXPECT_EQ(message.value().waypoint_index, 8);
  EXPECT_EQ(message.value().solver, ::vbar::waypoint::kSolverClosedForm);
  EXPECT_EQ(message.value().dv_rtn[2], -0.25);
}

TEST(CPackets, RefuseDamageOtherSizesAndWhatIsNotFinite) {
  ::vbar::range_measurement range{};
  range.range_m = 12.5;
  std::array<std::uint8_t, kMaxPacketBytes> bytes{};
  const std::size_t size = encode(PacketHeader{}, range, bytes).value();
  vbar_packet packet;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    auto damaged = bytes;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(vbar_read_packet(damaged.data(), size, &packet)) << bit;
  }
  for (std::size_t shorter = 0; shorter < size; ++shorter) {
    EXPECT_FALSE(vbar_read_packet(bytes.data(), shorter, &packet)) << shorter;
  }
  vbar_range_measurement message{};
  message.range_m = __builtin_nan("");
  vbar_packet_header header{};
  const std::size_t written = vbar_write_range_measurement(bytes.data(), &header, &message);
  ASSERT_TRUE(vbar_read_packet(bytes.data(), written, &packet));
  EXPECT_FALSE(vbar_read_range_measurement(&packet, &message));
}

}  // namespace

}  // namespace vbar::fsw::packets
