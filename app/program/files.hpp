// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Files of the program: what it writes and reads, checked before anything runs, and text that a terminal may be shown.
#include <ostream>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>

#include "app/program/program.hpp"
#include "lcp/io/output_file.hpp"

namespace perp::app {

/// As lcp::write_file() and lcp::check_writable(). Throw InputError naming the file.
void write_file(const std::string& path, std::string_view content, lcp::Sync sync = lcp::Sync::Yes);
void check_writable(const std::string& path);

/// What is in a file; empty where there is none. Throws InputError for one that cannot be read.
std::string read_text(const std::string& path);

/// A file that a command reads or writes; path "" or "-" is none.
struct FileUse {
  std::string flag;  ///< "--json"
  std::string path;
};

/// Before anything is read or written: throws InputError where an output would replace an input or another output,
/// under whatever names. Streams and devices, /dev/null among them, may be given several times.
void check_apart(std::span<const FileUse> outputs, std::span<const FileUse> inputs);
/// The same, and where an output cannot be written.
void check_outputs(std::span<const FileUse> outputs, std::span<const FileUse> inputs);
/// The same as that; false: `err` says why not. To be asked before a refusal is written as JSON, too.
bool outputs_fit(std::span<const FileUse> outputs, std::span<const FileUse> inputs, Streams streams);

/// Bytes of the UTF-8 character that the text, which is not empty, begins with; 0 if it is none, and `whole` false if
/// the text ends within it.
std::size_t utf8_character(std::string_view text, bool& whole);
bool is_utf8(std::string_view text);

/// Control characters (ESC, C1, also between line ends) and bytes that are no UTF-8 as \x1b; line ends and tabs stay.
std::string printable(std::string_view text);

/// Makes what goes through a stream printable() while it lives, and gives access to the stream as it was.
class PrintableStream {
 public:
  explicit PrintableStream(std::ostream& stream);
  ~PrintableStream();
  PrintableStream(const PrintableStream&) = delete;
  PrintableStream& operator=(const PrintableStream&) = delete;

  std::ostream& raw() { return raw_; }  ///< for what steers the cursor

 private:
  class Buffer : public std::streambuf {
   public:
    explicit Buffer(std::streambuf* to) : to_(to) {}
    void end();  ///< also what is no whole character

   protected:
    int_type overflow(int_type c) override;
    std::streamsize xsputn(const char* text, std::streamsize size) override;
    int sync() override;

   private:
    bool put(std::string_view text);

    std::streambuf* to_;
    std::string begun_{};  // the first bytes of a character whose others have not come
  };

  std::ostream& stream_;
  std::ostream raw_;
  Buffer buffer_;
};

}  // namespace perp::app
