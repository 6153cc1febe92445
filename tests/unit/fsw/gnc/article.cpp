#include "tests/unit/fsw/gnc/article.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace vbar::fsw::gnc::test {
namespace {

template <class Message>
Message decoded(const packets::PacketView& packet) {
  const Result<Message> message = packets::decode<Message>(packet);
  EXPECT_TRUE(message.ok()) << "the flight software sent a packet that cannot be read";
  return message.value();
}

}  // namespace

void Article::Free::operator()(std::byte* state) const {
  ::operator delete[](state, std::align_val_t(vbar_gnc_state_alignment()));
}

Article::Article()
    : tray_(std::make_unique<Tray>()),
      state_(new (std::align_val_t(vbar_gnc_state_alignment())) std::byte[vbar_gnc_state_size()]) {
  std::memset(state_.get(), fill, vbar_gnc_state_size());
  EXPECT_EQ(vbar_gnc_init(state_.get(), kServicer, &Article::sink, tray_.get()), 0);
}

vbar_status Article::deliver(const Bytes& packet) {
  return watched([&] { return vbar_gnc_receive(state_.get(), packet.data(), packet.size()); });
}

Answer Article::step(GpsTime now, Duration period) {
  tick message{};
  message.period_ns = period.ns;
  EXPECT_EQ(deliver(now, message), 0);
  return step_without_tick(now);
}

Answer Article::step_without_tick(GpsTime now) {
  return collect(watched([&] { return vbar_gnc_step(state_.get(), now.ns); }));
}

std::vector<std::byte> Article::save() const {
  return {state_.get(), state_.get() + vbar_gnc_state_size()};
}

void Article::restore(const std::vector<std::byte>& saved) {
  ASSERT_EQ(saved.size(), vbar_gnc_state_size());
  std::memcpy(state_.get(), saved.data(), saved.size());
  vbar_gnc_set_sink(state_.get(), &Article::sink, tray_.get());
}

std::vector<std::uint8_t> Article::snapshot() const {
  std::vector<std::uint8_t> bytes(vbar_gnc_snapshot_size());
  EXPECT_EQ(vbar_gnc_save(state_.get(), bytes.data(), bytes.size()), 0);
  return bytes;
}

vbar_status Article::restore_snapshot(const std::vector<std::uint8_t>& snapshot) {
  static constexpr std::uint8_t kNothing = 0;
  return vbar_gnc_restore(state_.get(), snapshot.empty() ? &kNothing : snapshot.data(), snapshot.size());
}

[[gnu::noinline]] void Article::fill_stack() {
  std::array<std::byte, 256 * 1024> stack;
  std::memset(stack.data(), fill, stack.size());
  asm volatile("" : : "r"(stack.data()) : "memory");  // the compiler must not remove what nothing reads
}

void Article::sink(void* context, const std::uint8_t* packet, std::size_t size) {
  Tray& tray = *static_cast<Tray*>(context);
  ASSERT_LT(tray.count, Tray::kPackets);
  ASSERT_LE(size, packets::kMaxPacketBytes);
  std::memcpy(tray.bytes[tray.count].data(), packet, size);
  tray.size[tray.count++] = size;
}

Answer Article::collect(vbar_status status) {
  using packets::Apid;
  Answer answer;
  answer.status = status;
  for (std::size_t k = 0; k < tray_->count; ++k) {
    const Bytes bytes(tray_->bytes[k].begin(), tray_->bytes[k].begin() + static_cast<std::ptrdiff_t>(tray_->size[k]));
    const Result<packets::PacketView> packet = packets::parse_packet(bytes);
    EXPECT_TRUE(packet.ok());
    if (!packet.ok()) continue;
    const packets::PacketView& view = packet.value();
    if (view.header.apid == Apid::kTelemetryTelecommand) {
      answer.acknowledgments.push_back(decoded<telemetry_telecommand>(view));
      answer.packets.push_back(bytes);
      continue;
    }
    if (view.header.apid == Apid::kTelemetryEvent) {
      answer.events.push_back(decoded<telemetry_event>(view));
      answer.packets.push_back(bytes);
      continue;
    }
    if (view.header.apid == Apid::kTelemetryPose) {
      answer.poses.push_back({view.header.unit, view.header.time, decoded<telemetry_pose>(view)});
      answer.packets.push_back(bytes);
      continue;
    }
    if (view.header.apid == Apid::kTelemetrySafety) {
      answer.safety = decoded<telemetry_safety>(view);
      answer.packets.push_back(bytes);
      continue;
    }
    constexpr std::array kKeptAsBytes{Apid::kPointingCommand, Apid::kExposureCommand, Apid::kTelemetryRange,
                                      Apid::kTelemetryGnss,   Apid::kTelemetryImage,  Apid::kTelemetryObjects};
    if (std::ranges::find(kKeptAsBytes, view.header.apid) != kKeptAsBytes.end()) {
      answer.packets.push_back(bytes);
      continue;
    }
    answer.telemetry_count += packets::is_telemetry(view.header.apid) ? 1 : 0;
    if (view.header.apid == Apid::kManeuverCommand) {
      answer.commands.push_back({view.header.time, decoded<maneuver_command>(view)});
    } else if (view.header.apid == Apid::kTelemetryNavigation) {
      answer.navigation = decoded<telemetry_navigation>(view);
    } else if (view.header.apid == Apid::kTelemetryControl) {
      answer.control = decoded<telemetry_control>(view);
    } else if (view.header.apid == Apid::kTelemetryHealth) {
      answer.health = decoded<telemetry_health>(view);
    } else {
      ADD_FAILURE() << "the flight software sent a packet of a kind it should not";
    }
    answer.packets.push_back(bytes);
  }
  tray_->count = 0;
  return answer;
}

}  // namespace vbar::fsw::gnc::test
