#include "host_sim/twins/run_log.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/message_traits.h"
#include "fsw/packets/packet.h"

namespace vbar::twins {
namespace {

std::string at_byte(const std::filesystem::path& file, const LoggedEvent& event) {
  return file.string() + ": byte " + std::to_string(event.offset) + ": ";
}

bool is_record(const std::string& channel) {
  return channel == kPacketChannel || channel == kTilesChannel;
}

/// "packet telemetry_control from the flight software"
std::string packet_text(const PacketRecord& record) {
  const std::string direction = record.to_flight ? " to the flight software" : " from the flight software";
  if (record.tiles) return "image tiles" + direction;
  const auto view = fsw::packets::parse_packet(record.packet);
  const char* const name = view.ok() ? fsw::packets::message_name(view.value().header.apid) : nullptr;
  return (name != nullptr ? std::string("packet ") + name : std::string("a packet")) + direction;
}

std::string text_of(const LcmEvent& event, const std::filesystem::path& file) {
  if (event.channel == kRecipeChannel) return "an image recipe";
  if (event.channel == kRecordingChannel) return "an image";
  if (!is_record(event.channel)) return "a message " + event.channel;
  const PacketRecord record = record_of({0, 0, 0, event.channel, event.data}, file);
  return "step " + std::to_string(record.step) + ", " + packet_text(record);
}

/// A packet whose own checksum is wrong.
bool is_damaged(const LoggedEvent& event, const std::filesystem::path& file) {
  return event.channel == kPacketChannel && !fsw::packets::parse_packet(record_of(event, file).packet).ok();
}

}  // namespace

RunLog::RunLog(const std::filesystem::path& file) : file_(file), reader_(file) {
  while (const auto event = next_intact()) {
    try {
      check(*event);
    } catch (const DamagedLog&) {
      if (reader_.has_event_after(event->offset)) throw;
      damaged_from_ = event->offset;
      break;
    }
  }
  reader_ = LcmLogReader(file);
  is_over_ = events_ == 0;
}

/// Nothing at the end, which may be damaged.
std::optional<LoggedEvent> RunLog::next_intact() {
  const std::uint64_t begin = reader_.offset();
  try {
    auto event = reader_.next();
    if (!event && reader_.cut_short()) damaged_from_ = begin;
    return event;
  } catch (const DamagedLog&) {
    if (begin == 0 || reader_.has_event_after(begin)) throw;
    damaged_from_ = begin;
    return std::nullopt;
  }
}

void RunLog::check(const LoggedEvent& event) {
  if (has_end_) throw DamagedLog(at_byte(file_, event) + "an event after the end");
  const bool is_end = event.channel == kEndChannel;
  if (std::cmp_not_equal(event.number, events_)) {
    throw IncompleteLog(at_byte(file_, event) + "records are missing: event " + std::to_string(event.number) +
                        " follows event " + std::to_string(static_cast<std::int64_t>(events_) - 1));
  }
  if (message_.has_value() != event.channel.starts_with("vbar/") ||
      (message_ && (message_->channel != event.channel || message_->data != event.data)))
    throw DamagedLog(at_byte(file_, event) + "a message that is not that of its packet");
  message_.reset();
  if (is_record(event.channel)) check_record(event);
  if (!is_end) {
    ++events_;
    return;
  }
  if (event.data.size() != sizeof events_ || fsw::packets::read_big_endian<std::uint64_t>(event.data, 0) != events_)
    throw DamagedLog(at_byte(file_, event) + "a damaged end record");
  has_end_ = true;
}

void RunLog::check_record(const LoggedEvent& event) {
  const PacketRecord record = record_of(event, file_);
  if (event.timestamp != lcm_timestamp(record.time) || (steps_ > 0 && record.time < time_))
    throw DamagedLog(at_byte(file_, event) + "a record whose time is wrong");
  if (record.step != steps_ && record.step + 1 != steps_)
    throw IncompleteLog(at_byte(file_, event) + "records are missing: of step " + std::to_string(steps_));
  steps_ = record.step + 1;
  time_ = record.time;
  std::vector<LcmEvent> events = lcm_events_of(record);
  if (events.size() > 1) message_ = std::move(events.back());
}

void RunLog::compare(fsw::GpsTime time, const LcmEvent& flown) {
  if (is_over_) return;
  const std::int64_t timestamp = lcm_timestamp(time);
  const auto logged = reader_.next();
  if (logged && logged->timestamp >= until_ && timestamp >= until_) {
    is_over_ = true;
    return;
  }
  if (!logged || logged->timestamp != timestamp || logged->channel != flown.channel || logged->data != flown.data)
    part(time, flown, logged ? &*logged : nullptr);
  is_over_ = ++compared_ == events_;
}

/// Says where flight and log part.
void RunLog::part(fsw::GpsTime time, const LcmEvent& flown, const LoggedEvent* logged) {
  if (logged == nullptr) throw DamagedLog(file_.string() + ": was changed while it was read");
  if (is_damaged(*logged, file_)) throw DamagedLog(at_byte(file_, *logged) + "a packet whose checksum is wrong");
  const std::string now = text_of(flown, file_);
  const std::string then = text_of({logged->channel, logged->data}, file_);
  if (now != then) throw RunDiffers(time, now + ", where the log has " + then);
  const auto place = std::ranges::mismatch(flown.data, logged->data).in1 - flown.data.begin();
  throw RunDiffers(time, now + ": differs from byte " + std::to_string(place) + " of its record on");
}

}  // namespace vbar::twins
