// SPDX-License-Identifier: MIT
// Python's stable ABI of 3.9 for C++: one module serves every Python since. Arrays come by numpy's interface in C
// (__array_struct__), which needs none of numpy's headers and costs a fifth of a microsecond an array.
#pragma once

#define Py_LIMITED_API 0x03090000
#include <Python.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherechain::python {

// An exception is set in Python's thread state; the C++ frames on the way up are left.
struct PythonError {};

[[noreturn]] inline void raise(PyObject* kind, const std::string& message) {
  PyErr_SetString(kind, message.c_str());
  throw PythonError{};
}

// A reference that is owned, or none.
class Object {
 public:
  Object() = default;
  Object(const Object& other) : object_(other.object_) { Py_XINCREF(object_); }
  Object(Object&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Object& operator=(Object other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Object() { Py_XDECREF(object_); }

  // Takes a new reference, as most functions of Python return it. Null is an exception that Python has set.
  static Object own(PyObject* object) {
    if (object == nullptr) {
      throw PythonError{};
    }
    Object out;
    out.object_ = object;
    return out;
  }
  static Object borrow(PyObject* object) {
    Py_XINCREF(object);
    return own(object);
  }

  PyObject* get() const { return object_; }
  PyObject* release() { return std::exchange(object_, nullptr); }

 private:
  PyObject* object_ = nullptr;
};

// While one lives, other threads of Python run.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil() { PyEval_RestoreThread(state_); }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

class WithGil {
 public:
  WithGil() : state_(PyGILState_Ensure()) {}
  ~WithGil() { PyGILState_Release(state_); }
  WithGil(const WithGil&) = delete;
  WithGil& operator=(const WithGil&) = delete;

 private:
  PyGILState_STATE state_;
};

// The struct that numpy documents for __array_struct__.
struct ArrayInterface {
  int two, axes;
  char kind;
  int item_size, flags;
  Py_ssize_t *shape, *strides;
  void* data;
  PyObject* description;
};
enum : int { kCOrder = 0x1, kAligned = 0x100, kNativeBytes = 0x200, kWriteable = 0x400 };

template <typename T>
constexpr char kKind = std::is_floating_point_v<T> ? 'f'
                       : std::is_signed_v<T>       ? 'i'
                                                   : 'u';

// Returns the capsule that holds an array's ArrayInterface, and keeps the array.
inline Object array_capsule(PyObject* object) {
  PyObject* const capsule = PyObject_GetAttrString(object, "__array_struct__");
  if (capsule == nullptr) {
    PyErr_Clear();
    raise(PyExc_TypeError, "pass an array of numpy");
  }
  return Object::own(capsule);
}

inline const ArrayInterface& interface_of(const Object& capsule) {
  const auto* const out = static_cast<const ArrayInterface*>(PyCapsule_GetPointer(capsule.get(), nullptr));
  if (out == nullptr || out->two != 2) {
    raise(PyExc_TypeError, "__array_struct__ is not of the version that numpy has");
  }
  return *out;
}

template <typename T>
bool holds(const ArrayInterface& array) {
  return array.kind == kKind<T> && array.item_size == static_cast<int>(sizeof(T)) && (array.flags & kNativeBytes) != 0;
}

// An array of exactly this type, of any strides. It lives as long as this does.
template <typename T>
class Array {
 public:
  Array() = default;
  explicit Array(PyObject* object) : capsule_(array_capsule(object)), array_(&interface_of(capsule_)) {
    if (!holds<T>(*array_) || (array_->flags & kAligned) == 0) {
      raise(PyExc_TypeError, std::string("pass an aligned array of ") + kKind<T> + std::to_string(sizeof(T)));
    }
    object_ = Object::borrow(object);
  }
  explicit Array(std::initializer_list<std::size_t> shape) {
    // No guard of C++ around it: a thread that waits there would hold the GIL, which the import may need.
    static PyObject* empty = nullptr;
    if (empty == nullptr) {
      empty = Object::own(PyObject_GetAttrString(Object::own(PyImport_ImportModule("numpy")).get(), "empty")).release();
    }
    const Object sizes = Object::own(PyTuple_New(static_cast<Py_ssize_t>(shape.size())));
    Py_ssize_t axis = 0;
    for (const std::size_t size : shape) {
      PyTuple_SetItem(sizes.get(), axis++, Object::own(PyLong_FromSize_t(size)).release());
    }
    const char type[] = {kKind<T>, static_cast<char>('0' + sizeof(T)), 0};
    *this = Array(Object::own(PyObject_CallFunction(empty, "Os", sizes.get(), type)).get());
  }

  const Object& object() const { return object_; }
  std::size_t axes() const { return static_cast<std::size_t>(array_->axes); }
  std::size_t size(std::size_t axis) const { return static_cast<std::size_t>(array_->shape[axis]); }
  Py_ssize_t stride(std::size_t axis) const { return array_->strides[axis]; }  // in bytes
  bool is_c_order() const { return (array_->flags & kCOrder) != 0; }
  bool is_writeable() const { return (array_->flags & kWriteable) != 0; }
  T* data() const { return static_cast<T*>(array_->data); }

 private:
  Object capsule_, object_;
  const ArrayInterface* array_ = nullptr;
};

// An instance of the Python class for C.
template <typename C>
struct Instance {
  PyObject head;
  C* value;
};

template <typename C>
inline PyObject* class_of = nullptr;

// Bytes of Python, as opposed to its text.
struct Bytes {
  std::string data;
};

// From Python: From<T>::get(object) returns a T, or throws PythonError with a TypeError.
template <typename T, typename = void>
struct From;

template <typename T>
struct From<T, std::enable_if_t<std::is_integral_v<T>>> {
  static T get(PyObject* object) {
    if constexpr (std::is_same_v<T, bool>) {
      const int is = PyObject_IsTrue(object);
      return is < 0 ? throw PythonError{} : is != 0;
    } else {
      const Object number = Object::own(PyNumber_Index(object));
      const long long value = PyLong_AsLongLong(number.get());
      if (value == -1 && PyErr_Occurred() != nullptr) {
        throw PythonError{};
      }
      const T out = static_cast<T>(value);
      if (static_cast<long long>(out) != value || (std::is_unsigned_v<T> && value < 0)) {
        raise(PyExc_OverflowError, "a number is out of range");
      }
      return out;
    }
  }
};

template <typename T>
struct From<T, std::enable_if_t<std::is_enum_v<T>>> {
  static T get(PyObject* object) { return static_cast<T>(From<std::uint8_t>::get(object)); }
};

template <>
struct From<float> {
  static float get(PyObject* object) {
    const double value = PyFloat_AsDouble(object);
    return value == -1 && PyErr_Occurred() != nullptr ? throw PythonError{} : static_cast<float>(value);
  }
};

template <>
struct From<Object> {
  static Object get(PyObject* object) { return Object::borrow(object); }
};

template <>
struct From<Bytes> {
  static Bytes get(PyObject* object) {
    char* data = nullptr;
    Py_ssize_t size = 0;
    return PyBytes_AsStringAndSize(object, &data, &size) < 0 ? throw PythonError{}
                                                             : Bytes{{data, static_cast<std::size_t>(size)}};
  }
};

template <>
struct From<std::string> {
  static std::string get(PyObject* object) {
    return From<Bytes>::get(Object::own(PyUnicode_AsUTF8String(object)).get()).data;
  }
};

template <typename T>
struct From<Array<T>> {
  static Array<T> get(PyObject* object) { return Array<T>(object); }
};

template <typename T>
struct From<std::optional<T>> {
  static std::optional<T> get(PyObject* object) {
    return object == Py_None ? std::nullopt : std::optional<T>(From<T>::get(object));
  }
};

template <typename T>
T item(PyObject* sequence, std::size_t i) {
  return From<T>::get(Object::own(PySequence_GetItem(sequence, static_cast<Py_ssize_t>(i))).get());
}

inline std::size_t length_of(PyObject* sequence) {
  const Py_ssize_t size = PySequence_Size(sequence);
  return size < 0 ? throw PythonError{} : static_cast<std::size_t>(size);
}

inline void require_length(PyObject* sequence, std::size_t size) {
  if (length_of(sequence) != size) {
    raise(PyExc_TypeError, "pass " + std::to_string(size) + " entries");
  }
}

template <typename T>
struct From<std::vector<T>> {
  static std::vector<T> get(PyObject* object) {
    std::vector<T> out;
    for (std::size_t i = 0; i < length_of(object); ++i) {
      out.push_back(item<T>(object, i));
    }
    return out;
  }
};

template <typename T, std::size_t N>
struct From<std::array<T, N>> {
  static std::array<T, N> get(PyObject* object) {
    require_length(object, N);
    std::array<T, N> out;
    for (std::size_t i = 0; i < N; ++i) {
      out[i] = item<T>(object, i);
    }
    return out;
  }
};

template <typename A, typename B>
struct From<std::pair<A, B>> {
  static std::pair<A, B> get(PyObject* object) {
    require_length(object, 2);
    return {item<A>(object, 0), item<B>(object, 1)};
  }
};

template <typename C>
struct From<C&> {
  static C& get(PyObject* object) {
    using Class = std::remove_const_t<C>;
    if (PyObject_IsInstance(object, class_of<Class>) != 1) {
      PyErr_Clear();
      raise(PyExc_TypeError, "an object is of another class");
    }
    return *reinterpret_cast<Instance<Class>*>(object)->value;
  }
};

template <typename C>
struct From<C*> {
  static C* get(PyObject* object) { return object == Py_None ? nullptr : &From<C&>::get(object); }
};

template <typename T>
T entry(const Object& dict, const char* name) {
  PyObject* const value = PyDict_GetItemString(dict.get(), name);
  if (value == nullptr) {
    raise(PyExc_KeyError, name);
  }
  return From<T>::get(value);
}

// To Python.
inline Object to_python(Object object) { return object; }
inline Object to_python(const char* text) { return Object::own(PyUnicode_FromString(text)); }
inline Object to_python(const Bytes& bytes) {
  return Object::own(PyBytes_FromStringAndSize(bytes.data.data(), static_cast<Py_ssize_t>(bytes.data.size())));
}
template <typename T, typename = std::enable_if_t<std::is_arithmetic_v<T>>>
Object to_python(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return Object::own(PyFloat_FromDouble(double{value}));
  } else if constexpr (std::is_signed_v<T>) {
    return Object::own(PyLong_FromLongLong(value));
  } else {
    return Object::own(PyLong_FromUnsignedLongLong(value));
  }
}
template <typename T>
Object to_python(const Array<T>& array) {
  return array.object();
}

template <typename Entry>
Object list_of(std::size_t count, const Entry& entry_of) {
  Object out = Object::own(PyList_New(static_cast<Py_ssize_t>(count)));
  for (std::size_t i = 0; i < count; ++i) {
    PyList_SetItem(out.get(), static_cast<Py_ssize_t>(i), to_python(entry_of(i)).release());
  }
  return out;
}

template <typename... T>
Object tuple_of(const T&... values) {
  Object out = Object::own(PyTuple_New(sizeof...(T)));
  Py_ssize_t place = 0;
  (PyTuple_SetItem(out.get(), place++, to_python(values).release()), ...);
  return out;
}

template <typename T>
void set(const Object& dict, const char* name, const T& value) {
  if (PyDict_SetItemString(dict.get(), name, to_python(value).get()) < 0) {
    throw PythonError{};
  }
}

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
