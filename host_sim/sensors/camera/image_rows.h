#pragma once
// Telemetry about images as rows of a record.

#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/sensors/camera/camera_rows.h"

namespace vbar::sensors {

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<ObjectRow>& rows);

/// Appends the residuals of an image's bearing in the servicer's orbital plane and across it, in arcseconds, with the
/// standard deviation of the innovation along the residual vector: |prefit| / sqrt(NIS). None for a bearing of the
/// batch.
void append_residuals(const ImageRow& row, std::vector<report::ResidualRow>& rows);

}  // namespace vbar::sensors
