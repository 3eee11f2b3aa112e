# Installs fabloop into a fresh prefix, then configures, builds and runs the consumer project against it.
# Usage: cmake -D BUILD=... -D CONSUMER=... -D WORK=... -D GENERATOR=... -D COMPILER=... -D FLAGS=... -D CONFIG=... -P run_consumer.cmake
function(run_step name)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${name} failed (${result}):\n${output}")
  endif()
  message(STATUS "${name}: done")
endfunction()

file(REMOVE_RECURSE ${WORK})
run_step("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run_step("configure the consumer" ${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -G ${GENERATOR}
  -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${FLAGS}
  -D CMAKE_PREFIX_PATH=${WORK}/prefix)
run_step("build the consumer" ${CMAKE_COMMAND} --build ${WORK}/build)
run_step("run the consumer" ${WORK}/build/consumer)
run_step("run the installed program" ${WORK}/prefix/bin/fabloop --help)
file(REMOVE_RECURSE ${WORK})
