// Installs the drivers of testbeds before the first test, as the main function of vbar does (vbar_test_testbeds).

#include "hil_drivers/testbeds.h"

namespace {

[[maybe_unused]] const bool kIsInstalled = [] {
  vbar::testbeds::install(vbar::testbeds::drivers());
  return true;
}();

}  // namespace
