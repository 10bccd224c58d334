// SPDX-License-Identifier: GPL-3.0-or-later
// A pickle is a program for a small stack machine, which may call any function of Python. This one knows no function:
// it recognises the few names by which numpy's tables are written, and builds the tables from their arguments.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>

#include "baker/import/arrays.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

[[noreturn]] void fail_pickle(const std::string& what) { throw std::runtime_error(what); }
[[noreturn]] void fail_damaged() { fail_pickle("is damaged or cut off (save it again)"); }

using Ref = std::size_t;  // a value's number; lists may share values, or hold themselves

struct Value {
  enum class Kind { kNone, kBool, kNumber, kText, kBytes, kList, kTuple, kDict, kGlobal, kType, kTable };
  Kind kind = Kind::kNone;
  double number = 0;
  std::string text{};        // also the bytes, the name of a global, and that of a type of elements
  std::vector<Ref> items{};  // of a dictionary: key, value, key ...
  std::shared_ptr<Array> table{};
};
using Kind = Value::Kind;

// Names in a pickle that stand for what a table is made with.
enum class Maker { kReconstruct, kFromBuffer, kScalar, kType, kTableType, kEncode, kBytes, kDictionary };
std::optional<Maker> maker_of(std::string_view module, std::string_view name) {
  const bool is_builtin = module == "builtins" || module == "__builtin__";
  if (module.starts_with("numpy._core")) module.remove_prefix(7);
  if (module.starts_with("numpy.core")) module.remove_prefix(6);
  if (module == "core.multiarray" && name == "_reconstruct") return Maker::kReconstruct;
  if (module == "core.multiarray" && name == "scalar") return Maker::kScalar;
  if (module == "core.numeric" && name == "_frombuffer") return Maker::kFromBuffer;
  if (module == "numpy" && name == "dtype") return Maker::kType;
  if (module == "numpy" && name == "ndarray") return Maker::kTableType;
  if (module == "_codecs" && name == "encode") return Maker::kEncode;
  if (is_builtin && (name == "bytes" || name == "bytearray")) return Maker::kBytes;
  if (module == "collections" && name == "OrderedDict") return Maker::kDictionary;
  return std::nullopt;
}

class PickleMachine {
 public:
  explicit PickleMachine(std::string_view bytes) : bytes_(bytes) {
    if (bytes.size() < 2 || bytes[0] != '\x80') {
      fail_pickle("is no pickle of protocol 2 to 5 (save it again by pickle.dump with protocol 4)");
    }
  }

  // The number of the value that the pickle holds.
  Ref run() {
    while (true) {
      const auto code = static_cast<unsigned char>(take(1)[0]);
      if (code == '.') return pop();
      step(code);
    }
  }
  const Value& at(Ref ref) const { return values_[ref]; }

