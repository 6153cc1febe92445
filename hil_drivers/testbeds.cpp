#include "hil_drivers/testbeds.h"

#include "hil_drivers/external/external_run.h"
#include "hil_drivers/grand/grand_run.h"
#include "hil_drivers/grand/pps/edge_clock.h"

namespace vbar::testbeds {

std::shared_ptr<const mission::TestbedSettings> read_without_driver(const mission::TableReader& section) {
  leave_to_vbar_hil();
  section.refuse("", "a testbed whose driver is not beside this program",
                 "vbar_hil beside it, which cmake --build --preset host makes with the packages of ci/install.sh test "
                 "(libsdl2-dev, libxrandr-dev, libaravis-dev, libusb-1.0-0-dev)");
}

Drivers drivers() {
  Drivers drivers{.testbeds = {&grand::kGrand, &external::kExternal}, .clocks = {&grand::kPpsClock}};
  drivers.testbeds.insert(drivers.testbeds.begin() + 1, optional_testbeds().begin(), optional_testbeds().end());
  return drivers;
}

}  // namespace vbar::testbeds
