// vbar propagate: a mission file, its truth alone, an ephemeris of every spacecraft.

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/propagation.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/propagation_folder.h"
#include "host_sim/report/propagation_summary.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {
namespace {

/// Returns the time of this computer's clock, to a second.
fsw::GpsTime now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return truth::gps_from_utc(fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", utc));
}

}  // namespace

int propagate_command(const PropagateOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  if (mission.truth_source != mission::kTruthModel)
    throw Refused(fmt::format("truth.source: found \"{}\"; accepted: model, which is what vbar propagate propagates",
                              mission.truth_source));
  Propagation propagation = [&] {
    try {
      return Propagation(mission, mission::data_directory());
    } catch (const std::exception& error) {
      throw Refused(error.what());  // nothing is written yet
    }
  }();
  report::PropagationFolder folder(options.out.empty() ? report::default_propagation_folder(mission.name) : options.out,
                                   mission.name);
  const report::OemFile::Span span{mission.start_time(), mission.end_time(), propagation.sampling_times().size(),
                                   now()};
  folder.start_files(propagation.names(), options.oem ? &span : nullptr);
  catch_stop_signals();

  report::PropagationRecord record;
  {
    ProgressLine progress(mission.duration, options.quiet);
    record = propagation.run([&](std::size_t k, const report::EphemerisRow& row) { folder.append(k, row); },
                             [&](fsw::Duration simulated) { progress.update(simulated); }, stop_requested);
  }
  folder.finish(record);
  if (!options.quiet) fmt::print("{}ephemeris  {}\n", report::propagation_table(record), folder.path().string());
  if (record.complete) return kDone;
  fmt::print(stderr, "vbar: {}: propagation incomplete: {}\n", folder.path().string(), record.incomplete_reason);
  return record.incomplete_reason == Propagation::kInterruption ? kInterrupted : kFailed;
}

}  // namespace vbar::app
