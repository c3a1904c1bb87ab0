// SPDX-License-Identifier: Apache-2.0
#include "exr/guarded_stream.hpp"

#include "stein/error.hpp"

namespace stein::exr {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kIo, "cannot read '" + path + "': " + why);
}

}  // namespace

GuardedStream::GuardedStream(const std::string& path, ByteProgress& progress)
    : IStream(path.c_str()), path_(path), file_(path, std::ios::binary), progress_(progress) {
  if (!file_) fail(path, "it cannot be opened");
}

bool GuardedStream::read(char* to, int count) {
  if (count < 0) fail(path_, "a chunk claims to have a negative size: the file is damaged");
  progress_.advance(count);
  file_.read(to, count);
  if (!file_) fail(path_, "it ends before its pixels do: it is truncated");
  return true;
}

std::uint64_t GuardedStream::tellg() { return static_cast<std::uint64_t>(file_.tellg()); }

void GuardedStream::seekg(std::uint64_t position) {
  file_.seekg(static_cast<std::streamoff>(position));
  if (!file_) fail(path_, "it ends before its pixels do: it is truncated");
}

void GuardedStream::clear() { file_.clear(); }

}  // namespace stein::exr
