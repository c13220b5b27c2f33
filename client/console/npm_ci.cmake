# Fetches what ${SOURCE}/package-lock.json names into ${WORK}/node_modules, once for each lock; sets is_fetched.
# Without npm's registry everything else is built all the same.
set(is_fetched FALSE)
file(READ ${SOURCE}/package-lock.json lock)
set(done "")
if(EXISTS ${WORK}/done.json)
  file(READ ${WORK}/done.json done)
endif()
if(done STREQUAL lock)
  set(is_fetched TRUE)
  return()
endif()
file(MAKE_DIRECTORY ${WORK})
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${WORK})
execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
                WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed ERROR_VARIABLE why OUTPUT_QUIET)
if(failed)
  message("npm could not fetch what ${SOURCE}/package-lock.json names, so ${WHAT} left out; build again when this "
          "machine is online.\n${why}")
  return()
endif()
file(COPY_FILE ${SOURCE}/package-lock.json ${WORK}/done.json)
set(is_fetched TRUE)
