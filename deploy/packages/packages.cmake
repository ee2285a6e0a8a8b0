# Debian packages, by deploy/packages/make: `prehend`, `prehend-vision` (what loads OpenCV, libav or
# HDF5) and `prehend-dev` (the contract and a CMake configuration for others' services).
include(CMakePackageConfigHelpers)

install(FILES ${CMAKE_CURRENT_LIST_DIR}/prehend.bash DESTINATION share/bash-completion/completions RENAME prehend
  COMPONENT lab)
# Made from the commands' own help by deploy/packages/make, so that neither says something else.
install(DIRECTORY ${CMAKE_BINARY_DIR}/man/ DESTINATION share/man/man1 COMPONENT lab OPTIONAL)
# Not enabled: deploy/systemd.md says how.
install(DIRECTORY ${CMAKE_CURRENT_LIST_DIR}/systemd/ DESTINATION lib/systemd/system COMPONENT lab
  FILES_MATCHING PATTERN *.service)
foreach(units prehend- prehend@)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/systemd/10-shared.conf
    DESTINATION lib/systemd/system/${units}.service.d COMPONENT lab)
endforeach()
install(FILES ${CMAKE_CURRENT_LIST_DIR}/systemd/20-planner.conf
  DESTINATION lib/systemd/system/prehend@planner.service.d COMPONENT lab)
# Headers of these are compiled into the programs: no dependency names them, so the bill of materials
# and their licences do.
set(compiled_in libboost-dev libcli11-dev libeigen3-dev libexpected-dev nlohmann-json3-dev)
execute_process(COMMAND ${CMAKE_SOURCE_DIR}/deploy/sbom records ${compiled_in}
  OUTPUT_FILE ${CMAKE_BINARY_DIR}/compiled-in.tsv COMMAND_ERROR_IS_FATAL ANY)
install(FILES ${CMAKE_BINARY_DIR}/compiled-in.tsv DESTINATION share/doc/prehend COMPONENT lab)
foreach(header_package ${compiled_in})
  install(FILES /usr/share/doc/${header_package}/copyright DESTINATION share/doc/prehend/compiled-in
    RENAME ${header_package} COMPONENT lab)
endforeach()
foreach(component lab vision dev)
  set(package prehend)
  if(NOT component STREQUAL lab)
    set(package prehend-${component})
  endif()
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION share/doc/${package} COMPONENT ${component})
  install(FILES ${CMAKE_BINARY_DIR}/changelog.Debian.gz DESTINATION share/doc/${package}
    COMPONENT ${component} OPTIONAL)
  install(FILES ${CMAKE_BINARY_DIR}/sbom/${package}.spdx.json DESTINATION share/doc/${package}
    RENAME sbom.spdx.json COMPONENT ${component} OPTIONAL)
endforeach()

install(FILES ${CMAKE_CURRENT_LIST_DIR}/prehend-config.cmake DESTINATION lib/cmake/prehend COMPONENT dev)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/prehend-config-version.cmake
  COMPATIBILITY SameMajorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_BINARY_DIR}/prehend-config-version.cmake DESTINATION lib/cmake/prehend
  COMPONENT dev)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME prehend)
set(CPACK_PACKAGE_CONTACT "The Prehend developers <prehend@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL lab vision dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LAB_PACKAGE_NAME prehend)
set(CPACK_DEBIAN_VISION_PACKAGE_NAME prehend-vision)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME prehend-dev)
set(CPACK_DEBIAN_LAB_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_LIST_DIR}/postinst"
  "${CMAKE_CURRENT_LIST_DIR}/prerm" "${CMAKE_CURRENT_LIST_DIR}/postrm")
set(CPACK_COMPONENT_LAB_DESCRIPTION "leads a robot hand by a human one\n\
 A glove's fingertips and what a camera sees of the object become the joint angles of a robot hand;\n\
 a physics simulation judges the grasp. Services speak over DDS.")
set(CPACK_COMPONENT_VISION_DESCRIPTION "leads a robot hand by a human one: the camera's side\n\
 Recognises objects and supplies their shape, size and place; writes recordings as training data.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "leads a robot hand by a human one: the contract\n\
 The topics' types in IDL, and a CMake configuration that generates them.")
set(CPACK_DEBIAN_LAB_PACKAGE_RECOMMENDS "prehend-vision, gnuplot-nox")
set(CPACK_DEBIAN_VISION_PACKAGE_DEPENDS "prehend (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "prehend (= ${PROJECT_VERSION}), fastddsgen")
set(CPACK_DEBIAN_DEV_PACKAGE_ARCHITECTURE all)
include(CPack)
