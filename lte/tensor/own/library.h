// Operators by name, of the CPU alone. Schemas are LibTorch's: they are not read here.
#pragma once

#include <map>
#include <string>
#include <typeindex>

#include "lte/tensor/own/error.h"

namespace lte::tensor {

/// A registered operator as a function of its type.
template <typename Signature>
struct TypedOperatorHandle;
template <typename Result, typename... Args>
struct TypedOperatorHandle<Result(Args...)> {
  Result (*function)(Args...);
  Result call(Args... args) const { return function(args...); }
};

class Operator {
 public:
  template <typename Function>
  explicit Operator(Function* function)
      : type_(typeid(Function)), function_(reinterpret_cast<void (*)()>(function)) {}

  template <typename Signature>
  TypedOperatorHandle<Signature> typed() const {
    TORCH_CHECK(type_ == typeid(Signature), "an operator is called as what it is not");
    return {reinterpret_cast<Signature*>(function_)};
  }

 private:
  std::type_index type_;
  void (*function_)();
};

class Dispatcher {
 public:
  static Dispatcher& singleton();
  const Operator& findSchemaOrThrow(const char* name, const char* overload) const;
  void add(const std::string& name, const Operator& op) { operators_.insert_or_assign(name, op); }

 private:
  std::map<std::string, Operator> operators_;
};

/// Registers operators of a file before main().
class Library {
 public:
  template <typename Function>
  void impl(const char* name, Function* function) {
    Dispatcher::singleton().add(std::string("lte::") + name, Operator(function));
  }
  void def(const char* /*schema*/) {}
};

struct Registration {
  explicit Registration(void (*each)(Library&)) {
    Library library;
    each(library);
  }
};

}  // namespace lte::tensor

#define LTE_JOIN_NAMES(a, b) a##b
#define LTE_LINE_NAME(name, line) LTE_JOIN_NAMES(name, line)
#define LTE_REGISTER(function, m)                                                   \
  static void function(::lte::tensor::Library& m);                                  \
  static const ::lte::tensor::Registration LTE_LINE_NAME(function, _at)(&function); \
  static void function([[maybe_unused]] ::lte::tensor::Library& m)

#define TORCH_LIBRARY_FRAGMENT(space, m) LTE_REGISTER(LTE_LINE_NAME(lte_define_, __COUNTER__), m)
#define TORCH_LIBRARY_IMPL(space, key, m) \
  LTE_REGISTER_##key(LTE_LINE_NAME(lte_implement_, __COUNTER__), m)
#define LTE_REGISTER_CPU(function, m) LTE_REGISTER(function, m)
// Gradients are LibTorch's.
#define LTE_REGISTER_Autograd(function, m) \
  [[maybe_unused]] static void function([[maybe_unused]] ::lte::tensor::Library& m)
