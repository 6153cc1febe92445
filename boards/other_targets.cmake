# The flight software of vbar for other targets than Tango: the same code with the weights of data/networks/<target>_keypoints.bin in place
# of Tango's. On this computer the library libvbar_gnc_<target>.so (flight_computer.library = "vbar_gnc_<target>"), for the Zynq the image
# vbar_zynq7000_<target>.elf (flight_computer.image).
file(GLOB networks CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/data/networks/*_keypoints.bin)
foreach(weights ${networks})
  get_filename_component(target ${weights} NAME)
  string(REPLACE "_keypoints.bin" "" target ${target})
  if(target STREQUAL "tango")
    continue()
  endif()
  # An object of the program itself comes before the one of vbar_fsw_vision_pose, which the linker then does not take.
  set(own ${CMAKE_CURRENT_BINARY_DIR}/${target}_weights.S)
  configure_file(${PROJECT_SOURCE_DIR}/fsw/vision/pose/on_board_weights.S ${own} COPYONLY)
  set_source_files_properties(${own} PROPERTIES OBJECT_DEPENDS ${weights} COMPILE_DEFINITIONS VBAR_KEYPOINT_WEIGHTS="${weights}")
  if(VBAR_TARGET STREQUAL "host")
    add_library(vbar_gnc_${target} SHARED ${own})
    target_link_libraries(vbar_gnc_${target} PRIVATE vbar_options vbar_fsw_gnc)
    # The interface of vbar_gnc.h, to which nothing in the library refers; and its own symbols before those of the program.
    target_link_options(vbar_gnc_${target} PRIVATE -Wl,-u,vbar_gnc_step -Wl,-Bsymbolic)
    set_property(GLOBAL APPEND PROPERTY VBAR_GNC_OF_OTHER_TARGETS vbar_gnc_${target})
    set_target_properties(vbar_gnc_${target} PROPERTIES LINKER_LANGUAGE CXX LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  elseif(VBAR_TARGET STREQUAL "zynq7000")
    vbar_zynq7000_image(vbar_zynq7000_${target} SOURCES ${own} LIBRARIES vbar_zynq7000_main vbar_fsw_gnc)
  endif()
endforeach()
