# Libraries that a build on this computer can be without. What needs one is left out then, and a message names the packages.

set(VBAR_OPTIONAL_LIBRARIES "")

# vbar_optional_library(name FOR ... PACKAGES ... FIND ...): FIND is a list of packages that must all be there, each with its
# arguments of find_package as one text; "PKG_CONFIG module" is a module of pkg-config. Sets VBAR_HAS_<name>.
# VBAR_WITH_<name>=OFF builds as if the library were not installed. A macro, as the variables of find_package belong to all
# folders.
macro(vbar_optional_library name)
  cmake_parse_arguments(optional "" "FOR" "PACKAGES;FIND" ${ARGN})
  list(APPEND VBAR_OPTIONAL_LIBRARIES ${name})
  option(VBAR_WITH_${name} "${optional_FOR}, where its library is installed" ON)
  set(VBAR_HAS_${name} ${VBAR_WITH_${name}})
  foreach(optional_find IN LISTS optional_FIND)
    if(VBAR_HAS_${name})
      separate_arguments(optional_find)
      list(POP_FRONT optional_find optional_package)
      if(optional_package STREQUAL "PKG_CONFIG")
        set(optional_package ${name})
        find_package(PkgConfig QUIET)
        if(PkgConfig_FOUND)
          pkg_check_modules(${name} QUIET IMPORTED_TARGET ${optional_find})
        endif()
      else()
        find_package(${optional_package} QUIET ${optional_find})
      endif()
      set(VBAR_HAS_${name} ${${optional_package}_FOUND})
    endif()
  endforeach()
  if(NOT VBAR_HAS_${name})
    list(JOIN optional_PACKAGES ", " optional_packages)
    message(STATUS "without ${optional_FOR} (${name}: ${optional_packages})")
  endif()
endmacro()

vbar_optional_library(SDL2 FOR "the display of the Optical Stimulator" PACKAGES libsdl2-dev libx11-dev libxrandr-dev
                      FIND "SDL2 CONFIG" "X11 COMPONENTS Xrandr")
vbar_optional_library(Aravis FOR "GigE Vision cameras" PACKAGES libaravis-dev libusb-1.0-0-dev FIND "PKG_CONFIG aravis-0.8")
vbar_optional_library(Ceres FOR "calibration of the Optical Stimulator and of TRON" PACKAGES libceres-dev FIND "Ceres")
vbar_optional_library(OpenCV FOR "calibration of TRON by images" PACKAGES libopencv-contrib-dev
                      FIND "OpenCV COMPONENTS core imgproc calib3d aruco")
