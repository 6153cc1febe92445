target_sources(vbar_bench PRIVATE link_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_pil_bridge)
