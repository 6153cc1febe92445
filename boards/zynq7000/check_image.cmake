# cmake -DNM=... -DIMAGE=... -DHEAP_TRAPS=... -P check_image.cmake: fails, and removes the image, if it holds an
# allocator or anything else that flight code must not depend on. Run after each link.
execute_process(COMMAND ${NM} --defined-only ${IMAGE} OUTPUT_VARIABLE listing RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${NM} cannot read ${IMAGE}")
endif()
# newlib's allocator, which runtime.cpp's traps must have kept out: what moves its break, its locks, its pool.
set(forbidden
  _sbrk _sbrk_r sbrk __malloc_lock __malloc_unlock __malloc_av_ __malloc_sbrk_base __malloc_free_list _malloc_trim_r
  # formatted and buffered input and output, which allocate
  printf _printf_r _vfprintf_r __sinit __sfp fopen
  # exceptions and run-time types
  __cxa_throw __cxa_allocate_exception __gxx_personality_v0 _Unwind_RaiseException __dynamic_cast
  # newlib's mathematics: flight code has its own (fsw/math)
  sin cos tan asin acos atan atan2 sinh cosh tanh exp exp2 log log2 log10 pow cbrt hypot erf tgamma lgamma fmod
  remainder __ieee754_sqrt __ieee754_rem_pio2)
if(NOT HEAP_TRAPS)  # then nothing refers to an allocator, and the linker has left out even the traps
  list(APPEND forbidden malloc calloc realloc memalign aligned_alloc free _malloc_r _calloc_r _realloc_r _free_r
    _Znwj _Znaj _ZdlPv _ZdaPv _ZdlPvj _ZdaPvj)
endif()
set(found "")
foreach(symbol ${forbidden})
  if(listing MATCHES "[ ]${symbol}\n")
    list(APPEND found ${symbol})
  endif()
endforeach()
if(found)
  file(REMOVE ${IMAGE})
  list(JOIN found " " found)
  message(FATAL_ERROR "${IMAGE} must not contain: ${found}")
endif()
