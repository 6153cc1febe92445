// A mission whose GNSS receiver is a recorded one: the packets to the flight software are its observations.

#include <algorithm>
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/gnss/receiver_decoder.h"
#include "fsw/packets/messages.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "tests/support/paths.h"

namespace vbar::sensors {
namespace {

using testing::HasSubstr;

std::string mission_file() {
  return vbar::tests::source_path("tests/data/flight/grace_b.toml");
}

/// A body in a low orbit at the time, whose attitude a packet states.
twins::TruthSnapshot truth_at(fsw::GpsTime time) {
  twins::TruthSnapshot truth;
  truth.time = time;
  twins::SpacecraftTruth& servicer = truth.spacecraft.emplace_back();
  servicer.name = "servicer";
  servicer.orbit = {fsw::Vector3(6838e3, 0.0, 0.0), fsw::Vector3(0.0, 7600.0, 0.0)};
  servicer.attitude.emplace();
  return truth;
}

TEST(RecordedGnss, IsSentAsTheReceiverWouldSendIt) {
  const mission::Mission mission = load_mission(mission_file());
  const mission::Spacecraft& servicer = mission.spacecraft.front();
  const MadeSources made = make_sources(mission, servicer, mission::data_directory(), nullptr);
  const auto gnss = std::ranges::find(made.sources, "servicer/gnss", &twins::NamedSource::name);
  ASSERT_NE(gnss, made.sources.end());
  EXPECT_EQ(gnss->kind, "rinex");
  const auto first = gnss->packets->next_epoch(mission.start_time());
  ASSERT_EQ(first, mission.start_time());
  const twins::Measurement measured = gnss->packets->measure(truth_at(*first));
  EXPECT_EQ(measured.status, twins::MeasurementStatus::kReady);
  fsw::gnss::ReceiverDecoder decoder;
  int epochs = 0, ephemerides = 0;
  for (const twins::Packet& packet : measured.packets) {
    const auto view = fsw::packets::parse_packet(packet);
    if (!view.ok() || view.value().header.apid != fsw::packets::Apid::kGnssBytes) continue;
    const auto message = fsw::packets::decode<vbar::gnss_bytes>(view.value());
    ASSERT_TRUE(message.ok());
    for (std::int32_t n = 0; n < message.value().count; ++n) {
      const auto update = decoder.push(message.value().data[n]);
      if (update == fsw::gnss::ReceiverUpdate::kObservations) ++epochs;
      if (update == fsw::gnss::ReceiverUpdate::kEphemeris) ++ephemerides;
    }
  }
  ASSERT_EQ(epochs, 1);
  // The first epoch of the recording, 10:20: G02, G13, G23, G29, G30 and G31 on two frequencies, each with its set.
  EXPECT_EQ(decoder.observations().receiver_time, *first);
  EXPECT_EQ(ephemerides, 6);
  ASSERT_EQ(decoder.observations().count, 12U);
  EXPECT_EQ(decoder.observations().observations[0].satellite.prn, 2);
  EXPECT_EQ(decoder.observations().observations[11].satellite.prn, 31);
  EXPECT_EQ(decoder.observations().observations[0].signal, fsw::gnss::Signal::kGpsL1);
}

TEST(RecordedGnss, NeedsItsFiles) {
  const auto error = [](const std::string& assignment) -> std::string {
    const std::string overrides[] = {"spacecraft.servicer.sensors.gnss.recording." + assignment};
    try {
      static_cast<void>(load_mission(mission_file(), overrides));
    } catch (const std::exception& what) {
      return what.what();
    }
    return "";
  };
  EXPECT_THAT(error("observations=\"\""), HasSubstr("found nothing; accepted: a RINEX file, as source is rinex"));
  EXPECT_THAT(error("l1=[\"C1\"]"), HasSubstr("accepted: three types: code, carrier phase, signal strength"));
  EXPECT_THAT(error("corrects_code=true"), HasSubstr("two frequencies need no correction"));
}

}  // namespace
}  // namespace vbar::sensors
