include(GoogleTest)

# soffit_library(NAME FOLDER folder [PUBLIC lib...] [PRIVATE lib...])
#
# One folder is one target: soffit::NAME from every source file in FOLDER, tested by every *_test.cc in the
# mirrored folder under test/. Tests are named FOLDER/Suite.Case and carry the folder as their label.
function(soffit_library name)
  cmake_parse_arguments(ARG "" "FOLDER" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${ARG_FOLDER}/*.cc)
  list(FILTER sources EXCLUDE REGEX "_main\\.cc$")
  if(sources)
    add_library(soffit_${name} STATIC ${sources})
    target_include_directories(soffit_${name} PUBLIC ${PROJECT_SOURCE_DIR})
    target_link_libraries(soffit_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} soffit_flags)
    soffit_tidy(soffit_${name})
  else()
    add_library(soffit_${name} INTERFACE)
    target_include_directories(soffit_${name} INTERFACE ${PROJECT_SOURCE_DIR})
    target_link_libraries(soffit_${name} INTERFACE ${ARG_PUBLIC})
  endif()
  add_library(soffit::${name} ALIAS soffit_${name})
  soffit_test(${name} FOLDER ${ARG_FOLDER} PRIVATE soffit::${name})
endfunction()

# soffit_test(NAME FOLDER folder [PRIVATE lib...]): the *_test.cc of test/FOLDER as one test program.
function(soffit_test name)
  cmake_parse_arguments(ARG "" "FOLDER;TIMEOUT" "PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/${ARG_FOLDER}/*_test.cc)
  if(NOT sources)
    return()
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name}_test ${sources})
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name}_test PRIVATE ${ARG_PRIVATE} GTest::gmock GTest::gtest_main soffit_flags)
  set_target_properties(${name}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/test)
  gtest_discover_tests(${name}_test TEST_PREFIX ${ARG_FOLDER}/ DISCOVERY_MODE PRE_TEST NO_PRETTY_VALUES
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS ${ARG_FOLDER})
endfunction()

# soffit_stage(NAME [PUBLIC lib...] [PRIVATE lib...]): a stage of the service, in service/NAME.
function(soffit_stage name)
  soffit_library(${name} FOLDER service/${name} ${ARGN})
endfunction()

# soffit_program(NAME MAIN file [PRIVATE lib...]): a program in bin/, installed.
function(soffit_program name)
  cmake_parse_arguments(ARG "" "MAIN" "PRIVATE" ${ARGN})
  add_executable(${name} ${ARG_MAIN})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} soffit_flags)
  soffit_tidy(${name})
  install(TARGETS ${name} RUNTIME)
endfunction()

function(soffit_tidy target)
  if(SOFFIT_TIDY)
    set_target_properties(${target} PROPERTIES CXX_CLANG_TIDY ${CLANG_TIDY})
  endif()
endfunction()
