// What the flight decoder makes of a receiver's bytes on standard input, as lines for the peer tests to read:
//
//   observation  time_ns system prn signal code phase_usable pseudorange_m phase_cycles doppler_hz cn0_dbhz lock_time_s
//   ephemeris    system prn issue healthy toe_ns toc_ns, the elements in the order of Ephemeris, clock, group delay
//   counters     messages bad_checksum skipped_bytes unknown not_ready refused not_used not_locked implausible

#include <cinttypes>
#include <cstdio>
#include <memory>

#include "fsw/gnss/receiver_decoder.h"

namespace {

using namespace vbar::fsw::gnss;

constexpr const char* kSystems = "GEC";

char system_letter(Constellation constellation) {
  return kSystems[static_cast<std::size_t>(constellation)];
}

void print(const ObservationEpoch& epoch) {
  for (std::size_t k = 0; k < epoch.count; ++k) {
    const Observation& o = epoch.observations[k];
    std::printf("observation %" PRId64 " %c %d %d %d %d %.4f %.5f %.4f %.2f %.3f\n", epoch.receiver_time.ns,
                system_letter(o.satellite.constellation), o.satellite.prn, static_cast<int>(o.signal), o.code,
                o.phase_usable ? 1 : 0, o.pseudorange_m, o.carrier_phase_cycles, o.doppler_hz, o.cn0_dbhz,
                o.lock_time_s);
  }
}

void print(const Ephemeris& e) {
  std::printf("ephemeris %c %d %d %d %" PRId64 " %" PRId64, system_letter(e.satellite.constellation), e.satellite.prn,
              e.issue, e.healthy ? 1 : 0, e.toe.ns, e.toc.ns);
  for (const double value :
       {e.sqrt_a, e.e,   e.m0,  e.delta_n, e.omega0, e.omega_dot,     e.i0,  e.i_dot, e.omega, e.cuc,
        e.cus,    e.cic, e.cis, e.crc,     e.crs,    e.toe_of_week_s, e.af0, e.af1,   e.af2,   e.group_delay_s}) {
    std::printf(" %.17g", value);
  }
  std::printf("\n");
}

}  // namespace

int main() {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (int byte = std::getchar(); byte != EOF; byte = std::getchar()) {
    const ReceiverUpdate update = decoder->push(static_cast<std::uint8_t>(byte));
    if (update == ReceiverUpdate::kObservations) print(decoder->observations());
    if (update == ReceiverUpdate::kEphemeris) print(decoder->ephemeris());
  }
  const OemStreamCounters& stream = decoder->stream().counters();
  const ReceiverCounters& counters = decoder->counters();
  std::printf("counters %u %u %" PRIu64 " %u %u %u %u %u %u\n", stream.messages, stream.bad_checksum,
              decoder->stream().skipped_bytes(), counters.unknown, counters.not_ready, counters.refused,
              counters.observations.not_used, counters.observations.not_locked, counters.observations.implausible);
  return 0;
}
