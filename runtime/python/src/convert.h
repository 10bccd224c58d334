// SPDX-License-Identifier: MIT
// Values of Python to values of C++, and back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "python.h"

namespace spherechain::python {

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

}  // namespace spherechain::python
