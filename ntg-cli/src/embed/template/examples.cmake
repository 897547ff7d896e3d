# The loops of this folder: as part of the project around it, or alone where @NAME@ is installed.
cmake_minimum_required(VERSION 3.16)
project(@NAME@_examples LANGUAGES C CXX)
if(NOT TARGET @NAME@::@NAME@)
  find_package(@NAME@ REQUIRED)
endif()

add_executable(@NAME@_loop_c loop.c)
set_target_properties(@NAME@_loop_c PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
target_link_libraries(@NAME@_loop_c PRIVATE @NAME@::@NAME@)

add_executable(@NAME@_loop_cpp loop.cpp)
set_target_properties(@NAME@_loop_cpp PROPERTIES CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
target_link_libraries(@NAME@_loop_cpp PRIVATE @NAME@::@NAME@_shared)
