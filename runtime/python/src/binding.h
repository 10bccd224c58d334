// SPDX-License-Identifier: MIT
// Functions and classes of C++ that Python calls.
#pragma once

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "convert.h"

namespace spherechain::python {

// Runs what Python called: C++ exceptions become Python's.
template <typename Run>
auto guarded(const Run& run) -> decltype(run()) {
  try {
    return run();
  } catch (const PythonError&) {
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::invalid_argument& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
  return {};
}

// The type that a call holds for a parameter of type A while it runs: a value for a reference to const.
template <typename A>
using Held = std::conditional_t<std::is_lvalue_reference_v<A> && std::is_class_v<std::remove_reference_t<A>>,
                                std::remove_const_t<std::remove_reference_t<A>>, A>;

template <typename... A, std::size_t... I>
std::tuple<A...> arguments(PyObject* given, std::index_sequence<I...>) {
  require_length(given, sizeof...(A));
  return std::tuple<A...>{From<A>::get(PyTuple_GetItem(given, I))...};
}

// call<&function>(self, args) of a function whose first parameter is the instance.
template <auto F>
struct Call;
template <typename R, typename C, typename... A, R (*F)(C&, A...)>
struct Call<F> {
  static PyObject* run(PyObject* self, PyObject* given) {
    return guarded([&]() -> PyObject* {
      auto held = arguments<Held<A>...>(given, std::index_sequence_for<A...>());
      C& object = From<C&>::get(self);
      const auto call = [&](auto&... values) { return F(object, values...); };
      if constexpr (std::is_void_v<R>) {
        std::apply(call, held);
        Py_INCREF(Py_None);
        return Py_None;
      } else {
        return to_python(std::apply(call, held)).release();
      }
    });
  }
};

// The same of two functions: the type of the first array decides.
template <auto Single, auto Double>
PyObject* call_by_type(PyObject* self, PyObject* given) {
  return guarded([&]() -> PyObject* {
    if (length_of(given) > 0 && holds<double>(interface_of(array_capsule(PyTuple_GetItem(given, 0))))) {
      return Call<Double>::run(self, given);
    }
    return Call<Single>::run(self, given);
  });
}

// Makes an instance from the arguments A of C's constructor.
template <typename C, typename... A>
PyObject* make_instance(PyTypeObject* type, PyObject* given, PyObject*) {
  return guarded([&]() -> PyObject* {
    auto held = arguments<Held<A>...>(given, std::index_sequence_for<A...>());
    std::unique_ptr<C> value = std::apply([](auto&... values) { return std::make_unique<C>(values...); }, held);
    const auto allocate = reinterpret_cast<allocfunc>(PyType_GetSlot(type, Py_tp_alloc));
    PyObject* const self = Object::own(allocate(type, 0)).release();
    reinterpret_cast<Instance<C>*>(self)->value = value.release();
    return self;
  });
}

template <typename C>
void end_instance(PyObject* self) {
  PyTypeObject* const type = Py_TYPE(self);
  delete reinterpret_cast<Instance<C>*>(self)->value;
  reinterpret_cast<freefunc>(PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(reinterpret_cast<PyObject*>(type));
}

// Adds the class `name`, as "spherechain._native.Model", to a module. `methods` ends with an empty one.
template <typename C, typename... A>
void add_class(PyObject* module, const char* name, PyMethodDef* methods) {
  PyType_Slot slots[] = {{Py_tp_new, reinterpret_cast<void*>(&make_instance<C, A...>)},
                         {Py_tp_dealloc, reinterpret_cast<void*>(&end_instance<C>)},
                         {Py_tp_methods, methods},
                         {0, nullptr}};
  PyType_Spec spec{name, sizeof(Instance<C>), 0, Py_TPFLAGS_DEFAULT, slots};
  class_of<C> = Object::own(PyType_FromSpec(&spec)).release();
  if (PyModule_AddObject(module, std::string(name).substr(std::string(name).rfind('.') + 1).c_str(),
                         Object::borrow(class_of<C>).release()) < 0) {
    throw PythonError{};
  }
}

}  // namespace spherechain::python