 private:
  void step(unsigned char code) {
    switch (code) {
      case 0x80:  // PROTO
        if (const auto version = unsigned_of(1); version < 2 || version > 5) {
          fail_pickle(fmt::format("is a pickle of protocol {}; 2 to 5 are read (save it with protocol 4)", version));
        }
        return;
      case 0x95:  // FRAME
        take(8);
        return;
      case '0':
        pop();
        return;
      case '1':
        pop_to_mark();
        return;
      case '2':
        stack_.push_back(top());
        return;
      case '(':
        marks_.push_back(stack_.size());
        return;
      case 'N':
        push({});
        return;
      case 0x88:
      case 0x89:
        push({Kind::kBool, code == 0x88 ? 1.0 : 0.0});
        return;
      case 'K':
        return push_number(static_cast<double>(unsigned_of(1)));
      case 'M':
        return push_number(static_cast<double>(unsigned_of(2)));
      case 'J':
        return push_number(static_cast<std::int32_t>(unsigned_of(4)));
      case 0x8a:
        return push_long(unsigned_of(1));
      case 0x8b:
        return push_long(unsigned_of(4));
      case 'G':
        return push_double();
      case 0x8c:
        return push_text(Kind::kText, 1);
      case 'X':
        return push_text(Kind::kText, 4);
      case 0x8d:
        return push_text(Kind::kText, 8);
      case 'U':  // Python 2's texts, which are bytes
      case 'C':
        return push_text(Kind::kBytes, 1);
      case 'T':
      case 'B':
        return push_text(Kind::kBytes, 4);
      case 0x8e:
      case 0x96:
        return push_text(Kind::kBytes, 8);
      case ']':
        push({Kind::kList});
        return;
      case ')':
        push({Kind::kTuple});
        return;
      case '}':
        push({Kind::kDict});
        return;
      case 'l':
        return push_items(Kind::kList, pop_to_mark());
      case 't':
        return push_items(Kind::kTuple, pop_to_mark());
      case 'd':
        return push_items(Kind::kDict, pop_to_mark());
      case 0x85:
      case 0x86:
      case 0x87:
        return push_items(Kind::kTuple, pop(code - 0x84u));
      case 'a':
        return add_to(Kind::kList, pop(1));
      case 'e':
        return add_to(Kind::kList, pop_to_mark());
      case 's':
        return add_to(Kind::kDict, pop(2));
      case 'u':
        return add_to(Kind::kDict, pop_to_mark());
      case 'q':
        return remember(unsigned_of(1));
      case 'r':
        return remember(unsigned_of(4));
      case 0x94:
        return remember(memo_.size());
      case 'h':
        return recall(unsigned_of(1));
      case 'j':
        return recall(unsigned_of(4));
      case 'c': {
        const std::string module = line(), name = line();
        return push_global(module, name);
      }
      case 0x93: {
        const std::string name = pop_text(), module = pop_text();
        return push_global(module, name);
      }
      case 'R':
      case 0x81:
        return make();
      case 'b':
        return build();
      default:
        fail_pickle(
            fmt::format("has the pickle instruction {:#04x}, which is not read (save numbers, lists, dictionaries and "
                        "numpy tables)",
                        code));
    }
  }

  std::string_view take(std::size_t size) {
    if (size > bytes_.size() - place_) fail_damaged();
    place_ += size;
    return bytes_.substr(place_ - size, size);
  }
  std::uint64_t unsigned_of(std::size_t size) {
    std::uint64_t out = 0;
    const std::string_view bytes = take(size);
    for (std::size_t k = size; k-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[k]);
    return out;
  }
  std::string line() {
    const std::size_t end = bytes_.find('\n', place_);
    if (end == bytes_.npos) fail_damaged();
    const std::string out(take(end - place_));
    take(1);
    return out;
  }

  void push(Value value) {
    values_.push_back(std::move(value));
    stack_.push_back(values_.size() - 1);
  }
  void push_number(double number) { push({Kind::kNumber, number}); }
  // A whole number of any length: the lowest byte comes first, in two's complement.
  void push_long(std::uint64_t size) {
    const std::string_view bytes = take(size);
    double out = 0;
    for (std::size_t k = size; k-- > 0;) out = out * 256 + static_cast<unsigned char>(bytes[k]);
    if (size > 0 && static_cast<signed char>(bytes.back()) < 0) out -= std::ldexp(1.0, static_cast<int>(8 * size));
    push_number(out);
  }
  void push_double() {
    std::uint64_t bits = 0;
    for (const char c : take(8)) bits = bits << 8 | static_cast<unsigned char>(c);
    double out;
    std::memcpy(&out, &bits, sizeof out);
    push_number(out);
  }
  void push_text(Kind kind, std::size_t width) {
    const std::uint64_t size = unsigned_of(width);
    push({kind, 0, std::string(take(size))});
  }
  void push_items(Kind kind, std::vector<Ref> items) { push({kind, 0, {}, std::move(items)}); }
  void push_global(const std::string& module, const std::string& name) {
    const std::optional<Maker> maker = maker_of(module, name);
    if (!maker) {
      fail_pickle(
          fmt::format("holds '{}.{}', which is not read: a pickle may run any program (save numbers, lists, "
                      "dictionaries and numpy tables)",
                      module, name));
    }
    push({Kind::kGlobal, static_cast<double>(*maker), module + "." + name});
  }

