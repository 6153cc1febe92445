# How a library, a program and a test of this project are declared, and the compiler flags they get.
#
# One rule stands behind the flags: flight code must give the same bits on every target, and in_process runs link flight
# and host code into one program. Both therefore share everything that can change a bit or an inline function of Eigen:
# no contraction of a*b+c, no vectorised Eigen.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(VBAR_SANITIZE "" CACHE STRING "sanitizers, e.g. address,undefined")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g1")
set(CMAKE_C_FLAGS_RELEASE "-O2 -g1")

# Paths are hashed relative to the checkout, so that all checkouts on a computer share one cache. Precompiled headers need
# the sloppiness that ccache's manual names for them (section "Precompiled headers").
find_program(VBAR_CCACHE ccache)
if(VBAR_CCACHE)
  set(ccache env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${VBAR_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${ccache})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${ccache})
endif()

# LLVM's linker, where it is installed, needs a third of the time of GNU's for each of the many test programs.
find_program(VBAR_LLD ld.lld)
if(VBAR_LLD AND VBAR_TARGET STREQUAL "host")
  add_link_options(-fuse-ld=lld)
endif()

find_path(VBAR_EIGEN_INCLUDE Eigen/Core PATHS /usr/include/eigen3 NO_CMAKE_FIND_ROOT_PATH REQUIRED)

