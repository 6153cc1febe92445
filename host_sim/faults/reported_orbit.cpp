#include "host_sim/faults/reported_orbit.h"

#include <algorithm>
#include <utility>

#include "fsw/orbit/roe.h"
#include "fsw/packets/packet.h"

namespace vbar::faults {
namespace {

using fsw::packets::Apid;

fsw::Vector3 vector(const double (&values)[3]) {
  return fsw::Vector3(values);
}

}  // namespace

std::optional<vbar::target_apriori> apriori_of(const vbar::telemetry_navigation& reported) {
  const auto servicer =
      fsw::orbit::qns_from_cartesian({vector(reported.servicer_position_eci), vector(reported.servicer_velocity_eci)});
  if (!servicer.ok()) return std::nullopt;
  fsw::Vector6 sigma_a_roe_m = fsw::Vector6::Zero();
  for (Eigen::Index k = 0; k < 6; ++k) {
    const fsw::Vector6 error = reported.sigma_rtn[k] * fsw::Vector6::Unit(k);
    sigma_a_roe_m += servicer.value().a * fsw::orbit::roe_from_rtn_linear(servicer.value(), error).cwiseAbs();
  }
  vbar::target_apriori apriori{};
  apriori.kind = vbar::target_apriori::kKindRoe;
  std::ranges::copy(reported.a_roe_mean_m, apriori.mean_a_roe_m);
  std::ranges::copy(sigma_a_roe_m, apriori.sigma_a_roe_m);
  return apriori;
}

void ReportedOrbit::take(std::span<const pil::Packet> packets) {
  for (const pil::Packet& packet : packets) {
    const auto view = fsw::packets::parse_packet(packet);
    if (!view.ok() || view.value().header.apid != Apid::kTelemetryNavigation) continue;
    const auto navigation = fsw::packets::decode<vbar::telemetry_navigation>(view.value());
    if (navigation.ok() && navigation.value().valid != 0) last_ = {view.value().header.time, navigation.value()};
  }
}

std::vector<pil::Packet> ReportedOrbit::applied_to(std::vector<pil::Packet> telecommands, fsw::GpsTime now) const {
  if (!last_ || now - last_->time > kOldestReport) return telecommands;
  const auto apriori = apriori_of(last_->navigation);
  if (!apriori) return telecommands;
  for (pil::Packet& packet : telecommands) {
    const auto view = fsw::packets::parse_packet(packet);
    if (!view.ok() || view.value().header.apid != Apid::kTargetApriori) continue;
    fsw::packets::PacketHeader header = view.value().header;
    header.time = last_->time;
    pil::Packet reported(fsw::packets::kMaxPacketBytes);
    const auto size = fsw::packets::encode(header, *apriori, reported);
    if (!size.ok()) continue;  // not finite
    reported.resize(size.value());
    packet = std::move(reported);
  }
  return telecommands;
}

}  // namespace vbar::faults
