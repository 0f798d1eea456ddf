// SPDX-License-Identifier: Apache-2.0
#include "contact/io/hdf5_check.hpp"

#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Address = std::uint64_t;

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);
constexpr Address undefined = ~Address{0};
constexpr Address longest_type = 1 << 16;
constexpr int deepest = 32;
constexpr const char* newer = ", one of the newer layouts (h5repack rewrites them)";

enum Message : std::uint64_t {
  Nil = 0x00,
  Dataspace = 0x01,
  Datatype = 0x03,
  OldFill = 0x04,
  Fill = 0x05,
  Layout = 0x08,
  Attribute = 0x0c,
  Comment = 0x0d,
  OldTime = 0x0e,
  Continuation = 0x10,
  SymbolTable = 0x11,
  Time = 0x12,
};

enum DatatypeClass : std::uint64_t { Integer = 0, Float = 1, Text = 3, VariableLength = 9 };

template <class... Parts>
[[noreturn]] void refuse(const char* what, Address at, const Parts&... parts) {
  refuse_input(what, " at byte ", at, ": ", parts...);
}

/// Part of the file by which a part of it is described.
struct Range {
  Address at;
  Address size;
  Address end() const { return at + size; }
};

class Checker {
 public:
  explicit Checker(std::string_view file) : file_(file), budget_(1 << 20) { budget_ += 64 * file.size(); }

  void superblock();

 private:
  /// Little-endian number of `bytes` bytes.
  std::uint64_t number(Address at, unsigned bytes) const {
    require("the file", {.at = at, .size = bytes});
    std::uint64_t value = 0;
    for (unsigned k = bytes; k-- > 0;) value = value << 8 | static_cast<unsigned char>(file_[at + k]);
    return value;
  }
  void require(const char* what, Range part) const {
    if (part.at > file_.size() || part.size > file_.size() - part.at)
      refuse(what, part.at, part.size, " bytes, beyond the end of the file");
  }
  void require_signature(const char* what, Address at, std::string_view letters) const {
    require(what, {.at = at, .size = letters.size()});
    if (file_.substr(at, letters.size()) != letters) refuse(what, at, "does not begin with ", letters);
  }
  /// Bounds the time spent on files whose parts lie over each other.
  void spend(Address bytes) {
    if (bytes > budget_) throw std::invalid_argument("its parts refer to each other without end");
    budget_ -= bytes;
  }

  struct Heap {
    Range data;
  };
  struct Group {
    Address tree;
    Address heap;
    bool operator==(const Group&) const = default;
  };
  /// What the messages of an object header say.
  struct Object {
    std::optional<Group> group{};
    std::optional<Address> points{};  ///< of the dataspace
    std::optional<Address> size{};    ///< of one value
    std::optional<Address> stored{};  ///< bytes, undefined where nothing has been stored
    Address fill = 0;                 ///< bytes of a fill value, 0: none
  };

  void entry(Address at, const Heap* names, int depth);
  Object object(Address at, int depth);
  void messages(Address at, Range chunk, std::vector<Range>& chunks, Address& count, Object& object);
  void message(Message type, Range body, std::vector<Range>& chunks, Object& object);
  Address dataspace(Range body) const;
  Address datatype(Range body, int depth) const;
  Address fill(Range body) const;
  Address layout(Range body) const;
  void tree(Address at, const Heap& names, std::optional<std::uint64_t> level, int depth);
  void symbols(Address at, const Heap& names, int depth);
  Heap heap(Address at);
  void name(Address offset, const Heap& names);

  std::string_view file_;
  Address budget_;
  std::uint64_t leaf_k_ = 0;
  std::uint64_t internal_k_ = 0;
  std::set<Address> seen_;  // object headers
};

void Checker::superblock() {
  const std::uint64_t version = number(8, 1);
  if (version > 1) refuse("superblock", 0, "version ", version, newer);
  if (number(9, 1) != 0 || number(10, 1) != 0 || number(12, 1) != 0)
    refuse("superblock", 0, "unknown versions of parts");
  if (number(13, 1) != 8 || number(14, 1) != 8) refuse("superblock", 0, "sizes of addresses other than 8");
  leaf_k_ = number(16, 2);
  internal_k_ = number(18, 2);
  if (leaf_k_ == 0 || internal_k_ == 0) refuse("superblock", 0, "groups without room");
  const Address rest = version == 0 ? 24 : 28;
  if (number(rest, 8) != 0) refuse("superblock", 0, "its base address is ", number(rest, 8));
  if (number(rest + 8, 8) != undefined || number(rest + 24, 8) != undefined)
    refuse("superblock", 0, "free-space or driver information");
  const Address end = number(rest + 16, 8);
  if (end > file_.size())
    refuse("superblock", 0, "it says that the file ends at byte ", end, ", but there are only ", file_.size());
  file_ = file_.substr(0, end);
  entry(rest + 32, nullptr, 0);
}

