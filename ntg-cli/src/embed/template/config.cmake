# find_package(@NAME@): targets @NAME@::@NAME@ (static) and @NAME@::@NAME@_shared.
get_filename_component(@NAME@_library_folder "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
find_path(@NAME@_INCLUDE_DIR @NAME@.h PATHS "${@NAME@_library_folder}/../include" "${@NAME@_library_folder}/../../include"
          NO_DEFAULT_PATH)
mark_as_advanced(@NAME@_INCLUDE_DIR)
if(NOT @NAME@_INCLUDE_DIR)
  set(@NAME@_FOUND FALSE)
  set(@NAME@_NOT_FOUND_MESSAGE "@NAME@.h is not where it was installed")
  return()
endif()
if(NOT TARGET @NAME@::@NAME@)
  add_library(@NAME@::@NAME@ STATIC IMPORTED)
  set_target_properties(@NAME@::@NAME@ PROPERTIES
    IMPORTED_LOCATION "${@NAME@_library_folder}/${CMAKE_STATIC_LIBRARY_PREFIX}@NAME@${CMAKE_STATIC_LIBRARY_SUFFIX}"
    INTERFACE_INCLUDE_DIRECTORIES "${@NAME@_INCLUDE_DIR}")
  if(UNIX AND NOT APPLE)
    set_target_properties(@NAME@::@NAME@ PROPERTIES INTERFACE_LINK_LIBRARIES "pthread;dl;m")
  endif()
  add_library(@NAME@::@NAME@_shared SHARED IMPORTED)
  set_target_properties(@NAME@::@NAME@_shared PROPERTIES
    IMPORTED_LOCATION "${@NAME@_library_folder}/${CMAKE_SHARED_LIBRARY_PREFIX}@NAME@${CMAKE_SHARED_LIBRARY_SUFFIX}"
    IMPORTED_NO_SONAME TRUE
    INTERFACE_INCLUDE_DIRECTORIES "${@NAME@_INCLUDE_DIR}")
endif()
