// The flight software under Linux on a Zynq-7000.

#include "boards/posix/flight_main.h"

int main(int argc, char** argv) {
  return vbar::boards::posix::flight_main("Zynq-7000, Linux", argc, argv);
}
