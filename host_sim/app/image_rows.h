#pragma once
// Telemetry about images as rows of a record.

#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/report/run_record.h"

namespace vbar::app {

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<report::ObjectRow>& rows);

/// The residuals of an image's bearing, an axis of the camera each, in arcseconds.
void append_residuals(const report::ImageRow& row, std::vector<report::ResidualRow>& rows);

}  // namespace vbar::app
