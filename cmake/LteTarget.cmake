# Flags as INTERFACE targets, and the two functions every folder uses.
add_library(lte_warnings INTERFACE)
add_library(lte::warnings ALIAS lte_warnings)
target_compile_options(lte_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wvla>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${LTE_WERROR}>>:-Werror>)
if(LTE_SANITIZE)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined> $<$<COMPILE_LANGUAGE:CXX>:-fno-omit-frame-pointer>
                      $<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=vptr>)
  add_link_options(-fsanitize=address,undefined)
endif()
if(LTE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "LTE_FUZZ=ON needs clang (-DCMAKE_CXX_COMPILER=clang++), not ${CMAKE_CXX_COMPILER_ID}")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-sanitize=vptr)
  add_link_options(-fsanitize=address,undefined)
endif()

# lte_add_library(NAME [SHARED] [FAST] SOURCES ... DEPS ... [PRIVATE_DEPS ...]): target lte_NAME,
# alias lte::NAME. FAST: inner loops of its own, compiled with -O3.
function(lte_add_library name)
  cmake_parse_arguments(arg "SHARED;FAST" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  set(kind STATIC)
  if(arg_SHARED)
    set(kind SHARED)
  endif()
  add_library(lte_${name} ${kind} ${arg_SOURCES})
  add_library(lte::${name} ALIAS lte_${name})
  set_target_properties(lte_${name} PROPERTIES EXPORT_NAME ${name} DEFINE_SYMBOL "")
  target_include_directories(lte_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(lte_${name} INTERFACE cxx_std_20)  # the headers; CMake's default is C++17
  if(arg_FAST)
    target_compile_options(lte_${name} PRIVATE $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O3>)
  endif()
  target_link_libraries(lte_${name} PUBLIC ${arg_DEPS} PRIVATE $<BUILD_INTERFACE:lte::warnings> ${arg_PRIVATE_DEPS})
  set_property(GLOBAL APPEND PROPERTY LTE_LIBRARIES lte_${name})
endfunction()

# lte_unite_folders(TARGET MOST): compiles the sources of each folder of a target together, at most
# MOST at a time: a file that includes LibTorch, CLI11 or a parser of JSON costs seconds before its
# first line. Sources with options, definitions or precompiled headers of their own stay alone, so
# it comes after those are set. Names in unnamed namespaces differ within a folder.
function(lte_unite_folders target most)
  set(sources)  # the caller may have a list of this name
  set(folders)
  get_target_property(all ${target} SOURCES)
  list(FILTER all INCLUDE REGEX "^[^/$].*\\.cpp$")
  foreach(file IN LISTS all)
    set(own FALSE)
    foreach(property COMPILE_DEFINITIONS COMPILE_OPTIONS SKIP_PRECOMPILE_HEADERS)
      get_source_file_property(value ${file} ${property})
      if(value)
        set(own TRUE)
      endif()
    endforeach()
    if(NOT own)
      list(APPEND sources ${file})
    endif()
  endforeach()
  foreach(file IN LISTS sources)
    get_filename_component(folder ${file} DIRECTORY)
    string(MAKE_C_IDENTIFIER "${target}_${folder}" folder)
    list(APPEND folders ${folder})
    list(APPEND files_${folder} ${file})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    list(LENGTH files_${folder} count)
    math(EXPR groups "(${count} + ${most} - 1) / ${most}")
    set(number 0)
    foreach(file IN LISTS files_${folder})
      math(EXPR group "${number} * ${groups} / ${count}")
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${folder}_${group})
      math(EXPR number "${number} + 1")
    endforeach()
  endforeach()
  if(LTE_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
endfunction()

# lte_add_tool(NAME SOURCE DEPS ...): an executable in build/bin. Its main, as NAME_main, is in
# NAME_objects, which the program lte and the Python package link, too.
function(lte_add_tool name source)
  add_library(${name}_objects OBJECT ${source})
  # A main parses its command line, which is CLI11's templates and no work.
  target_compile_options(${name}_objects PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name}_objects PRIVATE main=${name}_main)
  target_link_libraries(${name}_objects PUBLIC ${ARGN} PRIVATE lte::warnings)
  add_executable(${name} ${PROJECT_SOURCE_DIR}/program/tool_main.cpp)
  target_compile_definitions(${name} PRIVATE LTE_TOOL_MAIN=${name}_main)
  target_link_libraries(${name} PRIVATE ${name}_objects lte::warnings)
  # Packages have the program lte, and links of these names to it.
  set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ${LTE_RELOCATABLE})
  set_property(GLOBAL APPEND PROPERTY LTE_TOOLS ${name})
