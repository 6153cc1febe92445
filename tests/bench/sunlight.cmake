target_sources(vbar_bench PRIVATE sunlight_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_host_truth erfa)