  Ref top() const {
    if (stack_.size() <= (marks_.empty() ? 0 : marks_.back())) fail_damaged();
    return stack_.back();
  }
  Ref pop() {
    const Ref out = top();
    stack_.pop_back();
    return out;
  }
  std::vector<Ref> pop(std::size_t count) {
    std::vector<Ref> out(count);
    for (std::size_t k = count; k-- > 0;) out[k] = pop();
    return out;
  }
  std::vector<Ref> pop_to_mark() {
    if (marks_.empty()) fail_damaged();
    const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
    std::vector<Ref> out(begin, stack_.end());
    stack_.erase(begin, stack_.end());
    marks_.pop_back();
    return out;
  }
  std::string pop_text() {
    const Value& value = values_[pop()];
    if (value.kind != Kind::kText) fail_damaged();
    return value.text;
  }
  void add_to(Kind kind, const std::vector<Ref>& items) {
    Value& into = values_[top()];
    if (into.kind != kind || (kind == Kind::kDict && items.size() % 2 != 0)) fail_damaged();
    into.items.insert(into.items.end(), items.begin(), items.end());
  }
  void remember(std::size_t number) { memo_[number] = top(); }
  void recall(std::size_t number) {
    const auto found = memo_.find(number);
    if (found == memo_.end()) fail_damaged();
    stack_.push_back(found->second);
  }

  const Value& item(const Value& tuple, std::size_t k) const {
    if (tuple.kind != Kind::kTuple || k >= tuple.items.size()) fail_damaged();
    return values_[tuple.items[k]];
  }
  static const std::string& text_in(const Value& value) {
    if (value.kind != Kind::kText && value.kind != Kind::kBytes) fail_damaged();
    return value.text;
  }
  std::vector<std::size_t> shape_in(const Value& value) const {
    std::vector<std::size_t> out;
    if (value.kind == Kind::kNumber) return {size_in(value)};
    if (value.kind != Kind::kTuple) fail_damaged();
    for (const Ref ref : value.items) out.push_back(size_in(values_[ref]));
    return out;
  }
  static std::size_t size_in(const Value& value) {
    constexpr double kMax = 1e15;
    if (value.kind != Kind::kNumber || !(value.number >= 0 && value.number < kMax)) fail_damaged();
    return static_cast<std::size_t>(value.number);
  }
  static std::string type_in(const Value& value) {
    if (value.kind != Kind::kType) fail_damaged();
    return value.text;
  }
  static Value table(const std::string& type, std::vector<std::size_t> shape, bool is_fortran, std::string_view bytes) {
    Value out{Kind::kTable};
    out.table = std::make_shared<Array>(table_of(element_type(type), std::move(shape), is_fortran, bytes));
    return out;
  }

  // One of the names above with its arguments.
  void make() {
    const Ref arguments_at = pop(), maker_at = pop();
    const Value arguments = values_[arguments_at];
    if (values_[maker_at].kind != Kind::kGlobal) fail_damaged();
    switch (static_cast<Maker>(static_cast<int>(values_[maker_at].number))) {
      case Maker::kReconstruct:  // empty, until its state follows
        return push({Kind::kTable, 0, {}, {}, std::make_shared<Array>()});
      case Maker::kFromBuffer:
        return push(table(type_in(item(arguments, 1)), shape_in(item(arguments, 2)), text_in(item(arguments, 3)) == "F",
                          text_in(item(arguments, 0))));
      case Maker::kScalar:
        return push(table(type_in(item(arguments, 0)), {}, false, text_in(item(arguments, 1))));
      case Maker::kType:
        return push({Kind::kType, 0, text_in(item(arguments, 0))});
      case Maker::kEncode:
        return push({Kind::kBytes, 0, latin(text_in(item(arguments, 0)))});
      case Maker::kBytes:
        if (arguments.items.empty()) return push({Kind::kBytes});
        return push({Kind::kBytes, 0, text_in(item(arguments, 0))});
      case Maker::kDictionary:
        return push({Kind::kDict});
      case Maker::kTableType:
        break;
    }
    fail_damaged();
  }

  // The state of a type is (3, order of bytes ...), that of a table (1, shape, type, is in Fortran's order, bytes).
  void build() {
    const Value state = values_[pop()];
    Value& value = values_[top()];
    if (value.kind == Kind::kType) {
      const std::string& order = text_in(item(state, 1));
      if (order == ">" || order == "<") value.text = order + value.text;
    } else if (value.kind == Kind::kTable) {
      const std::string type = type_in(item(state, 2));
      element_type(type);  // says what is wrong with a table of Python objects, whose state is a list
      const bool is_fortran = item(state, 3).number != 0;
      *value.table = table_of(element_type(type), shape_in(item(state, 1)), is_fortran, text_in(item(state, 4)));
    } else {
      fail_damaged();
    }
  }

