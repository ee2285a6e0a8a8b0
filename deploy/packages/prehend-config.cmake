# find_package(prehend) for a service that speaks Prehend's topics:
#   PREHEND_IDL_DIR             folder of the .idl files
#   prehend_idl_library(NAME)   a static library with the C++ types of all topics, by fastddsgen
get_filename_component(PREHEND_IDL_DIR ${CMAKE_CURRENT_LIST_DIR}/../../../share/prehend/idl ABSOLUTE)

function(prehend_idl_library name)
  find_program(FASTDDSGEN fastddsgen REQUIRED)
  find_package(fastcdr REQUIRED)
  find_package(fastdds QUIET)
  if(fastdds_FOUND)
    set(middleware fastdds)
  else()
    find_package(fastrtps REQUIRED)
    set(middleware fastrtps)
  endif()
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${name})
  file(MAKE_DIRECTORY ${generated})
  file(GLOB idls ${PREHEND_IDL_DIR}/*.idl)
  # At configure time: which files the generator writes differs from release to release.
  execute_process(
    COMMAND ${FASTDDSGEN} -cs -replace -d ${generated} -I ${PREHEND_IDL_DIR} ${idls}
    OUTPUT_QUIET RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "fastddsgen failed on ${PREHEND_IDL_DIR}")
  endif()
  file(GLOB sources ${generated}/*.cxx)
  add_library(${name} STATIC ${sources})
  target_include_directories(${name} SYSTEM PUBLIC ${generated})
  target_link_libraries(${name} PUBLIC ${middleware} fastcdr)
endfunction()
