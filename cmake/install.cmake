# What `cmake --install` gives: the program, the libraries with their headers, and the package for find_package(fabloop).
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/fabloop)

install(TARGETS fabloop RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS fabloop_frontend fabloop_verification fabloop_posegraph fabloop_data fabloop_lab EXPORT fabloopTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fabloop)
install(EXPORT fabloopTargets NAMESPACE fabloop:: DESTINATION ${package_folder})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

get_property(FABLOOP_USES_DLIB GLOBAL PROPERTY FABLOOP_USES_DLIB)
configure_package_config_file(cmake/fabloopConfig.cmake.in ${PROJECT_BINARY_DIR}/fabloopConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# Before 1.0 a minor version may break its users.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/fabloopConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/fabloopConfig.cmake ${PROJECT_BINARY_DIR}/fabloopConfigVersion.cmake
  DESTINATION ${package_folder})
