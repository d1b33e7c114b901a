# LTE_CUDA_ENABLED and lte::torch_cuda: the CUDA twins of the operators.
set(LTE_CUDA_ENABLED OFF)
if(LTE_CUDA STREQUAL "OFF")
  return()
endif()

include(CheckLanguage)
check_language(CUDA)
find_library(LTE_TORCH_CUDA torch_cuda HINTS ${LTE_TORCH_ROOT}/lib NO_DEFAULT_PATH)
find_library(LTE_C10_CUDA c10_cuda HINTS ${LTE_TORCH_ROOT}/lib NO_DEFAULT_PATH)
if(NOT CMAKE_CUDA_COMPILER OR NOT LTE_TORCH_CUDA OR NOT LTE_C10_CUDA)
  if(LTE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "LTE_CUDA=ON needs nvcc (found: ${CMAKE_CUDA_COMPILER}) and a LibTorch with CUDA (found: ${LTE_TORCH_CUDA})")
  endif()
  message(STATUS "CUDA: off (no nvcc, or a LibTorch without CUDA)")
  return()
endif()

if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES 80 89 90)
endif()
enable_language(CUDA)
# CMake 3.25 does not know that nvcc speaks C++20.
set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
set(CMAKE_CUDA_STANDARD 20)
find_package(CUDAToolkit REQUIRED)

add_library(lte_torch_cuda INTERFACE)
add_library(lte::torch_cuda ALIAS lte_torch_cuda)
set_target_properties(lte_torch_cuda PROPERTIES EXPORT_NAME torch_cuda)
target_link_libraries(lte_torch_cuda INTERFACE $<BUILD_INTERFACE:${LTE_TORCH_CUDA}> $<BUILD_INTERFACE:${LTE_C10_CUDA}> $<BUILD_INTERFACE:CUDA::cudart>)
# libtorch_cuda names cuBLAS, cuDNN, NCCL and others, which the machine that runs it has and this
# one may lack: nor must programs that link a library of ours look for them.
add_link_options(LINKER:--allow-shlib-undefined)
# No symbol of libtorch_cuda is called by name: where the linker drops such libraries, LibTorch
# would find no device.
target_link_options(lte_torch_cuda INTERFACE LINKER:--no-as-needed)
target_compile_options(lte_torch_cuda INTERFACE $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr -Xcompiler=-fPIC>)
set(LTE_CUDA_ENABLED ON)
message(STATUS "CUDA: on, architectures ${CMAKE_CUDA_ARCHITECTURES}")
