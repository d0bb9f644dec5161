# Makes the ROS 2 packages of a Python virtual environment usable as CMake packages.
#
# Included right after project() when the messages are built against ROS 2 from Python wheels
# (CMAKE_PROJECT_INCLUDE). With a ROS 2 installation under /opt/ros it is not needed.

# Exported targets of the wheels name include directories of the machine that built them; CMake
# refuses a target whose include directory does not exist, so drop those once all are imported.
function(drop_missing_include_directories)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(directories)
      set(present "")
      foreach(directory IN LISTS directories)
        if(directory MATCHES "^\\$<" OR EXISTS "${directory}")
          list(APPEND present "${directory}")
        endif()
      endforeach()
      set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${present}")
    endif()
  endforeach()
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} CALL drop_missing_include_directories)

# The environment is the first on PATH that holds ament: tell CMake and ament's index about it.
file(TO_CMAKE_PATH "$ENV{PATH}" search_path)
foreach(directory IN LISTS search_path)
  if(EXISTS "${directory}/../share/ament_cmake_core/cmake")
    get_filename_component(prefix "${directory}/.." ABSOLUTE)
    list(APPEND CMAKE_PREFIX_PATH "${prefix}")
    set(ENV{AMENT_PREFIX_PATH} "${prefix}")
    break()
  endif()
endforeach()

# The same for a project in a folder of this one.
set(CMAKE_PROJECT_INCLUDE "${CMAKE_CURRENT_LIST_FILE}")
