# Loads an image through a debug server (OpenOCD, Xilinx' hw_server, an emulator), compares what arrived, and starts it:
#
#   gdb-multiarch -batch -ex "target extended-remote localhost:3333" -x boards/zynq7000/jtag.gdb build/zynq/vbar_zynq7000.elf
#
# A loader must have set up clocks and DDR. A section that differs is printed as MIS-MATCHED: DDR that was not set up, mostly.
set confirm off
set pagination off
load
compare-sections
# Supervisor mode, ARM state, interrupts masked: a loader that was stopped may have been in any. `load` has set the pc to the entry.
set $cpsr = 0x1d3
info registers pc
detach
