# Run at every build: writes FILE (C++) with the commit of SOURCE, and leaves it alone if nothing changed, so that only one small
# file is compiled again, and only after a commit.
set(commit unknown)
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --abbrev=12 --exclude=* --dirty=+
    OUTPUT_VARIABLE found ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE result)
  if(result EQUAL 0)
    set(commit ${found})
  endif()
endif()
set(text "#include \"host_sim/cli/build_info.h\"\n\nnamespace vbar::app {\nconst char* const kBuildCommit = \"${commit}\";\n}\n")
set(old "")
if(EXISTS ${FILE})
  file(READ ${FILE} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${FILE} "${text}")
endif()
