#include "fsw/gnss/receiver_decoder.h"

#include "fsw/gnss/oem_ephemeris.h"

namespace vbar::fsw::gnss {

ReceiverUpdate ReceiverDecoder::push(std::uint8_t byte) {
  return stream_.push(byte) ? read(stream_.message()) : ReceiverUpdate::kNone;
}

ReceiverUpdate ReceiverDecoder::evaluate(Status status, ReceiverUpdate update) {
  if (status == Status::kOk) return update;
  ++(status == Status::kNotReady ? counters_.not_ready : counters_.refused);
  return ReceiverUpdate::kNone;
}

template <class T>
ReceiverUpdate ReceiverDecoder::keep(const Result<T>& result, T& place, ReceiverUpdate update) {
  if (result.ok()) place = result.value();
  return evaluate(result.status(), update);
}

ReceiverUpdate ReceiverDecoder::read(const OemMessage& message) {
  constexpr std::uint8_t kBinary = 0;
  constexpr std::uint8_t kSecondAntenna = 1;
  if (!message.is_response && message.format == kBinary && message.source != kSecondAntenna) {
    switch (message.id) {
      case kOemRange:
        return evaluate(read_range(message, observations_, counters_.observations), ReceiverUpdate::kObservations);
      case kOemRangeCompressed:
        return evaluate(read_range_compressed(message, observations_, counters_.observations),
                        ReceiverUpdate::kObservations);
      case kOemRawEphemeris:
        return keep(read_raw_ephemeris(message), ephemeris_, ReceiverUpdate::kEphemeris);
      case kOemGpsEphemeris:
        return keep(read_gps_ephemeris(message), ephemeris_, ReceiverUpdate::kEphemeris);
      case kOemGalileoEphemeris:
        return keep(read_galileo_ephemeris(message), ephemeris_, ReceiverUpdate::kEphemeris);
      case kOemBeidouEphemeris:
        return keep(read_beidou_ephemeris(message), ephemeris_, ReceiverUpdate::kEphemeris);
      case kOemIonosphere:
        return keep(read_ionosphere(message), ionosphere_, ReceiverUpdate::kIonosphere);
      case kOemTime:
        return keep(read_time(message), clock_, ReceiverUpdate::kClock);
      case kOemBestXyz:
        return keep(read_best_xyz(message), position_, ReceiverUpdate::kPosition);
      case kOemBestPosition:
        return keep(read_best_position(message), position_, ReceiverUpdate::kPosition);
      default:
        break;
    }
  }
  ++counters_.unknown;
  return ReceiverUpdate::kNone;
}

std::int32_t ReceiverDecoders::messages() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().messages;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

std::int32_t ReceiverDecoders::refused() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().bad_checksum + decoder.counters().refused;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

}  // namespace vbar::fsw::gnss
