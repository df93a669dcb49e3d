# Compiles SOURCE, which must fail with every sentence that the file announces in a line `// EXPECT: sentence`.
# cmake -D COMPILER=g++ -D "INCLUDES=include;/usr/include/eigen3" -D SOURCE=file.cpp -P compile_fail.cmake
cmake_minimum_required(VERSION 3.25)
file(STRINGS "${SOURCE}" expectations REGEX "^// EXPECT: ")
if(NOT expectations)
  message(FATAL_ERROR "${SOURCE} has no line `// EXPECT: sentence`.")
endif()
set(flags -std=c++20 -fsyntax-only)
foreach(directory IN LISTS INCLUDES)
  if(directory MATCHES "tactoid|examples" OR EXISTS "${directory}/tactoid")
    list(APPEND flags "-I${directory}")
  elseif(NOT directory MATCHES "^(/usr/include)?$")
    list(APPEND flags -isystem "${directory}")
  endif()
endforeach()
execute_process(
  COMMAND ${COMPILER} ${flags} "${SOURCE}"
  RESULT_VARIABLE status
  OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "${SOURCE} compiles, but must not.")
endif()
foreach(line IN LISTS expectations)
  string(REPLACE "// EXPECT: " "" sentence "${line}")
  # The announcement itself may be quoted in a diagnostic; it does not count.
  string(REPLACE "${line}" "" rest "${output}")
  string(FIND "${rest}" "${sentence}" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "${SOURCE} fails, but the compiler does not say \"${sentence}\". It says:\n${output}")
  endif()
endforeach()
