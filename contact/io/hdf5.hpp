// SPDX-License-Identifier: Apache-2.0
#pragma once
/// HDF5 files in memory, read and written without HDF5's library: their classic layout, which that library writes
/// unless it is told otherwise. It has superblock 0 or 1, object headers 1, groups as B-trees with local heaps, and
/// datasets in one piece (HDF5 File Format Specification 3.0, sections II.A, III.A.1, III.B - D, IV.A). Newer layouts,
/// chunked, compressed or external data and links are refused; h5repack rewrites most of them.
///
/// Files are not trusted: every address, count and size is checked before it is used. Private to contact/.
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lcp/types.hpp"

namespace perp::contact {

/// Finds HDF5's signature: at 0, or behind a block of the user's of 512, 1024, 2048, .. bytes. npos: nowhere.
std::size_t find_hdf5(std::string_view file);

/// Reads datasets by their paths. All members throw std::invalid_argument with path or place in the file, and reason.
class Hdf5Reader {
 public:
  /// `file` outlives *this.
  explicit Hdf5Reader(std::string_view file);

  /// Tells whether there is a group or dataset.
  bool has(const std::string& path);
  /// Tells whether there is a dataset that has been written: some files announce solutions that nobody stored.
  bool has_values(const std::string& path);
  /// Numbers of 32 or 64 bits, in no or one dimension.
  std::vector<long long> integers(const std::string& path);
  lcp::Vec numbers(const std::string& path);
  /// Text of fixed length. Empty where there is none.
  std::string text(const std::string& path);

 private:
  using Address = std::uint64_t;
  struct Range {
    Address at = 0;
    Address size = 0;
  };
  enum class Kind { Other, Integer, Float, Text };
  struct Object {
    bool group = false;
    Address tree = 0;  ///< of a group
    Address heap = 0;
    Kind kind = Kind::Other;  ///< of a dataset
    bool big_endian = false;
    bool is_signed = false;
    Address bytes = 0;  ///< of one value
    std::uint64_t rank = 0;
    Address points = 0;
    bool written = false;
    Range data{};
    std::string refused{};  ///< why its data cannot be read
  };
  using Names = std::map<std::string, Address, std::less<>>;

  std::uint64_t number(Address at, unsigned bytes) const;
  void require(const char* what, Range part) const;
  void require_signature(const char* what, Address at, std::string_view letters) const;
  void spend(Address bytes);
  Object object(Address at);
  void message(std::uint64_t type, std::uint64_t flags, Range body, Object& object) const;
  void dataspace(Range body, Object& object) const;
  void datatype(Range body, Object& object) const;
  void layout(Range body, Object& object) const;
  const Names& names_in(const Object& group);
  void tree(Address at, Range heap, std::uint64_t most_level, Names& names);
  void symbols(Address at, Range heap, Names& names);
  bool find(const std::string& path, Object& found);
  Object values(const std::string& path, Kind kind, const char* wanted);
  std::uint64_t bits(const Object& data, Address k) const;

  std::string_view file_;
  Address budget_;
  Object root_{};
  std::map<Address, Names> groups_{};  // by their B-trees
};

/// Makes a file. The same calls give the same bytes.
class Hdf5Writer {
 public:
  // The groups above a path are made with it.
  void group(const std::string& path) { node(path); }
  void integers(const std::string& path, const std::vector<long long>& values);  ///< of 32 bits
  void numbers(const std::string& path, lcp::In values);
  void text(const std::string& path, const std::string& text);

  std::string bytes() const;

 private:
  struct Node {
    std::map<std::string, Node> members{};  ///< of a group
    std::string type{};                     ///< of a dataset: message Datatype
    std::string data{};
    bool scalar = false;
    std::uint64_t points = 0;
  };
  struct Placed;
  Node& node(const std::string& path);
  static Placed place(const Node& node, std::uint64_t fanout, std::string& file);
  static Placed place_dataset(const Node& node, std::string& file);
  static std::size_t largest(const Node& node);

  Node root_{};
};

}  // namespace perp::contact
