target_sources(vbar_bench PRIVATE pose_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_fsw_pose)
