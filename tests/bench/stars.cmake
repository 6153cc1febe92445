target_sources(vbar_bench PRIVATE stars_bench.cpp ${PROJECT_SOURCE_DIR}/tests/support/star_sky.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_fsw_stars erfa)
