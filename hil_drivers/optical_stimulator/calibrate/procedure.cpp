#include "hil_drivers/optical_stimulator/calibrate/procedure.h"

#include <utility>

namespace vbar::optical_stimulator::calibrate {

ProcedureResult calibrate(const Bench& bench, const ProcedureSettings& settings, Session::Progress progress) {
  Session session(bench, settings, std::move(progress));
  Validity& validity = session.result.validity;
  validity.display_width_px = bench.screen.width();
  validity.display_height_px = bench.screen.height();
  validity.region = settings.camera.region;
  validity.exposure_s = settings.camera.exposure_s;
  bench.rails.home();
  bench.rails.move_to(settings.lens_mm, settings.display_mm);
  measure_noise(session);
  find_display(session);
  focus(session);
  find_display(session);  // the scale has changed with the focus
  measure_gain(session);
  measure_light(session);
  measure_geometry(session);
  bench.screen.show(Picture(bench.screen.width(), bench.screen.height()));
  return {session.result, session.residuals};
}

}  // namespace vbar::optical_stimulator::calibrate
