#include "fsw/gnss/oem_range.h"

#include <array>

#include "fsw/gnss/oem_fields.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::size_t kCountBytes = 4;
constexpr std::size_t kRangeBytes = 44;
constexpr std::size_t kCompressedBytes = 24;

// From the ground or a low orbit a navigation satellite is 18,000 to 50,000 km away; 20 ms of clock error are 6,000 km.
constexpr double kMinPseudorange = 1.0e7;
constexpr double kMaxPseudorange = 6.0e7;
// Twice a pseudorange of 60,000 km in cycles, for a receiver that counts from its own origin.
constexpr double kMaxPhaseCycles = 1.0e9;
// 8 km/s of a low orbit on 4 km/s of a navigation satellite are 63 kHz; the receiver's oscillator adds a few.
constexpr double kMaxDoppler = 1.0e5;
constexpr double kMaxSigma = 1.0e4;
constexpr double kMaxPhaseSigmaCycles = 1.0e4;
constexpr double kMaxCn0Dbhz = 100.0;
constexpr double kMaxLockTime = 1.0e9;

/// False for NaN.
bool within(double value, double low, double high) {
  return value >= low && value <= high;
}

/// One signal's record of either log, before validation.
struct Record {
  std::uint32_t status_word = 0;
  std::uint32_t prn = 0;
  Observation measured;
};

/// Collects an epoch in order of satellite and signal.
class EpochBuilder {
 public:
  EpochBuilder(ObservationEpoch& epoch, ObservationTally& tally) : epoch_(epoch), tally_(tally) {}

  void add(const Record& record) {
    const TrackingStatus status = tracking_status(record.status_word);
    const std::optional<UsedSignal> used = used_signal(status);
    if (!used || record.prn == 0 || record.prn > highest_prn(used->constellation)) {
      ++tally_.not_used;
      return;
    }
    if (!status.code_lock) {
      ++tally_.not_locked;
      return;
    }
    Observation observation = record.measured;
    if (!plausible(observation)) {
      ++tally_.implausible;
      return;
    }
    observation.satellite = {used->constellation, static_cast<std::uint8_t>(record.prn)};
    observation.signal = used->signal;
    observation.code = status.signal;
    observation.phase_usable = status.phase_lock && status.parity_known;
    if (!within(observation.carrier_phase_cycles, -kMaxPhaseCycles, kMaxPhaseCycles) ||
        !within(observation.phase_sigma_cycles, 0.0, kMaxPhaseSigmaCycles)) {
      ++tally_.phase_refused;
      observation.phase_usable = false;
      observation.carrier_phase_cycles = 0.0;
      observation.phase_sigma_cycles = 0.0;
    }
    file(observation, used->code_rank);
  }

 private:
  static bool plausible(const Observation& observation) {
    return within(observation.pseudorange_m, kMinPseudorange, kMaxPseudorange) &&
           within(observation.doppler_hz, -kMaxDoppler, kMaxDoppler) &&
           within(observation.pseudorange_sigma_m, 0.0, kMaxSigma) && within(observation.cn0_dbhz, 0.0, kMaxCn0Dbhz) &&
           within(observation.lock_time_s, 0.0, kMaxLockTime);
  }

  /// Returns true if `a` comes after `b`.
  static bool after(const Observation& a, const Observation& b) {
    return a.satellite != b.satellite ? a.satellite > b.satellite : a.signal > b.signal;
  }

  void file(const Observation& observation, std::uint8_t rank) {
    std::size_t place = epoch_.count;
    while (place > 0 && after(epoch_.observations[place - 1], observation)) --place;
    if (place > 0 && !after(observation, epoch_.observations[place - 1])) {
      ++tally_.duplicate;
      if (rank < ranks_[place - 1]) put(place - 1, observation, rank);
      return;
    }
    if (epoch_.count == kMaxObservations) {
      ++tally_.no_room;
      return;
    }
    for (std::size_t k = epoch_.count; k > place; --k) put(k, epoch_.observations[k - 1], ranks_[k - 1]);
    put(place, observation, rank);
    ++epoch_.count;
  }

  void put(std::size_t place, const Observation& observation, std::uint8_t rank) {
    epoch_.observations[place] = observation;
    ranks_[place] = rank;
  }

  ObservationEpoch& epoch_;
  ObservationTally& tally_;
  std::array<std::uint8_t, kMaxObservations> ranks_{};
};

