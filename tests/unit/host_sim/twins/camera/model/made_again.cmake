# Runs the scripts of data/models into FOLDER and compares: cmake -D PYTHON= -D MODELS= -D FOLDER= -P made_again.cmake
file(MAKE_DIRECTORY ${FOLDER})
foreach(script make_tango make_tango_mockup make_winged_box)
  execute_process(COMMAND ${PYTHON} -B ${MODELS}/${script}.py ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(file tango.obj tango.mtl tango_mockup.obj tango_mockup.mtl winged_box.obj winged_box.mtl)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FOLDER}/${file} ${MODELS}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
