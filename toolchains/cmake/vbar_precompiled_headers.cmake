# Precompiled headers. Most of the time of a build goes into reading the headers of Eigen, googletest and the standard
# library, so flight libraries, host libraries and tests have one precompiled header each, of such headers only. A source
# still includes all that it uses: the build for Linux on the Zynq is without precompiled headers (VBAR_PRECOMPILE=OFF).
option(VBAR_PRECOMPILE "precompiled headers" ON)
set(CMAKE_PCH_WARN_INVALID ON)  # with -Werror: a target whose options prevent the use of its precompiled header is an error

# ccache's manual asks for these of a compiler that uses a precompiled header.
set(VBAR_PRECOMPILE_OPTIONS
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess> "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")

# vbar_precompile(name HEADERS): the target owns a precompiled header. No two files that GCC makes of the same headers are
# equal, so ccache goes by the preprocessed headers (without their paths), whose checksum is written beside the file.
function(vbar_precompile name)
  if(NOT VBAR_PRECOMPILE)
    return()
  endif()
  set_target_properties(${name} PROPERTIES VBAR_PRECOMPILED ON)
  target_compile_options(${name} PRIVATE ${VBAR_PRECOMPILE_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${PROJECT_SOURCE_DIR}/fsw/core/eigen_assert.h ${ARGN})

  set(folder ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${name}.dir)
  list(JOIN ARGN "\n#include " includes)
  file(CONFIGURE OUTPUT ${folder}/headers.cpp CONTENT "#include ${includes}\n")
  separate_arguments(flags UNIX_COMMAND "${CMAKE_CXX_FLAGS}")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} -std=c++20 -isystem ${VBAR_EIGEN_INCLUDE} -E -P ${folder}/headers.cpp
                  OUTPUT_VARIABLE preprocessed COMMAND_ERROR_IS_FATAL ANY)
  string(SHA256 checksum "${preprocessed}")
  foreach(suffix gch pch)
    file(CONFIGURE OUTPUT ${folder}/cmake_pch.hxx.${suffix}.sum CONTENT "${checksum}\n")
  endforeach()
endfunction()

# vbar_use_precompiled(name owner): the target takes the owner's precompiled header.
function(vbar_use_precompiled name owner)
  if(VBAR_PRECOMPILE)
    set_target_properties(${name} PROPERTIES VBAR_PRECOMPILED ON)
    target_compile_options(${name} PRIVATE ${VBAR_PRECOMPILE_OPTIONS})
    target_precompile_headers(${name} REUSE_FROM ${owner})
  endif()
endfunction()

# vbar_without_precompiled(name): for a target whose libraries bring options that the owner lacks.
function(vbar_without_precompiled name)
  set_target_properties(${name} PROPERTIES VBAR_PRECOMPILED OFF DISABLE_PRECOMPILE_HEADERS ON)
endfunction()

# vbar_precompiled_library(name OPTIONS HEADERS): an owner for all libraries with these options. An owner has a source.
function(vbar_precompiled_library name options)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${name}.cpp CONTENT "// Without code: see vbar_precompiled_headers.cmake.\n")
  add_library(${name} STATIC ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE ${options})
  vbar_precompile(${name} ${ARGN})
endfunction()

if(VBAR_PRECOMPILE)
  vbar_precompiled_library(vbar_flight_precompiled vbar_flight_options
    <Eigen/Dense> <algorithm> <array> <cmath> <cstddef> <cstdint> <optional> <span> <tuple> <utility>)
  if(VBAR_TARGET STREQUAL "host")
    set_target_properties(vbar_flight_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
    vbar_precompiled_library(vbar_host_precompiled vbar_host_options
      <Eigen/Dense> <fmt/format.h> <fmt/ranges.h> <algorithm> <array> <charconv> <chrono> <cmath> <cstdint> <filesystem>
      <fstream> <functional> <map> <memory> <numbers> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view>
      <system_error> <utility> <variant> <vector>)
  endif()
endif()
