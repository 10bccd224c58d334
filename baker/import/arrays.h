// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// A table of numbers or of texts, as numpy saves them. The last index runs fastest. A single value has no shape.
struct Array {
  std::vector<std::size_t> shape;
  std::vector<double> numbers;     // booleans are 0 and 1
  std::vector<std::string> texts;  // in place of numbers
  std::string refused;             // why it could not be read; empty where it was
};

// Tables by name. The table of an .npy file has the empty name; a table in nested dictionaries of a pickle is
// "outer/inner", but a dictionary with one name around all others is left out.
using Arrays = std::map<std::string, Array>;

// True if a file is an .npy, an .npz or a pickle by its content, or says so by its ending.
bool is_arrays(const std::filesystem::path& path);

// Reads all tables of such a file. A pickle is read as data: nothing in it is executed, and what is neither a number, a
// text, a list, a dictionary nor a numpy table is refused by its name. Throws Error(kFile).
Arrays read_arrays(const std::filesystem::path& path);

// The table of this name; null where there is none. Throws Error(kFile) that begins with `file` where it could not be
// read, or holds a number that is not finite or is beyond 1e9.
const Array* find_table(const Arrays& arrays, const std::string& name, const std::string& file);

// Frames a second, by 'mocap_framerate', 'mocap_frame_rate', 'fps' or 'frame_rate'. Where there is none of them, it is
// 30, and a note (notes.h) says so. Throws Error(kFile).
double frame_rate(const Arrays& arrays, const std::string& file);

// read_arrays on bytes; `file` is for messages. They throw Error(kFile).
Array parse_npy(std::string_view bytes, const std::string& file);
Arrays parse_npz(std::string_view bytes, const std::string& file);  // a table that cannot be read is `refused`
Arrays parse_pickle(std::string_view bytes, const std::string& file);

// The type of a table's elements by numpy's short name, such as "<f4".
struct ElementType {
  char kind = 0;         // f, i, u, b(oolean), U(nicode) or S (bytes)
  std::size_t size = 0;  // bytes of an element
  bool is_big_endian = false;
};
// Throws std::runtime_error that says which type is not read.
ElementType element_type(std::string_view name);

// A table of elements as they lie in memory; in Fortran's order the first index runs fastest. Throws std::runtime_error
// where the bytes are too few or the table is too large.
Array table_of(const ElementType& type, std::vector<std::size_t> shape, bool is_fortran, std::string_view bytes);

}  // namespace spherechain::baker
