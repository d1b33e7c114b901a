# cpack: Debian packages lte (tools, scenes, the C library), lte-dev (headers, libraries,
# lteConfig.cmake) and lte-models (networks), and one archive of all. Of builds without LibTorch and
# with LTE_RELOCATABLE: LibTorch is no package of Debian, and tools look for its libraries where
# they were built.
foreach(key IN ITEMS name email)
  execute_process(COMMAND git config user.${key} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                  OUTPUT_VARIABLE lte_git_${key} OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endforeach()
set(lte_contact "$ENV{LTE_MAINTAINER}")
if(NOT lte_contact AND lte_git_email)
  set(lte_contact "${lte_git_name} <${lte_git_email}>")
elseif(NOT lte_contact)
  set(lte_contact "The lte authors <lte@localhost>")
endif()
set(CPACK_PACKAGE_NAME lte)
set(CPACK_PACKAGE_VENDOR "The lte authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "global illumination of interiors, fast and right")
set(CPACK_PACKAGE_CONTACT "${lte_contact}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_COMPONENTS_ALL tools dev models)
set(lte_debian_names lte lte-dev lte-models)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME lte)
set(CPACK_DEBIAN_TOOLS_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/triggers)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
"The program lte reads glTF, PBRT, OBJ and PLY scenes, and makes pictures, light
maps and irradiance at points by gathered light and by path tracing;
liblte_c_api has pictures and points for C programs.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS lte-models)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME lte-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "lte (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libembree-dev, libopenexr-dev, libtinygltf-dev, libcli11-dev, libyaml-cpp-dev, nlohmann-json3-dev, libwebp-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION
"Development files: headers and libraries of lte for C and C++, with
find_package(lte), and its example programs.")
set(CPACK_DEBIAN_MODELS_PACKAGE_NAME lte-models)
set(CPACK_DEBIAN_MODELS_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_MODELS_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_MODELS_DESCRIPTION
"Trained networks for the tools of lte, in safetensors.")
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian/installed_size.cmake)
include(CPack)
# What Debian expects in each package.
execute_process(COMMAND git log -1 --format=%aD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                OUTPUT_VARIABLE lte_commit_date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT lte_commit_date)
  string(TIMESTAMP lte_commit_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
configure_file(cmake/debian/changelog.in ${PROJECT_BINARY_DIR}/changelog @ONLY)
execute_process(COMMAND gzip -9nkf changelog WORKING_DIRECTORY ${PROJECT_BINARY_DIR})
execute_process(COMMAND awk -f ${PROJECT_SOURCE_DIR}/cmake/notices.awk ${LTE_XATLAS}/xatlas.cpp
                OUTPUT_VARIABLE lte_xatlas_notices ERROR_QUIET)
configure_file(cmake/debian/copyright.in ${PROJECT_BINARY_DIR}/copyright @ONLY)
foreach(component package IN ZIP_LISTS CPACK_COMPONENTS_ALL lte_debian_names)
  install(FILES ${PROJECT_BINARY_DIR}/copyright ${PROJECT_BINARY_DIR}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
# Man pages and completion, from what the program says about itself.
find_package(Python COMPONENTS Interpreter QUIET)
if(Python_Interpreter_FOUND AND LTE_RELOCATABLE AND NOT SKBUILD)
  add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/manual.stamp
    COMMAND ${Python_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/manual.py
            $<TARGET_FILE:lte_program> ${PROJECT_BINARY_DIR}/manual
    COMMAND ${CMAKE_COMMAND} -E touch ${PROJECT_BINARY_DIR}/manual.stamp
    DEPENDS lte_program ${PROJECT_SOURCE_DIR}/scripts/manual.py VERBATIM)
  add_custom_target(lte_manual ALL DEPENDS ${PROJECT_BINARY_DIR}/manual.stamp)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT tools)
endif()
