# install and find_package(lte): libraries, headers, tools, shipped assets, configurations,
# examples, documents, and a package file that finds the rest.
include(CMakePackageConfigHelpers)
get_property(lte_libraries GLOBAL PROPERTY LTE_LIBRARIES)
if(LTE_TORCH)
  list(APPEND lte_libraries lte_torch)
endif()
# Components are those of packages (LtePackages): tools, dev, models, and what an evaluation needs.
install(TARGETS ${lte_libraries} EXPORT lteTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT tools NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY lte DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev FILES_MATCHING PATTERN "*.h" PATTERN "cpu" EXCLUDE
  PATTERN "cuda" EXCLUDE PATTERN "c_api" EXCLUDE)
# README's commands name assets/, configs/ and examples/: they run in share/lte as in the sources.
# What the tools look for by themselves, models and data, they also find there.
install(DIRECTORY assets/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/lte/assets COMPONENT tools PATTERN outside EXCLUDE)
install(DIRECTORY configs docs DESTINATION ${CMAKE_INSTALL_DATADIR}/lte COMPONENT tools)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/lte COMPONENT tools)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/lte COMPONENT dev)
install(DIRECTORY assets/models DESTINATION ${CMAKE_INSTALL_DATADIR}/lte/assets COMPONENT models)
install(DIRECTORY assets/data DESTINATION ${CMAKE_INSTALL_DATADIR}/lte/assets COMPONENT network)
install(DIRECTORY assets/scenes/outside DESTINATION ${CMAKE_INSTALL_DATADIR}/lte/assets/scenes COMPONENT network)
install(EXPORT lteTargets NAMESPACE lte:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lte COMPONENT dev)
configure_package_config_file(cmake/lteConfig.cmake.in ${PROJECT_BINARY_DIR}/lteConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lte)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lteConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lteConfig.cmake ${PROJECT_BINARY_DIR}/lteConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lte COMPONENT dev)
