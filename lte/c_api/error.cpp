#include "lte/c_api/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string_view>

#include "lte/base/text.h"
#include "lte/runtime/device.h"
#include "lte/runtime/limit_error.h"

namespace lte::c_api {
namespace {

/// Of fixed size, so that running out of memory can be told.
thread_local std::array<char, 1024> last_message{};

lte_status keep(lte_status status, std::string_view message) noexcept {
  const size_t size = std::min(message.size(), last_message.size() - 1);
  std::memcpy(last_message.data(), message.data(), size);
  last_message[size] = '\0';
  return status;
}

}  // namespace

const char* last_error() noexcept { return last_message.data(); }

lte_status record(const std::exception_ptr& error, lte_status of_ours) noexcept {
  try {
    try {
      std::rethrow_exception(error);
    } catch (const ApiError& e) {
      return keep(e.status(), e.what());
    } catch (const runtime::SceneTooLarge& e) {
      return keep(LTE_ERROR_SCENE_TOO_LARGE, concat("scene points: ", e.what()));
    } catch (const runtime::NoDevice& e) {
      return keep(LTE_ERROR_NO_CUDA, e.what());
    } catch (const runtime::NotEnoughMemory& e) {
      return keep(LTE_ERROR_OUT_OF_MEMORY, e.what());
    } catch (const runtime::GpuFailure& e) {
      return keep(LTE_ERROR_CUDA, e.what());
    } catch (const Error& e) {
      return keep(of_ours, e.what());
    } catch (const std::bad_alloc&) {
      return keep(LTE_ERROR_OUT_OF_MEMORY, "out of memory");
    } catch (const std::exception& e) {
      return keep(LTE_ERROR_INTERNAL, first_line(e.what()));
    }
  } catch (...) {  // no std::exception, or no memory for the words of one
    return keep(LTE_ERROR_INTERNAL, "an unknown error");
  }
}

}  // namespace lte::c_api
