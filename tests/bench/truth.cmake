find_library(VBAR_GEOGRAPHICLIB GeographicLib REQUIRED)
target_sources(vbar_bench PRIVATE truth_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_host_truth ${VBAR_GEOGRAPHICLIB})
