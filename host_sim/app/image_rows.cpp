#include "host_sim/app/image_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vbar::app {
namespace {

constexpr double kArcsecond = M_PI / 648000.0;

report::Pair in_arcsec(const double (&angles)[2]) {
  return {angles[0] / kArcsecond, angles[1] / kArcsecond};
}

}  // namespace

report::ImageRow image_row(double exposure_s, double step_s, const telemetry_image& m) {
  report::ImageRow row;
  row.time_s = exposure_s;
  row.step_time_s = step_s;
  row.step = m.step;
  row.image = m.image;
  row.status = m.status;
  row.star_method = m.star_method;
  row.tiles_missing = m.tiles_missing;
  row.objects = m.objects;
  row.stars = m.stars;
  row.hypotheses = m.hypotheses;
  row.target_object = m.target_object;
  row.background_dn = m.background_dn;
  row.noise_dn = m.noise_dn;
  std::ranges::copy(m.q_eci_camera, row.q_eci_camera.begin());
  row.attitude_sigma_arcsec = m.attitude_sigma / kArcsecond;
  std::ranges::copy(m.bearing_eci, row.bearing_eci.begin());
  row.bearing_sigma_arcsec = m.bearing_sigma / kArcsecond;
  row.prefit_arcsec = in_arcsec(m.prefit);
  row.postfit_arcsec = in_arcsec(m.postfit);
  row.nis = m.nis;
  row.used = m.fate >= 2 ? m.fate - 1 : 0;  // none and refused are alike here
  std::ranges::copy(m.covariance_a_roe, row.covariance_a_roe_m2.begin());
  std::ranges::copy(m.a_roe_osculating_m, row.a_roe_osculating_m.begin());
  row.bearings_used = m.bearings_used;
  row.bearings_refused = m.bearings_refused;
  row.images_without_stars = m.images_without_stars;
  row.tiles_refused = m.tiles_refused;
  return row;
}

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<report::ObjectRow>& rows) {
  const int count = std::min<int>(objects.count, static_cast<int>(std::size(objects.kind)));
  for (int k = 0; k < count; ++k)
    rows.push_back({exposure_s, objects.image, k, objects.kind[k], objects.star[k], objects.x_px[k], objects.y_px[k]});
}

void append_residuals(const report::ImageRow& row, std::vector<report::ResidualRow>& rows) {
  const auto& [x, y] = row.prefit_arcsec;
  if (!(row.nis > 0.0)) return;  // the filter did not run
  const double sigma_arcsec = std::hypot(x, y) / std::sqrt(row.nis);
  const char* const sensors[] = {"bearing_in_plane_arcsec", "bearing_cross_plane_arcsec"};
  for (const std::size_t axis : {0U, 1U})
    rows.push_back({row.time_s, sensors[axis], row.prefit_arcsec[axis], row.postfit_arcsec[axis], sigma_arcsec});
}

}  // namespace vbar::app
