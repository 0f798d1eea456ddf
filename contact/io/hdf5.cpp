// SPDX-License-Identifier: Apache-2.0
#include "contact/io/hdf5.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Address = std::uint64_t;

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);
constexpr Address undefined = ~Address{0};
constexpr Address longest_text = 1 << 16;
constexpr const char* newer = ", one of the newer layouts (h5repack rewrites them)";

/// Messages of object headers; others say nothing of where data are.
enum Message : std::uint64_t {
  Dataspace = 0x01,
  LinkInfo = 0x02,
  Datatype = 0x03,
  Link = 0x06,
  External = 0x07,
  Layout = 0x08,
  GroupInfo = 0x0a,
  Filters = 0x0b,
  Fill = 0x05,
  Continuation = 0x10,
  SymbolTable = 0x11,
};

template <class... Parts>
[[noreturn]] void refuse_bytes(const char* what, Address at, const Parts&... parts) {
  refuse_input("no HDF5 file, damaged or cut short: ", what, " at byte ", at, ": ", parts...);
}

}  // namespace

std::size_t find_hdf5(std::string_view file) {
  if (file.starts_with(signature)) return 0;
  for (std::size_t at = 512; at < file.size(); at *= 2)
    if (file.substr(at).starts_with(signature)) return at;
  return std::string_view::npos;
}

// --- reading ---------------------------------------------------------------------------------------------------------

Hdf5Reader::Hdf5Reader(std::string_view file) : file_(file), budget_((1 << 20) + 64 * file.size()) {
  const std::size_t at = find_hdf5(file);
  if (at == std::string_view::npos) refuse_bytes("the signature", 0, "it is missing");
  if (at > 0) refuse_bytes("the signature", at, "a block of the user's before it (h5unjam removes it)");
  const std::uint64_t version = number(8, 1);
  if (version > 1) refuse_bytes("superblock", 0, "version ", version, newer);
  if (number(13, 1) != 8 || number(14, 1) != 8) refuse_bytes("superblock", 0, "sizes of addresses other than 8");
  const Address rest = version == 0 ? 24 : 28;
  if (number(rest, 8) != 0) refuse_bytes("superblock", 0, "its base address is ", number(rest, 8));
  const Address end = number(rest + 16, 8);
  if (end > file_.size())
    refuse_bytes("superblock", 0, "it says that the file ends at byte ", end, ", but there are only ", file_.size());
  file_ = file_.substr(0, end);
  root_ = object(number(rest + 40, 8));
  if (!root_.group) refuse_bytes("superblock", 0, "the root is no group");
}

/// Little-endian number of `bytes` bytes.
std::uint64_t Hdf5Reader::number(Address at, unsigned bytes) const {
  require("the file", {.at = at, .size = bytes});
  std::uint64_t value = 0;
  for (unsigned k = bytes; k-- > 0;) value = value << 8 | static_cast<unsigned char>(file_[at + k]);
  return value;
}

void Hdf5Reader::require(const char* what, Range part) const {
  if (part.at > file_.size() || part.size > file_.size() - part.at)
    refuse_bytes(what, part.at, part.size, " bytes, beyond the end of the file");
}

void Hdf5Reader::require_signature(const char* what, Address at, std::string_view letters) const {
  require(what, {.at = at, .size = letters.size()});
  if (file_.substr(at, letters.size()) != letters) refuse_bytes(what, at, "does not begin with ", letters);
}

/// Bounds the time spent on files whose parts lie over each other.
void Hdf5Reader::spend(Address bytes) {
  if (bytes > budget_) refuse_bytes("the file", 0, "its parts refer to each other without end");
  budget_ -= bytes;
}

