# How this project's own programs are compiled. None of it reaches programs that use the library.
include_guard()

add_library(tactoid_build_flags INTERFACE)
if(MSVC)
  target_compile_options(tactoid_build_flags INTERFACE /W4 $<$<BOOL:${TACTOID_WARNINGS_AS_ERRORS}>:/WX>)
else()
  target_compile_options(
    tactoid_build_flags INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                  $<$<BOOL:${TACTOID_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The compiler tidies up its memory from 2 GB on, not from 0.1: up to a tenth of its time for a third more memory.
    target_compile_options(tactoid_build_flags INTERFACE --param=ggc-min-heapsize=2000000)
    # At -O1 g++ does not see that arrays of fixed size are filled by the loops over them.
    target_compile_options(tactoid_build_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
  if(TACTOID_NATIVE)
    target_compile_options(tactoid_build_flags INTERFACE -march=native)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      # g++ 12 warns of its own AVX-512 intrinsics, which leave a register undefined on purpose (GCC bug 105593), and of
      # Eigen's wide loads from short vectors, in branches that are never taken.
      target_compile_options(tactoid_build_flags INTERFACE -Wno-uninitialized -Wno-array-bounds -Wno-stringop-overflow)
    endif()
  endif()
endif()
