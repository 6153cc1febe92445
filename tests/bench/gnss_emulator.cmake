target_sources(vbar_bench PRIVATE gnss_emulator_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_host_gnss)
target_compile_definitions(vbar_bench PRIVATE VBAR_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