Hdf5Reader::Object Hdf5Reader::object(Address at) {
  require("object header", {.at = at, .size = 16});
  if (file_.substr(at, 4) == "OHDR") refuse_bytes("object header", at, "version 2", newer);
  if (number(at, 1) != 1) refuse_bytes("object header", at, "version ", number(at, 1));
  Object found;
  std::vector<Range> chunks{{.at = at + 16, .size = number(at + 8, 4)}};
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    require("object header", chunks[k]);
    spend(16 + chunks[k].size);
    constexpr Address head = 8;
    const Address end = chunks[k].at + chunks[k].size;
    for (Address next = chunks[k].at; end - next >= head;) {
      const std::uint64_t type = number(next, 2);
      const Range body{.at = next + head, .size = number(next + 2, 2)};
      if (body.size > end - body.at)
        refuse_bytes("object header", at, "a message of ", body.size, " bytes does not fit");
      if (type == Continuation)
        chunks.push_back({.at = number(body.at, 8), .size = number(body.at + 8, 8)});
      else
        message(type, number(next + 4, 1), body, found);
      next = body.at + body.size;
    }
  }
  return found;
}

void Hdf5Reader::message(std::uint64_t type, std::uint64_t flags, Range body, Object& object) const {
  constexpr std::uint64_t shared = 2;
  if ((type == Dataspace || type == Datatype || type == Layout) && (flags & shared) != 0)
    refuse_bytes("object header", body.at, "a message that is shared");
  if (type == SymbolTable) {
    object.group = true;
    object.tree = number(body.at, 8);
    object.heap = number(body.at + 8, 8);
  } else if (type == Dataspace) {
    dataspace(body, object);
  } else if (type == Datatype) {
    datatype(body, object);
  } else if (type == Layout) {
    layout(body, object);
  } else if (type == External || type == Filters) {
    object.refused = "is chunked, compressed or in another file (h5repack -f NONE -l CONTI unpacks)";
  } else if (type == LinkInfo || type == Link || type == GroupInfo) {
    refuse_bytes("object header", body.at, "a group of the newer kind (h5repack rewrites it)");
  }
}

/// The number of values.
void Hdf5Reader::dataspace(Range body, Object& object) const {
  const std::uint64_t version = number(body.at, 1);
  object.rank = number(body.at + 1, 1);
  if ((version != 1 && version != 2) || object.rank > 32)
    refuse_bytes("dataspace", body.at, "version ", version, ", rank ", object.rank);
  const bool nothing = version == 2 && number(body.at + 3, 1) == 2;
  object.points = nothing ? 0 : 1;
  for (std::uint64_t k = 0; k < object.rank; ++k) {
    const Address extent = number(body.at + (version == 1 ? 8 : 4) + 8 * k, 8);
    if (extent > 0 && object.points > (Address{1} << 48) / extent)
      refuse_bytes("dataspace", body.at, "more than 2^48 values");
    object.points *= extent;
  }
}

/// Numbers whose bits are those of C's types; text of fixed length.
void Hdf5Reader::datatype(Range body, Object& object) const {
  const std::uint64_t kind = number(body.at, 1) & 15U;
  const std::uint64_t bits = number(body.at + 1, 1);
  object.bytes = number(body.at + 4, 4);
  if (kind == 3) object.kind = Kind::Text;
  if (kind > 1 || (object.bytes != 4 && object.bytes != 8)) return;
  object.big_endian = (bits & 1U) != 0;
  object.is_signed = (bits & 8U) != 0;
  const std::uint64_t whole = number(body.at + 8, 2) << 16 | number(body.at + 10, 2);  // first bit, and how many
  if (whole != 8 * object.bytes) return;
  if (kind == 0) {
    if (object.is_signed || object.bytes == 4) object.kind = Kind::Integer;
    return;
  }
  const bool is_double = object.bytes == 8;
  const std::uint64_t parts = number(body.at + 12, 4);  // first bit and how many, of exponent and mantissa
  if (number(body.at + 2, 1) == (is_double ? 63 : 31) && parts == (is_double ? 0x34000b34 : 0x17000817) &&
      number(body.at + 16, 4) == (is_double ? 1023 : 127))
    object.kind = Kind::Float;
}

