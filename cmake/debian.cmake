# Debian packages by CPack: cmake --preset package && cmake --build build/package --target package.
#   libshape1     the shared library        libshape-dev  headers, static libraries, shaders
#   nephele       the programs, with manual pages, completion, examples and documentation
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME nephele)
set(CPACK_PACKAGE_VENDOR "The Nephele authors")
set(NEPHELE_MAINTAINER "The Nephele authors <nephele@localhost>" CACHE STRING "Maintainer of the packages: name <address>")
set(CPACK_PACKAGE_CONTACT ${NEPHELE_MAINTAINER})
# The first line of each description; the rest stands below.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "cloud shapes as spheres and ellipsoids")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library development programs)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
# Where dpkg-shlibdeps finds our own library; the dependency on it stands below.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})

set(same_version "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libshape${SHAPE_SOVERSION})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION
    "The shared library: reads and writes .neph files, generates cloud shapes from grammars, Gaussian heaps, metaballs and meshes, evaluates their density and lights them.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libshape-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libshape${SHAPE_SOVERSION} ${same_version}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libpng-dev, libopenexr-dev, libjansson-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
    "Headers, static libraries, CMake and pkg-config files of libshape, and the GLSL sources that draw its clouds.")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME nephele)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "libshape${SHAPE_SOVERSION} ${same_version}")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "gnuplot-nox") # of neph-chart
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION
    "Small programs that make a cloud out of spheres and rotated ellipsoids, change it, show it, render it and measure it. Each is a filter over .neph files.")

# Debian's policy: a copyright file and the changes, a package.
set(changelog ${CMAKE_BINARY_DIR}/debian/changelog.gz)
add_custom_command(OUTPUT ${changelog} COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > ${changelog}
                   DEPENDS CHANGELOG.md)
add_custom_target(nephele_changelog ALL DEPENDS ${changelog})
foreach(component library development programs)
  string(TOUPPER ${component} upper)
  install(FILES ${changelog} COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES LICENSE RENAME copyright COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
endforeach()
include(CPack)
