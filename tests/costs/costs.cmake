# Read by ctest after all tests, so that a first run, too, begins with the longest.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/costs.txt costs)
foreach(line ${costs})
  string(REPLACE " " ";" line "${line}")
  list(GET line 0 seconds)
  list(GET line 1 name)
  set_tests_properties(${name} PROPERTIES COST ${seconds})
endforeach()