/// A symbol table entry; the root's has no name.
void Checker::entry(Address at, const Heap* names, int depth) {
  constexpr Address size = 40;
  require("symbol table entry", {.at = at, .size = size});
  spend(size);
  const Address header = number(at + 8, 8);
  const std::uint64_t cached = number(at + 16, 4);
  if (names != nullptr) name(number(at, 8), *names);
  if (cached == 2 && names != nullptr) {  // a symbolic link
    name(number(at + 24, 4), *names);
    return;
  }
  if (cached > 1) refuse("symbol table entry", at, "cache type ", cached);
  if (header == undefined || seen_.contains(header)) refuse("symbol table entry", at, "no object, or one met before");
  const Object found = object(header, depth);
  if (cached == 1 && found.group != Group{.tree = number(at + 24, 8), .heap = number(at + 32, 8)})
    refuse("symbol table entry", at, "what it says of its object is not what that says");
}

Checker::Object Checker::object(Address at, int depth) {
  Object found;
  if (depth > deepest) refuse("object header", at, "groups within groups, ", depth, " deep");
  seen_.insert(at);
  require("object header", {.at = at, .size = 16});
  if (file_.substr(at, 4) == "OHDR") refuse("object header", at, "version 2", newer);
  if (number(at, 1) != 1) refuse("object header", at, "version ", number(at, 1));
  const std::uint64_t expected = number(at + 2, 2);
  Address count = 0;
  std::vector<Range> chunks{{.at = at + 16, .size = number(at + 8, 4)}};
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    const Range chunk = chunks[k];
    require("object header", chunk);
    spend(chunk.size);
    messages(at, chunk, chunks, count, found);
    if (chunks.size() > expected + 1) refuse("object header", at, "continued more often than it has messages");
  }
  if (count != expected) refuse("object header", at, count, " messages, not ", expected);
  const bool data = found.points && found.size && found.stored;
  if (data == found.group.has_value()) refuse("object header", at, "neither a group nor a dataset");
  if (data && found.fill != 0 && found.fill != *found.size) refuse("object header", at, "a fill value of another size");
  if (data && *found.stored != undefined && *found.points > 0 && *found.stored / *found.points < *found.size)
    refuse("object header", at, *found.points, " values of ", *found.size, " bytes in ", *found.stored);
  if (found.group) tree(found.group->tree, heap(found.group->heap), std::nullopt, depth + 1);
  return found;
}

void Checker::messages(Address at, Range chunk, std::vector<Range>& chunks, Address& count, Object& object) {
  constexpr Address head = 8;
  Address next = chunk.at;
  while (chunk.end() - next >= head) {
    const std::uint64_t type = number(next, 2);
    const Range body{.at = next + head, .size = number(next + 2, 2)};
    const std::uint64_t flags = number(next + 4, 1);
    if (body.size % 8 != 0 || body.size > chunk.end() - body.at)
      refuse("object header", at, "a message of ", body.size, " bytes does not fit");
    if ((flags & ~std::uint64_t{0x05}) != 0) refuse("object header", at, "a message that is shared, or flags unknown");
    message(static_cast<Message>(type), body, chunks, object);
    ++count;
    next = body.end();
  }
  if (next != chunk.end()) refuse("object header", at, "bytes left over");
}

void Checker::message(Message type, Range body, std::vector<Range>& chunks, Object& object) {
  const auto once = [&](const auto& part) {
    if (part) refuse("message", body.at, "a second one of its kind");
  };
  const auto room = [&](Address least) {
    if (body.size < least) refuse("message", body.at, "of ", body.size, " bytes, not ", least);
  };
  switch (type) {
    case Nil:
    case Attribute:
    case Comment:
    case OldTime:
    case Time:
      return;
    case Continuation:
      room(16);
      chunks.push_back({.at = number(body.at, 8), .size = number(body.at + 8, 8)});
      return;
    case SymbolTable:
      once(object.group);
      room(16);
      object.group = Group{.tree = number(body.at, 8), .heap = number(body.at + 8, 8)};
      return;
    case Dataspace:
      once(object.points);
      room(8);
      object.points = dataspace(body);
      return;
    case Datatype:
      once(object.size);
      object.size = datatype(body, 0);
      return;
    case Layout:
      once(object.stored);
      room(8);
      object.stored = layout(body);
      return;
    case Fill:
      room(8);
      object.fill = fill(body);
      return;
    case OldFill:
      room(8);
      if (number(body.at, 4) > body.size - 4) refuse("fill value", body.at, "longer than its message");
      return;
  }
  refuse("message", body.at, "of type ", static_cast<std::uint64_t>(type),
         ": a group of the newer kind (h5repack rewrites it), compressed data or another file");
}

