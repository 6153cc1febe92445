#include "hil_drivers/grand/grand_kind.h"

#include "hil_drivers/grand/grand_bench.h"
#include "hil_drivers/grand/grand_report.h"

namespace vbar::grand {
namespace {

std::optional<engine::ClockMode> clock_mode(const mission::TestbedSettings& settings) {
  return dynamic_cast<const GrandSettings&>(settings).pace == Pace::kRealTime ? engine::ClockMode::kRealTime
                                                                              : engine::ClockMode::kLockStep;
}

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<GrandBench>(dynamic_cast<const GrandSettings&>(settings), context);
}

}  // namespace

const testbeds::TestbedKind kGrand{{"grand", read_grand, clock_mode}, open, {tables, summarise, sections}};

}  // namespace vbar::grand