/// Reads where the values are.
void Hdf5Reader::layout(Range body, Object& object) const {
  const std::uint64_t version = number(body.at, 1);
  const std::uint64_t kind = number(body.at + 1, 1);
  if (version != 3 && version != 4) refuse_bytes("data layout", body.at, "version ", version);
  if (kind > 1) {
    object.refused = "is chunked, compressed or in another file (h5repack -f NONE -l CONTI unpacks)";
  } else if (kind == 0) {
    object.data = {.at = body.at + 4, .size = number(body.at + 2, 2)};
  } else {
    object.data = {.at = number(body.at + 2, 8), .size = number(body.at + 10, 8)};
  }
  object.written = kind <= 1 && object.data.at != undefined;
  if (object.written) require("data", object.data);
}

const Hdf5Reader::Names& Hdf5Reader::names_in(const Object& group) {
  const auto [found, is_new] = groups_.try_emplace(group.tree);
  if (is_new) {
    require_signature("local heap", group.heap, "HEAP");
    const Range heap{.at = number(group.heap + 24, 8), .size = number(group.heap + 8, 8)};
    require("local heap", heap);
    tree(group.tree, heap, 255, found->second);
  }
  return found->second;
}

/// A node of a group's B-tree, whose level is at most this.
void Hdf5Reader::tree(Address at, Range heap, std::uint64_t most_level, Names& names) {
  require_signature("B-tree", at, "TREE");
  const std::uint64_t level = number(at + 5, 1);
  const std::uint64_t entries = number(at + 6, 2);
  if (number(at + 4, 1) != 0 || level > most_level)
    refuse_bytes("B-tree", at, "type ", number(at + 4, 1), ", level ", level);
  spend(24 + 16 * entries);
  for (std::uint64_t k = 0; k < entries; ++k) {
    const Address child = number(at + 32 + 16 * k, 8);
    if (level > 0)
      tree(child, heap, level - 1, names);
    else
      symbols(child, heap, names);
  }
}

void Hdf5Reader::symbols(Address at, Range heap, Names& names) {
  require_signature("symbol table node", at, "SNOD");
  const std::uint64_t entries = number(at + 6, 2);
  spend(8 + 40 * entries);
  const std::string_view data = file_.substr(heap.at, heap.size);
  for (std::uint64_t k = 0; k < entries; ++k) {
    const Address entry = at + 8 + 40 * k;
    const Address offset = number(entry, 8);
    const std::size_t end = offset < data.size() ? data.find('\0', offset) : std::string_view::npos;
    if (end == std::string_view::npos) refuse_bytes("local heap", heap.at, "no name at ", offset);
    spend(end - offset);
    const bool link = number(entry + 16, 4) == 2;
    names.emplace(data.substr(offset, end - offset), link ? undefined : number(entry + 8, 8));
  }
}

bool Hdf5Reader::find(const std::string& path, Object& found) {
  found = root_;
  for (std::size_t begin = 1; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (!found.group) return false;
    const Names& names = names_in(found);
    const auto entry = names.find(std::string_view(path).substr(begin, end - begin));
    if (entry == names.end()) return false;
    if (entry->second == undefined) refuse_input(path.substr(0, end), ": is a symbolic or external link");
    found = object(entry->second);
    begin = end + 1;
  }
  return true;
}

bool Hdf5Reader::has(const std::string& path) {
  Object found;
  return find(path, found);
}

bool Hdf5Reader::has_values(const std::string& path) {
  Object found;
  return find(path, found) && (found.group || found.written || !found.refused.empty());
}

/// The dataset, which has values of this kind, all of them within the file.
Hdf5Reader::Object Hdf5Reader::values(const std::string& path, Kind kind, const char* wanted) {
  Object found;
  if (!find(path, found)) refuse_input(path, ": is missing");
  if (found.group) refuse_input(path, ": is no dataset");
  if (found.kind != kind) refuse_input(path, ": is of another type than ", wanted);
  if (!found.refused.empty()) refuse_input(path, ": ", found.refused);
  if (found.rank > 1) refuse_input(path, ": has ", found.rank, " dimensions, not one");
  if (found.points > 0 && (!found.written || found.data.size / found.bytes < found.points))
    refuse_input(path, ": has ", found.points, " entries, more than the file holds");
  return found;
}

