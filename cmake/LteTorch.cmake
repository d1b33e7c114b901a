# lte::torch: LibTorch for the CPU, and with LTE_CUDA also lte::torch_cuda.
#
# Found, in this order: -DTorch_ROOT or CMAKE_PREFIX_PATH (a LibTorch folder: .../share/cmake/Torch
# inside), then the wheel in .venv that scripts/setup.sh makes. The CPU build links libtorch_cpu and
# libc10 alone: the wheel's own find_package(Torch) insists on a CUDA toolkit, and its libtorch.so
# leaves CUDA symbols open.
set(lte_torch_hints ${Torch_ROOT} $ENV{Torch_ROOT})
foreach(prefix ${CMAKE_PREFIX_PATH})
  list(APPEND lte_torch_hints ${prefix} ${prefix}/../..)
endforeach()
file(GLOB lte_torch_wheels ${PROJECT_SOURCE_DIR}/.venv/lib/python3*/site-packages/torch)
find_path(LTE_TORCH_INCLUDE torch/csrc/api/include/torch/torch.h HINTS ${lte_torch_hints} ${lte_torch_wheels}
          PATH_SUFFIXES include NO_DEFAULT_PATH)
if(NOT LTE_TORCH_INCLUDE)
  message(FATAL_ERROR "LibTorch not found: run scripts/setup.sh, or pass -DCMAKE_PREFIX_PATH=<LibTorch folder>, "
                      "or -DLTE_TORCH=OFF to build the scene and data tools alone")
endif()
get_filename_component(LTE_TORCH_ROOT ${LTE_TORCH_INCLUDE} DIRECTORY)
find_library(LTE_TORCH_CPU torch_cpu HINTS ${LTE_TORCH_ROOT}/lib NO_DEFAULT_PATH REQUIRED)
find_library(LTE_C10 c10 HINTS ${LTE_TORCH_ROOT}/lib NO_DEFAULT_PATH REQUIRED)

# libtorch_cpu of the wheel names two small CUDA libraries that sit beside it in nvidia/*/lib.
file(GLOB lte_nvidia_libs ${LTE_TORCH_ROOT}/../nvidia/*/lib)
set(lte_torch_rpath ${LTE_TORCH_ROOT}/lib ${lte_nvidia_libs})
find_package(Threads REQUIRED)

add_library(lte_torch INTERFACE)
add_library(lte::torch ALIAS lte_torch)
set_target_properties(lte_torch PROPERTIES EXPORT_NAME torch)
target_include_directories(lte_torch SYSTEM INTERFACE
  $<BUILD_INTERFACE:${LTE_TORCH_INCLUDE}> $<BUILD_INTERFACE:${LTE_TORCH_INCLUDE}/torch/csrc/api/include>)
target_link_libraries(lte_torch INTERFACE $<BUILD_INTERFACE:${LTE_TORCH_CPU}> $<BUILD_INTERFACE:${LTE_C10}> Threads::Threads)
foreach(dir ${lte_nvidia_libs})
  target_link_options(lte_torch INTERFACE $<BUILD_INTERFACE:LINKER:-rpath-link,${dir}>)
endforeach()
list(APPEND CMAKE_BUILD_RPATH ${lte_torch_rpath})
# Installed tools find our libraries beside them and LibTorch where it was when they were built.
set(CMAKE_INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}" ${lte_torch_rpath})
if(LTE_RELOCATABLE)
  # Its macros of checks have __FILE__ in them.
  target_compile_options(lte_torch INTERFACE
    $<BUILD_INTERFACE:-ffile-prefix-map=${LTE_TORCH_ROOT}/include/=>
    $<BUILD_INTERFACE:-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=>)
endif()
message(STATUS "LibTorch: ${LTE_TORCH_ROOT}")

include(LteCuda)
