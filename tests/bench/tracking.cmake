target_sources(vbar_bench PRIVATE tracking_bench.cpp ${PROJECT_SOURCE_DIR}/tests/unit/fsw/tracking/scene.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_fsw_tracking vbar_host_truth vbar_host_engine)
