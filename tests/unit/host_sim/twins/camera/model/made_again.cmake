# Runs the script of data/models into FOLDER and compares: cmake -D PYTHON= -D MODELS= -D FOLDER= -P made_again.cmake
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${PYTHON} -B ${MODELS}/make_tango.py ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
foreach(file tango.obj tango.mtl)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FOLDER}/${file} ${MODELS}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
