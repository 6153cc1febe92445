#include "hil_drivers/grand/bench/samples/gnss_sdr/configuration.h"

#include <fmt/format.h>

namespace vbar::grand::bench {
namespace {

// Search: +-45 kHz of Doppler in steps of 500 Hz. Tracking: third order, 35 Hz on 1 ms until bits are synchronised,
// then 15 Hz on 10 ms. Position: ranges are used as they are, from satellites at every elevation.
constexpr const char* kConstant = R"(SignalConditioner.implementation=Pass_Through
Channels.in_acquisition=1
Channel.signal=1C
Acquisition_1C.implementation=GPS_L1_CA_PCPS_Acquisition
Acquisition_1C.item_type=gr_complex
Acquisition_1C.coherent_integration_time_ms=1
Acquisition_1C.pfa=0.01
Acquisition_1C.doppler_max=45000
Acquisition_1C.doppler_step=500
Acquisition_1C.blocking=true
Acquisition_1C.max_dwells=2
Tracking_1C.implementation=GPS_L1_CA_DLL_PLL_Tracking
Tracking_1C.item_type=gr_complex
Tracking_1C.order=3
Tracking_1C.pll_bw_hz=35
Tracking_1C.dll_bw_hz=2
Tracking_1C.extend_correlation_symbols=10
Tracking_1C.pll_bw_narrow_hz=15
Tracking_1C.dll_bw_narrow_hz=0.5
Tracking_1C.carrier_aiding=true
TelemetryDecoder_1C.implementation=GPS_L1_CA_Telemetry_Decoder
Observables.implementation=Hybrid_Observables
PVT.implementation=RTKLIB_PVT
PVT.positioning_mode=Single
PVT.output_rate_ms=1000
PVT.display_rate_ms=10000
PVT.rinexobs_rate_ms=1000
PVT.rinex_version=3
PVT.iono_model=OFF
PVT.trop_model=OFF
PVT.elevation_mask=0
PVT.gpx_output_enabled=false
PVT.kml_output_enabled=false
PVT.geojson_output_enabled=false
PVT.xml_output_enabled=false
PVT.nmea_output_file_enabled=false
PVT.rtcm_output_file_enabled=false
)";

}  // namespace

std::string text_of(const GnssSdrConfiguration& configuration) {
  std::string text = "[GNSS-SDR]\n";
  text += fmt::format("GNSS-SDR.internal_fs_sps={}\n", configuration.rate_hz);
  text += fmt::format("GNSS-SDR.observable_interval_ms={}\n", configuration.observable_interval_ms);
  text += "SignalSource.implementation=Fifo_Signal_Source\nSignalSource.sample_type=ibyte\n";
  text += fmt::format("SignalSource.filename={}\n", configuration.samples.string());
  text += fmt::format("Channels_1C.count={}\n", configuration.channels);
  text += kConstant;
  text += fmt::format("PVT.output_path={}\nPVT.rinex_output_enabled={}\n", configuration.output.string(),
                      configuration.rinex);
  if (configuration.monitor_port != 0)
    text += fmt::format(
        "Monitor.enable_monitor=true\nMonitor.decimation_factor=1\nMonitor.client_addresses=127.0.0.1\n"
        "Monitor.udp_port={}\n",
        configuration.monitor_port);
  if (configuration.navigation_port != 0)
    text += fmt::format(
        "NavDataMonitor.enable_monitor=true\nNavDataMonitor.client_addresses=127.0.0.1\nNavDataMonitor.port={}\n",
        configuration.navigation_port);
  return text;
}

}  // namespace vbar::grand::bench
