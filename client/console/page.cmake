# Puts the console's page together: cmake -D SOURCE=… -D OUT=… -D WORK=… -D NPM=… -P page.cmake
file(REMOVE_RECURSE ${OUT})
set(WHAT "the web console is")
include(${CMAKE_CURRENT_LIST_DIR}/npm_ci.cmake)
if(NOT is_fetched)
  return()
endif()

set(three ${WORK}/node_modules/three)
file(COPY ${SOURCE}/page/ DESTINATION ${OUT})
file(COPY ${three}/build/three.module.js ${three}/build/three.core.js DESTINATION ${OUT}/three)
file(COPY ${three}/LICENSE DESTINATION ${OUT}/three)
# A bare 'three' would need an import map, which is an inline script: the page allows none.
file(READ ${three}/examples/jsm/controls/OrbitControls.js controls)
string(REPLACE "from 'three'" "from './three.module.js'" controls "${controls}")
file(WRITE ${OUT}/three/OrbitControls.js "${controls}")
