target_sources(vbar_bench PRIVATE network_bench.cpp)
target_link_libraries(vbar_bench PRIVATE vbar_fsw_network)
find_package(OpenCV QUIET COMPONENTS core dnn)
if(OpenCV_FOUND)
  set_source_files_properties(network_bench.cpp PROPERTIES
    COMPILE_DEFINITIONS VBAR_HAVE_OPENCV INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIRS}")
  target_link_libraries(vbar_bench PRIVATE opencv_core opencv_dnn)
endif()
