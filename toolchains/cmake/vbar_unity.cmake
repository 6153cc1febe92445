# Unity builds (VBAR_UNITY=ON) for cold builds, where no compiler cache has the objects: the sources of a folder of host code or
# of tests are compiled together, so that the headers and templates that several of them use are read and instantiated once. An
# edit then compiles a whole folder, so that it is off by default. Flight code always has the same units: its calls between
# them are what mutants (ci/mutate.py) are made of.
option(VBAR_UNITY "compile the sources of a folder together: half the time for a cold build, more for an edit" OFF)

# Sources of one unit at most, so that both processors of a small computer have work and neither runs out of memory.
set(VBAR_UNITY_FILES_MAX 10)

# vbar_has_common(result list list): whether two lists (by their names) have a common element.
function(vbar_has_common result one other)
  set(${result} FALSE PARENT_SCOPE)
  foreach(element IN LISTS ${one})
    if(element IN_LIST ${other})
      set(${result} TRUE PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# vbar_unity(name source...): groups the sources of a target by folder. The anonymous namespaces of one unit are one, so that
# two files are placed in different units if both declare the same function, constant or type at the margin, where those
# of namespaces stand, or if one declares, or takes from another namespace, what the other takes by a using
# declaration. A file with a using directive is compiled alone, as CMake does with one that has options or
# definitions of its own. A unity build does not warn of names that hide those of other files (-Wshadow).
function(vbar_unity name)
  if(NOT VBAR_UNITY)
    return()
  endif()
  set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A class that a source declares for itself may have members of its anonymous namespace.
  target_compile_options(${name} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  foreach(source IN LISTS ARGN)
    get_filename_component(source ${source} ABSOLUTE)
    if(NOT source MATCHES "\\.cpp$" OR NOT EXISTS ${source})
      continue()
    endif()
    file(READ ${source} text)
    if(text MATCHES "\nusing namespace ")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    string(REGEX REPLACE "\n\\[\\[[a-z_]+\\]\\] " "\n" text "\n${text}")
    string(REGEX REPLACE "[];[]" " " text "${text}")
    string(REGEX MATCHALL "\n[A-Za-z][A-Za-z0-9_:<>,&* ]* [*&]*[A-Za-z0-9_]+ *[=({]" declared "${text}")
    list(FILTER declared EXCLUDE REGEX "^\n(namespace |[A-Z_]+\\()")  # nor macros: tests
    list(TRANSFORM declared REPLACE "^.*[ *&]([A-Za-z0-9_]+) *[=({]$" "\\1")
    string(REGEX MATCHALL "\nusing [A-Za-z0-9_:]+::[A-Za-z0-9_]+ " origins "${text}")
    set(taken ${origins})
    list(TRANSFORM taken REPLACE "^.*::([A-Za-z0-9_]+) $" "\\1")
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})  # the same names in every checkout
    string(MD5 folder ${folder})
    set(number 0)
    while(TRUE)
      set(unit ${folder}_${number})
      vbar_has_common(declared_twice declared declared_${unit})
      vbar_has_common(taken_there declared taken_${unit})
      vbar_has_common(taken_here taken declared_${unit})
      set(taken_elsewhere FALSE)
      foreach(origin IN LISTS origins)
        string(REGEX REPLACE "^.*::([A-Za-z0-9_]+) $" "\\1" own "${origin}")
        if(own IN_LIST taken_${unit} AND NOT origin IN_LIST origins_${unit})
          set(taken_elsewhere TRUE)
        endif()
      endforeach()
      list(LENGTH sources_${unit} files)
      if(files LESS VBAR_UNITY_FILES_MAX AND NOT (declared_twice OR taken_there OR taken_here OR taken_elsewhere))
        break()
      endif()
      math(EXPR number "${number} + 1")
    endwhile()
    list(APPEND declared_${unit} ${declared})
    list(APPEND taken_${unit} ${taken})
    list(APPEND origins_${unit} ${origins})
    list(APPEND sources_${unit} ${source})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${unit})
  endforeach()
endfunction()
