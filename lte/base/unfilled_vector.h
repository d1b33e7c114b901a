// Vectors whose resize() writes nothing: the pages of large arrays are touched once, by the threads
// that fill them.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace lte {

template <typename T>
struct UnfilledAllocator : std::allocator<T> {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  template <typename Other>
  struct rebind {
    using other = UnfilledAllocator<Other>;
  };
  void construct(T*) noexcept {}
  template <typename... Arguments>
  void construct(T* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) T(std::forward<Arguments>(arguments)...);
  }
};

/// New elements have no value until they are written.
template <typename T>
using UnfilledVector = std::vector<T, UnfilledAllocator<T>>;

}  // namespace lte