# Flags of all code of the project. A target with a precompiled header has eigen_assert.h as its first header instead: GCC
# takes a precompiled header as the first file of a source only.
add_library(vbar_options INTERFACE)
target_include_directories(vbar_options INTERFACE ${PROJECT_SOURCE_DIR})
target_include_directories(vbar_options SYSTEM INTERFACE ${VBAR_EIGEN_INCLUDE})
target_compile_definitions(vbar_options INTERFACE EIGEN_MPL2_ONLY EIGEN_DONT_VECTORIZE EIGEN_DONT_PARALLELIZE)
target_compile_options(vbar_options INTERFACE
  "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<BOOL:$<TARGET_PROPERTY:VBAR_PRECOMPILED>>>>:SHELL:-include ${PROJECT_SOURCE_DIR}/fsw/core/eigen_assert.h>"
  -ffp-contract=off -fno-math-errno
  -Wall -Wextra -Wpedantic $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow> -Wcast-align -Wformat=2 -Wimplicit-fallthrough -Werror
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual>)
if(VBAR_SANITIZE)
  target_compile_options(vbar_options INTERFACE -fsanitize=${VBAR_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(vbar_options INTERFACE -fsanitize=${VBAR_SANITIZE})
endif()

# Flight code besides: no exceptions, no run-time types, no implicit conversion that can lose a value.
add_library(vbar_flight_options INTERFACE)
target_link_libraries(vbar_flight_options INTERFACE vbar_options)
target_compile_options(vbar_flight_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti>
  -Wconversion -Wsign-conversion -Wdouble-promotion -Wundef -Wswitch-enum)

# Host code has the options that a shared precompiled header needs to be equal.
if(VBAR_TARGET STREQUAL "host")
  find_package(fmt REQUIRED)
  add_library(vbar_host_options INTERFACE)
  target_link_libraries(vbar_host_options INTERFACE vbar_options fmt::fmt)
  include(vbar_host_packages)
  include(vbar_optional_libraries)
endif()

include(vbar_precompiled_headers)
include(vbar_unity)

# vbar_target_of(result folder): the target of a module is named after its folder: fsw/gnss is vbar_fsw_gnss. Other names stay.
function(vbar_target_of result)
  set(targets "")
  foreach(name IN LISTS ARGN)
    if(name MATCHES "^(fsw|boards|pil_bridge|host_sim|hil_drivers|emulators)(/|$)")
      string(REPLACE "/" "_" name "vbar_${name}")
    endif()
    list(APPEND targets ${name})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# vbar_flight_library(name SOURCES source... DEPENDS name...), vbar_host_library(...): a static library with the flags of flight
# code, or of host code. DEPENDS: modules by their folders, other targets by their names.
function(vbar_flight_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  vbar_target_of(depends ${ARG_DEPENDS})
  add_library(${name} STATIC ${ARG_SOURCES})
  if(NOT VBAR_TARGET STREQUAL "zynq7000")
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)  # a shared library may be made of it
  endif()
  target_link_libraries(${name} PRIVATE vbar_flight_options PUBLIC ${depends})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  vbar_use_precompiled(${name} vbar_flight_precompiled)
endfunction()
function(vbar_host_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  vbar_target_of(depends ${ARG_DEPENDS})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC vbar_host_options ${depends})
  vbar_use_precompiled(${name} vbar_host_precompiled)
  vbar_unity(${name} ${ARG_SOURCES})
endfunction()

# vbar_module(folder [EXCEPT path...] [SOURCES source...] [DEPENDS name...]): the library of a folder (path from the top of
# the project): of the .cpp in it and below it, but for files and subfolders EXCEPT (relative to it), and of generated or
# other SOURCES. Without any it has headers only. Modules of fsw and boards are flight code, all others host code. The set of
# flight code common to all targets (fsw and boards/common) is in the global property VBAR_FLIGHT_LIBRARIES, which the
# target flight_code and the flight rules go by.
function(vbar_module folder)
  cmake_parse_arguments(ARG "" "" "EXCEPT;SOURCES;DEPENDS" ${ARGN})
  vbar_target_of(name ${folder})
  set(place ${PROJECT_SOURCE_DIR}/${folder})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${place}/*.cpp)
  foreach(except IN LISTS ARG_EXCEPT)
    list(FILTER sources EXCLUDE REGEX "^${place}/${except}(/|$)")
  endforeach()
  list(APPEND sources ${ARG_SOURCES})
  if(NOT sources)
    vbar_target_of(depends ${ARG_DEPENDS})
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ${depends})
    target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR})
  elseif(folder MATCHES "^(fsw|boards)/")
    vbar_flight_library(${name} SOURCES ${sources} DEPENDS ${ARG_DEPENDS})
    if(folder MATCHES "^(fsw/|boards/common$)")
      set_property(GLOBAL APPEND PROPERTY VBAR_FLIGHT_LIBRARIES ${name})
    endif()
  else()
    vbar_host_library(${name} SOURCES ${sources} DEPENDS ${ARG_DEPENDS})
  endif()
endfunction()

# vbar_program(name SOURCES source... DEPENDS name...): a program of host code in the top of the build folder.
function(vbar_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  vbar_target_of(depends ${ARG_DEPENDS})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE vbar_options ${depends})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
endfunction()

# vbar_test(name ROOMS folder... [EXCEPT file...] [SOURCES source...] [DEPENDS name...] [LABELS ...]): a googletest program of the
# *_test.cpp in the folders (below tests/; not of those below them), one ctest entry a test case (with a sanitizer: four for the program).
# Without LABELS it is a unit test. Its folders are labels as well (ctest -L '^fsw/gnss$' for tests/unit/fsw/gnss), and
# unit_test_modules.txt lists them for ci/quick.sh. EXCEPT and SOURCES are below tests/ too.
function(vbar_test name)
  cmake_parse_arguments(ARG "" "" "ROOMS;EXCEPT;SOURCES;DEPENDS;LABELS" ${ARGN})
  set(tests ${PROJECT_SOURCE_DIR}/tests)
  set(modules ${ARG_ROOMS})
  list(TRANSFORM modules REPLACE "^unit/" "")
  set(sources "")
  foreach(room IN LISTS ARG_ROOMS)
    file(GLOB files CONFIGURE_DEPENDS ${tests}/${room}/*_test.cpp)
    list(APPEND sources ${files})
  endforeach()
  list(TRANSFORM ARG_EXCEPT PREPEND ${tests}/)
  if(ARG_EXCEPT)
    list(REMOVE_ITEM sources ${ARG_EXCEPT})
  endif()
  list(TRANSFORM ARG_SOURCES REPLACE "^([^/].*)" "${tests}/\\1")
  vbar_target_of(depends ${ARG_DEPENDS})
  add_executable(${name} ${sources} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE vbar_options vbar_test_support ${depends} GTest::gtest_main GTest::gmock)
  target_compile_options(${name} PRIVATE ${VBAR_TEST_OPTIONS})
  vbar_use_precompiled(${name} vbar_test_support)
  vbar_unity(${name} ${sources})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
    add_dependencies(unit_tests ${name})
    foreach(module IN LISTS modules)
      set_property(GLOBAL APPEND PROPERTY VBAR_UNIT_TEST_MODULES "${module} ${name}")
    endforeach()
  endif()
  list(APPEND ARG_LABELS ${modules})
  if(VBAR_SANITIZE)
    # A sanitized program takes longer to start than most test cases to run: four entries for all of them, which share the
    # processors better than one.
    foreach(shard RANGE 3)
      add_test(NAME ${name}.${shard} COMMAND ${name} --gtest_brief=1)
      set_tests_properties(${name}.${shard} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 1800
        ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/toolchains/leaks.supp;GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=${shard}")
    endforeach()
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
  # A property of a discovered test cannot be a list, so ctest sets the labels when it reads the tests.
  set(labels_file ${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake)
  file(WRITE ${labels_file} "foreach(test IN LISTS ${name}_TESTS)
  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${ARG_LABELS}\")
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${labels_file})
endfunction()

# vbar_add_rooms(): every folder below this one that has a CMakeLists.txt.
function(vbar_add_rooms)
  file(GLOB rooms RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS */CMakeLists.txt)
  foreach(room ${rooms})
    get_filename_component(room ${room} DIRECTORY)
    add_subdirectory(${room})
  endforeach()
endfunction()
