// The flight software as a process of its own on this computer.

#include "boards/posix/flight_main.h"

int main(int argc, char** argv) {
  return vbar::boards::posix::flight_main("host process", argc, argv);
}
