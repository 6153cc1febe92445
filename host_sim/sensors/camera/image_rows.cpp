#include "host_sim/sensors/camera/image_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fsw/math/math.h"

namespace vbar::sensors {
namespace {

using fsw::math::kArcsecond;

}  // namespace

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<ObjectRow>& rows) {
  const int count = std::min<int>(objects.count, static_cast<int>(std::size(objects.kind)));
  for (int k = 0; k < count; ++k)
    rows.push_back({exposure_s, objects.image, k, objects.kind[k], objects.star[k], objects.x_px[k], objects.y_px[k]});
}

void append_residuals(const ImageRow& row, std::vector<report::ResidualRow>& rows) {
  if (!(row.nis > 0.0)) return;  // the filter did not run
  const double sigma_arcsec = std::hypot(row.prefit[0], row.prefit[1]) / std::sqrt(row.nis) / kArcsecond;
  const char* const sensors[] = {"bearing_in_plane_arcsec", "bearing_cross_plane_arcsec"};
  for (const std::size_t axis : {0U, 1U})
    rows.push_back(
        {row.time_s, sensors[axis], row.prefit[axis] / kArcsecond, row.postfit[axis] / kArcsecond, sigma_arcsec});
}

}  // namespace vbar::sensors
