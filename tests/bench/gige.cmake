if(TARGET vbar_hil_gige_camera)
  target_sources(vbar_bench PRIVATE gige_bench.cpp)
  target_link_libraries(vbar_bench PRIVATE vbar_hil_gige_camera vbar_hil_gige_device)
endif()
