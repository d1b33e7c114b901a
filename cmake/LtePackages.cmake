# cpack: Debian packages lte (tools, scenes, the C library) and lte-dev (headers, libraries,
# lteConfig.cmake), and one archive of both. Of builds without LibTorch and with LTE_RELOCATABLE:
# LibTorch is no package of Debian, and tools look for its libraries where they were built.
set(CPACK_PACKAGE_NAME lte)
set(CPACK_PACKAGE_VENDOR "The lte authors")
set(CPACK_PACKAGE_CONTACT "The lte authors <lte@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "global illumination of interiors, fast and right")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_COMPONENTS_ALL tools dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME lte)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
"global illumination of interiors, fast and right
 lte_render, lte_probe, lte_view and lte_datagen read glTF, PBRT, OBJ and PLY
 scenes, and make pictures and irradiance at points by gathered light and by
 path tracing; liblte_c_api has the same for C programs.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME lte-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "lte (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libembree-dev, libopenexr-dev, libtinygltf-dev, libcli11-dev, libyaml-cpp-dev, nlohmann-json3-dev, libwebp-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION
"global illumination of interiors: development files
 Headers and libraries of lte for C and C++, with find_package(lte), and its
 example programs.")
include(CPack)
