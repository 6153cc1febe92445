# What `cmake --install` installs: of the host build the programs, data, missions and the package for test articles; of the
# build for the bare Zynq the flight image and the board's libraries, into the same prefix.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Not CMAKE_INSTALL_LIBDIR, which some prefixes have below a name of the architecture: vbar finds images relative to itself.
set(package lib/cmake/vbar)
set(board lib/vbar/zynq7000)

if(VBAR_TARGET STREQUAL "host")
  foreach(program vbar vbar_hil vbar_flight vbar_fit_ephemerides vbar_flown_receiver vbar_grand_bench vbar_os_bench vbar_os_calibrate vbar_tron vbar_tron_bench)
    if(TARGET ${program})  # or a library that it needs is not there
      install(TARGETS ${program} RUNTIME)
    endif()
  endforeach()
  # Completion by bash and zsh. Debian's zsh looks into vendor-completions for /usr, others into site-functions.
  set(completions ${PROJECT_BINARY_DIR}/completions)
  foreach(shell bash zsh)
    install(CODE "file(MAKE_DIRECTORY \"${completions}\")
      execute_process(COMMAND \"$<TARGET_FILE:vbar>\" completion ${shell} OUTPUT_FILE \"${completions}/${shell}\" COMMAND_ERROR_IS_FATAL ANY)")
  endforeach()
  install(FILES ${completions}/bash RENAME vbar DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  foreach(folder site-functions vendor-completions)
    install(FILES ${completions}/zsh RENAME _vbar DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder})
  endforeach()
  install(TARGETS vbar_packets ARCHIVE DESTINATION lib/vbar)
  get_property(others GLOBAL PROPERTY VBAR_GNC_OF_OTHER_TARGETS)
  if(others)
    install(TARGETS ${others} LIBRARY DESTINATION lib/vbar)
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/fsw/messaging/vbar_gnc.h ${VBAR_C_PACKETS}/vbar_packets.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vbar)
  install(FILES ${PROJECT_SOURCE_DIR}/fsw/packets/vbar.lcm ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE
    DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data ${PROJECT_SOURCE_DIR}/missions DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar)
  # Beside data and missions as in the source tree, where vbar new-article finds them.
  foreach(example c_article/article.c cpp_article/article.cpp)
    cmake_path(GET example PARENT_PATH folder)
    install(FILES ${PROJECT_SOURCE_DIR}/boards/examples/${example} DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar/boards/examples/${folder})
  endforeach()
  install(FILES ${PROJECT_SOURCE_DIR}/hil_drivers/external/examples/range_finder.py
    DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar/hil_drivers/external/examples)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/python ${PROJECT_SOURCE_DIR}/host_sim/python/notebooks DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar
    PATTERN __pycache__ EXCLUDE)
  install(FILES ${PROJECT_SOURCE_DIR}/host_sim/python/vbar_run.m DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar/octave)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/vbar_bound ${PROJECT_BINARY_DIR}/vbar_export ${PROJECT_BINARY_DIR}/vbar_watch
    ${PROJECT_BINARY_DIR}/vbar_xtce DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/toolchains/package/article DESTINATION ${CMAKE_INSTALL_DATADIR}/vbar/toolchains/package)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/toolchains/package/vbarConfig.cmake.in vbarConfig.cmake
    INSTALL_DESTINATION ${package})
  write_basic_package_version_file(vbarConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
  install(FILES ${PROJECT_BINARY_DIR}/vbarConfig.cmake ${PROJECT_BINARY_DIR}/vbarConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/toolchains/arm-none-eabi-zynq7000.cmake DESTINATION ${package})
elseif(VBAR_TARGET STREQUAL "zynq7000")
  install(TARGETS vbar_zynq7000 RUNTIME DESTINATION ${board})
  install(TARGETS vbar_zynq7000_board vbar_zynq7000_main vbar_boards_common vbar_fsw_link vbar_fsw_packets vbar_packets
    ARCHIVE DESTINATION ${board})
  set(source ${PROJECT_SOURCE_DIR}/boards/zynq7000)
  install(FILES ${source}/zynq7000.ld ${source}/check_image.cmake ${source}/zynq7000_image.cmake ${source}/boot.bif ${source}/jtag.gdb DESTINATION ${board})
  install(PROGRAMS ${source}/set_address.py ${source}/set_telecommand_key.py DESTINATION ${board})
endif()

# `cpack --config build/host/CPackConfig.cmake`: a Debian package of what this build installs, and of the bare Zynq's build if it is
# beside it.
if(VBAR_TARGET STREQUAL "host")
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_NAME vbar)
  set(CPACK_PACKAGE_CONTACT "the authors of vbar")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "flight software harness for spacecraft rendezvous and formation flying")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
  set(CPACK_STRIP_FILES ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  # Loaded when they are needed, so that they are not found as dependencies: images; the LCM bus.
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "libosmesa6")
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "qemu-system-arm, liblcm1")
  set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};vbar;ALL;/")
  cmake_path(GET PROJECT_BINARY_DIR PARENT_PATH builds)
  if(EXISTS ${builds}/zynq/cmake_install.cmake)
    list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${builds}/zynq;vbar;ALL;/")
  endif()
  include(CPack)
endif()
