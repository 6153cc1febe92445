target_sources(vbar_bench PRIVATE link_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_pil_bridge)
target_compile_definitions(vbar_bench PRIVATE VBAR_BINARY_DIR="${PROJECT_BINARY_DIR}")
add_dependencies(vbar_bench vbar_flight_echo vbar_echo_article_shared)
