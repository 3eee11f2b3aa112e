# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT, in which every suite of the test program PROGRAM is a ctest of its own with PROPERTIES (a list of names and values);
# the suite SLOW, where one is named, with the label `slow`. Names begin with the program's, since ctest knows tests of all folders by them.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} does not list its tests")
endif()
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
if(NOT suites)
  message(FATAL_ERROR "${PROGRAM} has no tests")
endif()

# A suite counts as skipped where the last thing that it says is which tests it skipped: nothing failed, or that would come after.
set(skipped "\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]*\n)+$")
get_filename_component(program ${PROGRAM} NAME)
string(REPLACE ";" " " PROPERTIES "${PROPERTIES}")
set(tests "")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  set(label "")
  if(suite STREQUAL "${SLOW}")
    set(label " LABELS slow")
  endif()
  string(APPEND tests
    "add_test([==[${program}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
    "set_tests_properties([==[${program}.${suite}]==] PROPERTIES SKIP_REGULAR_EXPRESSION [==[${skipped}]==] ${PROPERTIES}${label})\n")
endforeach()
file(WRITE "${OUTPUT}" "${tests}")