/// Returns the bits of value k.
std::uint64_t Hdf5Reader::bits(const Object& data, Address k) const {
  const Address at = data.data.at + k * data.bytes;
  std::uint64_t value = 0;
  for (Address i = 0; i < data.bytes; ++i) {
    const Address place = data.big_endian ? i : data.bytes - 1 - i;
    value = value << 8 | static_cast<unsigned char>(file_[at + place]);
  }
  return value;
}

std::vector<long long> Hdf5Reader::integers(const std::string& path) {
  const Object data = values(path, Kind::Integer, "32- or 64-bit integers");
  std::vector<long long> out(data.points);
  for (Address k = 0; k < data.points; ++k) {
    const std::uint64_t value = bits(data, k);
    const bool extended = data.bytes == 4 && data.is_signed;
    out[k] = extended ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value)) : static_cast<long long>(value);
  }
  return out;
}

lcp::Vec Hdf5Reader::numbers(const std::string& path) {
  const Object data = values(path, Kind::Float, "32- or 64-bit floating point");
  lcp::Vec out(static_cast<lcp::Index>(data.points));
  for (Address k = 0; k < data.points; ++k) {
    const std::uint64_t value = bits(data, k);
    out[static_cast<lcp::Index>(k)] = data.bytes == 8 ? std::bit_cast<double>(value)
                                                      : double{std::bit_cast<float>(static_cast<std::uint32_t>(value))};
  }
  return out;
}

std::string Hdf5Reader::text(const std::string& path) {
  Object found;
  if (!find(path, found) || found.kind != Kind::Text || !found.written || !found.refused.empty() || found.points != 1 ||
      found.bytes > std::min(longest_text, found.data.size))
    return {};
  const std::string_view text = file_.substr(found.data.at, found.bytes);
  return std::string(text.substr(0, text.find('\0')));
}

// --- writing ---------------------------------------------------------------------------------------------------------

namespace {

void put(std::string& to, std::uint64_t value, unsigned bytes) {
  for (unsigned k = 0; k < bytes; ++k) to.push_back(static_cast<char>(value >> 8 * k & 0xff));
}

void align(std::string& to) { to.resize((to.size() + 7) / 8 * 8, '\0'); }

std::string message(Message type, std::string body) {
  align(body);
  std::string out;
  put(out, type, 2);
  put(out, body.size(), 2);
  put(out, 0, 4);
  return out + body;
}

/// Returns where it is.
Address add_header(const std::vector<std::string>& messages, std::string& file) {
  const Address at = file.size();
  std::size_t size = 0;
  for (const std::string& one : messages) size += one.size();
  put(file, 1, 2);
  put(file, messages.size(), 2);
  put(file, 1, 4);  // links to it
  put(file, size, 8);
  for (const std::string& one : messages) file += one;
  return at;
}

constexpr std::uint64_t leaf_k = 4;  // a node has at most twice as many symbols

}  // namespace

struct Hdf5Writer::Placed {
  Address header = 0;
  Address tree = undefined;  ///< of a group
  Address heap = undefined;

  /// The entry of a symbol table with this name.
  std::string entry(Address name) const {
    std::string out;
    put(out, name, 8);
    put(out, header, 8);
    put(out, tree != undefined ? 1 : 0, 8);
    put(out, tree != undefined ? tree : 0, 8);
    put(out, tree != undefined ? heap : 0, 8);
    return out;
  }
};

Hdf5Writer::Node& Hdf5Writer::node(const std::string& path) {
  Node* at = &root_;
  for (std::size_t begin = 1; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    at = &at->members[path.substr(begin, end - begin)];
    begin = end + 1;
  }
  return *at;
}

void Hdf5Writer::integers(const std::string& path, const std::vector<long long>& values) {
  Node& to = node(path);
  to.points = values.size();
  put(to.type, 0x000810, 4);  // version 1; signed
  put(to.type, 4, 4);
  put(to.type, 0x00200000, 4);
  for (const long long value : values) put(to.data, static_cast<std::uint64_t>(value), 4);
}

