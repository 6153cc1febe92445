# cmake -DIMAGE=... -DOBJDUMP=... -DPYTHON=... -DSCRIPT=... -DSTACK_KILOBYTES=... -P check_stack.cmake: fails, and removes the image,
# if its stack cannot be bounded or the bound exceeds it. Run after the link.
cmake_path(REPLACE_EXTENSION IMAGE LAST_ONLY stack.lst OUTPUT_VARIABLE listing)
cmake_path(REPLACE_EXTENSION IMAGE LAST_ONLY stack.txt OUTPUT_VARIABLE report)
math(EXPR stack_bytes "${STACK_KILOBYTES} * 1024")
execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${IMAGE} OUTPUT_FILE ${listing} RESULT_VARIABLE result)
if(result EQUAL 0)
  execute_process(COMMAND ${PYTHON} ${SCRIPT} ${listing} --stack ${stack_bytes} OUTPUT_FILE ${report} RESULT_VARIABLE result)
endif()
file(REMOVE ${listing})
if(NOT result EQUAL 0)
  file(REMOVE ${IMAGE})
  message(FATAL_ERROR "${IMAGE}: no bound of its stack")
endif()
