// SPDX-License-Identifier: Apache-2.0
/// Uses the C++ library alone: a file in a folder is written to a draft beside it, which then takes its place; whether
/// it has come to the disk is left to the system. What is no file is written in place.
#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

#include "lcp/io/file_path.hpp"
#include "lcp/io/output_file.hpp"

namespace perp::lcp {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw FileError(path, 0, "cannot be written: " + why);
}

/// Without links and dots, as far as it is there.
fs::path whole_path(const std::string& name, std::error_code& error) {
  const fs::path path = fs::absolute(file_path(name), error);
  return error ? path : fs::weakly_canonical(path, error);
}

struct Place {
  fs::path path;  // where links lead
  bool in_place = false;
};

/// The place of an output, if it is one that can be written at all.
Place fit_place(const std::string& path) {
  if (path.empty()) refuse(path, "it has no name");
  std::error_code error;
  Place place{.path = whole_path(path, error)};
  if (error) refuse(path, error.message());
  const fs::file_status status = fs::status(place.path, error);
  if (fs::is_directory(status)) refuse(path, "it is a directory");
  place.in_place = fs::exists(status) && !fs::is_regular_file(status);
  if (fs::is_regular_file(status) && (status.permissions() & fs::perms::owner_write) == fs::perms::none)
    refuse(path, std::make_error_code(std::errc::permission_denied).message());
  if (!fs::exists(status) && !fs::is_directory(place.path.parent_path(), error))
    refuse(path, "there is no folder of that name");
  return place;
}

/// Short, so that there is room for it where there is room for the target's name.
std::string draft_name() {
  static std::atomic<unsigned> count{0};
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), ".perp-%08x%08x.part", std::random_device()(), ++count);
  return text.data();
}

void write_all(const std::string& told_as, const fs::path& path, std::string_view content) {
  std::ofstream file(path, std::ios::binary);
  if (!file) refuse(told_as, "it cannot be opened");
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) refuse(told_as, "the system takes no more of it");
}

}  // namespace

struct OutputFile::Draft {
  std::string told_as;
  Place place;
  std::string content{};  // of what is written in place
  fs::path draft{};       // empty: there is none

  ~Draft() {
    std::error_code ignored;
    if (!draft.empty()) fs::remove(draft, ignored);
  }
};

OutputFile::OutputFile(const std::string& path, std::string_view content, Sync)
    : draft_(new Draft{.told_as = path, .place = fit_place(path)}) {
  if (draft_->place.in_place) {
    draft_->content = content;
    return;
  }
  draft_->draft = draft_->place.path.parent_path() / draft_name();
  write_all(path, draft_->draft, content);
}

OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

void OutputFile::replace() {
  if (draft_->place.in_place) return write_all(draft_->told_as, draft_->place.path, draft_->content);
  std::error_code error;
  fs::rename(draft_->draft, draft_->place.path, error);
  if (error) refuse(draft_->told_as, error.message());
  draft_->draft.clear();
}

void write_file(const std::string& path, std::string_view content, Sync sync) {
  OutputFile(path, content, sync).replace();
}

void check_writable(const std::string& path) { fit_place(path); }

bool replaces(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file_path(path), ignored);
  return !fs::exists(status) || fs::is_regular_file(status);
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(file_path(a), file_path(b), error)) return true;
  error.clear();
  const fs::path one = whole_path(a, error), other = whole_path(b, error);
  return !error && one == other;
}

}  // namespace perp::lcp
