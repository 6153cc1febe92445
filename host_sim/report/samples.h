#pragma once
// Consistency of navigation over a run and at selected times, for campaigns.

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Dimension of the NEES, mean NIS and its dimension, and the samples at the times that `summary.samples` names: of the
/// estimates and of the figures that the extensions give. A sample without an estimate at its time has no errors; the
/// consistency figures of a sample are the last ones after the previous sample, so that no figure serves two samples.
void summarise_consistency(const RunRecord& record, Summary& summary);

}  // namespace vbar::report
