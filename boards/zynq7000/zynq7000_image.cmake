# vbar_zynq7000_image(name [SOURCES ...] LIBRARIES ... [HEAP_TRAPS]): the image <name>.elf for a Zynq-7000 without an
# operating system. newlib's mathematics is not linked, and its allocator is replaced by traps (runtime.cpp). Without
# HEAP_TRAPS not even these may be in the image: no code in it can ask for memory. A foreign test article may need the
# option, for a virtual destructor refers to delete.
#
# Used by this project's build and by its installed package, which set
#   VBAR_ZYNQ7000_FOLDER      of zynq7000.ld and check_image.cmake
#   VBAR_ZYNQ7000_OUTPUT      of the images
#   VBAR_ZYNQ7000_OBJECTS     start-up code and interrupt vectors, which nothing refers to by name
#   VBAR_ZYNQ7000_LIBRARIES   of the board

string(REGEX REPLACE "gcc$" "nm" vbar_nm_default ${CMAKE_C_COMPILER})
set(VBAR_NM ${vbar_nm_default} CACHE STRING "nm of the cross compiler")

function(vbar_zynq7000_image name)
  cmake_parse_arguments(ARG "HEAP_TRAPS" "" "SOURCES;LIBRARIES" ${ARGN})
  set(script ${VBAR_ZYNQ7000_FOLDER}/zynq7000.ld)
  set(check ${VBAR_ZYNQ7000_FOLDER}/check_image.cmake)
  add_executable(${name} ${ARG_SOURCES} ${VBAR_ZYNQ7000_OBJECTS})
  set_target_properties(${name} PROPERTIES
    SUFFIX .elf RUNTIME_OUTPUT_DIRECTORY ${VBAR_ZYNQ7000_OUTPUT} LINKER_LANGUAGE CXX LINK_DEPENDS "${script};${check}")
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} ${VBAR_ZYNQ7000_LIBRARIES})
  target_link_options(${name} PRIVATE
    -T${script} -nostdlib -Wl,--fatal-warnings -Wl,--no-warn-execstack -Wl,-Map=${VBAR_ZYNQ7000_OUTPUT}/${name}.map)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -DNM=${VBAR_NM} -DIMAGE=$<TARGET_FILE:${name}> -DHEAP_TRAPS=${ARG_HEAP_TRAPS} -P ${check} VERBATIM)
endfunction()