Record range_record(std::span<const std::uint8_t> bytes) {
  Record record;
  record.prn = read_little_endian<std::uint16_t>(bytes, 0);
  record.measured.pseudorange_m = read_f64(bytes, 4);
  record.measured.pseudorange_sigma_m = read_f32(bytes, 12);
  record.measured.carrier_phase_cycles = -read_f64(bytes, 16);  // decreases with increasing range
  record.measured.phase_sigma_cycles = read_f32(bytes, 24);
  record.measured.doppler_hz = read_f32(bytes, 28);
  record.measured.cn0_dbhz = read_f32(bytes, 32);
  record.measured.lock_time_s = read_f32(bytes, 36);
  record.status_word = read_u32(bytes, 40);
  return record;
}

/// RANGECMP sends the accumulated Doppler range modulo 2^23 cycles; the receiver starts counting at the pseudorange, so
/// it determines the number of rollovers (log RANGECMP, note on ADR rollover).
double unrolled_phase_cycles(double rolled_adr_cycles, double pseudorange_m, Signal signal) {
  constexpr double kRollover = 8388608.0;
  const double rollovers = math::floor((pseudorange_m / wavelength(signal) + rolled_adr_cycles) / kRollover + 0.5);
  return rollovers * kRollover - rolled_adr_cycles;
}

Record compressed_record(std::span<const std::uint8_t> bytes) {
  // Manual's table "Range record format (RANGECMP only)": standard deviations of the pseudorange, m.
  constexpr std::array<double, 16> kPseudorangeSigma{0.050, 0.075, 0.113, 0.169, 0.253, 0.380, 0.570, 0.854,
                                                     1.281, 2.375, 4.750, 9.500, 19.00, 38.00, 76.00, 152.0};
  const auto field = [bytes](std::size_t first, unsigned count) { return read_low_first_bits(bytes, first, count); };
  const auto signed_field = [field](std::size_t first, unsigned count) {
    return static_cast<double>(sign_extended(static_cast<std::uint32_t>(field(first, count)), count));
  };
  Record record;
  record.status_word = static_cast<std::uint32_t>(field(0, 32));
  record.measured.doppler_hz = signed_field(32, 28) / 256.0;
  record.measured.pseudorange_m = static_cast<double>(field(60, 36)) / 128.0;
  record.measured.pseudorange_sigma_m = kPseudorangeSigma[static_cast<std::size_t>(field(128, 4))];
  record.measured.phase_sigma_cycles = static_cast<double>(field(132, 4) + 1) / 512.0;
  record.prn = static_cast<std::uint32_t>(field(136, 8));
  record.measured.lock_time_s = static_cast<double>(field(144, 21)) / 32.0;
  record.measured.cn0_dbhz = 20.0 + static_cast<double>(field(165, 5));
  const std::optional<UsedSignal> used = used_signal(tracking_status(record.status_word));
  if (used) {
    record.measured.carrier_phase_cycles =
        unrolled_phase_cycles(signed_field(96, 32) / 256.0, record.measured.pseudorange_m, used->signal);
  }
  return record;
}

template <class ReadRecord>
Status read_records(const OemMessage& message, std::size_t record_bytes, ReadRecord read_record,
                    ObservationEpoch& epoch, ObservationTally& tally) {
  const Result<GpsTime> time = time_of(message);
  if (!time.ok()) return time.status();
  if (message.body.size() < kCountBytes) return Status::kTooShort;
  const std::uint32_t announced = read_u32(message.body, 0);
  const std::size_t held = (message.body.size() - kCountBytes) / record_bytes;
  if (announced > held) return Status::kTooShort;
  epoch.receiver_time = time.value();
  EpochBuilder builder(epoch, tally);
  for (std::size_t k = 0; k < announced; ++k) {
    builder.add(read_record(message.body.subspan(kCountBytes + k * record_bytes, record_bytes)));
  }
  return Status::kOk;
}

}  // namespace

Status read_range(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally) {
  epoch.count = 0;
  if (message.id != kOemRange) return Status::kWrongType;
  return read_records(message, kRangeBytes, range_record, epoch, tally);
}

Status read_range_compressed(const OemMessage& message, ObservationEpoch& epoch, ObservationTally& tally) {
  epoch.count = 0;
  if (message.id != kOemRangeCompressed) return Status::kWrongType;
  return read_records(message, kCompressedBytes, compressed_record, epoch, tally);
}

}  // namespace vbar::fsw::gnss