endfunction()

# lte_use_first_versions(TARGET): what a wheel has, for older systems than this one.
function(lte_use_first_versions target)
  set(source ${PROJECT_SOURCE_DIR}/python/src/first_versions.cpp)
  target_sources(${target} PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_link_options(${target} PRIVATE -Wl,--wrap=hypot,--wrap=hypotf
    -Wl,--wrap=_ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE)
endfunction()

# lte_add_test(FOLDER SOURCES ... DEPS ... [LABELS ...] [PCH TARGET] [OWN_WAITING]): one executable
# and one ctest entry a folder. PCH names another precompiled header than that of tests, NONE for
# one of its own. Threads of OpenMP wait as in the tools, but with OWN_WAITING.
function(lte_add_test folder)
  cmake_parse_arguments(arg "OWN_WAITING" "PCH" "SOURCES;DEPS;LABELS" ${ARGN})
  set(name lte_${folder}_test)
  if(NOT arg_PCH)
    set(arg_PCH lte_test_pch)
    if(NOT TARGET lte_test_pch)
      add_library(lte_test_pch OBJECT ${PROJECT_SOURCE_DIR}/tests/support/pch.cpp)
      target_compile_options(lte_test_pch PRIVATE $<$<CONFIG:Release>:-O1>)
      target_link_libraries(lte_test_pch PRIVATE GTest::gtest GTest::gmock lte::warnings)
      target_precompile_headers(lte_test_pch PRIVATE ${PROJECT_SOURCE_DIR}/tests/support/pch.h)
    endif()
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE lte::warnings ${arg_DEPS} GTest::gtest GTest::gmock GTest::gtest_main)
  if(NOT arg_OWN_WAITING)
    target_sources(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support/passive_waiting.cpp)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/tests/support/passive_waiting.cpp
                                PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  endif()
  if(NOT arg_PCH STREQUAL "NONE")
    target_precompile_headers(${name} REUSE_FROM ${arg_PCH})
    # GCC 12 takes functions of the standard library for ours where they come from a precompiled
    # header, and warns of what it inlines of strings.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${name} PRIVATE -Wno-array-bounds -Wno-restrict)
    endif()
  endif()
  # Tests are compiled for every build and run for seconds.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE LTE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" LTE_BINARY_DIR="${CMAKE_BINARY_DIR}")
  add_test(NAME ${folder} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${folder} PROPERTIES TIMEOUT 1200 LABELS "${arg_LABELS}")
  lte_test_environment(${folder})
endfunction()

# lte_test_environment(TEST [NAME=VALUE ...]): variables that a ctest entry runs with, and where
# GoogleTest puts its results: a file an entry, as entries of one program may run at the same time.
function(lte_test_environment test)
  set_tests_properties(${test} PROPERTIES ENVIRONMENT
    "GTEST_OUTPUT=json:${CMAKE_BINARY_DIR}/test-results/${test}.json;${ARGN}")
endfunction()

# Whether this processor has AVX-512. Where it has not, a run by AVX2 is the plain run once more.
set(LTE_MACHINE_HAS_AVX512 FALSE)
if(EXISTS /proc/cpuinfo)
  file(STRINGS /proc/cpuinfo lte_avx512_flags REGEX "avx512f" LIMIT_COUNT 1)
  if(lte_avx512_flags)
    set(LTE_MACHINE_HAS_AVX512 TRUE)
  endif()
endif()

# lte_test_as_avx2(FOLDER [FILTER]): on a processor with AVX-512, the same tests once more as one
# without would run them; FILTER is GoogleTest's and leaves out what no instruction set can change.
function(lte_test_as_avx2 folder)
  if(NOT LTE_MACHINE_HAS_AVX512)
    return()
  endif()
  add_test(NAME ${folder}_avx2 COMMAND lte_${folder}_test ${ARGN}
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${folder}_avx2 PROPERTIES TIMEOUT 1200)
  lte_test_environment(${folder}_avx2 LTE_CPU_ISA=avx2 ATEN_CPU_CAPABILITY=avx2
    ONEDNN_MAX_CPU_ISA=AVX2 MKL_ENABLE_INSTRUCTIONS=AVX2)
endfunction()
