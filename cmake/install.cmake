# What `cmake --install` puts where, in three components (the Debian packages of cmake/debian.cmake): the shared library,
# what a developer needs beside it, and the programs. The tree can be moved: nothing in it knows where it stands.
# Programs, headers and shaders are found by folder; a new one needs no line here.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
find_program(GZIP gzip REQUIRED)
set(NEPHELE_DATA ${CMAKE_INSTALL_DATADIR}/nephele)
set(NEPHELE_DOC ${CMAKE_INSTALL_DATADIR}/doc/nephele)

# --- libshape.so, of the same objects as libshape.a. SOVERSION rises where a program would have to be built anew.
set(SHAPE_SOVERSION 1)
file(GLOB SHAPE_HEADERS CONFIGURE_DEPENDS libshape/include/shape/*.h)
set(SHAPE_EXPORTS ${CMAKE_BINARY_DIR}/shape.map)
add_custom_command(OUTPUT ${SHAPE_EXPORTS}
  COMMAND ${CMAKE_COMMAND} -DHEADERS=${PROJECT_SOURCE_DIR}/libshape/include/shape -DOUTPUT=${SHAPE_EXPORTS}
          -P ${PROJECT_SOURCE_DIR}/cmake/exports.cmake
  DEPENDS ${SHAPE_HEADERS} cmake/exports.cmake)
add_custom_target(nephele_exports DEPENDS ${SHAPE_EXPORTS})
file(WRITE ${CMAKE_BINARY_DIR}/shape_shared.c.new "/* libshape.so has the objects of libshape.a. */\ntypedef int shape_nothing;\n")
configure_file(${CMAKE_BINARY_DIR}/shape_shared.c.new ${CMAKE_BINARY_DIR}/shape_shared.c COPYONLY)
add_library(shape_shared SHARED $<TARGET_OBJECTS:shape> ${CMAKE_BINARY_DIR}/shape_shared.c)
add_dependencies(shape_shared nephele_exports)
target_include_directories(shape_shared INTERFACE libshape/include)
target_link_libraries(shape_shared PRIVATE nephele_flags m OpenMP::OpenMP_C)
# Calls within the library stay within it, as in libshape.a.
target_link_options(shape_shared PRIVATE LINKER:--version-script=${SHAPE_EXPORTS} LINKER:-Bsymbolic-functions)
set_target_properties(shape_shared PROPERTIES OUTPUT_NAME shape VERSION ${SHAPE_SOVERSION}.${PROJECT_VERSION_MINOR}.${PROJECT_VERSION_PATCH}
                      SOVERSION ${SHAPE_SOVERSION} LINK_DEPENDS ${SHAPE_EXPORTS})

# --- the programs: all targets of tools/ and viewer/ by the name neph-*
set(NEPHELE_PROGRAMS "")
foreach(folder tools viewer)
  if(IS_DIRECTORY ${CMAKE_BINARY_DIR}/${folder})
    get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
    list(FILTER targets INCLUDE REGEX "^neph-")
    list(APPEND NEPHELE_PROGRAMS ${targets})
  endif()
endforeach()
file(RELATIVE_PATH library_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
foreach(program ${NEPHELE_PROGRAMS})
  if(NEPHELE_SHARED)
    # First on the linker's line: what it exports is taken from it, and nothing of libshape.a.
    get_target_property(libraries ${program} LINK_LIBRARIES)
    set_target_properties(${program} PROPERTIES LINK_LIBRARIES "shape_shared;${libraries}")
    if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr") # there the system finds it by itself
      set_target_properties(${program} PROPERTIES INSTALL_RPATH "$ORIGIN/${library_from_bin}")
    endif()
  endif()
  install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
endforeach()

# What programs load when they are given a .vdb.
install(TARGETS nephele_openvdb LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/nephele COMPONENT programs)
foreach(program neph-view neph-render neph-mesh)
  if(TARGET ${program})
    set_property(TARGET ${program} APPEND PROPERTY INSTALL_RPATH "$ORIGIN/${library_from_bin}/nephele")
  endif()
endforeach()

# --- manual pages and completion, printed by the programs themselves from their option tables
set(NEPHELE_PAGES "")
if(NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR)
  foreach(program ${NEPHELE_PROGRAMS})
    foreach(kind man bash zsh)
      set(page ${CMAKE_BINARY_DIR}/pages/${kind}/${program})
      add_custom_command(OUTPUT ${page}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/pages/${kind}
        COMMAND ${program} --generate ${kind} -o ${page}
        DEPENDS ${program})
      list(APPEND NEPHELE_PAGES ${page})
    endforeach()
    set(page ${CMAKE_BINARY_DIR}/pages/man/${program})
    add_custom_command(OUTPUT ${page}.1.gz COMMAND ${GZIP} -9nc ${page} > ${page}.1.gz DEPENDS ${page})
    list(APPEND NEPHELE_PAGES ${page}.1.gz)
    install(FILES ${page}.1.gz
            DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
    install(FILES ${CMAKE_BINARY_DIR}/pages/bash/${program}
            DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
    install(FILES ${CMAKE_BINARY_DIR}/pages/zsh/${program} RENAME _${program}
            DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${NEPHELE_ZSH_FOLDER} COMPONENT programs)
  endforeach()
  add_custom_target(nephele_pages ALL DEPENDS ${NEPHELE_PAGES})
else()
  message(STATUS "Nephele: no manual pages and no completion (a cross build cannot run its programs)")
endif()

# --- the libraries, headers, and how others find them
install(TARGETS shape_shared LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
        NAMELINK_COMPONENT development)
foreach(library shape shape_scene shape_io)
  if(TARGET ${library})
    install(TARGETS ${library} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  endif()
endforeach()
install(DIRECTORY libshape/include/shape DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
set(NEPHELE_CMAKE ${CMAKE_INSTALL_LIBDIR}/cmake/Nephele)
configure_package_config_file(cmake/NepheleConfig.cmake.in ${CMAKE_BINARY_DIR}/NepheleConfig.cmake
  INSTALL_DESTINATION ${NEPHELE_CMAKE} PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR NEPHELE_DATA)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/NepheleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/NepheleConfig.cmake ${CMAKE_BINARY_DIR}/NepheleConfigVersion.cmake
        DESTINATION ${NEPHELE_CMAKE} COMPONENT development)
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/libshape.pc.in ${CMAKE_BINARY_DIR}/libshape.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/libshape.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
install(DIRECTORY shaders DESTINATION ${NEPHELE_DATA} COMPONENT development
        FILES_MATCHING PATTERN "*.glsl" PATTERN "*.frag" PATTERN "*.vert" PATTERN "*.md")

# --- the page of the C API, made from the headers: cmake --build build/release --target docs
set(NEPHELE_API ${CMAKE_BINARY_DIR}/docs/api.md)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/docs)
add_custom_command(OUTPUT ${NEPHELE_API}
  COMMAND awk -f ${PROJECT_SOURCE_DIR}/docs/api.awk ${SHAPE_HEADERS} > ${NEPHELE_API}
  DEPENDS docs/api.awk ${SHAPE_HEADERS})
add_custom_target(docs ALL DEPENDS ${NEPHELE_API})
install(FILES ${NEPHELE_API} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libshape-dev COMPONENT development)

# --- what to read and to begin with
install(DIRECTORY examples/ DESTINATION ${NEPHELE_DATA}/examples COMPONENT programs
        FILES_MATCHING PATTERN "*.lsys" PATTERN "*.json" PATTERN "*.glb"
        PATTERN gallery EXCLUDE PATTERN engine EXCLUDE)
install(DIRECTORY examples/blender DESTINATION ${NEPHELE_DATA}/examples COMPONENT programs FILES_MATCHING PATTERN "*.py")
install(DIRECTORY examples/engine DESTINATION ${NEPHELE_DATA}/examples COMPONENT development)
install(FILES README.md LICENSE DESTINATION ${NEPHELE_DOC} COMPONENT programs)
install(DIRECTORY docs DESTINATION ${NEPHELE_DOC} COMPONENT programs PATTERN "*.awk" EXCLUDE PATTERN "*.sh" EXCLUDE)
