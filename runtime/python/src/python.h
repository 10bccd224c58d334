// SPDX-License-Identifier: MIT
// Objects and arrays of Python, by its stable ABI of 3.9: one module serves every Python since. Arrays come by numpy's
// interface in C (__array_struct__), which needs none of numpy's headers.
#pragma once

#define Py_LIMITED_API 0x03090000
#include <Python.h>

#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>

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

}  // namespace spherechain::python
