# soffit_flags: warnings, sanitizers and clang-tidy for our own sources (never for generated ones).
set(SOFFIT_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them")
option(SOFFIT_TIDY "Run clang-tidy on every source that is compiled" OFF)

add_library(soffit_flags INTERFACE)
target_compile_options(soffit_flags INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Werror)

if(SOFFIT_SANITIZE)
  add_compile_options(-fsanitize=${SOFFIT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SOFFIT_SANITIZE})
endif()

if(SOFFIT_TIDY)
  find_program(CLANG_TIDY clang-tidy REQUIRED)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
endif()
