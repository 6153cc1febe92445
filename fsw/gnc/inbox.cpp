#include "fsw/gnc/inbox.h"

namespace vbar::fsw::gnc {
namespace {

using packets::Apid;
using packets::PacketView;

template <class Message, std::size_t kCapacity>
Status decode_and_file(const PacketView& packet, TimeOrderedQueue<Message, kCapacity>& queue) {
  const Result<Message> message = packets::decode<Message>(packet);
  if (!message.ok()) return message.status();
  const packets::PacketHeader& header = packet.header;
  return queue.file({header.time, header.unit, header.sequence_count}, message.value());
}

}  // namespace

Status Inbox::receive(std::span<const std::uint8_t> bytes) {
  const Result<PacketView> packet = packets::parse_packet(bytes);
  const Status status = packet.ok() ? file(packet.value()) : packet.status();
  count(status);
  return status;
}

Status Inbox::file(const PacketView& packet) {
  if (packet.header.spacecraft != spacecraft_) return Status::kInvalidArgument;
  if (!is_usable(packet.header.time)) return Status::kOutOfRange;
  switch (packet.header.apid) {
    case Apid::kTick: {
      const Result<tick> message = packets::decode<tick>(packet);
      if (!message.ok()) return message.status();
      const Duration period{message.value().period_ns};
      if (!is_usable(period)) return Status::kOutOfRange;
      step_period_ = period;
      return Status::kOk;
    }
    case Apid::kIdealNavigation:
      return decode_and_file(packet, ideal_navigation_);
    case Apid::kGnssBytes:
      return decode_and_file(packet, gnss_bytes_);
    case Apid::kCrosslinkGnssBytes:
      return decode_and_file(packet, crosslink_gnss_bytes_);
    case Apid::kAttitude:
      return decode_and_file(packet, attitudes_);
    case Apid::kCrosslinkAttitude:
      return decode_and_file(packet, crosslink_attitudes_);
    case Apid::kExecutedManeuver:
      return decode_and_file(packet, executed_maneuvers_);
    case Apid::kWaypointTable:
      return decode_and_file(packet, waypoint_tables_);
    case Apid::kGncConfiguration:
      return decode_and_file(packet, configurations_);
    case Apid::kModeCommand:
      return decode_and_file(packet, mode_commands_);
    case Apid::kNavigationConfiguration:
      return decode_and_file(packet, navigation_configurations_);
    case Apid::kCameraConfiguration:
      return decode_and_file(packet, camera_configurations_);
    case Apid::kAnglesOnlyConfiguration:
      return decode_and_file(packet, angles_only_configurations_);
    case Apid::kTargetApriori:
      return decode_and_file(packet, target_aprioris_);
    case Apid::kPoseConfiguration:
      return decode_and_file(packet, pose_configurations_);
    case Apid::kImageTile: {
      const Result<image_tile> message = packets::decode<image_tile>(packet);
      if (!message.ok()) return message.status();
      return image_.take(packet.header.time, packet.header.unit, message.value());
    }
    case Apid::kRangeMeasurement:  // navigation does not use it: accepted if it is valid, then ignored
      return packets::decode<range_measurement>(packet).status();
    case Apid::kManeuverCommand:
    case Apid::kPointingCommand:
    case Apid::kTelemetryNavigation:
    case Apid::kTelemetryControl:
    case Apid::kTelemetryHealth:
    case Apid::kTelemetryGnss:
    case Apid::kTelemetryImage:
    case Apid::kTelemetryObjects:
    case Apid::kTelemetryPose:
    case Apid::kStepReport:
    case Apid::kWiredBytes:
      break;
  }
  return Status::kWrongType;
}

void Inbox::count(Status status) {
  switch (status) {
    case Status::kOk:
      ++counters_.accepted;
      break;
    case Status::kBadChecksum:
      ++counters_.rejected_checksum;
      break;
    case Status::kWrongType:
      ++counters_.rejected_type;
      break;
    case Status::kTooShort:
    case Status::kTooLong:
      ++counters_.rejected_length;
      break;
    case Status::kNotFinite:
    case Status::kOutOfRange:
      ++counters_.rejected_content;
      break;
    case Status::kFull:
      ++counters_.dropped_full;
      break;
    case Status::kBadSequence:
    case Status::kInvalidArgument:
    case Status::kDidNotConverge:
    case Status::kSingular:
    case Status::kUnsafe:
    case Status::kNotReady:
      ++counters_.rejected_other;
      break;
  }
}

void Inbox::clear(GpsTime next_step) {
  if (image_.has_image()) image_.clear();
  image_.accept_until(next_step);
  ideal_navigation_.clear();
  executed_maneuvers_.clear();
  waypoint_tables_.clear();
  configurations_.clear();
  mode_commands_.clear();
  navigation_configurations_.clear();
  camera_configurations_.clear();
  angles_only_configurations_.clear();
  target_aprioris_.clear();
  pose_configurations_.clear();
  gnss_bytes_.clear();
  crosslink_gnss_bytes_.clear();
  attitudes_.clear();
  crosslink_attitudes_.clear();
}

}  // namespace vbar::fsw::gnc
