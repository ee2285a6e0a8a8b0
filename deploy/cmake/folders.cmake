# A folder with sources is one library: all its .cpp but main.cpp, named by its path with «_» for
# «/» (common/dds: common_dds). A program is made from main.cpp of its folder, and from its library.

# Every folder below these that has a CMakeLists.txt, once. A target may be named before it is there.
function(prehend_folders)
  foreach(top ${ARGN})
    file(GLOB_RECURSE found CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${top}/CMakeLists.txt)
    list(APPEND lists ${found})
  endforeach()
  list(REMOVE_DUPLICATES lists)
  foreach(list ${lists})
    get_filename_component(folder ${list} DIRECTORY)
    add_subdirectory(${folder})
  endforeach()
endfunction()

function(prehend_folder_target out)
  file(RELATIVE_PATH path ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "_" name ${path})
  set(${out} ${name} PARENT_SCOPE)
endfunction()

#   prehend_library(LINK what its headers need ... PRIVATE what only its sources need ...)
#   HOT: loops whose speed is measured; compiled with -O3
#   COMMANDS: reads options and prints; compiled with -O1, in four fifths of the time
function(prehend_library)
  cmake_parse_arguments(ARG "HOT;COMMANDS" "" "LINK;PRIVATE" ${ARGN})
  prehend_folder_target(name)
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
  prehend_fast_build(${name})
  if(ARG_HOT)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
  elseif(ARG_COMMANDS)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

#   prehend_program(NAME [VISION] LINK what main.cpp needs beside its folder's library ...): is
#   installed; VISION: it loads OpenCV, libav or HDF5, and has its place in that package
function(prehend_program name)
  cmake_parse_arguments(ARG "VISION" "" "LINK" ${ARGN})
  prehend_folder_target(library)
  add_executable(${name} main.cpp)
  if(TARGET ${library})
    target_link_libraries(${name} PRIVATE ${library})
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  prehend_fast_build(${name})
  if(ARG_VISION)
    install(TARGETS ${name} COMPONENT vision)
  else()
    install(TARGETS ${name} COMPONENT lab)
  endif()
  set_property(GLOBAL APPEND PROPERTY PREHEND_PROGRAMS ${name})
endfunction()

# What makes a first build short; the preset `develop` is without it, so that a changed source is
# compiled alone.
option(PREHEND_UNITY "compile the sources of a folder together" ON)
function(prehend_fast_build target)
  if(PREHEND_UNITY)
    # One unit, since headers cost more than sources; two units and more of what is large, so that
    # two cores share it.
    get_target_property(sources ${target} SOURCES)
    list(LENGTH sources count)
    set(batch 16)
    if(count GREATER 16)
      set(batch 8)
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
    # A file does not see its neighbours' names when it is compiled alone, so only what shadows a
    # name of its own function is told here; `develop` tells the rest.
    target_compile_options(${target} PRIVATE -Wno-shadow -Wshadow=local -Wno-subobject-linkage)
  endif()
endfunction()