  // Protocol 2 writes a byte as the character of its number, and that in UTF-8.
  static std::string latin(const std::string& utf8) {
    std::string out;
    for (std::size_t k = 0; k < utf8.size(); ++k) {
      auto c = static_cast<unsigned char>(utf8[k]);
      if (c >= 0xC0 && k + 1 < utf8.size()) c = static_cast<unsigned char>(c << 6 | (utf8[++k] & 0x3F));
      out.push_back(static_cast<char>(c));
    }
    return out;
  }

  std::string_view bytes_;
  std::size_t place_ = 0;
  std::vector<Value> values_;
  std::vector<Ref> stack_;
  std::vector<std::size_t> marks_;
  std::map<std::size_t, Ref> memo_;
};

class TablesOf {
 public:
  explicit TablesOf(const PickleMachine& machine) : machine_(machine) {}

  void add(const std::string& name, Ref ref, int depth = 0) {
    const Value& value = machine_.at(ref);
    if (value.kind == Kind::kNone) return;
    if (value.kind != Kind::kDict) {
      try {
        Array table;
        put(value, 0, table);
        out[name] = std::move(table);
      } catch (const std::runtime_error& error) {
        out[name].refused = error.what();
      }
      return;
    }
    if (depth == kDepthMax) fail_pickle("has dictionaries in each other without end");
    // Some programs put all into a dictionary of one name, that of the recording.
    if (name.empty() && value.items.size() == 2 && machine_.at(value.items[1]).kind == Kind::kDict) {
      add("", value.items[1], depth + 1);
      return;
    }
    for (std::size_t k = 0; k + 1 < value.items.size(); k += 2) {
      const Value& key = machine_.at(value.items[k]);
      if (key.kind != Kind::kText && key.kind != Kind::kBytes) continue;
      count();
      add(name.empty() ? key.text : name + "/" + key.text, value.items[k + 1], depth + 1);
    }
  }
  Arrays out;

 private:
  static constexpr int kDepthMax = 8;

  void count() {
    constexpr std::size_t kMax = 10'000'000;
    if (++count_ > kMax) fail_pickle("has more than 10000000 values in lists (save numpy tables)");
  }

  // Lists of lists of one size are a table.
  void put(const Value& value, int depth, Array& into) {
    count();
    switch (value.kind) {
      case Kind::kBool:
      case Kind::kNumber:
        into.numbers.push_back(value.number);
        break;
      case Kind::kText:
      case Kind::kBytes:
        into.texts.push_back(value.text);
        break;
      case Kind::kTable:
        if (depth == 0) {
          into = *value.table;
          return;
        }
        if (!value.table->shape.empty()) fail_pickle("is a list of tables, which is not read (save one table)");
        into.numbers.insert(into.numbers.end(), value.table->numbers.begin(), value.table->numbers.end());
        into.texts.insert(into.texts.end(), value.table->texts.begin(), value.table->texts.end());
        break;
      case Kind::kList:
      case Kind::kTuple:
        if (depth == kDepthMax) fail_pickle("has lists in each other without end");
        if (into.shape.size() <= static_cast<std::size_t>(depth)) into.shape.push_back(value.items.size());
        if (into.shape[static_cast<std::size_t>(depth)] != value.items.size())
          fail_pickle("has lists of different lengths");
        for (const Ref ref : value.items) put(machine_.at(ref), depth + 1, into);
        break;
      default:
        fail_pickle("holds what is neither a number nor a text");
    }
    std::size_t size = 1;
    if (depth == 0) {
      for (const std::size_t n : into.shape) size *= n;
      if (size != into.numbers.size() + into.texts.size() || (!into.numbers.empty() && !into.texts.empty())) {
        fail_pickle("has lists of different lengths, or numbers between texts");
      }
    }
  }

  const PickleMachine& machine_;
  std::size_t count_ = 0;
};

}  // namespace

Arrays parse_pickle(std::string_view bytes, const std::string& file) {
  try {
    PickleMachine machine(bytes);
    TablesOf tables(machine);
    tables.add("", machine.run());
    return std::move(tables.out);
  } catch (const std::runtime_error& error) {
    throw Error(ExitCode::kFile, file + ": " + error.what());
  }
}

}  // namespace spherechain::baker
