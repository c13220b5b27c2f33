# Writes OUTPUT from TEMPLATE where the build id has changed.
set(BUILD_ID "${VERSION}")
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE_DIR} describe --always --dirty --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
                  RESULT_VARIABLE status)
  if(status EQUAL 0)
    string(APPEND BUILD_ID "+${commit}")
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