/// The number of values.
Address Checker::dataspace(Range body) const {
  const std::uint64_t version = number(body.at, 1);
  const std::uint64_t rank = number(body.at + 1, 1);
  const std::uint64_t flags = number(body.at + 2, 1);
  if ((version != 1 && version != 2) || flags > 1 || rank > 32)
    refuse("dataspace", body.at, "version ", version, ", rank ", rank, ", flags ", flags);
  const Address first = version == 1 ? 8 : 4;
  if (body.size < first + 8 * rank * (flags + 1)) refuse("dataspace", body.at, "longer than its message");
  if (version == 2 && number(body.at + 3, 1) != (rank > 0 ? 1U : 0U))
    refuse("dataspace", body.at, "of the kind ", number(body.at + 3, 1));
  Address points = 1;
  for (std::uint64_t k = 0; k < rank; ++k) {
    const Address extent = number(body.at + first + 8 * k, 8);
    if (extent > 0 && points > (Address{1} << 48) / extent) refuse("dataspace", body.at, "more than 2^48 values");
    points *= extent;
    if (flags == 1 && number(body.at + first + 8 * (rank + k), 8) < extent)
      refuse("dataspace", body.at, "more values than it says it may have");
  }
  return points;
}

/// The bytes of one value.
Address Checker::datatype(Range body, int depth) const {
  const auto room = [&](Address least) {
    if (body.size < least) refuse("datatype", body.at, "longer than its message");
  };
  room(8);
  const std::uint64_t version = number(body.at, 1) >> 4;
  const std::uint64_t kind = number(body.at, 1) & 15U;
  const Address size = number(body.at + 4, 4);
  if (version < 1 || version > 3 || size == 0 || size > longest_type)
    refuse("datatype", body.at, "version ", version, ", ", size, " bytes");
  const Address bits = 8 * size;
  switch (kind) {
    case Integer:
    case Float: {
      room(kind == Integer ? 12 : 20);
      const std::uint64_t offset = number(body.at + 8, 2);
      const std::uint64_t precision = number(body.at + 10, 2);
      if (size > 16 || precision == 0 || offset + precision > bits)
        refuse("datatype", body.at, "bits beyond its ", size, " bytes");
      if (kind == Integer) return size;
      const std::uint64_t exponent = number(body.at + 12, 1) + number(body.at + 13, 1);
      const std::uint64_t mantissa = number(body.at + 14, 1) + number(body.at + 15, 1);
      const std::uint64_t sign = number(body.at + 2, 1);
      if (number(body.at + 13, 1) == 0 || number(body.at + 15, 1) == 0 || exponent > bits || mantissa > bits ||
          sign >= bits)
        refuse("datatype", body.at, "bits beyond its ", size, " bytes");
      return size;
    }
    case Text:
      return size;
    case VariableLength:
      if (depth > 0) refuse("datatype", body.at, "lists of lists");
      datatype({.at = body.at + 8, .size = body.size - 8}, depth + 1);
      return size;
    default:
      refuse("datatype", body.at, "class ", kind, ", neither number nor text");
  }
}

/// Its bytes, 0 if there is none.
Address Checker::fill(Range body) const {
  const std::uint64_t version = number(body.at, 1);
  if (version < 1 || version > 3) refuse("fill value", body.at, "version ", version);
  const bool given = version == 1 || (version == 2 ? number(body.at + 3, 1) : number(body.at + 1, 1) & 32U) != 0;
  if (!given) return 0;
  const Address first = version == 3 ? 2 : 4;
  const Address size = number(body.at + first, 4);
  if (size >= Address{1} << 31) return 0;  // -1: undefined
  if (body.size < first + 4 || size > body.size - first - 4) refuse("fill value", body.at, "longer than its message");
  return size;
}

