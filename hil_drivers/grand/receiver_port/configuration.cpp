#include "hil_drivers/grand/receiver_port/configuration.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <fmt/format.h>

#include "host_sim/truth/earth/geodetic.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand {
namespace {

// RANGE first and TIME last: a burst is complete with its TIME log.
void add_logs(const std::string& port, const ReceiverConfiguration& configuration, std::vector<std::string>& commands) {
  const auto periodic = [&](const char* log) {
    commands.push_back(
        fmt::format("LOG {} {} ONTIME {:g} {:g}", port, log, configuration.period_s, configuration.log_offset_s));
  };
  periodic("RANGEB");
  for (const char* const log : {"RAWEPHEMB", "GALEPHEMERISB", "BDSEPHEMERISB", "IONUTCB"})
    commands.push_back(fmt::format("LOG {} {} ONCHANGED", port, log));
  periodic("BESTXYZB");
  periodic("TIMEB");
}

}  // namespace

std::vector<unsigned> rates_to_ask(unsigned configured) {
  constexpr std::array<unsigned, 9> kFactoryFirst{9600, 115200, 230400, 460800, 57600, 38400, 19200, 4800, 2400};
  std::vector<unsigned> rates{configured};
  for (const unsigned rate : kFactoryFirst)
    if (rate != configured) rates.push_back(rate);
  return rates;
}

std::string rate_command(unsigned baud) {
  return fmt::format("SERIALCONFIG THISPORT {} N 8 1 N ON", baud);
}

std::vector<std::string> configuration_commands(const ReceiverConfiguration& configuration) {
  std::vector<std::string> commands{"UNLOGALL THISPORT TRUE"};
  if (configuration.start != twins::gnss::StartMode::kCold) {
    const auto time = twins::gnss::week_time(twins::gnss::System::kGps, configuration.approximate_time);
    commands.push_back(fmt::format("SETAPPROXTIME {} {:.3f}", time.week, time.seconds_of_week()));
    const truth::GeodeticPosition at = truth::geodetic_from_itrf(configuration.approximate_position_ecef_m);
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    commands.push_back(
        fmt::format("SETAPPROXPOS {:.6f} {:.6f} {:.1f}", kDegrees * at.latitude, kDegrees * at.longitude, at.altitude));
  }
  commands.push_back(configuration.clock_adjust ? "CLOCKADJUST ENABLE" : "CLOCKADJUST DISABLE");
  if (!configuration.board_port.empty()) {
    commands.push_back("UNLOGALL " + configuration.board_port + " TRUE");
    add_logs(configuration.board_port, configuration, commands);
  }
  add_logs("THISPORT", configuration, commands);
  return commands;
}

}  // namespace vbar::grand
