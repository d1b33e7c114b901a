# Run by CPack on what it has packed: Installed-Size is of files. CPack's counts the program once
# more for each link to it.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  if(NOT package MATCHES "/lte_[^/]*\\.deb$")  # that of the program
    continue()
  endif()
  set(folder ${package}.files)
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${folder} COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE files LIST_DIRECTORIES false ${folder}/usr/*)
  set(bytes 0)
  foreach(file IN LISTS files)
    if(NOT IS_SYMLINK ${file})
      file(SIZE ${file} size)
      math(EXPR bytes "${bytes} + ${size}")
    endif()
  endforeach()
  math(EXPR kilobytes "(${bytes} + 1023) / 1024")
  file(READ ${folder}/DEBIAN/control control)
  string(REGEX REPLACE "Installed-Size: [0-9]+" "Installed-Size: ${kilobytes}" control "${control}")
  file(WRITE ${folder}/DEBIAN/control "${control}")
  execute_process(COMMAND dpkg-deb --root-owner-group -Zgzip --build ${folder} ${package}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${folder})
endforeach()