void Hdf5Writer::numbers(const std::string& path, lcp::In values) {
  Node& to = node(path);
  to.points = static_cast<std::uint64_t>(values.size());
  put(to.type, 0x003f2011, 4);  // version 1; sign in bit 63, mantissa without its first bit
  put(to.type, 8, 4);
  put(to.type, 0x00400000, 4);
  put(to.type, 0x34000b34, 4);
  put(to.type, 1023, 4);
  for (const double value : values) put(to.data, std::bit_cast<std::uint64_t>(value), 8);
}

void Hdf5Writer::text(const std::string& path, const std::string& text) {
  Node& to = node(path);
  to.points = 1;
  to.scalar = true;
  to.data = text + '\0';
  put(to.type, 0x13, 4);
  put(to.type, to.data.size(), 4);
}

Hdf5Writer::Placed Hdf5Writer::place_dataset(const Node& node, std::string& file) {
  std::string space;
  put(space, node.scalar ? 0x0001 : 0x0101, 8);
  if (!node.scalar) put(space, node.points, 8);
  std::string layout;
  put(layout, 0x0103, 2);  // in one piece
  put(layout, node.data.empty() ? undefined : file.size(), 8);
  put(layout, node.data.size(), 8);
  std::string fill;
  put(fill, 0x01020202, 8);  // none is written
  file += node.data;
  align(file);
  return {add_header(
      {message(Dataspace, space), message(Datatype, node.type), message(Fill, fill), message(Layout, layout)}, file)};
}

/// `fanout`: half of the children of a B-tree's node, at most.
Hdf5Writer::Placed Hdf5Writer::place(const Node& node, std::uint64_t fanout, std::string& file) {
  if (!node.type.empty()) return place_dataset(node, file);
  std::string names(8, '\0');  // the empty one first
  std::vector<std::string> entries;
  std::vector<Address> offsets;
  for (const auto& [name, member] : node.members) {
    offsets.push_back(names.size());
    entries.push_back(place(member, fanout, file).entry(names.size()));
    names += name + '\0';
    align(names);
  }
  Placed out;
  const std::size_t most = 2 * leaf_k;
  std::string tree = "TREE";
  put(tree, 0, 2);
  put(tree, (entries.size() + most - 1) / most, 2);
  put(tree, undefined, 8);
  put(tree, undefined, 8);
  put(tree, 0, 8);
  for (std::size_t begin = 0; begin < entries.size(); begin += most) {
    const std::size_t end = std::min(begin + most, entries.size());
    put(tree, file.size(), 8);
    put(tree, offsets[end - 1], 8);
    std::string symbols = "SNOD";
    put(symbols, 1, 2);
    put(symbols, end - begin, 2);
    for (std::size_t k = begin; k < end; ++k) symbols += entries[k];
    symbols.resize(8 + 40 * most, '\0');
    file += symbols;
  }
  tree.resize(24 + 8 * (4 * fanout + 1), '\0');
  out.tree = file.size();
  file += tree;
  out.heap = file.size();
  file += "HEAP";
  put(file, 0, 4);
  put(file, names.size(), 8);
  put(file, 1, 8);  // nothing is free
  put(file, out.heap + 32, 8);
  file += names;
  std::string table;
  put(table, out.tree, 8);
  put(table, out.heap, 8);
  out.header = add_header({message(SymbolTable, table)}, file);
  return out;
}

/// Returns the most members that a group has.
std::size_t Hdf5Writer::largest(const Node& node) {
  std::size_t most = node.members.size();
  for (const auto& [name, member] : node.members) most = std::max(most, largest(member));
  return most;
}

std::string Hdf5Writer::bytes() const {
  const std::uint64_t fanout = std::max<std::uint64_t>(16, largest(root_) / (4 * leaf_k) + 1);
  std::string file(96, '\0');
  const Placed root = place(root_, fanout, file);
  std::string head(signature);
  put(head, 0, 5);
  put(head, 0x0808, 3);
  put(head, leaf_k, 2);
  put(head, fanout, 2);
  put(head, 0, 4);
  put(head, 0, 8);
  put(head, undefined, 8);
  put(head, file.size(), 8);
  put(head, undefined, 8);
  head += root.entry(0);
  file.replace(0, head.size(), head);
  return file;
}

}  // namespace perp::contact
