target_sources(vbar_bench PRIVATE grand_wire_bench.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/hil_drivers/grand/generators/loopback.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_hil_grand_bench_control vbar_hil_grand_generators vbar_hil_grand_trajectory)