/// The bytes stored, undefined if none.
Address Checker::layout(Range body) const {
  const std::uint64_t version = number(body.at, 1);
  const std::uint64_t kind = number(body.at + 1, 1);
  if (version != 3 && version != 4) refuse("data layout", body.at, "version ", version);
  if (kind == 0) {
    const Address size = number(body.at + 2, 2);
    if (size > body.size - 4) refuse("data layout", body.at, "longer than its message");
    return size;
  }
  if (kind != 1) refuse("data layout", body.at, "in chunks or another file (h5repack -f NONE -l CONTI unpacks)");
  if (body.size < 18) refuse("data layout", body.at, "longer than its message");
  const Range data{.at = number(body.at + 2, 8), .size = number(body.at + 10, 8)};
  if (data.at == undefined) return undefined;
  require("data", data);
  return data.size;
}

/// A node of a group's B-tree; level: what its parent expects.
void Checker::tree(Address at, const Heap& names, std::optional<std::uint64_t> level, int depth) {
  require_signature("B-tree", at, "TREE");
  const Address size = 24 + 8 * (4 * internal_k_ + 1);
  require("B-tree", {.at = at, .size = size});
  spend(size);
  const std::uint64_t own = number(at + 5, 1);
  const std::uint64_t entries = number(at + 6, 2);
  if (number(at + 4, 1) != 0 || own > deepest || (level && own != *level) || entries > 2 * internal_k_)
    refuse("B-tree", at, "type ", number(at + 4, 1), ", level ", own, ", ", entries, " entries");
  for (const Address sibling : {number(at + 8, 8), number(at + 16, 8)})
    if (sibling != undefined && !level) refuse("B-tree", at, "a root with siblings");
  for (std::uint64_t k = 0; k <= entries && entries > 0; ++k) name(number(at + 24 + 16 * k, 8), names);
  for (std::uint64_t k = 0; k < entries; ++k) {
    const Address child = number(at + 32 + 16 * k, 8);
    if (own > 0)
      tree(child, names, own - 1, depth);
    else
      symbols(child, names, depth);
    // Siblings are each other's neighbours under one parent, or under two that are: the library goes from one to the
    // next only in iterations, which are not used.
  }
}

void Checker::symbols(Address at, const Heap& names, int depth) {
  require_signature("symbol table node", at, "SNOD");
  const Address size = 8 + 80 * leaf_k_;
  require("symbol table node", {.at = at, .size = size});
  spend(size);
  const std::uint64_t entries = number(at + 6, 2);
  if (number(at + 4, 1) != 1 || entries > 2 * leaf_k_)
    refuse("symbol table node", at, "version ", number(at + 4, 1), ", ", entries, " entries");
  for (std::uint64_t k = 0; k < entries; ++k) entry(at + 8 + 40 * k, &names, depth);
}

Checker::Heap Checker::heap(Address at) {
  require_signature("local heap", at, "HEAP");
  require("local heap", {.at = at, .size = 32});
  const Range data{.at = number(at + 24, 8), .size = number(at + 8, 8)};
  if (number(at + 4, 1) != 0) refuse("local heap", at, "version ", number(at + 4, 1));
  require("local heap", data);
  // The free blocks, which the library lists as well: offset of the next (1: none), size.
  Address block = number(at + 16, 8);
  Address most = data.size / 16;
  for (; block != 1 && block != undefined; --most) {
    if (most == 0 || data.size < 16 || block > data.size - 16) refuse("local heap", at, "a free block outside of it");
    const Address size = number(data.at + block + 8, 8);
    if (size < 16 || size > data.size - block) refuse("local heap", at, "a free block of ", size, " bytes");
    block = number(data.at + block, 8);
    spend(16);
  }
  return {.data = data};
}

/// Names end within the heap.
void Checker::name(Address offset, const Heap& names) {
  const std::string_view data = file_.substr(names.data.at, names.data.size);
  const std::size_t end = offset < data.size() ? data.find('\0', offset) : std::string_view::npos;
  if (end == std::string_view::npos) refuse("local heap", names.data.at, "no name at ", offset);
  spend(end - offset);
}

}  // namespace

std::size_t find_hdf5(std::string_view file) {
  if (file.starts_with(signature)) return 0;
  for (std::size_t at = 512; at < file.size(); at *= 2)
    if (file.substr(at).starts_with(signature)) return at;
  return std::string_view::npos;
}

void check_hdf5(std::string_view file) {
  const std::size_t at = find_hdf5(file);
  if (at == std::string_view::npos) throw std::invalid_argument("it has no HDF5 signature");
  if (at > 0) throw std::invalid_argument("a block of the user's before the HDF5 signature (h5unjam removes it)");
  Checker(file).superblock();
}

}  // namespace perp::contact
