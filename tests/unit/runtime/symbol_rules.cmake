# SPDX-License-Identifier: MIT
# cmake -D NM=<nm> -D LIBRARY=<archive> -P symbol_rules.cmake: fails where the archive needs what the runtime must not use.
execute_process(COMMAND ${NM} -u -C ${LIBRARY} OUTPUT_VARIABLE symbols RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT symbols MATCHES "memcpy|memset|vsnprintf")
  message(FATAL_ERROR "cannot read the symbols of ${LIBRARY}")
endif()
set(found FALSE)
foreach(name malloc calloc realloc free aligned_alloc posix_memalign "operator new" "operator delete" __cxa_throw
    __cxa_guard_acquire pthread_mutex_lock)
  if(symbols MATCHES "U ${name}[(\n@]" OR symbols MATCHES "U ${name}\\[")
    message(NOTICE "${LIBRARY} refers to ${name}")
    set(found TRUE)
  endif()
endforeach()
if(found)
  message(FATAL_ERROR "a symbol that must not be there")
endif()
